/** All objects of a scene, each mesh drawn where it is seen. */

import {
    DataTexture,
    DataUtils,
    Group,
    HalfFloatType,
    LinearFilter,
    Matrix3,
    RGFormat,
    TextureLoader,
    Vector3,
} from "three";
import { GLTFLoader } from "three/examples/jsm/loaders/GLTFLoader.js";

import { blackBodyUniforms, colorUniforms, definesOf } from "../effects/colors.js";
import { roundOf } from "../shape/round.js";
import { orientationOf } from "../spacetime/moment.js";
import { rotate } from "../spacetime/quaternion.js";
import { dot, length, scaled, subtract, sum, unit } from "../spacetime/vector.js";
import { viewOf } from "../spacetime/view.js";
import { Piece } from "./piece.js";

/** @typedef {import("../spacetime/vector.js").Vec3} Vec3 */
/** @typedef {import("../data.js").PageData} PageData */
/** @typedef {import("../data.js").PageObject} PageObject */
/** @typedef {import("../data.js").Model} Model */
/** @typedef {import("../tessellation/edge_rule.js").Sharpness} Sharpness */

/** Most leaves of all objects together: beyond them pictures get coarser instead of slower. */
const MOST_LEAVES = 60_000;

/** The part of what is seen that the first view from outside has in its picture. */
const MOST_SEEN = 0.65;

/** How much coarser pictures get, at most, and how quickly they recover. */
const COARSEST = 1024;
const RECOVERY = 0.97;

export class World {
    group = new Group();
    /** Uniforms that all meshes share: what the views and the effects set. */
    shared;

    /** @type {{ object: PageObject, pieces: Piece[] }[]} */
    #objects = [];
    #model;
    #coarseness = 1;

    #data;

    /**
     * @param {PageData} data
     * @param {Uint8Array} colors The table of colours.
     */
    constructor(data, colors) {
        this.#data = data;
        this.shared = {
            ...colorUniforms(data.colors, colors),
            fromOutside: { value: 0 },
            upright: { value: new Matrix3() },
            albedo: { value: albedoTexture(data.shading.albedo) },
            brightness: { value: new Vector3(data.shading.head_light, data.shading.horizon, data.shading.above) },
        };
        this.#model = data.model;
    }

