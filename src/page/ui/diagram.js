/**
 * A small Minkowski diagram of the flight so far: scene time up, the direction in which the flight began to the right, both
 * at one scale; the observer's worldline, its light cone backward and own axes of now, and the worldlines of objects.
 */

import { headingOf, orientationOf, velocityOf } from "../spacetime/moment.js";
import { rotate } from "../spacetime/quaternion.js";
import { celerity } from "../spacetime/spinor.js";
import { AHEAD, dot, scaled, unit } from "../spacetime/vector.js";
import { History } from "./history.js";

/** @typedef {import("../spacetime/vector.js").Vec3} Vec3 */
/** @typedef {import("../spacetime/moment.js").Moment} Moment */
/** @typedef {import("../spacetime/view.js").Body} Body */

/** Milliseconds between two drawings. */
const BETWEEN_MS = 100;

/** Worldlines of more objects would hide the diagram. */
const MOST_OBJECTS = 100;

/** Room around what is shown, as a part of it. */
const MARGIN = 0.12;

/** Letters, in CSS pixels. */
const LETTERS = 10;

const COLORS = {
    ground: "#12161a",
    grid: "#2b333b",
    light: "#56606a",
    letters: "#a9b4bf",
    object: "#a86f35",
    observer: "#56b4e9",
    cone: "#f2dc6b",
    coneInside: "#f2dc6b1f",
    axes: "#3ecf9c",
};

export class Diagram {
    history = new History();
    #canvas;
    #bodies;
    #size;
    #drawn = -Infinity;
    /** @type {Vec3 | null} */
    #direction = null;

    /**
     * @param {HTMLCanvasElement} canvas Its size on the page is that of the diagram.
     * @param {readonly Body[]} bodies
     * @param {number} sizeOfScene
     */
    constructor(canvas, bodies, sizeOfScene) {
        this.#canvas = canvas;
        this.#bodies = bodies.slice(0, MOST_OBJECTS);
        this.#size = sizeOfScene;
    }

    /**
     * Remembers a moment; the first one says which direction is to the right.
     * @param {Moment} moment
     */
    record(moment) {
        this.history.record(moment);
        if (this.history.events.length === 1) {
            this.#direction = headingOf(moment) ? velocityOf(moment).direction : rotate(orientationOf(moment), AHEAD);
        }
    }

    /** For another flight. */
    clear() {
        this.history.clear();
    }

