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
        const physics = element("p", "physics", words.physics.join(" "));
        this.element.setAttribute("aria-label", words.help);
        this.element.append(
            element("h2", "", words.helpTitle),
            element("p", "", words.helpMouse),
            keys,
            element("h2", "", words.physicsTitle),
            physics,
            button(words.close, () => this.element.close()),
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
