/** Pages are closed: they ask for nothing, names are text, and a file opens by double-click. */

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { pathToFileURL } from "node:url";
import { momentOf } from "../../src/page/spacetime/moment.js";
import { inBrowser, openPage, STILL, show, writePage } from "./browser.mjs";
import { inFirefox } from "./firefox.mjs";

/** The largest bundle, in bytes: all of a page but its meshes. */
const MOST_BUNDLE = 800_000;

const NASTY = `</script><script>globalThis.hacked = 1</script><img src=x onerror="globalThis.hacked = 2">'"&amp;\u2028`;

test("a page asks for nothing, in a film, with every effect and in every view", async () => {
    await inBrowser(async (browser, folder) => {
        const { page, failures, requests } = await openPage(browser, writePage(folder, ["--example", "flight"]));
        for (const doppler of ["none", "spectrum", "ramp"]) {
            for (const layout of ["both", "observer", "outside"]) {
                await page.evaluate(
                    (state) => {
                        globalThis.photosurface.store.change(state);
                        globalThis.photosurface.drawNow();
                    },
                    {
                        doppler,
                        layout,
                        searchlight: layout === "both",
                        ghostAtRest: true,
                        ghostContracted: true,
                        diagram: true,
                        help: true,
                    },
                );
            }
        }
        const isRefused = await page.evaluate(() =>
            fetch("https://example.org/").then(
                () => false,
                () => true,
            ),
        );
        assert.ok(isRefused);
        assert.ok(failures.some((text) => text.includes("connect-src")));
        assert.deepEqual(
            failures.filter((text) => !/connect-src|example\.org/.test(text)),
            [],
        );
        assert.deepEqual(
            requests().filter((url) => url !== "https://example.org/"),
            [],
        );
    });
});

test("names and titles are text", async () => {
    await inBrowser(async (browser, folder) => {
        const names = [NASTY, "x".repeat(1_000_000)];
        const scene = {
            title: NASTY,
            observer: { position: [0, 0, 5], marker: 0.1 },
            objects: names.map((name, index) => ({
                name,
                shape: { box: { size: [1, 1, 1] } },
                position: [2 * index, 0, 0],
            })),
        };
        const { page, failures, requests } = await openPage(browser, writePage(folder, scene));
        const { title, data, hacked } = await page.evaluate(() => ({
            title: document.title,
            data: JSON.parse(document.getElementById("scene").textContent),
            hacked: globalThis.hacked,
        }));
        assert.equal(hacked, undefined);
        assert.equal(title.replace(/\s+/g, " ").trim(), NASTY.replace(/\s+/g, " ").trim());
        assert.deepEqual(
            data.objects.map(({ name }) => name),
            names,
        );
        assert.deepEqual(failures, []);
        assert.deepEqual(requests(), []);
    });
});

test("the program of a page is no larger than it may be", async () => {
    const bundle = readFileSync(new URL("../../src/page/bundle/page.js", import.meta.url));
    assert.ok(bundle.length <= MOST_BUNDLE, `${bundle.length} bytes`);
    await inBrowser(async (_, folder) => {
        const html = readFileSync(writePage(folder, ["--example", "flight"]), "utf8");
        const meshes = /id="meshes">([^<]*)</.exec(html)[1];
        assert.ok(html.length - meshes.length <= MOST_BUNDLE + 150_000, `${html.length - meshes.length}`);
    });
});

test("a page opens as a file in Firefox and draws what Chromium draws", async (t) => {
    await inBrowser(async (browser, folder) => {
        const path = writePage(folder, ["--example", "flight"]);
        const moment = momentOf({
            time: 0,
            position: [0, 2, 0],
            rapidity: 1.5,
            direction: [0, 0, -1],
            orientation: [0, 0, 0, 1],
        });
        const { page } = await openPage(browser, path, { width: 480, height: 360 });
        await show(page, {}, moment);
        const expected = await page.evaluate(drawInPage, [{}, {}, 480, 360]);

        const seen = await inFirefox(folder, async (send) => {
            await send("WebDriver:SetTimeouts", { script: 120_000, pageLoad: 120_000 });
            await send("WebDriver:Navigate", { url: pathToFileURL(path).href });
            const script = `
                const [args, done] = arguments;
                const start = () => {
                    const viewer = window.wrappedJSObject ? window.wrappedJSObject.photosurface : window.photosurface;
                    viewer ? done((${drawInPage})(args)) : setTimeout(start, 100);
                };
                start();`;
            // Firefox is told in JSON, which has no typed arrays.
            const plain = { ...moment, frame: [...moment.frame], event: [...moment.event] };
            const args = [[STILL, plain, 480, 360]];
            return (await send("WebDriver:ExecuteAsyncScript", { script, args, sandbox: null })).value;
        });
        assert.equal(seen.length, expected.length);
        const differing = seen.filter((value, k) => Math.abs(value - expected[k]) > 24).length / seen.length;
        const colors = new Set(seen).size;
        t.diagnostic(`${(100 * differing).toFixed(2)} % of the channels differ`);
        assert.ok(colors > 50, `${colors} values: the canvas is blank`);
        assert.ok(differing < 0.02, `${differing}`);
    });
});

/** Draws a state; the channels of a canvas of this size, in the middle of the page's. */
function drawInPage([state, moment, width, height]) {
    const viewer = globalThis.photosurface;
    viewer.store.change(state);
    if (moment.frame) {
        viewer.moment = moment;
    }
    const layout = viewer.views.renderer;
    layout.setSize = (
        (own) => () =>
            own.call(layout, width, height, false)
    )(layout.setSize);
    const canvas = document.getElementById("canvas");
    canvas.style.width = `${width}px`;
    canvas.style.height = `${height}px`;
    viewer.drawNow();
    const gl = layout.getContext();
    const pixels = new Uint8Array(4 * width * height);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    return Array.from(pixels);
}
