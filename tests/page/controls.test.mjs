/** Flying: devices, commands, and what becomes of the observer. */

import assert from "node:assert/strict";
import { test } from "node:test";
import { Controls, thrustFor, timeScaleFor } from "../../src/page/controls/controls.js";
import { Film } from "../../src/page/controls/film.js";
import { fly } from "../../src/page/controls/flying.js";
import { Gamepads, inputOfPad, outsideDeadZone, padsOf } from "../../src/page/controls/gamepad.js";
import { Hands } from "../../src/page/controls/hands.js";
import { noInput, sumOfInputs } from "../../src/page/controls/input.js";
import { Keyboard } from "../../src/page/controls/keyboard.js";
import { directionOfLook, lookOf, rotationOfLook, turnedLook } from "../../src/page/controls/look.js";
import { mouseLook } from "../../src/page/controls/mouse.js";
import { Stick, Touch } from "../../src/page/controls/touch.js";
import { headingOf, momentOf, velocityOf } from "../../src/page/spacetime/moment.js";
import { dot } from "../../src/page/spacetime/vector.js";
import { numbers, vectorFrom } from "./program.mjs";

const FRAME = 1 / 60;

function start(changes = {}) {
    return momentOf({
        time: 0,
        position: [0, 0, 0],
        rapidity: 0,
        direction: [0, 0, -1],
        orientation: [0, 0, 0, 1],
        ...changes,
    });
}

function command(changes = {}) {
    return { acceleration: [0, 0, 0], turnRate: [0, 0, 0], brake: 0, ...changes };
}

function near(found, expected, allowed) {
    const gap = Math.hypot(...found.map((number, index) => number - expected[index]));
    assert.ok(gap <= allowed, `${found} and ${expected} differ by ${gap}`);
}

/** An element without a document: what the controls use of one. */
function element(changes = {}) {
    const target = new EventTarget();
    const properties = {};
    return Object.assign(target, {
        style: { setProperty: (name, value) => Object.assign(properties, { [name]: value }) },
        properties,
        clientHeight: 100,
        setPointerCapture: () => {},
        getBoundingClientRect: () => ({ left: 0, top: 0, width: 100, height: 100 }),
        ...changes,
    });
}

function send(target, type, properties = {}) {
    const event = new Event(type, { cancelable: true });
    for (const [name, value] of Object.entries(properties)) {
        Object.defineProperty(event, name, { value });
    }
    target.dispatchEvent(event);
    return event;
}

function keyboard() {
    const window = Object.assign(new EventTarget(), { document: new EventTarget() });
    const actions = [];
    const keys = new Keyboard(window, (action) => actions.push(action));
    const press = (code, properties = {}) => send(window, "keydown", { code, key: code, ...properties });
    const release = (code) => send(window, "keyup", { code, key: code });
    return { window, actions, keys, press, release };
}

test("keys fly while they are down", () => {
    const { window, keys, press, release, actions } = keyboard();
    press("KeyW");
    press("ArrowLeft");
    press("KeyR");
    press("KeyE");
    press("ShiftLeft");
    assert.deepEqual(keys.read(), { thrust: 1, yaw: 1, pitch: 1, roll: -1, brake: false, strong: true });
    release("KeyW");
    press("KeyX");
    assert.deepEqual(keys.read(), { thrust: 0, yaw: 1, pitch: 1, roll: -1, brake: true, strong: true });
    send(window, "blur");
    assert.deepEqual(keys.read(), noInput());
    press("Space");
    press("Space", { repeat: true });
    press("Slash", { key: "?" });
    press("Backspace");
    assert.deepEqual(actions, ["pause", "help", "reset"]);
    press("constructor");
    assert.deepEqual(keys.read(), noInput());
});

test("keys are left to fields that have the focus, and to the browser", () => {
    const { keys, press, actions } = keyboard();
    const text = { target: { tagName: "INPUT", type: "text" } };
    const slider = { target: { tagName: "INPUT", type: "range" } };
    const button = { target: { tagName: "BUTTON" } };
    press("KeyW", text);
    press("KeyW", { target: { tagName: "TEXTAREA" } });
    press("KeyW", { target: { tagName: "SELECT" } });
    press("KeyW", { target: { tagName: "DIV", isContentEditable: true } });
    press("KeyW", { ctrlKey: true });
    press("KeyR", { metaKey: true });
    press("ArrowLeft", slider);
    press("Space", button);
    assert.deepEqual(keys.read(), noInput());
    assert.deepEqual(actions, []);
    assert.equal(press("ArrowLeft", slider).defaultPrevented, false);
    assert.equal(press("ArrowLeft").defaultPrevented, true);
    press("KeyW", slider);
    press("KeyR", button);
    assert.deepEqual(keys.read(), { ...noInput(), thrust: 1, yaw: 1, pitch: 1 });
    // No field but those that are written into has a use for it.
    press("Backspace", button);
    press("Backspace", text);
    assert.deepEqual(actions, ["reset"]);
});

