/** Where vertices are seen from moments of the page, against the program's photosurfaces. */

import assert from "node:assert/strict";
import { test } from "node:test";
import { momentOfFlight } from "../../src/page/spacetime/flight.js";
import { advance, momentOf, observerOf } from "../../src/page/spacetime/moment.js";
import { rotate } from "../../src/page/spacetime/quaternion.js";
import { cross, dot, length, scaled, subtract, sum, unit } from "../../src/page/spacetime/vector.js";
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

test("so is something as fast that is near at the end of a long flight", () => {
    const next = numbers(37);
    let largest = 0;
    for (let round = 0; round < 12; round++) {
        const start = startFrom(next, 0, [1, 0, 0]);
        const thrust = scaled(unit(vectorFrom(next), [1, 0, 0]), 14 / 30);
        const turn = { ...segmentsFrom(next, 0.5)[0], proper_time: 5 };
        const straight = { proper_time: 30, acceleration: thrust, turn_rate: [0, 0, 0], steer: "free" };
        const flight = round % 2 === 0 ? [straight] : [turn, straight, turn];
        const time = round % 2 === 0 ? 30 : 36 + 3 * next();
        const { position, rapidity, direction, time: sceneTime } = observerOf(momentOfFlight(start, flight, time));
        assert.ok(rapidity > 12, `${rapidity}`);
        const velocity = scaled(direction, Math.tanh(rapidity));
        const body = {
            ...bodyFrom(next, rapidity, direction),
            position: subtract(position, scaled(velocity, sceneTime)),
        };
        largest = Math.max(largest, sees(start, flight, [body], time, next));
    }
    // The way there was magnified by `gamma`, and with it the rounding of both flights.
    assert.ok(largest < 5e-8, `${largest}`);
});

test("a long flight leads beside something fast in one segment as in a thousand", () => {
    const next = numbers(39);
    for (let round = 0; round < 6; round++) {
        const start = momentOf(startFrom(next, 0, [1, 0, 0]));
        const thrust = scaled(unit(vectorFrom(next), [1, 0, 0]), 14 / 30);
        const turnRate = round % 2 === 0 ? [0, 0, 0] : vectorFrom(next, 0.02);
        const [once, often] = [1, 1000].map((count) => {
            let moment = start;
            for (let part = 0; part < count; part++) {
                moment = advance(moment, thrust, turnRate, 30 / count);
            }
            return moment;
        });
        const { position, rapidity, direction, time } = observerOf(once);
        assert.ok(rapidity > 13);
        const beside = {
            rapidity,
            direction,
            position: subtract(position, scaled(direction, Math.tanh(rapidity) * time)),
        };
        const gap = length(subtract(viewOf(once, beside).offset, viewOf(often, beside).offset));
        assert.ok(gap < 5e-9, `${gap}`);
    }
});
