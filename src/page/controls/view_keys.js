/** Looking around by keys: the head with I, J, K, L, and the view from outside with the arrows while it has the focus. */

/** Radians of a press of a key, and how much nearer another one comes. */
const STEP = Math.PI / 36;
const NEARER = 0.9;

/** Steps to the left and up. @type {Readonly<Record<string, readonly [number, number]>>} */
const HEAD = { KeyJ: [1, 0], KeyL: [-1, 0], KeyI: [0, 1], KeyK: [0, -1] };

/** @type {Readonly<Record<string, readonly [number, number]>>} */
const ARROWS = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

/** @type {Readonly<Record<string, number>>} */
const ZOOM = { Equal: NEARER, NumpadAdd: NEARER, Minus: 1 / NEARER, NumpadSubtract: 1 / NEARER };

/**
 * @param {HTMLElement} element
 * @param {(change: [number, number]) => void} turn Radians to the left and up.
 */
export function headKeys(element, turn) {
    element.addEventListener("keydown", (event) => {
        const step = HEAD[event.code];
        const isWriting = event.target instanceof HTMLInputElement && event.target.type !== "range";
        if (step && !event.ctrlKey && !event.metaKey && !event.altKey && !isWriting) {
            turn([step[0] * STEP, step[1] * STEP]);
        }
    });
}

/**
 * @param {HTMLElement} element It takes these keys from all others while it has the focus.
 * @param {{ turn: (left: number, up: number) => void, zoom: (factor: number) => void }} view
 */
export function outsideKeys(element, view) {
    element.addEventListener("keydown", (event) => {
        const step = ARROWS[event.code];
        const factor = ZOOM[event.code];
        if (step) {
            view.turn(step[0] * STEP, step[1] * STEP);
        } else if (factor) {
            view.zoom(factor);
        } else {
            return;
        }
        event.preventDefault();
        event.stopPropagation();
    });
}
