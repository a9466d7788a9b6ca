/**
 * How a moving observer is placed in the rest frame of a moving object.
 *
 * The rest frame has its origin at the object's origin, and axes that a pure boost makes of those of the scene.
 */

import { conjugate } from "./quaternion.js";
import {
    boost,
    celerity,
    eventOf,
    inverse,
    multiply,
    rotationOf,
    sumOfEvents,
    transform,
    velocityOfCelerity,
} from "./spinor.js";
import { AHEAD } from "./vector.js";

/** @typedef {import("./vector.js").Vec3} Vec3 */
/** @typedef {import("./spinor.js").Spinor} Spinor */
/**
 * Something that moves uniformly: its place at scene time 0, and its velocity.
 * @typedef {{ readonly position: Readonly<Vec3>, readonly rapidity: number, readonly direction: Readonly<Vec3> }} Body
 */
/**
 * `offset`: the place of the observer in the rest frame at the observation. `rapidity`, `direction`: how it moves there.
 * `rotation`: takes vectors from the axes that a pure boost with this velocity makes of those of the rest frame to the
 * observer's own axes.
 * @typedef {{
 *     offset: Vec3,
 *     rapidity: number,
 *     direction: Vec3,
 *     rotation: import("./quaternion.js").Quaternion,
 * }} View
 */

/** @type {WeakMap<Body, Spinor>} */
const framesOfBodies = new WeakMap();

/** From the scene's axes to those of the body's rest frame. @param {Body} body */
function sceneToRest(body) {
    let frame = framesOfBodies.get(body);
    if (!frame) {
        frame = inverse(boost(body.rapidity, body.direction));
        framesOfBodies.set(body, frame);
    }
    return frame;
}

/** The last moment, and the motion relative to bodies of each velocity. */
const lately = {
    /** @type {import("./moment.js").Moment | null} */
    moment: null,
    /** @type {Map<string, Omit<View, "offset">>} */
    motions: new Map(),
};

/** @param {import("./moment.js").Moment} moment @param {Body} body @returns {Omit<View, "offset">} */
function motionOf(moment, body) {
    if (lately.moment !== moment) {
        lately.moment = moment;
        lately.motions.clear();
    }
    const key = body.rapidity === 0 ? "rest" : `${body.rapidity},${body.direction}`;
    let motion = lately.motions.get(key);
    if (!motion) {
        const frame = body.rapidity === 0 ? moment.frame : multiply(sceneToRest(body), moment.frame);
        const { rapidity, direction } = velocityOfCelerity(celerity(frame), AHEAD);
        motion = { rapidity, direction, rotation: conjugate(rotationOf(frame)) };
        lately.motions.set(key, motion);
    }
    return motion;
}

/**
 * A body is known by its identity: one that changes has to be a new object.
 * @param {import("./moment.js").Moment} moment @param {Body} body @returns {View}
 */
export function viewOf(moment, body) {
    const { rapidity, direction, rotation } = motionOf(moment, body);
    const [x, y, z] = body.position;
    const difference = sumOfEvents(moment.event, eventOf(0, [-x, -y, -z]));
    const place = body.rapidity === 0 ? difference : transform(sceneToRest(body), difference);
    return { offset: [place[1], place[2], place[3]], rapidity, direction: [...direction], rotation: [...rotation] };
}
