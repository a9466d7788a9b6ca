/** The bar of the scene's own flight: play, stop, and a line of its proper time with a mark for each step. */

import { words } from "../texts.js";
import { button, element, slider } from "./fields.js";
import { numberText } from "./numbers.js";

/** Steps of the line. */
const STEPS = 1000;

export class FilmBar {
    element = element("div", "film");
    #film;
    #line;
    #button;
    #isPlaying = false;

    /**
     * @param {import("../controls/film.js").Film} film
     * @param {readonly number[]} steps Proper times of the scene's pictures.
     * @param {{ play: (isPlaying: boolean) => void, seek: (properTime: number) => void }} on
     */
    constructor(film, steps, on) {
        this.#film = film;
        const duration = film.to - film.from;
        this.#button = button(words.play, () => on.play(!this.#isPlaying));
        this.#line = slider(
            words.filmTime,
            { from: 0, to: STEPS, step: 1 },
            (step) => numberText(film.from + (step / STEPS) * duration),
            (step) => on.seek(film.from + (step / STEPS) * duration),
        );
        const marks = element("datalist", "");
        marks.id = "steps";
        for (const step of steps.slice(0, STEPS)) {
            const mark = document.createElement("option");
            mark.value = String(((step - film.from) / duration) * STEPS);
            marks.append(mark);
        }
        this.#line.line.setAttribute("list", marks.id);
        this.element.append(this.#button, this.#line.field, marks);
    }

    /** @param {boolean} isPlaying */
    showPlaying(isPlaying) {
        this.#isPlaying = isPlaying;
        this.#button.textContent = isPlaying ? words.pause : words.play;
    }

    /** Shows the proper time of the film. */
    show() {
        const { properTime, from, to } = this.#film;
        this.#line.show(Math.round(((properTime - from) / (to - from)) * STEPS));
    }
}
