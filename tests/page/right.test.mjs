/** What the page draws, against the program: positions against its meshes, pictures against its rays. */

import assert from "node:assert/strict";
import { copyFileSync, readFileSync, writeFileSync } from "node:fs";
import { basename, join } from "node:path";
import { after, before, test } from "node:test";
import { momentOf } from "../../src/page/spacetime/moment.js";
import { subtract, sum } from "../../src/page/spacetime/vector.js";
import { words } from "../../src/page/texts.js";
import { inBrowser, openPage, pictureOf, show, writePage } from "./browser.mjs";
import { readBack } from "./feedback.mjs";
import { pixelsOf, runLine, verticesSeen } from "./program.mjs";
import { STATES } from "./states.mjs";

/** The largest error of a position, over its distance from the observer. */
const MOST_ERROR = 4e-5;

/** Vertices of each mesh that are compared. */
const VERTICES = 300;

/** Two colours of which no channel differs by more are the same. */
const SAME = 24;

const SIZE = { width: 480, height: 360 };

/** In pictures of the Doppler factor the program draws a legend, in this part of the lower right corner. */
const LEGEND = { width: 0.55, height: 0.26 };

let chromium;
let finished;

before(async () => {
    await new Promise((resolve, reject) => {
        finished = inBrowser(
            (browser, folder) =>
                new Promise((end) => {
                    chromium = { browser, folder, end };
                    resolve();
                }),
        );
        finished.catch(reject);
    });
});

after(async () => {
    chromium?.end();
    await finished;
});

for (const { name, input, observer, files = [], state = {} } of STATES) {
    test(`${name}: positions and picture are the program's`, async (t) => {
        const { browser, folder } = chromium;
        for (const file of files) {
            copyFileSync(file, join(folder, basename(file.pathname)));
        }
        const path = writePage(folder, input);
        const { page, context, failures } = await openPage(browser, path, SIZE);
        await show(page, state, momentOf(observer));

        const { data, glb } = contentOf(path);
        const { error, vertices, leaves } = positions(await readBack(page, VERTICES), data, glb, observer, state);
        const picture = await pictureOf(page);
        const seen = pixelsOf(picture);
        assert.ok(isDrawn(seen), "the canvas is blank");
        const traced = await rays(page, folder);
        keep(name, { page: picture, rays: traced });
        const { differing, outline, apart } = compare(seen, pixelsOf(traced), state.doppler === "ramp");
        t.diagnostic(
            `${vertices} positions (${leaves} of leaves), largest relative error ${error.toExponential(1)}; ` +
                `${differing} pixels differ, outlines ${outline}, ${apart} of them away from outlines`,
        );
        assert.deepEqual(failures, []);
        assert.ok(error <= MOST_ERROR, `positions: ${error}`);
        assert.ok(differing <= outline, `${differing} pixels differ, the outlines are ${outline} long`);
        await context.close();
    });
}

/** Keeps pictures in the folder that PHOTOSURFACE_PICTURES names, for those who want to look at them. */
function keep(name, pictures) {
    const folder = process.env.PHOTOSURFACE_PICTURES;
    for (const [kind, png] of folder ? Object.entries(pictures) : []) {
        writeFileSync(join(folder, `${name.replaceAll(" ", "_")}.${kind}.png`), png);
    }
}

/** What the program wrote into a page. */
function contentOf(path) {
    const html = readFileSync(path, "utf8");
    const text = (id) => new RegExp(`id="${id}">([^<]*)<`).exec(html)[1];
    const bytes = Buffer.from(text("meshes"), "base64");
    return {
        data: JSON.parse(text("scene")),
        glb: JSON.parse(bytes.toString("utf8", 20, 20 + bytes.readUInt32LE(12))),
    };
}

/** The pieces of the page: for each mesh its object, and where the origin of its node is in the object's rest frame. */
function piecesOf(data, glb) {
    const nodes = new Map(glb.nodes.map((node) => [node.name, node]));
    return data.objects.flatMap((object) =>
        object.nodes.flatMap((name) => {
            const { mesh, translation = [0, 0, 0] } = nodes.get(name);
            const origin = subtract(translation, object.position);
            return glb.meshes[mesh].primitives.map(() => ({ object, origin }));
        }),
    );
}

