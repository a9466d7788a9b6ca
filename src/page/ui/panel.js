/** The panel: everything that can be set, in groups. */

import { words } from "../texts.js";
import { button, choice, element, group, slider, toggle } from "./fields.js";
import { betaText, numberText } from "./numbers.js";

/** The largest rapidity of the speed's line. */
const FASTEST = 8;

/** Factors of the speed of time, as powers of two. */
const SLOWEST = -5;
const QUICKEST = 5;

/**
 * What the panel asks the page to do.
 * @typedef {object} Actions
 * @property {() => void} reset
 * @property {() => void} playFilm
 * @property {(rapidity: number) => void} setRapidity
 * @property {(isOn: boolean) => void} setSearchlight
 * @property {() => void} copyLink
 * @property {() => void} copyRender
 * @property {() => void} copyExport
 * @property {() => void} savePicture
 */

export class Panel {
    element = element("aside", "panel");
    #speed;

    /**
     * @param {import("../state.js").Store} store
     * @param {Actions} actions
     * @param {{ timeScale: number, hasFilm: boolean, extra: HTMLElement[] }} scene The usual speed of time, whether there is a film,
     *     and what else belongs to the group of what one takes along.
     */
    constructor(store, actions, { timeScale, hasFilm, extra }) {
        this.element.id = "panel";
        this.element.setAttribute("aria-label", words.panel);
        this.#speed = slider(words.speed, { from: 0, to: FASTEST, step: 0.01 }, betaText, actions.setRapidity);
        this.element.append(
            this.#flying(store, actions, timeScale, hasFilm),
            this.#seeing(store),
            this.#effects(store, actions),
            group(words.share, [
                button(words.copyLink, actions.copyLink),
                button(words.copyRender, actions.copyRender),
                button(words.copyExport, actions.copyExport),
                button(words.savePicture, actions.savePicture),
                ...extra,
            ]),
        );
    }

    /**
     * Shows the observer's speed.
     * @param {number} rapidity
     */
    showSpeed(rapidity) {
        this.#speed.show(Math.min(Math.round(rapidity * 100) / 100, FASTEST));
    }

    /**
     * @param {import("../state.js").Store} store
     * @param {Actions} actions
     * @param {number} timeScale
     * @param {boolean} hasFilm
     */
    #flying(store, actions, timeScale, hasFilm) {
        const paused = toggle(words.pause, (isDown) => store.change({ paused: isDown }));
        const steering = choice(words.steering, words.steerings, (value) => store.change({ steering: value }));
        const pace = slider(
            words.timeScale,
            { from: SLOWEST, to: QUICKEST, step: 0.25 },
            (octaves) => `× ${numberText(2 ** octaves)}`,
            (octaves) => store.change({ timeScale: timeScale * 2 ** octaves }),
        );
        store.subscribe(["paused"], (state) => paused.show(state.paused));
        store.subscribe(["steering"], (state) => steering.show(state.steering));
        store.subscribe(["timeScale"], (state) =>
            pace.show(Math.round(4 * Math.log2(state.timeScale / timeScale)) / 4),
        );
        const film = hasFilm ? [button(words.film, actions.playFilm)] : [];
        return group(words.flying, [
            paused.field,
            button(words.reset, actions.reset),
            ...film,
            this.#speed.field,
            steering.field,
            pace.field,
        ]);
    }

    /** @param {import("../state.js").Store} store */
    #seeing(store) {
        const layout = choice(words.layout, words.layouts, (value) => store.change({ layout: value }));
        const model = choice(words.model, words.models, (value) => store.change({ model: value }));
        const rest = toggle(words.ghostAtRest, (isDown) => store.change({ ghostAtRest: isDown }));
        const contracted = toggle(words.ghostContracted, (isDown) => store.change({ ghostContracted: isDown }));
        const diagram = toggle(words.diagram, (isDown) => store.change({ diagram: isDown }));
        const fov = slider(
            words.fieldOfView,
            { from: 5, to: 150, step: 1 },
            (degrees) => `${Math.round(degrees)}°`,
            (degrees) => store.change({ fieldOfViewDeg: degrees }),
        );
        store.subscribe(["layout"], (state) => layout.show(state.layout));
        store.subscribe(["model"], (state) => model.show(state.model));
        store.subscribe(["ghostAtRest"], (state) => rest.show(state.ghostAtRest));
        store.subscribe(["ghostContracted"], (state) => contracted.show(state.ghostContracted));
        store.subscribe(["diagram"], (state) => diagram.show(state.diagram));
        store.subscribe(["fieldOfViewDeg"], (state) => fov.show(Math.round(state.fieldOfViewDeg)));
        return group(words.picture, [
            layout.field,
            fov.field,
            model.field,
            rest.field,
            contracted.field,
            diagram.field,
        ]);
    }

    /**
     * @param {import("../state.js").Store} store
     * @param {Actions} actions
     */
    #effects(store, actions) {
        const doppler = choice(words.doppler, words.dopplers, (value) => store.change({ doppler: value }));
        const searchlight = toggle(words.searchlight, actions.setSearchlight);
        const exposure = slider(
            words.exposure,
            { from: -12, to: 12, step: 0.25 },
            (stops) => words.stops(stops.toFixed(2).replace("-", "−")),
            (stops) => store.change({ exposure: stops }),
        );
        store.subscribe(["doppler"], (state) => doppler.show(state.doppler));
        store.subscribe(["searchlight"], (state) => searchlight.show(state.searchlight));
        store.subscribe(["exposure"], (state) => exposure.show(state.exposure));
        return group(words.effects, [doppler.field, searchlight.field, exposure.field]);
    }
}
