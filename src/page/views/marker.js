/** The observer as the view from outside shows it: a ball, and an arrow in the direction in which it looks. */

import { ConeGeometry, CylinderGeometry, Group, Mesh, MeshBasicMaterial, SphereGeometry } from "three";

import { OUTSIDE_LAYER } from "../surface/piece.js";

const COLOR = "#ff5c4d";

/** @returns {Group} One unit large; the observer looks along -z. */
export function observerMarker() {
    const material = new MeshBasicMaterial({ color: COLOR });
    const ball = new Mesh(new SphereGeometry(0.5, 24, 16), material);
    const shaft = new Mesh(
        new CylinderGeometry(0.12, 0.12, 1.6, 12).rotateX(-Math.PI / 2).translate(0, 0, -1.2),
        material,
    );
    const head = new Mesh(new ConeGeometry(0.36, 0.9, 16).rotateX(-Math.PI / 2).translate(0, 0, -2.4), material);
    const group = new Group().add(ball, shaft, head);
    for (const part of group.children) {
        part.layers.set(OUTSIDE_LAYER);
        part.frustumCulled = false;
    }
    return group;
}
