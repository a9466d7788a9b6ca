/** Where the two views are: side by side, one above the other where there is little width, or one alone. */

import { words } from "../texts.js";

/** Where the page is narrower than this for its height, views beside each other would be too narrow. */
const NARROW = 1.5;

export class Layout {
    #canvas;
    #observer;
    #outside;
    /** @type {import("../state.js").State["layout"]} */
    #layout = "both";
    /** @type {ReturnType<Layout["place"]> | null} */
    #placed = null;

    /**
     * @param {HTMLCanvasElement} canvas
     * @param {HTMLElement} observer The element over the observer's view.
     * @param {HTMLElement} outside The element over the view from outside.
     */
    constructor(canvas, observer, outside) {
        this.#canvas = canvas;
        this.#observer = observer;
        this.#outside = outside;
        for (const [element, label] of /** @type {[HTMLElement, string][]} */ ([
            [observer, words.observerView],
            [outside, words.outsideView],
        ])) {
            element.setAttribute("aria-label", label);
            const caption = document.createElement("p");
            caption.className = "caption";
            caption.textContent = label;
            element.append(caption);
        }
    }

    /** @param {import("../state.js").State["layout"]} layout */
    show(layout) {
        this.#placed = null;
        this.#layout = layout;
        this.#observer.hidden = layout === "outside";
        this.#outside.hidden = layout === "observer";
    }

    /**
     * Places the views, if they are not in their places, and says where they are.
     * @returns {{ width: number, height: number, rectangles: import("../views/views.js").Rectangles }}
     */
    place() {
        this.#placed ??= this.#arranged();
        return this.#placed;
    }

    /** The canvas has another size: the views have other places. */
    resized() {
        this.#placed = null;
    }

    #arranged() {
        const { clientWidth: width, clientHeight: height } = this.#canvas;
        const isNarrow = width < NARROW * height;
        const whole = { x: 0, y: 0, width, height };
        /** @param {number} part */
        const half = (part) =>
            isNarrow
                ? { x: 0, y: Math.round((part * height) / 2), width, height: Math.round(height / 2) }
                : { x: Math.round((part * width) / 2), y: 0, width: Math.round(width / 2), height };
        const rectangles = {
            observer: this.#layout === "outside" ? null : this.#layout === "both" ? half(0) : whole,
            outside: this.#layout === "observer" ? null : this.#layout === "both" ? half(1) : whole,
        };
        this.#outside.classList.toggle("below", isNarrow);
        for (const [element, rectangle] of /** @type {const} */ ([
            [this.#observer, rectangles.observer],
            [this.#outside, rectangles.outside],
        ])) {
            if (rectangle) {
                element.style.left = `${rectangle.x}px`;
                element.style.top = `${rectangle.y}px`;
                element.style.width = `${rectangle.width}px`;
                element.style.height = `${rectangle.height}px`;
            }
        }
        return { width, height, rectangles };
    }
}
