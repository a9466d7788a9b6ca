/** Flying with the two controllers of a headset. */

import { outsideDeadZone } from "../controls/gamepad.js";
import { noInput, sumOfInputs } from "../controls/input.js";

/** @typedef {import("../controls/input.js").Input} Input */

/** Buttons of the mapping "xr-standard". */
const TRIGGER = 0;
const SQUEEZE = 1;

/** The first of the two axes of the thumbstick; a touchpad, where there is one in place of it, has the axes from 0. */
const THUMBSTICK = 2;

/**
 * @typedef {object} Controller
 * @property {"left" | "right" | "none" | string} handedness
 * @property {{ axes: readonly number[], buttons: readonly { pressed: boolean }[] } | null | undefined} [gamepad]
 */

/**
 * The left stick is thrust and roll, the right one turns; a trigger gives all there is, a squeeze brakes.
 * @param {Iterable<Controller>} controllers
 * @returns {Input}
 */
export function inputOfControllers(controllers) {
    return sumOfInputs([...controllers].map(inputOfOne));
}

/** @param {Controller} controller @returns {Input} */
function inputOfOne({ handedness, gamepad }) {
    const input = noInput();
    if (!gamepad) {
        return input;
    }
    const first = gamepad.axes.length > THUMBSTICK ? THUMBSTICK : 0;
    const [x, y] = outsideDeadZone(gamepad.axes[first] ?? 0, gamepad.axes[first + 1] ?? 0);
    if (handedness === "left") {
        input.thrust = 0 - y;
        input.roll = 0 - x;
    } else {
        input.yaw = 0 - x;
        input.pitch = 0 - y;
    }
    input.strong = gamepad.buttons[TRIGGER]?.pressed ?? false;
    input.brake = gamepad.buttons[SQUEEZE]?.pressed ?? false;
    return input;
}
