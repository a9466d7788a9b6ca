/** Anywhere, at any speed: no hole in what is closed, and no facet that finer triangles would take away. */

import assert from "node:assert/strict";
import { test } from "node:test";
import { momentOf } from "../../src/page/spacetime/moment.js";
import { inBrowser, openPage, show, writePage } from "./browser.mjs";
import { readBack } from "./feedback.mjs";
import { numbers, quaternionFrom, vectorFrom } from "./program.mjs";

/** Half the side of the room, and how far from its middle the observer flies. */
const ROOM = 30;
const REACH = 28;

/** The observer flies as near to a wall as this part of its length: nearer, `f32` does not tell its two sides apart. */
const NEAREST = 1e-4;

const FLIGHTS = 200;

/** A moment in this many is drawn with finer triangles too. */
const EVERY = 8;

/** How many times as fine. */
const FINER = 4;

/** Part of the pixels that finer triangles may change: those at outlines. */
const MOST_CHANGED = 2e-3;

/**
 * Pixels of all moments together in which background shows, alone or as a line no wider than a pixel: a part of 2.6e-6.
 * Vertices that pieces share are at one place to the last bit, and pieces cover everything (`covering.test.mjs`), so these
 * pixels are taken for the rasterizer's, which cuts off triangles that reach beyond the picture; nothing here proves that. A
 * hole has neighbours to its right and below too.
 */
const MOST_HAIRLINES = 40;

/** The colour of what is behind everything: nothing in the scene is like it. */
const NOTHING = "#ff00ff";

const SCENE = {
    observer: { position: [0, 0, 0] },
    objects: [
        { name: "room", shape: { box: { size: [2 * ROOM, 2 * ROOM, 2 * ROOM] } } },
        {
            name: "ball",
            shape: { sphere: { radius: 4 } },
            position: [8, 3, -10],
            velocity: { gamma: 2, direction: [0, 1, 0] },
        },
        { name: "ring", shape: { torus: { major_radius: 5, minor_radius: 1.2 } }, position: [-9, -4, 6] },
        {
            name: "crate",
            shape: { box: { size: [6, 4, 9] } },
            position: [4, -12, 12],
            velocity: { beta: 0.6, direction: [1, 0, 1] },
        },
        { name: "column", shape: { cylinder: { radius: 2, height: 20 } }, position: [-12, 0, -14] },
    ],
};

/** Moments in the room: in all directions, slow and fast, some of them nearly at a wall. */
function* moments() {
    const next = numbers(17);
    for (let flight = 0; flight < FLIGHTS; flight++) {
        const position = vectorFrom(next, REACH);
        if (flight % 3 === 0) {
            position[(flight % 9) / 3] = ROOM - 2 * ROOM * NEAREST ** (0.4 + 0.6 * next());
        }
        const rapidity = Math.acosh(20) * next();
        const direction = vectorFrom(next);
        yield momentOf({ time: 0, position, rapidity, direction, orientation: quaternionFrom(next) });
    }
}

/** Draws now, some times as fine as usual; counts pixels in which the background shows, and the part that differs from before. */
function drawInPage(finer) {
    const viewer = globalThis.photosurface;
    const { world, views } = viewer;
    const update = world.update;
    world.update = (moment, sharpness) =>
        update.call(world, moment, {
            ...sharpness,
            observer: sharpness.observer / finer,
            outside: sharpness.outside / finer,
        });
    // After many triangles, pictures are coarser for a while.
    for (let settle = 0; settle < (finer > 1 ? 1 : 2); settle++) {
        viewer.drawNow();
    }
    world.update = update;
    const gl = views.renderer.getContext();
    const { drawingBufferWidth: width, drawingBufferHeight: height } = gl;
    const pixels = new Uint8Array(4 * width * height);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    const last = globalThis.lastPixels ?? pixels;
    let [holes, hairlines, changed] = [0, 0, 0];
    for (let at = 0; at < pixels.length; at += 4) {
        const background = (pixels[at] + pixels[at + 2]) / 2 - pixels[at + 1];
        const besides = [at + 4, at + 4 * width].map(
            (next) => (pixels[next] + pixels[next + 2]) / 2 - pixels[next + 1],
        );
        holes += background > 128 && besides.every((each) => each > 128) ? 1 : 0;
        hairlines += background > 16 ? 1 : 0;
        changed += [0, 1, 2].some((k) => Math.abs(pixels[at + k] - last[at + k]) > 24) ? 1 : 0;
    }
    globalThis.lastPixels = pixels;
    return { holes, hairlines, changed: changed / (width * height) };
}

