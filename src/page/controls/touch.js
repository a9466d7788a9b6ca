/** Flying with sticks on a touch screen: elements of the page, of which the knob is placed by `--x` and `--y`. */

import { noInput } from "./input.js";

/** @typedef {import("./input.js").Input} Input */

/** How far from its middle, in parts of half an element, a stick is at its end. */
const END = 0.8;

/** A stick: `x` to the right, `y` up, each from -1 to 1. */
export class Stick {
    x = 0;
    y = 0;
    #element;
    /** @type {number | null} */
    #pointer = null;

    /** @param {HTMLElement} element */
    constructor(element) {
        this.#element = element;
        element.style.touchAction = "none";
        element.addEventListener("pointerdown", (event) => {
            if (this.#pointer === null && event.button === 0) {
                event.preventDefault();
                this.#pointer = event.pointerId;
                element.setPointerCapture(event.pointerId);
                this.#follow(event);
            }
        });
        element.addEventListener("pointermove", (event) => {
            if (event.pointerId === this.#pointer) {
                this.#follow(event);
            }
        });
        for (const end of /** @type {const} */ (["pointerup", "pointercancel", "lostpointercapture"])) {
            element.addEventListener(end, (event) => {
                if (event.pointerId === this.#pointer) {
                    this.#pointer = null;
                    this.#set(0, 0);
                }
            });
        }
    }

    /** @param {PointerEvent} event */
    #follow({ clientX, clientY }) {
        const { left, top, width, height } = this.#element.getBoundingClientRect();
        const x = (clientX - left - width / 2) / ((END * width) / 2);
        const y = (top + height / 2 - clientY) / ((END * height) / 2);
        const beyond = Math.max(Math.hypot(x, y), 1);
        this.#set(x / beyond, y / beyond);
    }

    /**
     * @param {number} x
     * @param {number} y
     */
    #set(x, y) {
        this.x = x;
        this.y = y;
        this.#element.style.setProperty("--x", x.toFixed(3));
        this.#element.style.setProperty("--y", y.toFixed(3));
    }
}

/** Two sticks, the left one for thrust and roll, the right one for turns, and a button that brakes while it is pressed. */
export class Touch {
    #thrust;
    #turn;
    #isBraking = false;

    /**
     * @param {HTMLElement} thrust
     * @param {HTMLElement} turn
     * @param {HTMLElement} brake
     */
    constructor(thrust, turn, brake) {
        this.#thrust = new Stick(thrust);
        this.#turn = new Stick(turn);
        brake.style.touchAction = "none";
        brake.addEventListener("pointerdown", (event) => {
            brake.setPointerCapture(event.pointerId);
            this.#isBraking = true;
        });
        for (const end of ["pointerup", "pointercancel", "lostpointercapture"]) {
            brake.addEventListener(end, () => {
                this.#isBraking = false;
            });
        }
    }

    /** @returns {Input} */
    read() {
        return {
            ...noInput(),
            thrust: this.#thrust.y,
            roll: 0 - this.#thrust.x,
            yaw: 0 - this.#turn.x,
            pitch: this.#turn.y,
            brake: this.#isBraking,
        };
    }
}
