/** The film of a scene's flight, and flying on from it. */

import assert from "node:assert/strict";
import { test } from "node:test";
import { noInput } from "../../src/page/controls/input.js";
import { Pilot } from "../../src/page/controls/pilot.js";
import { setBeta, velocityOf } from "../../src/page/spacetime/moment.js";

const FRAME = 1 / 60;

const SCENE = {
    observer: { time: 0, position: [0, 2, 0], rapidity: 1, direction: [0, 0, -1], orientation: [0, 0, 0, 1] },
    flight: [{ proper_time: 4, acceleration: [0, 0, -0.25], turn_rate: [0, 0, 0], steer: "free" }],
    steps: [0, 2, 4],
};

const STATE = { paused: false, timeScale: 1, steering: "free", film: true };

test("the film plays until someone takes over, and flying goes on from there", () => {
    const device = { input: noInput(), read: () => device.input };
    const pilot = new Pilot(SCENE, 60, [device]);
    assert.equal(pilot.timeScale, 0.5);
    for (let frame = 0; frame < 120; frame++) {
        assert.equal(pilot.frame(FRAME, STATE), false);
    }
    assert.ok(Math.abs(pilot.moment.properTime - 2) < 1e-12);
    assert.ok(Math.abs(velocityOf(pilot.moment).rapidity - 1.5) < 1e-12);
    pilot.frame(FRAME, { ...STATE, paused: true });
    assert.ok(Math.abs(pilot.moment.properTime - 2) < 1e-12);
    device.input = { ...noInput(), thrust: -1 };
    assert.equal(pilot.frame(FRAME, STATE), true);
    const flown = { ...STATE, film: false };
    for (let frame = 0; frame < 60; frame++) {
        assert.equal(pilot.frame(FRAME, flown), false);
    }
    assert.ok(velocityOf(pilot.moment).rapidity < 1.5 && pilot.moment.properTime > 3);
    assert.ok(pilot.moment.position[2] < -2);
    pilot.moment = setBeta(pilot.moment, 0.25);
    const { time } = pilot.moment;
    pilot.frame(FRAME, { ...flown, paused: true });
    assert.equal(pilot.moment.time, time);
    // A page that was in the background does not leap.
    pilot.frame(1e6, flown);
    assert.ok(pilot.moment.time - time < 0.2);
    pilot.reset();
    assert.deepEqual([pilot.moment.time, pilot.moment.properTime, pilot.film.properTime], [0, 0, 0]);
});

test("a film stays at its end", () => {
    const pilot = new Pilot(SCENE, 60, []);
    for (let frame = 0; frame < 600; frame++) {
        pilot.frame(FRAME, STATE);
    }
    assert.equal(pilot.moment.properTime, 4);
    assert.ok(pilot.film.isAtEnd);
});

test("who begins to fly ends a pause, but not with a key that is still down", () => {
    const device = { input: noInput(), read: () => device.input };
    const pilot = new Pilot(SCENE, 60, [device]);
    const paused = { ...STATE, film: false, paused: true };
    assert.equal(pilot.frame(FRAME, paused), false);
    device.input = { ...noInput(), thrust: 1 };
    assert.equal(pilot.frame(FRAME, paused), true);
    assert.equal(pilot.frame(FRAME, { ...paused, paused: false }), false);
    assert.equal(pilot.frame(FRAME, paused), false);
    // The engines still follow, but the key is pressed again.
    device.input = noInput();
    assert.equal(pilot.frame(FRAME, paused), false);
    device.input = { ...noInput(), yaw: 1 };
    assert.equal(pilot.frame(FRAME, paused), true);
});
