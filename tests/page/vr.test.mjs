/** VR in an emulated headset: each eye has its own light cone, and the controllers fly. */

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { momentOf } from "../../src/page/spacetime/moment.js";
import { dot, scaled, subtract, sum } from "../../src/page/spacetime/vector.js";
import { words } from "../../src/page/texts.js";
import { inBrowser, installedFile, openPage, show, writePage } from "./browser.mjs";

const GAMMA = 5;

/** Puts on a headset. */
async function putOnHeadset(page) {
    await page.addInitScript(`${readFileSync(installedFile("iwer/build/iwer.min.js"), "utf8")}
        globalThis.headset = new IWER.XRDevice(IWER.metaQuest3, { stereoEnabled: true });
        globalThis.headset.installRuntime({ forceInstall: true });`);
}

test("VR starts, each eye has its own light cone, and a thumbstick changes the speed", async (t) => {
    await inBrowser(async (browser, folder) => {
        const path = writePage(folder, ["--example", "cube"]);
        const { page, failures, requests } = await openPage(browser, path, { width: 1000, before: putOnHeadset });
        const direction = [0.6, 0, -0.8];
        const start = momentOf({
            time: 0,
            position: [0, 0, 6],
            rapidity: Math.acosh(GAMMA),
            direction,
            orientation: [0, 0, 0, 1],
        });
        await show(page, {}, start);
        const label = words.enterVr;
        await page.evaluate((label) => {
            [...document.querySelectorAll("button")].find((button) => button.textContent.trim() === label).click();
        }, label);
        await page.waitForFunction(() => globalThis.photosurface.views.renderer.xr.isPresenting, null, {
            timeout: 60_000,
        });

        // The uniforms of a mesh at each of its draws.
        const eyes = await page.evaluate(
            () =>
                new Promise((resolve) => {
                    const { world, views } = globalThis.photosurface;
                    const gl = views.renderer.getContext();
                    const own = gl.drawElements;
                    const drawn = [];
                    gl.drawElements = (...args) => {
                        const program = gl.getParameter(gl.CURRENT_PROGRAM);
                        const value = (name) => {
                            const place = gl.getUniformLocation(program, name);
                            return place && Array.from(gl.getUniform(program, place));
                        };
                        if (value("eye")) {
                            drawn.push({
                                eye: value("eye"),
                                pivot: value("pivotHigh"),
                                viewport: Array.from(gl.getParameter(gl.VIEWPORT)),
                            });
                        }
                        own.apply(gl, args);
                        if (drawn.length === 2 * world.group.children.length) {
                            delete gl.drawElements;
                            resolve(drawn);
                        }
                    };
                }),
        );
        const [left, right] = [eyes[0], eyes.at(-1)];
        const apart = right.eye.map((x, k) => x - left.eye[k]);
        t.diagnostic(`eyes ${JSON.stringify(eyes)}`);
        assert.ok(Math.hypot(...apart) > 0.05 && Math.hypot(...apart) < 0.08, `eyes apart by ${apart}`);
        assert.notDeepEqual(left.viewport, right.viewport);
        // Events that are simultaneous for the observer are `gamma` times as far apart along its motion where the mesh is at rest.
        const moved = right.pivot.map((x, k) => left.pivot[k] - x);
        const expected = sum(apart, scaled(direction, (GAMMA - 1) * dot(direction, apart)));
        assert.ok(Math.hypot(...subtract(moved, expected)) < 1e-5, `${moved} for ${apart}`);

        await page.evaluate(() => globalThis.photosurface.store.change({ paused: false }));
        const faster = await page.evaluate(async () => {
            const viewer = globalThis.photosurface;
            const frames = (count) =>
                new Promise((resolve) => {
                    const session = viewer.views.renderer.xr.getSession();
                    const next = (left) =>
                        left === 0 ? resolve() : session.requestAnimationFrame(() => next(left - 1));
                    next(count);
                });
            const frame = () => JSON.stringify(viewer.moment.frame);
            const first = frame();
            await frames(5);
            const coasting = frame();
            globalThis.headset.controllers.left.updateAxes("thumbstick", 0, -1);
            await frames(5);
            return { isCoasting: coasting === first, isFaster: frame() !== coasting, time: viewer.moment.time };
        });
        assert.ok(faster.isCoasting && faster.isFaster && faster.time > 0, JSON.stringify(faster));

        await page.evaluate((label) => {
            [...document.querySelectorAll("button")].find((button) => button.textContent.trim() === label).click();
        }, words.leaveVr);
        await page.waitForFunction(() => !globalThis.photosurface.views.renderer.xr.isPresenting);
        assert.deepEqual(failures, []);
        assert.deepEqual(requests(), []);
    });
});
