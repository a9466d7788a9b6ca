/** A short message that goes away by itself; a screen reader reads it. */

import { element } from "./fields.js";

/** How long a message stays, in milliseconds. */
const STAYS_MS = 4000;

export class Toast {
    element = element("p", "toast");
    #timer = 0;

    constructor() {
        this.element.setAttribute("role", "status");
        this.element.hidden = true;
    }

    /**
     * @param {string} text
     * @param {number} [staysMs]
     */
    show(text, staysMs = STAYS_MS) {
        this.element.textContent = text;
        this.element.hidden = false;
        clearTimeout(this.#timer);
        this.#timer = setTimeout(() => {
            this.element.hidden = true;
        }, staysMs);
    }
}
