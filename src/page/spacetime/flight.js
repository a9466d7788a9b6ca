/**
 * A scene's own flight as a film: what the observer is at any of its proper times.
 *
 * Proper times are counted from the observation. Before it and after the last segment the observer coasts, axes unturned.
 */

import { Sum } from "./exact.js";
import { advance, advanceCoordinated, coast, momentOf } from "./moment.js";

/** @typedef {import("./vector.js").Vec3} Vec3 */
/** @typedef {import("./moment.js").Moment} Moment */
/**
 * As a scene says it.
 * @typedef {{
 *     proper_time: number,
 *     acceleration: Vec3,
 *     turn_rate: Vec3,
 *     steer: "free" | "coordinated",
 * }} Segment
 */

export class Flight {
    /** @param {import("./moment.js").Observer} observer @param {readonly Segment[]} segments */
    constructor(observer, segments) {
        const start = momentOf(observer);
        /** The moment at which each segment begins, and the one at which the last one ends. */
        this.moments = [start];
        /** The proper times of these. */
        this.times = [0];
        this.segments = segments;
        const sum = new Sum();
        for (const segment of segments) {
            sum.add(segment.proper_time);
            const end = flown(this.moments[this.moments.length - 1], segment, segment.proper_time);
            this.moments.push({ ...end, properTime: sum.value });
            this.times.push(sum.value);
        }
    }

    /** The proper time that all segments last together. */
    get properTime() {
        return this.times[this.segments.length];
    }

    /** @param {number} properTime @returns {Moment} */
    moment(properTime) {
        const index = this.index(properTime);
        const begun = this.moments[Math.max(index, 0)];
        const rest = properTime - this.times[Math.max(index, 0)];
        if (rest === 0) {
            return begun;
        }
        const segment = index >= 0 ? this.segments[index] : undefined;
        return segment ? flown(begun, segment, rest) : coast(begun, rest);
    }

    /** How many segments have begun, less one. @param {number} properTime */
    index(properTime) {
        let [from, to] = [0, this.times.length];
        while (from < to) {
            const middle = (from + to) >> 1;
            [from, to] = this.times[middle] <= properTime ? [middle + 1, to] : [from, middle];
        }
        return from - 1;
    }

    /** The segment that has begun and not ended. @param {number} properTime @returns {Segment | null} */
    segmentAt(properTime) {
        return this.segments[this.index(properTime)] ?? null;
    }
}

/** @param {Moment} from @param {Segment} segment @param {number} properTime */
function flown(from, segment, properTime) {
    return segment.steer === "coordinated"
        ? advanceCoordinated(from, segment.acceleration, properTime)
        : advance(from, segment.acceleration, segment.turn_rate, properTime);
}

/** @type {WeakMap<readonly Segment[], { observer: import("./moment.js").Observer, flight: Flight }>} */
const known = new WeakMap();

/**
 * The observer of a scene at one of its proper times.
 * @param {import("./moment.js").Observer} observer @param {readonly Segment[]} segments @param {number} properTime
 */
export function momentOfFlight(observer, segments, properTime) {
    let found = known.get(segments);
    if (found?.observer !== observer) {
        found = { observer, flight: new Flight(observer, segments) };
        known.set(segments, found);
    }
    return found.flight.moment(properTime);
}