test("a gamepad has a dead zone and its whole way", () => {
    assert.deepEqual(outsideDeadZone(0.1, -0.1), [0, 0]);
    near(outsideDeadZone(1, 0), [1, 0], 1e-15);
    near(outsideDeadZone(-1, 1), [-Math.SQRT1_2, Math.SQRT1_2], 1e-15);
    const buttons = Array.from({ length: 17 }, () => ({ value: 0, pressed: false }));
    buttons[7] = { value: 0.5, pressed: true };
    buttons[9] = { value: 1, pressed: true };
    const pad = { connected: true, mapping: "standard", axes: [1, -1, 0, 1], buttons };
    const { input, look } = inputOfPad(pad);
    assert.equal(input.thrust, 0.5);
    near([input.yaw, input.pitch], [-Math.SQRT1_2, Math.SQRT1_2], 1e-15);
    near(look, [0, -1], 1e-15);
    const actions = [];
    const pads = new Gamepads(
        () => [null, pad],
        (action) => actions.push(action),
    );
    pads.read();
    assert.deepEqual(pads.read(), input);
    assert.deepEqual(actions, ["pause"]);
    assert.deepEqual(
        new Gamepads(
            () => [null],
            () => {},
        ).read(),
        noInput(),
    );
});

test("hands in virtual reality fly", () => {
    const up = { value: 0, pressed: false };
    const down = { value: 1, pressed: true };
    const left = { handedness: "left", gamepad: { axes: [0, 0, 0, -1], buttons: [down, up] } };
    const right = { handedness: "right", gamepad: { axes: [1, 0], buttons: [up, down] } };
    const expected = { thrust: 1, yaw: -1, pitch: 0, roll: 0, brake: true, strong: true };
    assert.deepEqual(new Hands(() => [left, right, { handedness: "none" }]).read(), expected);
    assert.deepEqual(new Hands(() => []).read(), noInput());
    const denied = {
        getGamepads: () => {
            throw new Error("denied");
        },
    };
    assert.deepEqual([padsOf({}), padsOf(denied)], [[], []]);
});

test("sticks follow one finger and spring back", () => {
    const [left, right, brake] = [element(), element(), element()];
    const touch = new Touch(left, right, brake);
    const finger = { pointerId: 7, button: 0 };
    send(left, "pointerdown", { ...finger, clientX: 50, clientY: 30 });
    assert.equal(touch.read().thrust, 0.5);
    send(left, "pointermove", { pointerId: 8, clientX: 90, clientY: 50 });
    send(left, "pointermove", { ...finger, clientX: 50, clientY: -400 });
    assert.equal(touch.read().thrust, 1);
    assert.equal(left.properties["--y"], "1.000");
    send(right, "pointerdown", { pointerId: 8, button: 0, clientX: 90, clientY: 50 });
    assert.equal(touch.read().yaw, -1);
    send(brake, "pointerdown", { pointerId: 9 });
    assert.equal(touch.read().brake, true);
    send(brake, "pointerup", { pointerId: 9 });
    send(left, "pointerup", finger);
    send(right, "pointercancel", { pointerId: 8 });
    assert.deepEqual(touch.read(), noInput());
    assert.deepEqual([new Stick(element()).x, new Stick(element()).y], [0, 0]);
});

test("what is seen is dragged along", () => {
    const view = element();
    let look = [0, 0];
    const zooms = [];
    mouseLook(view, {
        fieldOfViewDeg: () => 90,
        turn: (change) => {
            look = turnedLook(look, change);
        },
        center: () => {
            look = [0, 0];
        },
        zoom: (factor) => zooms.push(factor),
    });
    send(view, "pointerdown", { pointerId: 1, button: 0, clientX: 10, clientY: 10 });
    send(view, "pointermove", { pointerId: 1, clientX: 20, clientY: 15 });
    near(look, [0.2, 0.1], 1e-15);
    // To the left, up.
    const [x, y, z] = directionOfLook(look);
    assert.ok(x < 0 && y > 0 && z < 0);
    send(view, "pointerup", { pointerId: 1 });
    send(view, "pointermove", { pointerId: 1, clientX: 90, clientY: 90 });
    near(look, [0.2, 0.1], 1e-15);
    send(view, "dblclick");
    assert.deepEqual(look, [0, 0]);
    send(view, "wheel", { deltaY: 3 });
    assert.deepEqual(zooms, [1.05]);
});

