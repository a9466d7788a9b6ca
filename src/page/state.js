/** The one state of the interface: what is shown and how, with listeners. The moment itself changes every frame and is not here. */

/**
 * @typedef {object} State
 * @property {boolean} paused
 * @property {number} timeScale Proper time of the observer for each second of the clock, in units of the scene.
 * @property {"free" | "coordinated"} steering
 * @property {"both" | "observer" | "outside"} layout
 * @property {"none" | "spectrum" | "ramp"} doppler
 * @property {boolean} searchlight
 * @property {number} exposure In stops.
 * @property {import("./data.js").Model} model
 * @property {boolean} ghostAtRest
 * @property {boolean} ghostContracted
 * @property {number} fieldOfViewDeg The vertical angle of the observer's view.
 * @property {[number, number]} look Yaw and pitch of the observer's head in radians.
 * @property {boolean} diagram
 * @property {boolean} help
 * @property {boolean} film Whether the observer follows the flight of the scene.
 */

/** @typedef {keyof State} StateKey */

/** What the interface shows, and who wants to know of its changes. */
export class Store {
    /** @type {State} */
    #state;
    /** @type {{ keys: Set<StateKey>, listener: (state: State) => void }[]} */
    #listeners = [];

    /** @param {State} state */
    constructor(state) {
        this.#state = { ...state };
    }

    /** @returns {Readonly<State>} */
    get state() {
        return this.#state;
    }

    /**
     * Calls a listener now, and after each change of one of these keys.
     * @param {StateKey[]} keys
     * @param {(state: Readonly<State>) => void} listener
     */
    subscribe(keys, listener) {
        this.#listeners.push({ keys: new Set(keys), listener });
        listener(this.#state);
    }

    /** @param {Partial<State>} changes */
    change(changes) {
        const changed = /** @type {StateKey[]} */ (Object.keys(changes)).filter(
            (key) => this.#state[key] !== changes[key],
        );
        if (changed.length === 0) {
            return;
        }
        this.#state = { ...this.#state, ...changes };
        for (const { keys, listener } of this.#listeners) {
            if (changed.some((key) => keys.has(key))) {
                listener(this.#state);
            }
        }
    }
}

/**
 * The state in which a scene is shown first.
 * @param {import("./data.js").PageData} data
 * @param {number} timeScale
 * @returns {State}
 */
export function firstState({ effects, model, camera, flight }, timeScale) {
    return {
        paused: false,
        timeScale,
        steering: "free",
        layout: "both",
        ...effects,
        model,
        ghostAtRest: false,
        ghostContracted: false,
        fieldOfViewDeg: camera.fov_deg,
        look: [0, 0],
        diagram: false,
        help: false,
        film: flight.length > 0,
    };
}
