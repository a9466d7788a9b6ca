/** From what a person asks for to the observer's next moment: one exact piece of flight for each frame. */

import { advance, advanceCoordinated, coast, headingOf, setRapidity, turned, velocityOf } from "../spacetime/moment.js";
import { AHEAD, cross, dot, length, scaled, sum, unit, ZERO } from "../spacetime/vector.js";

/** @typedef {import("../spacetime/vector.js").Vec3} Vec3 */
/** @typedef {import("../spacetime/moment.js").Moment} Moment */

/**
 * In the observer's own axes, x to the right, y up, looking along -z.
 * @typedef {object} Command
 * @property {Vec3} acceleration
 * @property {Vec3} turnRate In radians of each unit of proper time.
 * @property {number} brake The deceleration towards rest in the scene, in place of the acceleration; 0 for none.
 */

/** No thrust leads beyond this rapidity, a gamma of 4.4 million. */
const FASTEST = 16;

/** How fast the nose of an airplane turns into the direction of motion, in parts of the angle for each radian of a turn. */
const WEATHERVANE = 3;

/**
 * The observer a frame later.
 * @param {Moment} from
 * @param {Command} command
 * @param {"free" | "coordinated"} steering Whether the direction of motion keeps its place in the own axes.
 * @param {number} dTau
 * @returns {Moment}
 */
export function fly(from, command, steering, dTau) {
    const { acceleration, turnRate, brake } = command;
    if (brake > 0) {
        return braked(turnedBy(from, turnRate, dTau), brake, dTau);
    }
    const heading = headingOf(from);
    const next =
        steering === "free"
            ? advance(from, acceleration, turnRate, dTau)
            : heading
              ? airplane(from, command, heading, dTau)
              : advance(from, dot(acceleration, AHEAD) > 0 ? acceleration : ZERO, turnRate, dTau);
    if (length(acceleration) > 0) {
        const rapidity = velocityOf(next).rapidity;
        if (rapidity > FASTEST && rapidity > velocityOf(from).rapidity) {
            return fly(from, { ...command, acceleration: [0, 0, 0] }, steering, dTau);
        }
    }
    return next;
}

/**
 * An observer who steers like an airplane: engines act along the motion, which a brake ends but does not reverse. The
 * direction of motion turns in the scene at the rate that is asked for; own axes turn `gamma` times as fast.
 * @param {Moment} from
 * @param {Command} command
 * @param {Vec3} heading
 * @param {number} dTau
 */
function airplane(from, { acceleration, turnRate }, heading, dTau) {
    const thrust = dot(acceleration, AHEAD);
    const { rapidity } = velocityOf(from);
    if (thrust < 0 && rapidity + thrust * dTau <= 0) {
        return braked(turnedBy(from, turnRate, dTau), -thrust, dTau);
    }
    const roll = scaled(heading, dot(turnRate, heading));
    const sideways = scaled(cross(turnRate, heading), Math.sinh(rapidity));
    const rolled = turnedBy(from, roll, dTau);
    const flown = advanceCoordinated(rolled, sum(scaled(heading, thrust), sideways), dTau);
    return noseToHeading(flown, length(turnRate) * dTau + Math.abs(thrust) * dTau);
}

/**
 * The nose turned somewhat into the direction of motion: it is beside it after free steering.
 * @param {Moment} moment
 * @param {number} turn
 */
function noseToHeading(moment, turn) {
    const heading = headingOf(moment);
    if (!heading || turn === 0) {
        return moment;
    }
    const across = cross(AHEAD, heading);
    const angle = Math.atan2(length(across), dot(AHEAD, heading));
    if (angle < 1e-9) {
        return moment;
    }
    return turned(moment, unit(across, [0, 1, 0]), angle * -Math.expm1(-WEATHERVANE * turn));
}

/**
 * @param {Moment} from
 * @param {Vec3} turnRate
 * @param {number} dTau
 */
function turnedBy(from, turnRate, dTau) {
    const rate = length(turnRate);
    return rate === 0 ? from : turned(from, scaled(turnRate, 1 / rate), rate * dTau);
}

/**
 * Slower by so much, straight ahead; at rest, and exactly so, where that would be more than there is.
 * @param {Moment} from
 * @param {number} deceleration
 * @param {number} dTau
 */
function braked(from, deceleration, dTau) {
    const heading = headingOf(from);
    if (!heading) {
        return coast(from, dTau);
    }
    const { rapidity } = velocityOf(from);
    const rate = Math.min(deceleration, rapidity / dTau);
    const next = advance(from, scaled(heading, -rate), ZERO, dTau);
    return rate < deceleration ? setRapidity(next, 0) : next;
}
