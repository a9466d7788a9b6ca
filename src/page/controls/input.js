/** What the devices under a person's hands ask for, all alike. */

/**
 * Each number is from -1 to 1: thrust ahead; turns to the left, up, and over the left wing.
 * @typedef {object} Input
 * @property {number} thrust
 * @property {number} yaw
 * @property {number} pitch
 * @property {number} roll
 * @property {boolean} brake Brake until the observer is at rest in the scene.
 * @property {boolean} strong With all there is.
 */

/** @typedef {"pause" | "reset" | "help"} Action What a press of a key or button does once. */

/** @returns {Input} */
export function noInput() {
    return { thrust: 0, yaw: 0, pitch: 0, roll: 0, brake: false, strong: false };
}

/**
 * Of several devices at once.
 * @param {Input[]} inputs
 * @returns {Input}
 */
export function sumOfInputs(inputs) {
    const sum = noInput();
    for (const input of inputs) {
        sum.thrust += input.thrust;
        sum.yaw += input.yaw;
        sum.pitch += input.pitch;
        sum.roll += input.roll;
        sum.brake ||= input.brake;
        sum.strong ||= input.strong;
    }
    return {
        ...sum,
        thrust: held(sum.thrust),
        yaw: held(sum.yaw),
        pitch: held(sum.pitch),
        roll: held(sum.roll),
    };
}

/** @param {number} number */
function held(number) {
    return Math.min(Math.max(number, -1), 1);
}
