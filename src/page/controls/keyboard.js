/** Flying with the keyboard, by the places of keys: the same on all layouts. */

import { noInput } from "./input.js";

/** @typedef {import("./input.js").Input} Input */
/** @typedef {import("./input.js").Action} Action */

/** @type {Readonly<Record<string, Partial<Input>>>} */
const HELD = {
    KeyW: { thrust: 1 },
    KeyS: { thrust: -1 },
    ArrowUp: { thrust: 1 },
    ArrowDown: { thrust: -1 },
    KeyA: { yaw: 1 },
    KeyD: { yaw: -1 },
    ArrowLeft: { yaw: 1 },
    ArrowRight: { yaw: -1 },
    KeyR: { pitch: 1 },
    KeyF: { pitch: -1 },
    KeyQ: { roll: 1 },
    KeyE: { roll: -1 },
    KeyX: { brake: true },
    ShiftLeft: { strong: true },
    ShiftRight: { strong: true },
};

/** @type {Readonly<Record<string, Action>>} */
const PRESSED = { Space: "pause", Backspace: "reset", F1: "help" };

/** Keys that a focused button, slider or list uses itself. */
const OF_FIELDS = new Set(["Space", "ArrowUp", "ArrowDown", "ArrowLeft", "ArrowRight", "ShiftLeft", "ShiftRight"]);

/** Inputs into which nothing is written. */
const NOT_WRITTEN_INTO = new Set(["range", "checkbox", "radio", "button", "submit", "reset", "color"]);

/** Elements that letters do not concern, but {@link OF_FIELDS} do. */
const FIELDS = new Set(["INPUT", "BUTTON", "SUMMARY", "A"]);

export class Keyboard {
    /** @type {Set<string>} */
    #down = new Set();
    #onAction;

    /**
     * @param {Window} window
     * @param {(action: Action) => void} onAction
     */
    constructor(window, onAction) {
        this.#onAction = onAction;
        window.addEventListener("keydown", (event) => this.#press(event));
        window.addEventListener("keyup", (event) => this.#release(event));
        // Keys that are let go elsewhere are never heard of.
        window.addEventListener("blur", () => this.#down.clear());
        window.document.addEventListener("visibilitychange", () => this.#down.clear());
        window.document.addEventListener("focusin", (event) => {
            if (takes(event.target, "KeyW")) {
                this.#down.clear();
            }
        });
    }

    /** @returns {Input} */
    read() {
        const input = noInput();
        for (const code of this.#down) {
            const { thrust = 0, yaw = 0, pitch = 0, roll = 0, brake = false, strong = false } = HELD[code];
            input.thrust += thrust;
            input.yaw += yaw;
            input.pitch += pitch;
            input.roll += roll;
            input.brake ||= brake;
            input.strong ||= strong;
        }
        return input;
    }

    /** @param {KeyboardEvent} event */
    #press(event) {
        if (event.ctrlKey || event.metaKey || event.altKey || event.isComposing || takes(event.target, event.code)) {
            return;
        }
        const action = event.key === "?" ? "help" : Object.hasOwn(PRESSED, event.code) ? PRESSED[event.code] : null;
        if (action) {
            event.preventDefault();
            if (!event.repeat) {
                this.#onAction(action);
            }
        } else if (Object.hasOwn(HELD, event.code)) {
            // Arrow keys scroll.
            event.preventDefault();
            this.#down.add(event.code);
        }
    }

    /** @param {KeyboardEvent} event */
    #release(event) {
        if (event.key === "Meta") {
            // While it is down other keys are not heard of when they are let go.
            this.#down.clear();
        }
        this.#down.delete(event.code);
    }
}

/**
 * Whether an element with the focus uses a key itself.
 * @param {EventTarget | null} target
 * @param {string} code
 */
function takes(target, code) {
    const element = /** @type {HTMLElement | null} */ (target);
    const name = element?.tagName ?? "";
    const isWrittenInto =
        name === "TEXTAREA" ||
        name === "SELECT" ||
        element?.isContentEditable === true ||
        (name === "INPUT" && !NOT_WRITTEN_INTO.has(/** @type {HTMLInputElement} */ (element).type));
    return isWrittenInto || (FIELDS.has(name) && OF_FIELDS.has(code));
}
