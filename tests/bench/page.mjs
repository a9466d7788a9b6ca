/**
 * What a frame of the page costs, in Chromium: `node tests/bench/page.mjs`, with the environment of the tests in `tests/page`.
 *
 * Work outside the graphics processor is timed with drawing by WebGL left out; the relativistic frame and the frame of models at
 * rest are drawn in turn by SwiftShader, on the processor, to the last pixel.
 */

import { execFileSync } from "node:child_process";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { advance, momentOf } from "../../src/page/spacetime/moment.js";
import { inBrowser, openPage, show, writePage } from "../page/browser.mjs";
import { binary } from "../page/program.mjs";

const FRAMES = 300;
const PAIRS = 40;
const HEAP_FRAMES = 10_000;

/** Lines of a square mesh with a million triangles. */
const SIDE = 708;

function median(numbers) {
    return numbers.toSorted((a, b) => a - b)[numbers.length >> 1];
}

/** Moments of a flight ahead that speeds up and turns. */
function flight(frames) {
    const start = { time: 0, position: [0, 2, 4], rapidity: 0.5, direction: [0, 0, -1], orientation: [0, 0, 0, 1] };
    const moments = [momentOf(start)];
    while (moments.length < frames) {
        moments.push(advance(moments.at(-1), [0, 0, -0.25], [0, 0.02, 0], 12 / frames));
    }
    return moments;
}

/** Times of frames in which nothing is drawn: milliseconds of all else. */
async function timesOfWork(page, moments) {
    return page.evaluate((moments) => {
        const viewer = globalThis.photosurface;
        viewer.views.renderer.render = () => {};
        return moments.map((moment) => {
            viewer.moment = moment;
            const begun = performance.now();
            viewer.drawNow();
            return performance.now() - begun;
        });
    }, moments);
}

/** Milliseconds of frames as they are seen, and of frames of models at rest, drawn in turn. */
async function timesOfDrawing(page, moments) {
    return page.evaluate((moments) => {
        const viewer = globalThis.photosurface;
        const gl = viewer.views.renderer.getContext();
        const times = { seen: [], rest: [] };
        const pixel = new Uint8Array(4);
        for (const moment of moments) {
            for (const model of ["seen", "rest"]) {
                viewer.store.change({ model });
                viewer.moment = moment;
                // The first one compiles.
                for (let time = 0; time < 2; time++) {
                    const begun = performance.now();
                    viewer.drawNow();
                    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
                    if (time === 1) {
                        times[model].push(performance.now() - begun);
                    }
                }
            }
        }
        return times;
    }, moments);
}

/** Bytes of the heap after frames: after a tenth of them, and after all. */
async function heap(page, frames) {
    return page.evaluate(async (frames) => {
        const viewer = globalThis.photosurface;
        viewer.views.renderer.render = () => {};
        const sizes = [];
        const first = viewer.moment;
        for (let frame = 1; frame <= frames; frame++) {
            const [x, y, z] = first.position;
            const position = [x + Math.sin(frame / 50), y, z - (frame % 500) / 20];
            viewer.moment = {
                ...first,
                position,
                event: [frame / 100, ...position, 0, 0, 0, 0],
                time: frame / 100,
                properTime: frame / 100,
            };
            viewer.frame(frame * 16);
            if (frame % (frames / 10) === 0) {
                await new Promise((resolve) => setTimeout(resolve));
                globalThis.gc();
                sizes.push(performance.memory.usedJSHeapSize);
            }
        }
        return sizes;
    }, frames);
}

/** A mesh of a million triangles beside the flight. */
function million(folder) {
    const count = (SIDE + 1) ** 2;
    const places = new Float32Array(3 * count);
    for (let vertex = 0; vertex < count; vertex++) {
        const [x, z] = [vertex % (SIDE + 1), Math.floor(vertex / (SIDE + 1))];
        places.set([(60 * x) / SIDE - 30, 0.4 * Math.sin(x / 9) * Math.cos(z / 11), (60 * z) / SIDE - 50], 3 * vertex);
    }
    const faces = Buffer.alloc(13 * 2 * SIDE * SIDE);
    let at = 0;
    for (let cell = 0; cell < SIDE * SIDE; cell++) {
        const first = Math.floor(cell / SIDE) * (SIDE + 1) + (cell % SIDE);
        for (const corners of [
            [0, SIDE + 1, 1],
            [1, SIDE + 1, SIDE + 2],
        ]) {
            faces[at] = 3;
            corners.forEach((corner, k) => faces.writeUInt32LE(first + corner, at + 1 + 4 * k));
            at += 13;
        }
    }
    const header = ["ply", "format binary_little_endian 1.0", `element vertex ${count}`];
    header.push("property float x", "property float y", "property float z", `element face ${2 * SIDE * SIDE}`);
    header.push("property list uchar uint vertex_indices", "end_header\n");
    writeFileSync(
        join(folder, "million.ply"),
        Buffer.concat([Buffer.from(header.join("\n")), Buffer.from(places.buffer), faces]),
    );
    return { observer: { position: [0, 2, 4] }, objects: [{ name: "hills", file: "million.ply" }] };
}

function row(what, value, goal) {
    console.log(`| ${what} | ${value} | ${goal} |`);
}

await inBrowser(async (browser, folder) => {
    const version = execFileSync(binary(), ["--version"], { encoding: "utf8" }).trim();
    console.log(`${version}, Chromium ${browser.version()}\n\n| quantity | measured | goal |\n|---|---|---|`);
    const moments = flight(FRAMES);
    for (const [name, input, goal] of [
        ["the built-in flight", ["--example", "flight"], 4],
        ["a million triangles", million(folder), 16],
    ]) {
        const { page, context } = await openPage(browser, writePage(folder, input), { width: 1280, height: 720 });
        await show(page, { layout: "both" }, moments[0]);
        const times = await timesOfWork(page, moments);
        const slowest = times.toSorted((a, b) => a - b)[Math.floor(0.95 * FRAMES)];
        row(
            `${name}: work of a frame outside the graphics processor, median`,
            `${median(times).toFixed(1)} ms`,
            `${goal} ms`,
        );
        row(`${name}: the same, 19 of 20 frames`, `${slowest.toFixed(1)} ms`, "");
        await context.close();
    }
    for (const layout of ["observer", "outside", "both"]) {
        const { page, context } = await openPage(browser, writePage(folder, ["--example", "flight"]), {
            width: 800,
            height: 600,
        });
        await show(page, { layout }, moments[0]);
        const { seen, rest } = await timesOfDrawing(
            page,
            moments.filter((_, k) => k % Math.ceil(FRAMES / PAIRS) === 0),
        );
        const ratio = median(seen) / median(rest);
        row(
            `views "${layout}": frame as seen over the same with models at rest`,
            `${ratio.toFixed(2)} (${median(seen).toFixed(0)} ms)`,
            "1.25",
        );
        await context.close();
    }
    const { page } = await openPage(browser, writePage(folder, ["--example", "flight"]), { width: 320, height: 240 });
    await show(page, { layout: "both", diagram: true }, moments[0]);
    const sizes = await heap(page, HEAP_FRAMES);
    row(
        `heap after ${HEAP_FRAMES / 10} and ${HEAP_FRAMES} frames`,
        `${(sizes[0] / 1e6).toFixed(1)} and ${(sizes.at(-1) / 1e6).toFixed(1)} MB`,
        "equal",
    );
});
