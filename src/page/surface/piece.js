/** One mesh of an object: its triangles as they are, and the leaves of those that are drawn in pieces. */

import { BufferAttribute, DynamicDrawUsage, Group, Matrix3, Mesh, Vector2, Vector3 } from "three";

import { Placement } from "../light_cone/placement.js";
import { POINT_NUMBERS, seePoint, sightOf } from "../light_cone/sight.js";
import { conjugate, rotate } from "../spacetime/quaternion.js";
import { scaled, sum } from "../spacetime/vector.js";
import { clustersOf } from "../tessellation/clusters.js";
import { LEAF_HALVINGS } from "../tessellation/edge_rule.js";
import { Tessellation } from "../tessellation/tessellation.js";
import { Ghost } from "./ghost.js";
import { LeafGeometry } from "./leaf_geometry.js";
import { relativisticMaterial } from "./material.js";
import { vertexTable } from "./vertex_table.js";

/** @typedef {import("../spacetime/vector.js").Vec3} Vec3 */
/** @typedef {import("../data.js").Model} Model */
/** @typedef {import("./material.js").Defines} Defines */
/** @typedef {import("../tessellation/edge_rule.js").Sharpness} Sharpness */

/** The layer of three.js with what only the view from outside shows. Headsets have the layers 1 and 2, one for each eye. */
export const OUTSIDE_LAYER = 3;

/** More ranges of a buffer than this are uploaded as one. */
const MOST_RANGES = 256;

/** So many vertices tell where a mesh is seen. */
const MOST_PLACES = 100;

export class Piece {
    /** All that is drawn of the mesh. */
    group = new Group();
    /** How many leaves were drawn last. */
    leafCount = 0;
    /** The middle of the mesh relative to the object's origin, and the radius of a ball about it that holds the mesh. */
    middle;
    radius;

    #mesh;
    /** @type {{ geometry: LeafGeometry, mesh: Mesh | null }[]} */
    #leaves;
    #tessellation;
    #origin;
    #placement;
    #uniforms;
    #defines;
    #source;
    /** @type {Defines} */
    #look = {};
    /** @type {import("../spacetime/view.js").View | null} */
    #view = null;
    /** @type {Map<Model, Ghost>} */
    #ghosts = new Map();
    #index;
    /** @type {import("./vertex_table.js").VertexTable | null} */
    #table = null;

