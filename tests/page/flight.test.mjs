/** Flights of the page against those of the program, and against themselves. */

import assert from "node:assert/strict";
import { test } from "node:test";
import { Flight, momentOfFlight } from "../../src/page/spacetime/flight.js";
import {
    advance,
    advanceCoordinated,
    coast,
    headingOf,
    momentOf,
    setBeta,
    velocityOf,
} from "../../src/page/spacetime/moment.js";
import { axes, inverse, multiply } from "../../src/page/spacetime/spinor.js";
import { viewOf } from "../../src/page/spacetime/view.js";
import { momentsOf, numbers, quaternionFrom, vectorFrom } from "./program.mjs";

const START = { time: 0, position: [0, 0, 0], rapidity: 0, direction: [1, 0, 0], orientation: [0, 0, 0, 1] };

function observer(changes = {}) {
    return { ...START, ...changes };
}

function segment(proper_time, acceleration, turn_rate = [0, 0, 0], steer = "free") {
    return { proper_time, acceleration, turn_rate, steer };
}

/** As the scene file has it. */
function inScene({ time, position, rapidity, direction, orientation }, flight) {
    const segments = flight.map(({ turn_rate, steer, ...rest }) => ({
        ...rest,
        ...(steer === "free" ? { turn_rate } : { steer }),
    }));
    return { time, position, velocity: { rapidity, direction }, orientation, flight: segments };
}

/** The largest difference of numbers over the largest of them. */
function difference(found, expected) {
    const size = Math.max(...expected.map(Math.abs), 1e-300);
    return Math.max(...found.map((number, index) => Math.abs(number - expected[index]))) / size;
}

function flies(start, flight, steps, allowed = 1e-12) {
    for (const expected of momentsOf(inScene(start, flight), steps)) {
        const moment = momentOfFlight(start, flight, expected.proper_time);
        const name = `proper time ${expected.proper_time} of ${JSON.stringify(flight)}`;
        const event = [moment.time, ...moment.position];
        assert.ok(difference(event, [expected.time, ...expected.position]) < allowed, `event at ${name}: ${event}`);
        const { rapidity, gamma, direction, beta } = velocityOf(moment);
        assert.ok(Math.abs(rapidity - expected.rapidity) <= allowed * Math.max(1, rapidity), `rapidity at ${name}`);
        assert.ok(Math.abs(gamma / expected.gamma - 1) < allowed * Math.max(1, rapidity), `gamma at ${name}`);
        const velocity = direction.map((part) => part * beta);
        assert.ok(difference(velocity, expected.velocity) < allowed, `velocity at ${name}: ${velocity}`);
        const found = axes(moment.frame).flat();
        assert.ok(difference(found, expected.axes.flat()) < allowed * Math.max(1, rapidity), `axes at ${name}`);
    }
}

test("flights of every type are those of the program", () => {
    const turned = observer({
        time: 0.5,
        position: [3, 1, -1],
        rapidity: 1.5,
        direction: [1, -2, 0.5],
        orientation: [0, 0.6, 0, 0.8],
    });
    const linear = segment(3, [0.5, 0, 0]);
    const rotational = segment(20, [0, 0.5625, 0], [0, 0, 0.9375]);
    const general = segment(2, [0.5, 0.2, 0], [0, 0.1, 0.7]);
    const opposed = segment(4, [-0.5, 0.2, 0.3], [0.4, 0.1, -0.7]);
    const none = segment(3, [1, 0, 0], [0, 0, 1]);
    const nearlyNone = segment(3, [1, 0, 0], [1e-9, 0, 1 + 1e-9]);
    const spinning = segment(3, [0, 0, 0], [0.1, -2, 1]);
    const coasting = segment(3, [0, 0, 0]);
    for (const start of [observer(), turned]) {
        for (const motion of [linear, rotational, general, opposed, none, nearlyNone, spinning, coasting]) {
            const end = motion.proper_time;
            flies(start, [motion], [-2, 0, 1e-9, 0.3 * end, end, end + 1.5]);
        }
        flies(start, [general, none, rotational, linear, coasting, opposed], [1, 3, 7, 30, 35, 40]);
    }
    flies(turned, [], [-1, 0, 2.5]);
});

