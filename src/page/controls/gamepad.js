/** Flying with a gamepad in the standard mapping. */

import { noInput } from "./input.js";

/** @typedef {import("./input.js").Input} Input */
/** @typedef {import("./input.js").Action} Action */

/** A stick that is left alone is off its middle by less than this part of its way. */
const DEAD_ZONE = 0.15;

/** Buttons of the standard mapping. */
const STRONG = 0;
const BRAKE = 1;
const ROLL_LEFT = 4;
const ROLL_RIGHT = 5;
const BACKWARD = 6;
const AHEAD = 7;

/** @type {Readonly<Record<number, Action>>} */
const PRESSED = { 8: "reset", 9: "pause" };

/**
 * What a gamepad asks for, and where its right stick turns the head: to the left and up, each from -1 to 1.
 * @typedef {{ input: Input, look: [number, number] }} PadInput
 */

/**
 * A stick outside of its dead zone, which is round: there it starts from 0, slowly at first.
 * @param {number} x
 * @param {number} y
 * @returns {[number, number]}
 */
export function outsideDeadZone(x, y) {
    const size = Math.hypot(x, y);
    if (!(size > DEAD_ZONE)) {
        return [0, 0];
    }
    const part = Math.min((size - DEAD_ZONE) / (1 - DEAD_ZONE), 1);
    return [((x / size) * part * (1 + part)) / 2, ((y / size) * part * (1 + part)) / 2];
}

/**
 * @param {{ axes: readonly number[], buttons: readonly { value: number, pressed: boolean }[] }} pad
 * @returns {PadInput}
 */
export function inputOfPad({ axes, buttons }) {
    const [x, y] = outsideDeadZone(axes[0] ?? 0, axes[1] ?? 0);
    const [lookX, lookY] = outsideDeadZone(axes[2] ?? 0, axes[3] ?? 0);
    /** @param {number} button */
    const value = (button) => buttons[button]?.value ?? 0;
    /** @param {number} button */
    const isDown = (button) => buttons[button]?.pressed ?? false;
    const input = noInput();
    input.thrust = value(AHEAD) - value(BACKWARD);
    input.yaw = 0 - x;
    input.pitch = 0 - y;
    input.roll = Number(isDown(ROLL_LEFT)) - Number(isDown(ROLL_RIGHT));
    input.brake = isDown(BRAKE);
    input.strong = isDown(STRONG);
    return { input, look: [0 - lookX, 0 - lookY] };
}

/**
 * The gamepads of a browser, none where it does not show them.
 * @param {Partial<Navigator>} navigator
 * @returns {readonly (Gamepad | null)[]}
 */
export function padsOf(navigator) {
    try {
        return navigator.getGamepads?.() ?? [];
    } catch {
        // A page may be denied them.
        return [];
    }
}

export class Gamepads {
    /**
     * Where the right stick turns the head.
     * @type {[number, number]}
     */
    look = [0, 0];
    #pads;
    #onAction;
    /** @type {Set<number>} */
    #down = new Set();

    /**
     * @param {() => readonly (Gamepad | null)[]} pads As {@link padsOf} gives them.
     * @param {(action: Action) => void} onAction
     */
    constructor(pads, onAction) {
        this.#pads = pads;
        this.#onAction = onAction;
    }

    /** @returns {Input} */
    read() {
        const pads = [...this.#pads()].filter((pad) => pad?.connected);
        const pad = pads.find((pad) => pad?.mapping === "standard");
        if (!pad) {
            this.#down.clear();
            this.look = [0, 0];
            return noInput();
        }
        for (const [button, action] of Object.entries(PRESSED)) {
            const number = Number(button);
            const isDown = pad.buttons[number]?.pressed ?? false;
            if (isDown && !this.#down.has(number)) {
                this.#onAction(action);
            }
            isDown ? this.#down.add(number) : this.#down.delete(number);
        }
        const { input, look } = inputOfPad(pad);
        this.look = look;
        return input;
    }
}
