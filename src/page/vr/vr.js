/**
 * The observer's view in a headset. The headset is at the observer's place when it begins; one unit of the scene is one metre
 * of the room.
 */

import { inputOfHands } from "../controls/hands.js";
import { noInput } from "../controls/input.js";
import { words } from "../texts.js";
import { button } from "../ui/fields.js";

const MODE = "immersive-vr";

export class Vr {
    /** Enters and leaves; hidden where there is no headset. */
    button = button("", () => this.#toggle());
    #renderer;
    #xr;
    #onFailure;
    /** @type {XRSession | null} */
    #session = null;
    #isEntering = false;

    /**
     * @param {import("three").WebGLRenderer} renderer Its `setAnimationLoop` is the page's loop of frames: a headset has its own clock.
     * @param {XRSystem | undefined} xr As `navigator.xr` is, where the browser has it.
     * @param {(reason: string) => void} onFailure
     */
    constructor(renderer, xr, onFailure) {
        this.#renderer = renderer;
        this.#xr = xr;
        this.#onFailure = onFailure;
        renderer.xr.enabled = true;
        renderer.xr.setReferenceSpaceType("local");
        this.button.hidden = true;
        xr?.addEventListener?.("devicechange", () => this.#look());
        this.#show();
        this.#look();
    }

    /** Whether the headset shows the observer's view now. */
    get isPresenting() {
        return this.#session !== null;
    }

    /** What the controllers ask for. @returns {import("../controls/input.js").Input} */
    read() {
        return this.#session ? inputOfHands(this.#session.inputSources) : noInput();
    }

    /** Looks whether there is a headset. */
    async #look() {
        const isThere = await this.#xr?.isSessionSupported(MODE).catch(() => false);
        this.button.hidden = !isThere;
    }

    async #toggle() {
        if (this.#session) {
            await this.#session.end();
        } else if (this.#xr && !this.#isEntering) {
            this.#isEntering = true;
            try {
                await this.#enter(this.#xr);
            } catch (error) {
                this.#onFailure(error instanceof Error ? error.message : String(error));
            }
            this.#isEntering = false;
        }
    }

    /** @param {XRSystem} xr */
    async #enter(xr) {
        const session = await xr.requestSession(MODE);
        session.addEventListener("end", () => {
            this.#session = null;
            this.#show();
        });
        try {
            await this.#renderer.xr.setSession(session);
        } catch (error) {
            await session.end();
            throw error;
        }
        this.#session = session;
        this.#show();
    }

    #show() {
        this.button.textContent = this.#session ? words.leaveVr : words.enterVr;
    }
}
