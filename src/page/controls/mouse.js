/** Looking around with the mouse or a finger: what is seen is dragged along. */

/** @typedef {import("./look.js").Look} Look */

/** How much a notch of the wheel changes the field of view. */
const WHEEL_NOTCH = 1.05;

/**
 * @param {HTMLElement} element The element over the observer's view.
 * @param {object} on
 * @param {() => number} on.fieldOfViewDeg The vertical angle of the view.
 * @param {(change: Look) => void} on.turn
 * @param {() => void} on.center
 * @param {(factor: number) => void} on.zoom How many times as wide the view is to be.
 */
export function mouseLook(element, on) {
    /** @type {{ pointer: number, x: number, y: number } | null} */
    let drag = null;
    element.style.touchAction = "none";
    element.addEventListener("pointerdown", (event) => {
        if (drag === null && event.button === 0 && event.target === element) {
            element.setPointerCapture(event.pointerId);
            drag = { pointer: event.pointerId, x: event.clientX, y: event.clientY };
        }
    });
    element.addEventListener("pointermove", (event) => {
        if (drag?.pointer === event.pointerId) {
            // What is in the middle of the view stays below the pointer.
            const perPixel = (2 * Math.tan((on.fieldOfViewDeg() / 360) * Math.PI)) / Math.max(element.clientHeight, 1);
            on.turn([(event.clientX - drag.x) * perPixel, (event.clientY - drag.y) * perPixel]);
            drag = { pointer: drag.pointer, x: event.clientX, y: event.clientY };
        }
    });
    for (const end of /** @type {const} */ (["pointerup", "pointercancel", "lostpointercapture"])) {
        element.addEventListener(end, (event) => {
            if (drag?.pointer === event.pointerId) {
                drag = null;
            }
        });
    }
    element.addEventListener("dblclick", () => on.center());
    element.addEventListener(
        "wheel",
        (event) => {
            event.preventDefault();
            on.zoom(WHEEL_NOTCH ** Math.sign(event.deltaY));
        },
        { passive: false },
    );
}