test("a head turns all around but not over", () => {
    assert.deepEqual(directionOfLook([0, 0]), [0, 0, -1]);
    near(directionOfLook([Math.PI / 2, 0]), [-1, 0, 0], 1e-15);
    near(turnedLook([3, 0], [0.5, 9]), [3.5 - 2 * Math.PI, (89 / 180) * Math.PI], 1e-15);
    for (const look of [
        [0, 0],
        [1, 0.5],
        [-3, -1.5],
        [2, 0],
    ]) {
        near(lookOf(directionOfLook(look)), look, 1e-14);
    }
    assert.deepEqual(
        [lookOf([0, -2, 0]), lookOf([0, 2, 0])],
        [
            [0, -Math.PI / 2],
            [0, Math.PI / 2],
        ],
    );
    assert.deepEqual(lookOf([0, 0, -1]), [0, 0]);
    const [x, y, z, w] = rotationOfLook([1, 0.5]);
    assert.ok(Math.abs(Math.hypot(x, y, z, w) - 1) < 1e-15);
});

test("engines start and stop smoothly, and then the observer coasts", () => {
    const device = { input: noInput(), read: () => device.input };
    const controls = new Controls(thrustFor(20), [device, { read: noInput }]);
    assert.equal(timeScaleFor(20), 1);
    assert.equal(timeScaleFor(20, 4), 0.5);
    assert.equal(timeScaleFor(20, 400), 5);
    device.input = { ...noInput(), thrust: 1, yaw: 1 };
    const thrusts = Array.from({ length: 120 }, () => -controls.read(FRAME, 1).acceleration[2]);
    assert.ok(thrusts[0] > 0 && thrusts[0] < 0.2 * thrustFor(20));
    assert.ok(thrusts.every((thrust, index) => index === 0 || thrust > thrusts[index - 1]));
    near([thrusts[119]], [thrustFor(20)], 1e-6);
    // Turns take the same time for a person, however slow time is.
    const { turnRate } = controls.read(FRAME, 0.1);
    near(turnRate, [0, 8, 0], 1e-4);
    assert.ok(controls.isActive);
    device.input = noInput();
    for (let frame = 0; frame < 120; frame++) {
        controls.read(FRAME, 1);
    }
    assert.deepEqual(controls.read(FRAME, 1), command());
    assert.ok(!controls.isActive);
    assert.deepEqual(
        sumOfInputs([
            { ...noInput(), thrust: 1 },
            { ...noInput(), thrust: 0.5 },
        ]).thrust,
        1,
    );
});

test("a brake leads to rest, and not beyond", () => {
    const next = numbers(7);
    for (let round = 0; round < 20; round++) {
        let moment = start({ rapidity: 5 * next(), direction: vectorFrom(next), orientation: [0, 0.6, 0, 0.8] });
        const heading = headingOf(moment);
        let rapidity = velocityOf(moment).rapidity;
        const turnRate = round % 2 === 0 ? [0, 0, 0] : vectorFrom(next, 3);
        let frames = 0;
        while (rapidity > 0) {
            moment = fly(moment, command({ brake: 0.7, turnRate }), round % 3 === 0 ? "free" : "coordinated", FRAME);
            const slower = velocityOf(moment).rapidity;
            assert.ok(slower < rapidity);
            rapidity = slower;
            frames += 1;
            assert.ok(frames < 1000);
        }
        assert.equal(velocityOf(moment).rapidity, 0);
        const still = fly(moment, command({ brake: 0.7 }), "free", FRAME);
        assert.deepEqual(still.position, moment.position);
        assert.ok(heading);
    }
});

test("thrust in free steering passes through rest, that of an airplane stops there", () => {
    for (const steering of ["free", "coordinated"]) {
        let moment = start({ rapidity: 0.1 });
        for (let frame = 0; frame < 60; frame++) {
            moment = fly(moment, command({ acceleration: [0, 0, 0.5] }), steering, FRAME);
        }
        const { rapidity, direction } = velocityOf(moment);
        if (steering === "free") {
            near([rapidity, ...direction], [0.4, 0, 0, 1], 1e-14);
        } else {
            assert.equal(rapidity, 0);
        }
    }
});