    /**
     * Draws the diagram, if the last drawing is a while ago.
     * @param {Moment} moment
     * @param {number} now In milliseconds.
     * @returns {boolean} Whether the moment has been drawn.
     */
    show(moment, now) {
        const { clientWidth: width, clientHeight: height } = this.#canvas;
        const pen = this.#canvas.getContext("2d");
        if (now - this.#drawn < BETWEEN_MS || !pen || !this.#direction || width === 0 || height === 0) {
            return false;
        }
        this.#drawn = now;
        const ratio = globalThis.devicePixelRatio || 1;
        const [wide, high] = [Math.round(width * ratio), Math.round(height * ratio)];
        if (this.#canvas.width !== wide || this.#canvas.height !== high) {
            Object.assign(this.#canvas, { width: wide, height: high });
        }
        pen.setTransform(ratio, 0, 0, ratio, 0, 0);
        draw(pen, { width, height }, this.#direction, this.history.events, moment, this.#bodies, this.#size);
        return true;
    }
}

/**
 * The part of spacetime that is shown, a square of the direction to the right and time, and where that is on the page.
 * @param {{ width: number, height: number }} size
 * @param {readonly { x: number, t: number }[]} points What has to be seen.
 * @param {number} least The least side of the square.
 */
export function frameOf({ width, height }, points, least) {
    const room = Math.min(width, height);
    const range = (/** @type {"x" | "t"} */ key) => {
        let [low, high] = [Infinity, -Infinity];
        for (const point of points) {
            [low, high] = [Math.min(low, point[key]), Math.max(high, point[key])];
        }
        return { low, high };
    };
    const [across, upward] = [range("x"), range("t")];
    const side = Math.max(across.high - across.low, upward.high - upward.low, least) * (1 + 2 * MARGIN);
    const scale = room / side;
    const middle = { x: 0.5 * (across.low + across.high), t: 0.5 * (upward.low + upward.high) };
    return {
        scale,
        /** @param {{ x: number, t: number }} event @returns {[number, number]} */
        place: ({ x, t }) => [width / 2 + (x - middle.x) * scale, height / 2 - (t - middle.t) * scale],
        low: { x: middle.x - width / scale / 2, t: middle.t - height / scale / 2 },
        high: { x: middle.x + width / scale / 2, t: middle.t + height / scale / 2 },
    };
}

/**
 * A distance of ticks that is 1, 2 or 5 times a power of 10, about a part of the range.
 * @param {number} range
 */
export function tickOf(range) {
    const power = 10 ** Math.floor(Math.log10(range / 4));
    const times = range / 4 / power;
    return power * (times < 2 ? 1 : times < 5 ? 2 : 5);
}

/**
 * @param {CanvasRenderingContext2D} pen
 * @param {{ width: number, height: number }} size
 * @param {Vec3} direction
 * @param {readonly { time: number, position: readonly number[] }[]} events
 * @param {Moment} moment
 * @param {readonly Body[]} bodies
 * @param {number} sizeOfScene
 */
function draw(pen, size, direction, events, moment, bodies, sizeOfScene) {
    /** @param {readonly number[]} position */
    const along = (position) => direction[0] * position[0] + direction[1] * position[1] + direction[2] * position[2];
    const course = events.map(({ time, position }) => ({ x: along(position), t: time }));
    const now = { x: along(moment.position), t: moment.time };
    course.push(now);
    const frame = frameOf(size, course, sizeOfScene);
    const { low, high } = frame;
    const reach = high.x - low.x + (high.t - low.t);

    /** @param {readonly { x: number, t: number }[]} points */
    const path = (points) => {
        pen.beginPath();
        for (const point of points) {
            pen.lineTo(...frame.place(point));
        }
    };
    /** @param {string} color @param {number} width @param {number[]} dashes @param {{ x: number, t: number }[]} points */
    const line = (color, width, dashes, ...points) => {
        path(points);
        pen.strokeStyle = color;
        pen.lineWidth = width;
        pen.setLineDash(dashes);
        pen.stroke();
    };

    pen.lineJoin = "round";
    pen.fillStyle = COLORS.ground;
    pen.fillRect(0, 0, size.width, size.height);
    pen.font = `${LETTERS}px system-ui, sans-serif`;
    const letters = drawTicks(size, frame, line);

    for (const body of bodies) {
        const velocity = Math.tanh(body.rapidity) * along(unit(body.direction, AHEAD));
        const start = along(body.position);
        const ends = [low.t, high.t].map((t) => ({ x: start + velocity * t, t }));
        line(COLORS.object, 1, [], ...ends);
    }

    // Light that passes through the event at which the flight began.
    const first = course[0];
    for (const sign of [-1, 1]) {
        const ends = [-reach, reach].map((t) => ({ x: first.x + sign * t, t: first.t + t }));
        line(COLORS.light, 1, [2, 4], ...ends);
    }

    const [left, right] = [-reach, reach].map((x) => ({ x: now.x + x, t: now.t - reach }));
    path([left, now, right]);
    pen.fillStyle = COLORS.coneInside;
    pen.fill();
    line(COLORS.cone, 1.5, [], left, now, right);

    const velocity = dot(direction, scaled(celerity(moment.frame), 1 / velocityOf(moment).gamma));
    for (const [x, t] of [
        [velocity, 1],
        [1, velocity],
    ]) {
        const ends = [-reach, reach].map((part) => ({ x: now.x + x * part, t: now.t + t * part }));
        line(COLORS.axes, 1, [4, 3], ...ends);
    }

    line(COLORS.observer, 2.5, [], ...course);
    pen.beginPath();
    pen.arc(...frame.place(now), 3.5, 0, 2 * Math.PI);
    pen.fillStyle = COLORS.observer;
    pen.fill();

    pen.setLineDash([]);
    pen.lineWidth = 3;
    pen.strokeStyle = COLORS.ground;
    pen.fillStyle = COLORS.letters;
    pen.textBaseline = "middle";
    for (const { text, x, y, align } of letters) {
        pen.textAlign = align;
        pen.strokeText(text, x, y);
        pen.fillText(text, x, y);
    }
}

/**
 * @param {number} value
 * @param {number} step From one tick to the next.
 */
export function tickText(value, step) {
    const digits = Math.max(0, -Math.floor(Math.log10(step)));
    const isLong = digits > 3 || Math.abs(value) >= 1e5;
    const text =
        isLong && value !== 0
            ? value.toExponential(1).replace(".0", "").replace("+", "")
            : value.toFixed(isLong ? 0 : digits);
    return text.replaceAll("-", "−");
}

/**
 * Lines and numbers of the scale: the numbers are returned, to be written when all else is drawn.
 * @param {{ width: number, height: number }} size
 * @param {ReturnType<typeof frameOf>} frame
 * @param {(color: string, width: number, dashes: number[], ...points: { x: number, t: number }[]) => void} line
 */
function drawTicks({ width, height }, { low, high, place }, line) {
    const step = tickOf(Math.min(high.x - low.x, high.t - low.t));
    /** @type {{ text: string, x: number, y: number, align: CanvasTextAlign }[]} */
    const letters = [
        { text: "t", x: 3, y: LETTERS, align: "left" },
        { text: "x", x: width - 4, y: height - LETTERS, align: "right" },
    ];
    for (let tick = Math.ceil(low.x / step); tick * step <= high.x; tick++) {
        const x = tick * step;
        line(COLORS.grid, 1, [], { x, t: low.t }, { x, t: high.t });
        const [at] = place({ x, t: low.t });
        if (at > 3 * LETTERS && at < width - 2 * LETTERS) {
            letters.push({ text: tickText(x, step), x: at, y: height - LETTERS, align: "center" });
        }
    }
    for (let tick = Math.ceil(low.t / step); tick * step <= high.t; tick++) {
        const t = tick * step;
        line(COLORS.grid, 1, [], { x: low.x, t }, { x: high.x, t });
        const [, at] = place({ x: low.x, t });
        if (at > 2 * LETTERS && at < height - 2 * LETTERS) {
            letters.push({ text: tickText(t, step), x: 3, y: at, align: "left" });
        }
    }
    return letters;
}