    /** The radius of a ball about the middle of all objects at scene time 0 that holds them. */
    get size() {
        const places = this.#objects.flatMap(({ object, pieces }) =>
            pieces.map((piece) => ({ place: sum(object.position, piece.middle), radius: piece.radius })),
        );
        const middle = scaled(
            places.reduce((total, { place }) => sum(total, place), /** @type {Vec3} */ ([0, 0, 0])),
            1 / Math.max(places.length, 1),
        );
        return Math.max(...places.map(({ place, radius }) => length(subtract(place, middle)) + radius), 1e-30);
    }

    /**
     * Where some places of all objects are seen, in the observer's own axes.
     * @param {import("../spacetime/moment.js").Moment} moment
     */
    #seenPlaces(moment) {
        return this.#objects.flatMap(({ object, pieces }) => {
            const view = viewOf(moment, object);
            return pieces.flatMap((piece) => piece.seenPlaces(view, this.#modelOf(object)));
        });
    }

    /**
     * The part of the sky in which objects are seen: its middle, a unit vector in the observer's own axes, and the largest
     * angle from there in radians.
     * @param {import("../spacetime/moment.js").Moment} moment
     * @returns {{ middle: Vec3, angle: number }}
     */
    partOfSky(moment) {
        const directions = this.#seenPlaces(moment).map((place) => unit(place, [0, 0, 0]));
        const middle = unit(
            directions.reduce((total, direction) => sum(total, direction), [0, 0, 0]),
            [0, 0, -1],
        );
        const least = Math.min(...directions.map((direction) => dot(direction, middle)));
        return { middle, angle: Math.acos(Math.min(Math.max(least, -1), 1)) };
    }

    /**
     * Places around most of the photosurfaces, and the observer's: in the axes of the scene under the observer's boost.
     * @param {import("../spacetime/moment.js").Moment} moment
     * @returns {Vec3[]}
     */
    nearestSeen(moment) {
        const orientation = orientationOf(moment);
        const places = this.#seenPlaces(moment).map((place) => rotate(orientation, place));
        // What is drawn out far ahead would make all else small.
        places.sort((a, b) => length(a) - length(b));
        return [[0, 0, 0], ...places.slice(0, Math.ceil(places.length * MOST_SEEN))];
    }

    /**
     * Loads the meshes.
     * @param {ArrayBuffer} glb
     */
    async load(glb) {
        const nodes = await nodesOf(glb);
        for (const object of this.#data.objects) {
            const pieces = object.nodes.flatMap((name) => this.#piecesOf(object, nodes.get(name)));
            this.#objects.push({ object, pieces });
            for (const piece of pieces) {
                this.group.add(piece.group);
            }
        }
    }

    /**
     * @param {PageObject} object
     * @param {import("three").Object3D | undefined} node
     */
    #piecesOf(object, node) {
        /** @type {Piece[]} */
        const pieces = [];
        /** @type {{ uniforms: import("./material.js").Uniforms, defines: import("./material.js").Defines }} */
        const own = object.emission
            ? { uniforms: blackBodyUniforms(this.#data.colors, object.emission), defines: { BLACK_BODY: "" } }
            : { uniforms: {}, defines: {} };
        node?.traverse((child) => {
            const mesh = /** @type {import("three").Mesh} */ (child);
            if (mesh.isMesh) {
                const place = /** @type {Vec3} */ (node.position.toArray());
                const origin = sum(place, scaled(object.position, -1));
                const round = object.shape ? roundOf(object.shape, object, scaled(origin, -1)) : null;
                pieces.push(new Piece(mesh, origin, round, this.shared, own));
            }
        });
        return pieces;
    }

    /** @param {PageObject} object */
    #modelOf(object) {
        return this.#model === "seen" ? (object.model ?? "seen") : this.#model;
    }

    /**
     * Draws all objects under a model and with effects, which are compiled in only where they are on.
     * @param {Model} model
     * @param {import("../effects/colors.js").Effects} effects
     */
    setLook(model, effects) {
        this.#model = model;
        this.shared.exposureFactor.value = 2 ** effects.exposure;
        for (const { object, pieces } of this.#objects) {
            const look = { ...definesOf(effects), [`MODEL_${this.#modelOf(object).toUpperCase()}`]: "" };
            for (const piece of pieces) {
                piece.setLook(look);
            }
        }
    }

    /**
     * Moves everything to where it is seen at a moment.
     * @param {import("../spacetime/moment.js").Moment} moment
     * @param {Sharpness} sharpness
     */
    update(moment, sharpness) {
        const views = this.#objects.map(({ object }) => viewOf(moment, object));
        // Where there are too many leaves, all is made coarser at once: triangles that stay coarse alone would leave cracks.
        while (!this.#place(views, sharpness) && this.#coarseness < COARSEST) {
            this.#coarseness *= 2;
        }
        this.#coarseness = Math.max(this.#coarseness * RECOVERY, 1);
    }

    /**
     * Moves everything to where it is seen; false if there is no room for so many leaves.
     * @param {import("../spacetime/view.js").View[]} views One for each object.
     * @param {Sharpness} sharpness
     */
    #place(views, sharpness) {
        const coarse = {
            ...sharpness,
            observer: sharpness.observer * this.#coarseness,
            outside: sharpness.outside * this.#coarseness,
        };
        let room = MOST_LEAVES;
        for (const [at, { object, pieces }] of this.#objects.entries()) {
            for (const piece of pieces) {
                piece.update(views[at], this.#modelOf(object), coarse, room);
                room -= piece.leafCount;
            }
        }
        return room > 0;
    }

    /**
     * @param {Model} model
     * @param {boolean} isShown
     */
    setGhost(model, isShown) {
        for (const { pieces } of this.#objects) {
            for (const piece of pieces) {
                piece.setGhost(model, this.#data.ghosts[model], isShown);
            }
        }
    }
}

/**
 * The nodes of a GLB by the names in the file.
 * @param {ArrayBuffer} glb
 */
async function nodesOf(glb) {
    const loader = new GLTFLoader();
    // Pictures by elements of the page: fetching them is forbidden to it.
    loader.register((parser) => {
        parser.textureLoader = new TextureLoader(parser.options.manager);
        return { name: "pictures_without_fetch" };
    });
    const { parser } = await loader.parseAsync(glb, "");
    /** @type {Map<string, import("three").Object3D>} */
    const nodes = new Map();
    for (const [object, { nodes: number }] of parser.associations) {
        const node = /** @type {import("three").Object3D} */ (object);
        if (number !== undefined && node.isObject3D) {
            nodes.set(parser.json.nodes[number].name, node);
        }
    }
    return nodes;
}

/**
 * The light of the surroundings that a gloss sends to the eye, by roughness and cosine.
 * @param {[number, number][][]} table
 */
function albedoTexture(table) {
    const numbers = Uint16Array.from(table.flat(2), (value) => DataUtils.toHalfFloat(value));
    const texture = new DataTexture(numbers, table[0].length, table.length, RGFormat, HalfFloatType);
    texture.minFilter = LinearFilter;
    texture.magFilter = LinearFilter;
    texture.needsUpdate = true;
    return texture;
}