test("an airplane keeps its nose on its motion, and its speed in turns", () => {
    let moment = start({ rapidity: 2 });
    for (let frame = 0; frame < 600; frame++) {
        moment = fly(moment, command({ turnRate: [0.3, 0.8, -0.5] }), "coordinated", FRAME);
        near(headingOf(moment), [0, 0, -1], 1e-13);
        assert.ok(frame !== 120 || Math.abs(velocityOf(moment).direction[2] + 1) > 0.1);
    }
    near([velocityOf(moment).rapidity], [2], 1e-12);
    // A quarter of a circle in the scene.
    const [before, turn] = [velocityOf(moment).direction, command({ turnRate: [0, Math.PI / 2, 0] })];
    for (let frame = 0; frame < 60; frame++) {
        moment = fly(moment, turn, "coordinated", FRAME);
    }
    near([dot(velocityOf(moment).direction, before)], [0], 1e-12);
    for (let frame = 0; frame < 60; frame++) {
        moment = fly(moment, command({ acceleration: [0, 0, -1], turnRate: [0, 1, 0] }), "coordinated", FRAME);
    }
    near([velocityOf(moment).rapidity, ...headingOf(moment)], [3, 0, 0, -1], 1e-12);
});

test("one who drifted turns the nose into the motion when steering like an airplane", () => {
    let moment = start({ rapidity: 1, direction: [1, 0, 0] });
    for (let frame = 0; frame < 600; frame++) {
        moment = fly(moment, command({ acceleration: [0, 0, -0.3] }), "coordinated", FRAME);
    }
    near([velocityOf(moment).rapidity, ...velocityOf(moment).direction], [4, 1, 0, 0], 1e-12);
    near(headingOf(moment), [0, 0, -1], 1e-3);
});

test("at rest the nose turns in place", () => {
    for (const steering of ["free", "coordinated"]) {
        let moment = start();
        for (let frame = 0; frame < 60; frame++) {
            moment = fly(moment, command({ turnRate: [0, Math.PI / 2, 0] }), steering, FRAME);
        }
        near(moment.position, [0, 0, 0], 0);
        moment = fly(moment, command({ acceleration: [0, 0, -1] }), steering, FRAME);
        near(velocityOf(moment).direction, [-1, 0, 0], 1e-12);
    }
});

test("nobody flies faster than numbers of shaders hold", () => {
    for (const steering of ["free", "coordinated"]) {
        let moment = start({ rapidity: 15.9 });
        for (let frame = 0; frame < 600; frame++) {
            const turnRate = frame < 300 ? [0, 0, 0] : [0, 1, 0];
            moment = fly(moment, command({ acceleration: [0, 0, -1], turnRate }), steering, FRAME);
        }
        const { rapidity } = velocityOf(moment);
        assert.ok(rapidity <= 16 && rapidity > 14, `${rapidity}`);
        assert.ok(moment.position.every(Number.isFinite));
    }
    // One who starts faster stays so.
    assert.equal(velocityOf(fly(start({ rapidity: 40 }), command(), "free", FRAME)).rapidity, 40);
});

test("a film plays, stops anywhere, and is flown on from", () => {
    const observer = { time: 0, position: [0, 0, 0], rapidity: 0, direction: [1, 0, 0], orientation: [0, 0, 0, 1] };
    const flight = [{ proper_time: 2, acceleration: [0, 0, -1], turn_rate: [0, 0, 0], steer: "free" }];
    const film = new Film(observer, flight, [-1, 0, 3]);
    assert.deepEqual([film.from, film.to, film.properTime], [-1, 3, -1]);
    film.play(3);
    assert.equal(film.moment.properTime, 2);
    assert.equal(film.moment, film.moment);
    near([velocityOf(film.moment).rapidity], [2], 1e-14);
    const next = fly(film.moment, command({ acceleration: [0, 0, 1] }), "free", 2);
    near([velocityOf(next).rapidity, next.properTime], [0, 4], 1e-14);
    film.play(100);
    assert.ok(film.isAtEnd && film.isLong && film.properTime === 3);
    film.seek(-7);
    assert.equal(film.moment.time, -1);
    assert.ok(!new Film(observer, [], [0]).isLong);
});
