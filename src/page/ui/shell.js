/** The page around the views: title, buttons, instruments, panel, sticks; made once and found by the rest. */

import { words } from "../texts.js";
import { button, element } from "./fields.js";

export class Shell {
    /** The bar on top. */
    bar = element("header", "bar");
    /** What is at the bottom of the views. */
    dashboard = element("footer", "dashboard");
    panelButton;
    helpButton;
    diagram = element("canvas", "diagram");
    sticks = element("div", "sticks");
    thrust = element("div", "stick");
    turn = element("div", "stick");
    brake = element("button", "brake", "✕");

    /**
     * @param {HTMLElement} root
     * @param {string} title
     * @param {{ onPanel: () => void, onHelp: () => void }} on
     */
    constructor(root, title, { onPanel, onHelp }) {
        this.panelButton = button(words.openPanel, onPanel);
        this.panelButton.setAttribute("aria-controls", "panel");
        this.helpButton = button("?", onHelp);
        this.helpButton.setAttribute("aria-label", words.help);
        this.bar.append(element("h1", "title", title), this.helpButton, this.panelButton);
        for (const [stick, label] of /** @type {const} */ ([
            [this.thrust, words.stickThrust],
            [this.turn, words.stickTurn],
            [this.brake, words.stickBrake],
        ])) {
            stick.setAttribute("aria-label", label);
        }
        this.thrust.setAttribute("role", "img");
        this.turn.setAttribute("role", "img");
        this.sticks.append(this.thrust, this.brake, this.turn);
        this.diagram.setAttribute("role", "img");
        this.diagram.setAttribute("aria-label", words.diagram);
        root.append(this.bar, this.dashboard, this.diagram, this.sticks);
    }

    /** @param {boolean} isOpen */
    showPanel(isOpen) {
        document.body.classList.toggle("with-panel", isOpen);
        this.panelButton.setAttribute("aria-expanded", String(isOpen));
    }
}
