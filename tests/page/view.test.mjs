/** Where vertices are seen from moments of the page, against the program's photosurfaces. */

import assert from "node:assert/strict";
import { test } from "node:test";
import { momentOfFlight } from "../../src/page/spacetime/flight.js";
import { rotate } from "../../src/page/spacetime/quaternion.js";
import { cross, dot, length, scaled, subtract, sum } from "../../src/page/spacetime/vector.js";
import { viewOf } from "../../src/page/spacetime/view.js";
import { numbers, quaternionFrom, vectorFrom, verticesSeen } from "./program.mjs";

/** Where a point of the rest frame is seen, in the observer's own axes, by light-cone coordinates. */
function seen(view, place) {
    const offset = subtract(place, view.offset);
    const across = cross(cross(view.direction, offset), view.direction);
    const [along, distance, square] = [dot(view.direction, offset), length(offset), dot(across, across)];
    const ahead = along > 0 ? distance + along : square / (distance - along);
    const behind = along > 0 ? square / (distance + along) : distance - along;
    const stretch = Math.exp(view.rapidity);
    return rotate(view.rotation, sum(across, scaled(view.direction, 0.5 * (ahead * stretch - behind / stretch))));
}

/**
 * The largest error over the distance, where the relative speed is no larger than that of gamma 1e6. Above it places that are
 * numbers of 53 bits have no more digits straight behind the observer: the last one is magnified by `stretch`, `exp(rapidity)`.
 */
function sees(start, flight, bodies, time, next) {
    const meshes = bodies.map(() => [0, 1].map(() => [0, 1, 2].map(() => vectorFrom(next, 3).map(Math.fround))));
    const { rapidity, direction, ...rest } = start;
    const segments = flight.map(({ proper_time, acceleration, turn_rate }) => ({
        proper_time,
        acceleration,
        turn_rate,
    }));
    const observer = { ...rest, velocity: { rapidity, direction }, flight: segments };
    const objects = bodies.map((body) => ({
        position: body.position,
        rotation: body.rotation,
        scale: body.scale,
        velocity: { rapidity: body.rapidity, direction: body.direction },
    }));
    const expected = verticesSeen(observer, objects, time, meshes);
    const moment = momentOfFlight(start, flight, time);
    const found = bodies.flatMap((body, index) => {
        const view = viewOf(moment, body);
        const digits = Math.max(1, Math.exp(view.rapidity - 14.5));
        const places = meshes[index].flat().map((vertex) => scaled(rotate(body.rotation, vertex), body.scale));
        return places.map((place) => ({ vertex: seen(view, place), digits }));
    });
    assert.equal(found.length, expected.length);
    const errors = found.map(
        ({ vertex, digits }, index) => length(subtract(vertex, expected[index])) / length(expected[index]) / digits,
    );
    return Math.max(...errors);
}

function bodyFrom(next, rapidity, direction) {
    return { position: vectorFrom(next, 10), rapidity, direction, rotation: quaternionFrom(next), scale: 0.5 + next() };
}

function startFrom(next, rapidity, direction) {
    return {
        time: 2 * next() - 1,
        position: vectorFrom(next, 5),
        rapidity,
        direction,
        orientation: quaternionFrom(next),
    };
}

function segmentsFrom(next, size) {
    return [0, 1].map(() => ({
        proper_time: 0.1 + next(),
        acceleration: vectorFrom(next, size),
        turn_rate: vectorFrom(next, 1),
        steer: "free",
    }));
}

test("moving, turned objects are seen where the program sees them, at any speed", () => {
    const next = numbers(29);
    let largest = 0;
    for (let round = 0; round < 25; round++) {
        const start = startFrom(next, 14.5 * next(), vectorFrom(next));
        const flight = segmentsFrom(next, 2);
        const bodies = [0, 1, 2].map((index) => bodyFrom(next, index === 0 ? 0 : 14.5 * next(), vectorFrom(next)));
        largest = Math.max(largest, sees(start, flight, bodies, 2.5 * next(), next));
    }
    assert.ok(largest < 1e-9, `${largest}`);
});

test("so are objects as fast as the observer, at gamma 1e6", () => {
    const next = numbers(31);
    let largest = 0;
    for (let round = 0; round < 25; round++) {
        const direction = vectorFrom(next);
        const start = startFrom(next, 14.5, direction);
        const flight = round % 2 === 0 ? [] : segmentsFrom(next, 1);
        const near = vectorFrom(next, 1e-6);
        const bodies = [
            bodyFrom(next, 14.5, direction),
            bodyFrom(next, 14.5 + next() - 0.5, direction),
            bodyFrom(next, 14.5, sum(direction, near)),
        ];
        largest = Math.max(largest, sees(start, flight, bodies, 2 * next(), next));
    }
    assert.ok(largest < 1e-9, `${largest}`);
});
