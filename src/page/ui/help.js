/** The help: keys, and the physics in five sentences. */

import { words } from "../texts.js";
import { button, element } from "./fields.js";

export class Help {
    element = /** @type {HTMLDialogElement} */ (element("dialog", "help"));

    /** @param {() => void} onClose */
    constructor(onClose) {
        const keys = element("dl", "keys");
        for (const [key, meaning] of words.keys) {
            keys.append(element("dt", "key", key), element("dd", "meaning", meaning));
        }
        const physics = words.physics.map((sentence) => element("p", "physics", sentence));
        // First, where the focus begins: then the help is read from its top.
        const close = button(words.close, () => this.element.close());
        close.classList.add("close");
        this.element.setAttribute("aria-label", words.help);
        this.element.append(
            close,
            element("h2", "", words.helpTitle),
            keys,
            element("p", "", words.helpMouse),
            element("h2", "", words.physicsTitle),
            ...physics,
        );
        this.element.addEventListener("close", onClose);
        this.element.addEventListener("click", (event) => {
            if (event.target === this.element) {
                this.element.close();
            }
        });
    }

    /** @param {boolean} isShown */
    show(isShown) {
        if (isShown && !this.element.open) {
            this.element.showModal();
        } else if (!isShown && this.element.open) {
            this.element.close();
        }
    }
}