/**
 * Vertices that are at one place at rest and are not drawn at one place, and those that are at nearly one place:
 * pieces that share a vertex share all its bits, so that no crack opens between them.
 */
function parted({ rest, clip }) {
    const nearby = 2 ** -13;
    const places = new Map();
    let count = 0;
    for (let k = 0; 3 * k < rest.length; k++) {
        const place = rest.slice(3 * k, 3 * k + 3);
        const name = String(place.map((part) => Math.round(part / nearby)));
        const drawn = `${place} ${clip.slice(4 * k, 4 * k + 4)}`;
        count += (places.get(name) ?? drawn) === drawn ? 0 : 1;
        places.set(name, drawn);
    }
    return count;
}

test("what pieces share is drawn at one place, to the last bit", async (t) => {
    await inBrowser(async (browser, folder) => {
        const { page } = await openPage(browser, writePage(folder, SCENE), { width: 320, height: 240 });
        let vertices = 0;
        let number = 0;
        for (const moment of moments()) {
            if (number++ % EVERY !== 0) {
                continue;
            }
            await show(page, {}, moment);
            const { results } = await readBack(page, Number.MAX_SAFE_INTEGER);
            for (const piece of new Set(results.map((result) => result.piece))) {
                const parts = results.filter((result) => result.piece === piece);
                const rest = parts.flatMap((part) => part.rest);
                const clip = parts.flatMap((part) => part.clip);
                vertices += rest.length / 3;
                assert.equal(parted({ rest, clip }), 0, `vertices of ${piece} apart at ${JSON.stringify(moment)}`);
            }
        }
        assert.ok(vertices > 10_000, `${vertices} vertices`);
        t.diagnostic(`${vertices} vertices`);
    });
});

test("a flight through a closed room shows no hole and no facet", async (t) => {
    await inBrowser(async (browser, folder) => {
        const path = writePage(folder, SCENE, (html) =>
            html.replace(/"background":"[^"]*"/, `"background":"${NOTHING}"`),
        );
        const { page, failures } = await openPage(browser, path, { width: 320, height: 240 });

        // What a hole looks like: the room is not there.
        await show(
            page,
            {},
            momentOf({ time: 0, position: [0, 0, 0], rapidity: 0, direction: [0, 0, -1], orientation: [0, 0, 0, 1] }),
        );
        const [shown, taken] = await page.evaluate((source) => {
            const draw = new Function(`return ${source}`)();
            const [room] = globalThis.photosurface.world.group.children;
            const shown = draw(1).holes;
            room.visible = false;
            const taken = draw(1).holes;
            room.visible = true;
            return [shown, taken];
        }, drawInPage.toString());
        assert.equal(shown, 0);
        assert.ok(taken > 1000, `${taken} pixels of a scene without walls are background`);

        let drawn = 0;
        let thin = 0;
        let worst = 0;
        for (const moment of moments()) {
            await show(page, {}, moment);
            const { holes, hairlines } = await page.evaluate(drawInPage, 1);
            assert.equal(holes, 0, `${holes} pixels of background at ${JSON.stringify(moment)}`);
            thin += hairlines;
            assert.ok(thin <= MOST_HAIRLINES, `${thin} pixels of some background up to ${JSON.stringify(moment)}`);
            if (drawn % EVERY === 0) {
                const { changed } = await page.evaluate(drawInPage, FINER);
                assert.ok(changed <= MOST_CHANGED, `${changed} of the pixels change at ${JSON.stringify(moment)}`);
                worst = Math.max(worst, changed);
            }
            drawn += 1;
        }
        assert.equal(drawn, FLIGHTS);
        assert.deepEqual(failures, []);
        t.diagnostic(
            `${drawn} moments, ${thin} hairline pixels in all; finer triangles change at most ${(100 * worst).toFixed(2)} % of the pixels`,
        );
    });
});
