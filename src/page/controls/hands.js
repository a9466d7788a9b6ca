/** Flying with the controllers of virtual reality, one in each hand. */

import { outsideDeadZone } from "./gamepad.js";
import { noInput } from "./input.js";

/** @typedef {import("./input.js").Input} Input */
/**
 * A controller, as WebXR shows it.
 * @typedef {object} Hand
 * @property {string} handedness
 * @property {{ axes: readonly number[], buttons: readonly { value: number, pressed: boolean }[] } | null} [gamepad]
 */

/** Buttons of the mapping "xr-standard". */
const TRIGGER = 0;
const SQUEEZE = 1;

/** Where the axes of the thumbstick begin in that mapping; before them are those of a touchpad. */
const THUMBSTICK = 2;

/**
 * The left stick is for thrust and roll, the right one for turns; a trigger is all there is, a squeeze brakes.
 * @param {Iterable<Hand>} hands
 * @returns {Input}
 */
export function inputOfHands(hands) {
    const input = noInput();
    for (const { handedness, gamepad } of hands) {
        if (!gamepad) {
            continue;
        }
        const { axes, buttons } = gamepad;
        const at = axes.length > THUMBSTICK + 1 ? THUMBSTICK : 0;
        const [x, y] = outsideDeadZone(axes[at] ?? 0, axes[at + 1] ?? 0);
        if (handedness === "left") {
            input.thrust = 0 - y;
            input.roll = 0 - x;
        } else {
            input.yaw = 0 - x;
            input.pitch = 0 - y;
        }
        input.strong ||= buttons[TRIGGER]?.pressed ?? false;
        input.brake ||= buttons[SQUEEZE]?.pressed ?? false;
    }
    return input;
}

export class Hands {
    #sources;

    /** @param {() => Iterable<Hand>} sources Those of the session in virtual reality, none outside of one. */
    constructor(sources) {
        this.#sources = sources;
    }

    /** @returns {Input} */
    read() {
        return inputOfHands(this.#sources());
    }
}
