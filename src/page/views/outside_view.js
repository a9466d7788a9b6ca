/** The view from outside: the photosurface as an object that one can look at from anywhere. */

import { Matrix4, PerspectiveCamera, Quaternion, Spherical, Vector3 } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";

/** @typedef {import("../spacetime/vector.js").Vec3} Vec3 */
/** @typedef {import("../data.js").Quaternion} QuaternionNumbers */

/** Angle of the picture from its lower to its upper edge, in degrees. */
const FIELD_OF_VIEW_DEG = 40;

/** The part of the picture's width that places may fill, and the least part of its height. */
const FILLED = { across: 0.8, up: 0.4 };

/** The height of captions and of instruments in CSS pixels, between which places are shown. */
const COVERED = 85;

const UP = new Vector3(0, 1, 0);

/**
 * From where the photosurface is looked at first: obliquely from above, with the motion across the picture, to the right.
 * @param {Vector3} motion A unit vector.
 */
function firstSide(motion) {
    const across = motion.clone().cross(UP);
    if (across.length() < 0.1) {
        across.set(1, 0, 0);
    }
    return across.normalize().addScaledVector(UP, 0.9).addScaledVector(motion, -0.4).normalize();
}

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
        this.#orbit.position.set(0, 0, 1);
    }

    /**
     * Calls a listener where the camera has moved.
     * @param {() => void} listener
     */
    onChange(listener) {
        this.#controls.addEventListener("change", listener);
    }

    /**
     * Looks at places from the side, so that all of them are in the picture.
     * @param {readonly Vec3[]} places
     * @param {Vec3} motion How the observer moves, a unit vector.
     * @param {{ width: number, height: number }} size Of the picture, in CSS pixels.
     */
    frame(places, motion, { width, height }) {
        const back = firstSide(new Vector3(...motion));
        const right = UP.clone().cross(back).normalize();
        const axes = [right, back.clone().cross(right), back];
        const along = places.map((place) => axes.map((axis) => axis.dot(new Vector3(...place))));
        const middle = axes.map((_, axis) => {
            const parts = along.map((place) => place[axis]);
            return (Math.min(...parts) + Math.max(...parts)) / 2;
        });
        const halfUp = Math.tan((FIELD_OF_VIEW_DEG * Math.PI) / 360);
        const halfAcross = (halfUp * width) / Math.max(height, 1);
        const limits = [halfAcross * FILLED.across, halfUp * Math.max(1 - (2 * COVERED) / height, FILLED.up)];
        const distances = along.map((place) => {
            const [across, up, towards] = place.map((part, axis) => part - middle[axis]);
            return towards + Math.max(Math.abs(across) / limits[0], Math.abs(up) / limits[1]);
        });
        this.#controls.target.set(0, 0, 0);
        axes.forEach((axis, index) => {
            this.#controls.target.addScaledVector(axis, middle[index]);
        });
        this.#orbit.position.copy(this.#controls.target).addScaledVector(back, Math.max(...distances));
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