    /**
     * @param {Mesh} source The mesh of the file.
     * @param {Vec3} origin The place of its origin relative to the object's, in the rest frame.
     * @param {import("../shape/round.js").Round | null} round
     * @param {import("./material.js").Uniforms} shared Uniforms that all pieces share.
     * @param {{ uniforms: import("./material.js").Uniforms, defines: Defines }} own What the object has beside: that of a black body.
     */
    constructor(source, origin, round, shared, own) {
        const { geometry } = source;
        this.#source = Array.isArray(source.material) ? source.material[0] : source.material;
        geometry.deleteAttribute("tangent");
        const positions = /** @type {Float32Array} */ (geometry.attributes.position.array);
        const clusters = clustersOf(positions, properTriangles(geometry), this.#source.transparent);
        this.#index = clusters.index;
        this.#tessellation = new Tessellation(positions, clusters, round);
        const drawn = new BufferAttribute(this.#tessellation.drawn, 1);
        drawn.setUsage(DynamicDrawUsage);
        geometry.setIndex(drawn);
        this.#origin = origin;
        geometry.computeBoundingSphere();
        const ball = /** @type {import("three").Sphere} */ (geometry.boundingSphere);
        this.middle = sum(origin, /** @type {Vec3} */ (ball.center.toArray()));
        this.radius = ball.radius;
        this.#placement = new Placement();
        this.#defines = { ...own.defines, ...(round && { [round.kind]: "" }) };
        this.#uniforms = {
            ...shared,
            ...own.uniforms,
            ...this.#placement.uniforms,
            ...(round ? roundUniforms(round) : {}),
        };
        const hasOpacity = geometry.attributes.color?.itemSize === 4;
        this.#leaves = Array.from({ length: LEAF_HALVINGS + 1 }, (_, halvings) => {
            return { geometry: new LeafGeometry(2 ** halvings, hasOpacity), mesh: null };
        });
        this.#mesh = this.#drawn(geometry, {});
    }

    /**
     * Compiles the effects that are on and no others, if they are not those that were on.
     * @param {Defines} look
     */
    setLook(look) {
        if (Object.keys(look).join() === Object.keys(this.#look).join()) {
            return;
        }
        this.#look = look;
        for (const mesh of [this.#mesh, ...this.#leaves.map((leaves) => leaves.mesh)]) {
            if (mesh) {
                const material = /** @type {import("three").Material} */ (mesh.material);
                material.dispose();
                mesh.material = this.#material(/** @type {Defines} */ (mesh.userData.defines));
            }
        }
    }

    /**
     * Moves the mesh to where it is seen, in pieces as fine as the pictures call for.
     * @param {import("../spacetime/view.js").View} view
     * @param {Model} model
     * @param {Sharpness} sharpness With the camera in the observer's own axes.
     * @param {number} room The largest number of leaves.
     */
    update(view, model, sharpness, room) {
        this.#view = view;
        const place = this.#place(view);
        this.#placement.set(view, place, [0, 0, 0]);
        const sight = sightOf(place, view.direction, view.rapidity, model);
        const camera = rotate(conjugate(view.rotation), sharpness.camera);
        this.leafCount = this.#tessellation.update(sight, { ...sharpness, camera }, room);
        this.#upload();
    }

    /**
     * Where some of the vertices are seen, in the observer's own axes.
     * @param {import("../spacetime/view.js").View} view
     * @param {Model} model
     * @returns {Vec3[]}
     */
    seenPlaces(view, model) {
        const { array, count } = this.#mesh.geometry.attributes.position;
        const sight = sightOf(this.#place(view), view.direction, view.rapidity, model);
        const point = new Float64Array(POINT_NUMBERS);
        const places = [];
        for (let vertex = 0; vertex < count; vertex += Math.ceil(count / MOST_PLACES)) {
            seePoint(sight, array[3 * vertex], array[3 * vertex + 1], array[3 * vertex + 2], point, 0);
            places.push(rotate(view.rotation, [point[4], point[5], point[6]]));
        }
        return places;
    }

    /**
     * Draws the mesh under another model beside it, in the view from outside, or not.
     * @param {Model} model
     * @param {string} color
     * @param {boolean} isShown
     */
    setGhost(model, color, isShown) {
        const ghost = this.#ghosts.get(model);
        if (ghost) {
            ghost.mesh.visible = isShown;
        } else if (isShown) {
            const made = new Ghost(this.#mesh.geometry, this.#index, model, color, this.#uniforms, this.#defines);
            made.mesh.layers.set(OUTSIDE_LAYER);
            this.#ghosts.set(model, made);
            this.group.add(made.mesh);
        }
    }

    /** @param {import("../spacetime/view.js").View} view */
    #place(view) {
        return sum(this.#origin, scaled(view.offset, -1));
    }

    #upload() {
        const { changed, leaves } = this.#tessellation;
        const index = /** @type {BufferAttribute} */ (this.#mesh.geometry.index);
        // Ranges of an update that was not drawn are still to be uploaded; three.js clears them then.
        if (index.updateRanges.length > MOST_RANGES) {
            index.clearUpdateRanges();
            index.addUpdateRange(0, index.count);
        }
        for (const [start, count] of changed) {
            index.addUpdateRange(start, count);
        }
        if (changed.length > 0) {
            index.needsUpdate = true;
        }
        leaves.forEach((list, halvings) => {
            const own = this.#leaves[halvings];
            own.geometry.show(list);
            if (list.count > 0 && !own.mesh) {
                own.mesh = this.#drawn(own.geometry, { LEAF: "" });
            }
            if (own.mesh) {
                own.mesh.visible = list.count > 0;
            }
        });
    }

    /**
     * @param {import("three").BufferGeometry} geometry
     * @param {Defines} defines
     */
    #drawn(geometry, defines) {
        const mesh = new Mesh(geometry, this.#material(defines));
        mesh.userData.defines = defines;
        mesh.frustumCulled = false;
        mesh.matrixAutoUpdate = false;
        // In stereo each eye has its own light cone.
        mesh.onBeforeRender = (renderer, _scene, camera, _geometry, material) => {
            if (renderer.xr.isPresenting && this.#view) {
                const eye = new Vector3().setFromMatrixPosition(camera.matrixWorld);
                this.#placement.set(this.#view, this.#place(this.#view), [eye.x, eye.y, eye.z]);
                Object.assign(material, { uniformsNeedUpdate: true });
            }
        };
        this.group.add(mesh);
        return mesh;
    }

    /** @param {Defines} defines */
    #material(defines) {
        const all = { ...this.#defines, ...this.#look, ...defines };
        if (!("LEAF" in defines)) {
            return relativisticMaterial(this.#source, this.#uniforms, all);
        }
        this.#table ??= vertexTable(this.#mesh.geometry);
        const uniforms = { ...this.#uniforms, vertexTable: { value: this.#table.texture } };
        return relativisticMaterial(this.#source, uniforms, { ...all, ...this.#table.defines });
    }
}

/**
 * The triangles of a geometry, without those that have a vertex twice.
 * @param {import("three").BufferGeometry} geometry
 */
function properTriangles(geometry) {
    const count = geometry.attributes.position.count;
    const index = geometry.index
        ? Uint32Array.from(geometry.index.array)
        : Uint32Array.from({ length: count }, (_, k) => k);
    let kept = 0;
    for (let at = 0; at + 2 < index.length; at += 3) {
        const [a, b, c] = [index[at], index[at + 1], index[at + 2]];
        if (a !== b && b !== c && c !== a) {
            index[kept] = a;
            index[kept + 1] = b;
            index[kept + 2] = c;
            kept += 3;
        }
    }
    return index.slice(0, kept);
}

/** @param {import("../shape/round.js").Round} round */
function roundUniforms(round) {
    /** @param {number[]} rows */
    const matrix = (rows) => new Matrix3().fromArray(rows).transpose();
    return {
        fromShape: { value: matrix(round.fromShape) },
        toShape: { value: matrix(round.toShape) },
        shapeOrigin: { value: new Vector3(...round.origin) },
        shapeRadii: { value: new Vector2(...round.radii) },
    };
}
