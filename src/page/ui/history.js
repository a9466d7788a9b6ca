/** The observer's worldline so far, thinned: however long the flight is, it takes no more room. */

/** @typedef {import("../spacetime/moment.js").Moment} Moment */

/** More events than this are not kept. */
const MOST = 512;

export class History {
    /**
     * Time and place of events, the oldest first.
     * @type {{ time: number, position: readonly number[] }[]}
     */
    events = [];
    /** Proper time from one event that is kept to the next. */
    #spacing = 0;
    #properTime = 0;
    #begin = 0;

    /** @param {Moment} moment */
    record({ time, position, properTime }) {
        const last = this.events[this.events.length - 1];
        if (last && (properTime < this.#properTime || time < last.time)) {
            this.clear();
        } else if (last && properTime - this.#properTime <= this.#spacing) {
            return;
        }
        if (this.events.length === MOST) {
            // Every second one, and from now on about the spacing that these have.
            this.events = this.events.filter((_, index) => index % 2 === 0);
            this.#spacing = (properTime - this.#begin) / this.events.length;
        }
        if (this.events.length === 0) {
            this.#begin = properTime;
        }
        this.events.push({ time, position });
        this.#properTime = properTime;
    }

    /** For another flight. */
    clear() {
        this.events = [];
        this.#spacing = 0;
    }
}