/** Positions that were read back, against those of the program: the largest error over the distance. */
function positions({ results, projection, camera }, data, glb, observer, state) {
    const pieces = piecesOf(data, glb);
    const objects = [];
    const meshes = [];
    const found = [];
    for (const { piece, rest, clip } of results) {
        const { object, origin } = pieces[piece];
        const { position, rapidity, direction, model } = object;
        const chosen = state.model && state.model !== "seen" ? state.model : (model ?? "seen");
        objects.push({ position, velocity: { rapidity, direction }, model: chosen });
        meshes.push(
            threes(rest).map((vertex) => {
                const place = sum(vertex, origin);
                return [place, sum(place, [1, 0, 0]), sum(place, [0, 1, 0])];
            }),
        );
        for (let at = 0; at < clip.length; at += 4) {
            found.push(unprojected(clip.slice(at, at + 4), projection, camera));
        }
    }
    const { rapidity, direction, ...where } = observer;
    const expected = verticesSeen({ ...where, velocity: { rapidity, direction } }, objects, 0, meshes).filter(
        (_, k) => k % 3 === 0,
    );
    assert.equal(expected.length, found.length);
    const errors = found.map((place, k) => Math.hypot(...subtract(place, expected[k])) / Math.hypot(...expected[k]));
    const leaves = results.filter(({ isLeaf }) => isLeaf).reduce((count, { rest }) => count + rest.length / 3, 0);
    return { error: Math.max(...errors), vertices: found.length, leaves };
}

function threes(numbers) {
    return Array.from({ length: numbers.length / 3 }, (_, k) => numbers.slice(3 * k, 3 * k + 3));
}

/** From clip coordinates to the observer's own axes, without the depth, which is logarithmic. */
function unprojected([x, y, , w], projection, camera) {
    const own = [x / projection[0], y / projection[5], -w];
    return [0, 1, 2].map((row) => own[0] * camera[row] + own[1] * camera[4 + row] + own[2] * camera[8 + row]);
}

/** The picture by rays that the command makes which the page offers to copy. */
async function rays(page, folder) {
    await page.evaluate((label) => {
        const buttons = [...document.querySelectorAll("button")];
        buttons.find((button) => button.textContent.trim() === label).click();
    }, words.copyRender);
    const line = await page.evaluate(() => globalThis.copied.at(-1));
    assert.match(line, /^photosurface render .* --method rays /);
    const { status, stderr } = runLine(line, folder);
    assert.equal(status, 0, `${line}\n${stderr}`);
    return readFileSync(join(folder, "seen.png"));
}

/** Whether a picture has at least three colours. */
function isDrawn({ rows, channels }) {
    const colors = new Set();
    for (const row of rows) {
        for (let at = 0; at < row.length && colors.size < 3; at += channels) {
            colors.add((row[at] << 16) | (row[at + 1] << 8) | row[at + 2]);
        }
    }
    return colors.size === 3;
}

/**
 * How many pixels differ; how long the outlines are in pixels; and how many pixels differ that do not touch an outline.
 *
 * An outline is where the picture by rays changes from one pixel to the next: pixels that differ from the one to the right or
 * the one below. All edges are found so: of objects, of cells of the ground, of facets.
 */
function compare(seen, expected, hasLegend) {
    const { width, height } = expected;
    const isLegend = (x, y) => hasLegend && x > width * (1 - LEGEND.width) && y > height * (1 - LEGEND.height);
    assert.deepEqual([seen.width, seen.height], [width, height]);
    const differ = (a, x, y, b, u, v) =>
        [0, 1, 2].some((k) => Math.abs(a.rows[y][x * a.channels + k] - b.rows[v][u * b.channels + k]) > SAME);
    const edge = new Uint8Array(width * height);
    const near = new Uint8Array(width * height);
    for (let y = 0; y < height; y++) {
        for (let x = 0; x < width; x++) {
            const right = x + 1 < width && differ(expected, x, y, expected, x + 1, y);
            const below = y + 1 < height && differ(expected, x, y, expected, x, y + 1);
            if ((right || below) && !isLegend(x, y)) {
                edge[y * width + x] = 1;
                for (let v = Math.max(y - 1, 0); v <= Math.min(y + 2, height - 1); v++) {
                    near.fill(1, v * width + Math.max(x - 1, 0), v * width + Math.min(x + 2, width - 1) + 1);
                }
            }
        }
    }
    let [differing, apart] = [0, 0];
    for (let y = 0; y < height; y++) {
        for (let x = 0; x < width; x++) {
            if (differ(seen, x, y, expected, x, y) && !isLegend(x, y)) {
                differing += 1;
                apart += 1 - near[y * width + x];
            }
        }
    }
    return { differing, outline: edge.reduce((sum, is) => sum + is, 0), apart };
}