test("a long thrust is that of the program", () => {
    flies(observer(), [segment(40, [0.3, 0, 0])], [0, 12, 40, 41], 1e-11);
    flies(observer(), [segment(40, [0.3, 0.1, 0], [0, 0.1, 0.2])], [0, 12, 40, 41], 1e-11);
});

test("coordinated turns are those of the program", () => {
    const fast = observer({ rapidity: Math.atanh(0.6), direction: [1, 0, 0] });
    const steered = (time, acceleration) => segment(time, acceleration, [0, 0, 0], "coordinated");
    flies(fast, [steered(2, [0, 0.3, 0])], [0, 1, 2, 3]);
    flies(fast, [steered(80, [0, 0.3, 0.1])], [0, 1, 50, 80]);
    flies(fast, [steered(5, [0.2, 0.3, -0.1]), steered(4, [-0.2, 0, 0.2])], [1, 5, 7, 9, 10]);
    flies(observer(), [steered(3, [0.2, 0, 0]), steered(4, [0.01, 0.1, 0.2])], [1, 3, 5, 7]);
    flies(
        observer({ rapidity: 6, direction: [1, 2, 2], orientation: [0.5, 0.5, 0.5, 0.5] }),
        [steered(2, [-0.5, 0.4, 1])],
        [0.5, 2],
        1e-11,
    );
});

test("flights at random are those of the program", () => {
    const next = numbers(17);
    for (let round = 0; round < 12; round++) {
        const start = observer({
            time: 2 * next() - 1,
            position: vectorFrom(next, 5),
            rapidity: 3 * next(),
            direction: vectorFrom(next),
            orientation: quaternionFrom(next),
        });
        const flight = [0, 1, 2, 3].map((index) => {
            const time = 0.2 + 3 * next();
            const [acceleration, turnRate] = [vectorFrom(next), vectorFrom(next, 2)];
            const steer = index === 3 && start.rapidity > 1 ? "coordinated" : "free";
            return steer === "free"
                ? segment(time, acceleration, turnRate)
                : segment(
                      time,
                      acceleration.map((x) => x / 9),
                      [0, 0, 0],
                      steer,
                  );
        });
        const end = flight.reduce((sum, { proper_time }) => sum + proper_time, 0);
        flies(
            start,
            flight,
            [0, 0.25, 0.5, 0.75, 1].map((part) => part * end),
            1e-11,
        );
    }
});

test("many frames are one segment, also beside something as fast", () => {
    const fast = observer({ rapidity: 14.5, direction: [1, 2, 3], orientation: quaternionFrom(numbers(3)) });
    const beside = { position: [0.1, 0.2, 0.3], rapidity: 14.5, direction: [1, 2, 3] };
    const motions = [
        (from, time) => advance(from, [0.5, 0.2, 0], [0, 0.1, 0.7], time),
        (from, time) => advance(from, [1, 0, 0], [0, 0, 1], time),
        (from, time) => advance(from, [0.01, 0, -0.2], [0, 0, 0], time),
        (from, time) => advanceCoordinated(from, [1e-5, 2e-5, 1e-5], time),
        (from, time) => coast(from, time),
    ];
    for (const start of [momentOf(observer()), momentOf(fast)]) {
        for (const motion of motions) {
            let many = start;
            for (let frame = 0; frame < 600; frame++) {
                many = motion(many, 1 / 60);
            }
            const [found, expected] = [many, motion(start, 10)].map((moment) => viewOf(moment, beside));
            assert.ok(difference(found.offset, expected.offset) < 1e-12, `${found.offset} ${expected.offset}`);
            assert.ok(Math.abs(found.rapidity - expected.rapidity) < 1e-12 * Math.max(1, expected.rapidity));
            assert.ok(difference(found.direction, expected.direction) < 1e-11 || expected.rapidity < 1e-9);
            assert.ok(difference(found.rotation, expected.rotation) < 1e-11);
            assert.ok(Math.abs(many.properTime - 10) < 1e-11);
        }
    }
});

