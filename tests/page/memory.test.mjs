/** The memory of the page stays what it is, however long one flies. */

import assert from "node:assert/strict";
import { test } from "node:test";
import { advance, momentOf } from "../../src/page/spacetime/moment.js";
import { inBrowser, openPage, writePage } from "./browser.mjs";

/** Frames of a flight, over and over. */
const FLIGHT = 250;
const FRAMES = 10_000;
const ROUND = 1000;

/** The first rounds fill what is kept: buffers, histories, compiled code. */
const FIRST_ROUNDS = 3;

/** Bytes by which the heap may grow afterwards: a number for each frame would be more. */
const MOST_GROWTH = 8 * 7000 * 4;

test("ten thousand frames leave nothing behind", async (t) => {
    await inBrowser(async (browser, folder) => {
        const { page, context } = await openPage(browser, writePage(folder, ["--example", "flight"]), {
            width: 320,
            height: 240,
        });
        const session = await context.newCDPSession(page);
        const start = { time: 0, position: [0, 2, 4], rapidity: 0.5, direction: [0, 0, -1], orientation: [0, 0, 0, 1] };
        const moments = [momentOf(start)];
        while (moments.length < FLIGHT) {
            moments.push(advance(moments.at(-1), [0, 0, -0.25], [0, 0.02, 0], 0.04));
        }
        await page.evaluate(() => {
            const viewer = globalThis.photosurface;
            viewer.store.change({ film: false, paused: true, diagram: true });
            viewer.views.renderer.setAnimationLoop(null);
            // All but the graphics processor's work.
            viewer.views.renderer.render = () => {};
        });
        const heap = [];
        for (let frame = 0; frame < FRAMES; frame += ROUND) {
            await page.evaluate(
                ([moments, frames]) => {
                    for (let frame = 0; frame < frames; frame++) {
                        globalThis.photosurface.moment = moments[frame % moments.length];
                        globalThis.photosurface.drawNow();
                    }
                },
                [moments, ROUND],
            );
            await session.send("HeapProfiler.collectGarbage");
            const { usedSize } = await session.send("Runtime.getHeapUsage");
            heap.push(usedSize);
        }
        t.diagnostic(`megabytes after each thousand frames: ${heap.map((bytes) => (bytes / 1e6).toFixed(2)).join(" ")}`);
        const growth = heap.at(-1) - heap[FIRST_ROUNDS - 1];
        assert.ok(growth < MOST_GROWTH, `the heap grew by ${growth} bytes`);
    });
});
