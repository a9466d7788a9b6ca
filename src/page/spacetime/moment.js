/** What an observer is at one instant, and how it flies on. */

import { isWide, pieceOfTurn, piecesOfTurn, turnOf, wideTurn } from "./coordinated.js";
import { aboutAxis, rotate } from "./quaternion.js";
import { segment } from "./segment.js";
import {
    boost,
    celerity,
    celerityOwn,
    eventOf,
    multiply,
    rotation,
    rotationOf,
    sumOfEvents,
    transform,
    unimodular,
    velocityOfCelerity,
} from "./spinor.js";
import { AHEAD, length, scaled } from "./vector.js";

/** @typedef {import("./vector.js").Vec3} Vec3 */
/** @typedef {import("./quaternion.js").Quaternion} Quaternion */
/** @typedef {import("./spinor.js").Spinor} Spinor */
/**
 * An event in the scene frame, the observer's proper time, and the transformation from its own axes to those of the scene:
 * the boost of its velocity after the rotation of its orientation. Nothing changes a moment.
 *
 * `event` is time and place with twice the digits: beside an object that is as fast as the observer all depends on them.
 * @typedef {{
 *     readonly time: number,
 *     readonly position: Readonly<Vec3>,
 *     readonly properTime: number,
 *     readonly frame: Spinor,
 *     readonly event: import("./spinor.js").ExactEvent,
 * }} Moment
 */
/**
 * As a scene says it.
 * @typedef {{
 *     time: number,
 *     position: Readonly<Vec3>,
 *     rapidity: number,
 *     direction: Readonly<Vec3>,
 *     orientation: Readonly<Quaternion>,
 * }} Observer
 */

/** @param {import("./spinor.js").ExactEvent} event @param {number} properTime @param {Spinor} frame @returns {Moment} */
function moment(event, properTime, frame) {
    const [time, x, y, z] = event;
    return { time, position: [x, y, z], properTime, frame, event };
}

/** The moment of an observer at its proper time. @param {Observer} observer */
export function momentOf(observer, properTime = 0) {
    const frame = multiply(boost(observer.rapidity, observer.direction), rotation(observer.orientation));
    return moment(eventOf(observer.time, observer.position), properTime, unimodular(frame));
}

/** What is left of a zero in a unit vector that was computed with twice the digits. */
const NOTHING = 1e-18;

/** The observer of a moment, its numbers rounded. @param {Moment} moment @returns {Observer} */
export function observerOf(moment) {
    const { rapidity, direction } = velocityOf(moment);
    const [[x, y, z], [a, b, c]] = [moment.position, direction.map(orZero)];
    const [i, j, k, w] = orientationOf(moment).map(orZero);
    return { time: moment.time, position: [x, y, z], rapidity, direction: [a, b, c], orientation: [i, j, k, w] };
}

/** @param {number} part of a unit vector */
function orZero(part) {
    return Math.abs(part) < NOTHING ? 0 : part;
}

/** In the scene frame; the direction of rest is the one ahead. @param {Moment} moment */
export function velocityOf(moment) {
    const velocity = celerity(moment.frame);
    return velocityOfCelerity(velocity, rotate(orientationOf(moment), AHEAD));
}

/** How the own axes are turned before the boost: the rotation that `--orientation` takes. @param {Moment} moment */
export function orientationOf(moment) {
    return rotationOf(moment.frame);
}

/**
 * The direction in which the observer moves in the scene, in its own axes, where aberration crowds the sky; null at rest.
 * @param {Moment} moment @returns {Vec3 | null}
 */
export function headingOf(moment) {
    const own = celerityOwn(moment.frame);
    const size = length(own);
    return size > 0 ? scaled(own, 1 / size) : null;
}

/**
 * A piece of flight further.
 * @param {Moment} from @param {import("./segment.js").Piece} piece @param {number} properTime
 */
function after(from, piece, properTime) {
    const event = sumOfEvents(from.event, transform(from.frame, piece.way));
    return moment(event, properTime, unimodular(multiply(from.frame, piece.turn)));
}

/**
 * The same of a turn that is given in the scene.
 * @param {Moment} from @param {ReturnType<typeof wideTurn>} turn @param {number} properTime
 */
function afterWideTurn(from, { way, axis, angle, boost }, properTime) {
    const orientation = orientationOf(from);
    const event = sumOfEvents(from.event, transform(rotation(orientation), way));
    const turned = multiply(rotation(aboutAxis(rotate(orientation, axis), angle)), multiply(from.frame, boost));
    return moment(event, properTime, unimodular(turned));
}

/** The observer after coasting, axes unturned. @param {Moment} from @param {number} dTau */
export function coast(from, dTau) {
    const event = sumOfEvents(from.event, transform(from.frame, eventOf(dTau, [0, 0, 0])));
    return moment(event, from.properTime + dTau, from.frame);
}

/**
 * The observer after a segment of constant acceleration and turn rate in its own axes.
 * @param {Moment} from @param {Readonly<Vec3>} acceleration @param {Readonly<Vec3>} turnRate @param {number} dTau
 */
export function advance(from, acceleration, turnRate, dTau) {
    const { count, piece } = segment(acceleration, turnRate, dTau);
    let now = from;
    for (let part = 1; part <= count; part++) {
        now = after(now, piece, from.properTime + dTau * (part / count));
    }
    return now;
}

/**
 * The observer after a segment in which it turns so that the direction of motion keeps its place in its own axes. At rest,
 * straight ahead, and where it would come to rest in the turn it does not turn.
 * @param {Moment} from @param {Readonly<Vec3>} acceleration @param {number} dTau
 */
export function advanceCoordinated(from, acceleration, dTau) {
    const whole = turnOf(celerityOwn(from.frame), acceleration, dTau);
    if (!whole) {
        return advance(from, acceleration, [0, 0, 0], dTau);
    }
    const count = piecesOfTurn(whole, dTau);
    let now = from;
    for (let part = 1; part <= count; part++) {
        const turn = part === 1 ? whole : turnOf(celerityOwn(now.frame), acceleration, dTau / count);
        if (!turn) {
            return advance(now, acceleration, [0, 0, 0], (dTau * (count - part + 1)) / count);
        }
        const properTime = from.properTime + dTau * (part / count);
        now = isWide(turn, dTau / count)
            ? afterWideTurn(now, wideTurn(turn, dTau / count), properTime)
            : after(now, pieceOfTurn(turn, dTau / count), properTime);
    }
    return now;
}

/**
 * The observer with its axes turned about a unit vector, given in them.
 * @param {Moment} from @param {Readonly<Vec3>} axis @param {number} angle
 */
export function turned(from, axis, angle) {
    const frame = unimodular(multiply(from.frame, rotation(aboutAxis(axis, angle))));
    return moment(from.event, from.properTime, frame);
}

/**
 * The observer at another speed, in the same place, direction and axes; from rest in the direction ahead.
 * @param {Moment} from @param {number} beta
 */
export function setBeta(from, beta) {
    const held = Math.min(Math.max(beta, 0), 1 - 2 ** -53);
    return setRapidity(from, Math.atanh(held));
}

/** @param {Moment} from @param {number} rapidity */
export function setRapidity(from, rapidity) {
    const { direction } = velocityOf(from);
    const frame = multiply(boost(rapidity, direction), rotation(orientationOf(from)));
    return moment(from.event, from.properTime, unimodular(frame));
}
