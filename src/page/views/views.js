/** The two views of one moment: what the observer sees, and the photosurface from outside. */

import { Color, Matrix4, PerspectiveCamera, Quaternion, Scene, WebGLRenderer } from "three";

import { orientationOf } from "../spacetime/moment.js";
import { observerMarker } from "./marker.js";
import { OutsideView } from "./outside_view.js";

/** @typedef {import("../spacetime/moment.js").Moment} Moment */

/**
 * A part of the canvas in CSS pixels, from its upper left corner.
 * @typedef {{ x: number, y: number, width: number, height: number }} Rectangle
 */

/**
 * The parts of the canvas with the views; null for a view that is not shown.
 * @typedef {{ observer: Rectangle | null, outside: Rectangle | null }} Rectangles
 */

/** How many pixels a place may be off. */
const TOLERANCE_PX = 0.3;

/** The size of the marker as a part of the distance from which it is looked at. */
const MARKER_SIZE = 0.02;

/** The nearest and farthest depths, in sizes of the scene: beside a wall little is in front of the first. */
const NEAR = 1e-5;
const FAR = 1e9;

/** Pixels of a screen for each CSS pixel, at most. */
const MOST_PIXELS = 2;

export class Views {
    renderer;
    outside;
    /** What the observer sees: in its own axes, at their origin. */
    observer = new PerspectiveCamera();
    /** The vertical angle of the observer's view in degrees. */
    fieldOfViewDeg = 60;

    #world;
    #scene = new Scene();
    #marker = observerMarker();
    #size;

    /**
     * @param {HTMLCanvasElement} canvas
     * @param {import("../surface/world.js").World} world
     * @param {HTMLElement} outsideElement The element on which the view from outside is dragged.
     * @param {{ background: string, size: number }} scene The colour behind everything, and the size of the scene.
     */
    constructor(canvas, world, outsideElement, { background, size }) {
        this.renderer = new WebGLRenderer({ canvas, antialias: true, logarithmicDepthBuffer: true });
        this.renderer.setPixelRatio(Math.min(globalThis.devicePixelRatio, MOST_PIXELS));
        this.renderer.autoClear = false;
        this.#scene.background = new Color(background);
        this.#scene.add(world.group, this.#marker);
        this.#world = world;
        this.#size = size;
        this.outside = new OutsideView(outsideElement);
    }

    /**
     * Fits the canvas to its size on the page.
     * @param {number} width
     * @param {number} height
     */
    resize(width, height) {
        const ratio = this.renderer.getPixelRatio();
        const { domElement } = this.renderer;
        if (domElement.width !== Math.floor(width * ratio) || domElement.height !== Math.floor(height * ratio)) {
            this.renderer.setSize(width, height, false);
        }
    }

    /**
     * Turns the observer's head.
     * @param {import("../data.js").Quaternion} look From the camera's axes to the observer's own.
     */
    look(look) {
        // A headset has moved it.
        this.observer.position.set(0, 0, 0);
        this.observer.quaternion.set(...look);
    }

    /**
     * Draws a moment.
     * @param {Moment} moment
     * @param {Rectangles} rectangles
     */
    draw(moment, rectangles) {
        const orientation = orientationOf(moment);
        const depths = this.#depths();
        if (rectangles.outside) {
            this.outside.place(orientation, aspectOf(rectangles.outside), depths);
        }
        this.#world.update(moment, this.#sharpness(rectangles));
        this.renderer.setScissorTest(true);
        if (rectangles.observer) {
            Object.assign(this.observer, {
                fov: this.fieldOfViewDeg,
                aspect: aspectOf(rectangles.observer),
                near: depths[0],
                far: depths[1],
            });
            this.observer.updateProjectionMatrix();
            this.#draw(this.observer, rectangles.observer, 0);
        }
        if (rectangles.outside) {
            const turn = new Matrix4().makeRotationFromQuaternion(new Quaternion(...orientation));
            this.#world.shared.upright.value.setFromMatrix4(turn);
            this.#marker.scale.setScalar(MARKER_SIZE * Math.hypot(...this.outside.place3));
            this.#draw(this.outside.camera, rectangles.outside, 1);
        }
    }

    /**
     * The canvas as a picture; to be asked for right after it was drawn.
     * @returns {Promise<Blob>}
     */
    picture() {
        return new Promise((resolve, reject) => {
            this.renderer.domElement.toBlob((blob) => (blob ? resolve(blob) : reject(new Error("no picture"))));
        });
    }

    /**
     * Draws what the observer sees for the eyes of a headset, which place the camera.
     * @param {Moment} moment
     */
    drawInHeadset(moment) {
        const [near, far] = this.#depths();
        const [eye] = this.renderer.xr.getCamera().cameras;
        const pixels = (eye?.viewport?.w ?? 1000) * (eye?.projectionMatrix.elements[5] ?? 1);
        this.#world.update(moment, {
            observer: (2 * TOLERANCE_PX) / pixels,
            outside: Infinity,
            camera: this.outside.place3,
            nearest: near,
        });
        this.#world.shared.fromOutside.value = 0;
        Object.assign(this.observer, { near, far });
        this.renderer.render(this.#scene, this.observer);
    }

    /** The nearest and the farthest depth. @returns {[number, number]} */
    #depths() {
        return [NEAR * this.#size, FAR * this.#size];
    }

    /**
     * @param {import("three").Camera} camera
     * @param {Rectangle} rectangle
     * @param {number} fromOutside
     */
    #draw(camera, { x, y, width, height }, fromOutside) {
        this.#world.shared.fromOutside.value = fromOutside;
        const { renderer } = this;
        const bottom = renderer.domElement.height / renderer.getPixelRatio() - y - height;
        renderer.setViewport(x, bottom, width, height);
        renderer.setScissor(x, bottom, width, height);
        renderer.clear();
        renderer.render(this.#scene, camera);
    }

    /**
     * @param {Rectangles} rectangles
     * @returns {import("../tessellation/edge_rule.js").Sharpness}
     */
    #sharpness({ observer, outside }) {
        const ratio = this.renderer.getPixelRatio();
        /** @param {Rectangle | null} rectangle @param {number} fovDeg */
        const angle = (rectangle, fovDeg) =>
            rectangle ? (TOLERANCE_PX * 2 * Math.tan((fovDeg * Math.PI) / 360)) / (rectangle.height * ratio) : Infinity;
        return {
            observer: angle(observer, this.fieldOfViewDeg),
            outside: angle(outside, this.outside.camera.fov),
            camera: this.outside.place3,
            nearest: NEAR * this.#size,
        };
    }
}

/** @param {Rectangle} rectangle */
function aspectOf({ width, height }) {
    return width / Math.max(height, 1);
}
