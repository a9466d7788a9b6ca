/** An object under another model, drawn like glass beside what is seen: how it is at rest, or contracted. */

import { BufferAttribute, BufferGeometry, DoubleSide, Mesh, MeshBasicMaterial } from "three";

import { relativisticMaterial } from "./material.js";

export class Ghost {
    /**
     * @param {BufferGeometry} geometry
     * @param {Uint32Array} index All triangles.
     * @param {import("../data.js").Model} model
     * @param {string} color
     * @param {import("./material.js").Uniforms} uniforms
     * @param {import("./material.js").Defines} defines
     */
    constructor(geometry, index, model, color, uniforms, defines) {
        const whole = new BufferGeometry();
        for (const name of ["position", "normal"]) {
            whole.setAttribute(name, geometry.attributes[name]);
        }
        whole.setIndex(new BufferAttribute(index, 1));
        const source = new MeshBasicMaterial({ color, transparent: true, side: DoubleSide, depthWrite: false });
        const ofModel = { ...defines, GHOST: "", [`MODEL_${model.toUpperCase()}`]: "" };
        this.mesh = new Mesh(whole, relativisticMaterial(source, uniforms, ofModel));
        this.mesh.frustumCulled = false;
        this.mesh.matrixAutoUpdate = false;
    }
}
