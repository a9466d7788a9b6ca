/** The beginning of the page: the data of the scene, and the viewer that shows it. */

import { readColors, readMeshes, readScene } from "./data.js";
import { World } from "./surface/world.js";
import { words } from "./texts.js";
import { element } from "./ui/fields.js";
import { Viewer } from "./viewer.js";

/** @param {string} id */
function find(id) {
    return /** @type {HTMLElement} */ (document.getElementById(id));
}

async function start() {
    const data = readScene();
    const world = new World(data, readColors());
    await world.load(readMeshes());
    const viewer = new Viewer(data, world, {
        canvas: /** @type {HTMLCanvasElement} */ (find("canvas")),
        observer: find("observer-view"),
        outside: find("outside-view"),
        root: find("interface"),
    });
    // For tests, and for those who want to know.
    Object.assign(globalThis, { photosurface: viewer });
    viewer.start();
}

start().catch((error) => {
    const hasWebGl = document.createElement("canvas").getContext("webgl2") !== null;
    const why = hasWebGl ? String(error?.message ?? error) : words.noWebGl;
    document.body.append(element("p", "failure", `${words.failed}: ${why}`));
    throw error;
});
