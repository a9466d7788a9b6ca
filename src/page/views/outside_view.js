/** The view from outside: the photosurface as an object that one can look at from anywhere. */

import { Matrix4, PerspectiveCamera, Quaternion, Spherical, Vector3 } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";

/** @typedef {import("../spacetime/vector.js").Vec3} Vec3 */
/** @typedef {import("../data.js").Quaternion} QuaternionNumbers */

/** Angle of the picture from its lower to its upper edge, in degrees. */
const FIELD_OF_VIEW_DEG = 40;

/** From where the photosurface is looked at first: obliquely from above, with the motion across the picture. */
const FIRST_DIRECTION = new Vector3(1, 0.9, 0.4).normalize();

/**
 * A camera that moves around the photosurface. Its axes are those of the scene under a pure boost, so that nothing turns
 * where the observer turns its head.
 */
export class OutsideView {
    /** The camera in the observer's own axes, in which everything is drawn. */
    camera = new PerspectiveCamera(FIELD_OF_VIEW_DEG);

    #orbit = new PerspectiveCamera(FIELD_OF_VIEW_DEG);
    #controls;

    /** @param {HTMLElement} element The element on which the camera is dragged. */
    constructor(element) {
        this.camera.matrixAutoUpdate = false;
        this.camera.layers.enableAll();
        this.#controls = new OrbitControls(this.#orbit, element);
        this.#controls.enableDamping = false;
        this.#orbit.position.copy(FIRST_DIRECTION);
    }

    /**
     * Calls a listener where the camera has moved.
     * @param {() => void} listener
     */
    onChange(listener) {
        this.#controls.addEventListener("change", listener);
    }

    /**
     * Looks at a ball from where the camera is now, so that all of it is in the picture.
     * @param {{ middle: Vec3, radius: number }} ball
     * @param {number} aspect Width of the picture over its height.
     */
    frame({ middle, radius }, aspect) {
        const direction = this.#orbit.position.clone().sub(this.#controls.target).normalize();
        const half = Math.tan(((FIELD_OF_VIEW_DEG / 2) * Math.PI) / 180) * Math.min(aspect, 1);
        const distance = radius / Math.sin(Math.atan(half));
        this.#controls.target.set(...middle);
        this.#orbit.position.copy(this.#controls.target).addScaledVector(direction, distance);
        this.#controls.update();
    }

    /**
     * Moves the camera around what it looks at.
     * @param {number} left Radians.
     * @param {number} up Radians.
     */
    turn(left, up) {
        const { target } = this.#controls;
        const arm = new Spherical().setFromVector3(this.#orbit.position.clone().sub(target));
        arm.theta -= left;
        arm.phi -= up;
        this.#orbit.position.setFromSpherical(arm.makeSafe()).add(target);
        this.#controls.update();
    }

    /**
     * Moves the camera nearer to what it looks at, or farther away.
     * @param {number} factor
     */
    zoom(factor) {
        const { target } = this.#controls;
        this.#orbit.position.sub(target).multiplyScalar(factor).add(target);
        this.#controls.update();
    }

    /**
     * Places the camera for a picture.
     * @param {QuaternionNumbers} orientation The observer's orientation.
     * @param {number} aspect
     * @param {[number, number]} depths
     */
    place(orientation, aspect, [near, far]) {
        this.#controls.update();
        this.#orbit.updateMatrixWorld();
        const toOwnAxes = new Matrix4().makeRotationFromQuaternion(new Quaternion(...orientation).conjugate());
        this.camera.matrix.multiplyMatrices(toOwnAxes, this.#orbit.matrixWorld);
        this.camera.matrixWorldNeedsUpdate = true;
        Object.assign(this.camera, { aspect, near, far });
        this.camera.updateProjectionMatrix();
        this.camera.updateMatrixWorld(true);
    }

    /** The place of the camera in the observer's own axes. */
    get place3() {
        const place = new Vector3().setFromMatrixPosition(this.camera.matrixWorld);
        return /** @type {Vec3} */ (place.toArray());
    }
}
