/** The uniforms of `light_cone.glsl` for one mesh: from numbers in f64 to such in f32 that lose nothing that shows. */

import { Matrix3, Matrix4, Quaternion, Vector2, Vector3 } from "three";

import { conjugate, rotate } from "../spacetime/quaternion.js";
import { dot, scaled, sum } from "../spacetime/vector.js";

/** @typedef {import("../spacetime/vector.js").Vec3} Vec3 */

/** The uniforms that say where a mesh is seen. */
export class Placement {
    uniforms = {
        pivotHigh: { value: new Vector3() },
        pivotLow: { value: new Vector3() },
        motion: { value: new Vector3() },
        motionLow: { value: new Vector3() },
        stretch: { value: new Vector2() },
        turn: { value: new Matrix3() },
        eye: { value: new Vector3() },
        one: { value: 1 },
    };

    /**
     * Sets the uniforms for an eye.
     * @param {import("../spacetime/view.js").View} view How the observer sees the object.
     * @param {Vec3} place The place of the mesh's origin relative to the observer, in the rest frame.
     * @param {Vec3} eye The place of the eye relative to the observer, in the observer's own axes.
     */
    set(view, place, eye) {
        const { uniforms } = this;
        const motion = view.direction;
        // The event at the eye that is simultaneous for the observer, in the rest frame.
        const eyeBoosted = rotate(conjugate(view.rotation), eye);
        const eyeAtRest = sum(eyeBoosted, scaled(motion, (Math.cosh(view.rapidity) - 1) * dot(eyeBoosted, motion)));
        inTwoParts(sum(place, scaled(eyeAtRest, -1)), uniforms.pivotHigh.value, uniforms.pivotLow.value);
        inTwoParts(motion, uniforms.motion.value, uniforms.motionLow.value);
        uniforms.stretch.value.set(Math.exp(view.rapidity), Math.exp(-view.rapidity));
        uniforms.turn.value.setFromMatrix4(new Matrix4().makeRotationFromQuaternion(new Quaternion(...view.rotation)));
        uniforms.eye.value.set(...eye);
    }
}

/**
 * Numbers as sums of two that `f32` holds.
 * @param {Vec3} vector
 * @param {Vector3} high
 * @param {Vector3} low
 */
function inTwoParts([x, y, z], high, low) {
    high.set(Math.fround(x), Math.fround(y), Math.fround(z));
    low.set(x - high.x, y - high.y, z - high.z);
}