test("after hours of frames the frame is a Lorentz transformation still", () => {
    let moment = momentOf(observer({ rapidity: 14, direction: [1, 2, 3] }));
    const next = numbers(5);
    let [acceleration, turnRate] = [
        [0, 0, 0],
        [0, 0, 0],
    ];
    for (let frame = 0; frame < 1_000_000; frame++) {
        if (frame % 100 === 0) {
            // Up to gamma 1e6 and back.
            const heading = headingOf(moment) ?? [0, 0, 0];
            const isFast = velocityOf(moment).rapidity > 10;
            acceleration = isFast ? heading.map((part) => part * -2) : vectorFrom(next, 3);
            turnRate = isFast ? [0, 0, 0] : vectorFrom(next, 5);
        }
        moment = advance(moment, acceleration, turnRate, 1 / 60);
    }
    const determinant = multiply(moment.frame, inverse(moment.frame));
    determinant[0] -= 1;
    // Of numbers whose squares are `gamma`, with twice the digits.
    const allowed = 1e-30 * velocityOf(moment).gamma + 1e-28;
    assert.ok(
        determinant.every((part) => Math.abs(part) < allowed),
        `${determinant}`,
    );
});

test("at speeds of which no digits are left flights stay what they are", () => {
    for (const rapidity of [40, 100, 350]) {
        let moment = momentOf(observer({ rapidity, direction: [1, 2, 3], orientation: [0, 0.6, 0, 0.8] }));
        for (let frame = 0; frame < 600; frame++) {
            moment = advance(moment, [0, 0, 0], [0, 0.1, 0], 1 / 60);
        }
        assert.ok(Math.abs(velocityOf(moment).rapidity - rapidity) < 1e-9 * rapidity, `${velocityOf(moment).rapidity}`);
        const still = viewOf(moment, { position: [1, 2, 3], rapidity: 0, direction: [1, 0, 0] });
        assert.ok([...still.offset, ...still.direction, ...still.rotation].every(Number.isFinite));
    }
});

test("no threshold shows between the types of flight", () => {
    const start = momentOf(observer());
    let before = null;
    for (let exponent = -1; exponent > -18; exponent -= 0.01) {
        const off = 10 ** exponent;
        const { time, position } = advance(start, [1, 0, 0], [off, 0, 1 + off], 3);
        const now = [time, ...position];
        if (before) {
            // The difference from the null type is in proportion to `off`.
            assert.ok(difference(now, before.now) < 3 * (before.off - off) + 4e-15, `${exponent}: ${now}`);
        }
        before = { now, off };
    }
    assert.ok(difference(before.now, [7.5, 4.5, 4.5, 0]) < 1e-14);
});

test("the slider of speed keeps direction, place and axes", () => {
    const start = momentOf(
        observer({ rapidity: 2, direction: [1, 2, 3], position: [1, 2, 3], orientation: [0, 0.6, 0, 0.8] }),
    );
    for (const beta of [0.1, 0.999999, 0]) {
        const moment = setBeta(start, beta);
        assert.deepEqual(moment.position, start.position);
        assert.ok(Math.abs(velocityOf(moment).beta - beta) < 1e-15);
        if (beta > 0) {
            assert.ok(difference(velocityOf(moment).direction, velocityOf(start).direction) < 1e-15);
        }
    }
    // From rest it goes where the nose is.
    const { direction } = velocityOf(setBeta(setBeta(start, 0), 0.5));
    assert.ok(difference(direction, [-0.96, 0, -0.28]) < 1e-15, `${direction}`);
});

test("a flight knows its segments", () => {
    const flight = new Flight(observer(), [segment(1, [1, 0, 0]), segment(2, [0, 0, 0])]);
    assert.equal(flight.properTime, 3);
    assert.equal(flight.segmentAt(-1), null);
    assert.equal(flight.segmentAt(0), flight.segments[0]);
    assert.equal(flight.segmentAt(1), flight.segments[1]);
    assert.equal(flight.segmentAt(3), null);
    assert.equal(flight.moment(2.5).properTime, 2.5);
    assert.equal(new Flight(observer(), []).moment(-4).time, -4);
});
