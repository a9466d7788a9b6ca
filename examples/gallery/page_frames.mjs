/**
 * Takes pictures of the page that plays the flight of its scene, as draw_page.py makes them into a film.
 *
 *     node examples/gallery/page_frames.mjs PAGE FOLDER COUNT
 *
 * The frames are FOLDER/000.png and so on, even in the observer's proper time. Playwright is that of tests/page.
 */

import { join } from "node:path";
import { inBrowser, openPage } from "../../tests/page/browser.mjs";

/** Places that the view from outside is filled with, in the observer's frame: the observer, and things near it ahead. */
const NEAR = [
    [0, 0, 2],
    [-6, 0, -52],
    [6, 0, -52],
];

/** CSS pixels. At this width the page shows its title; the pictures are 900 pixels wide. */
const [WIDTH, HEIGHT, PIXELS_WIDE] = [1000, 500, 900];

const [path, folder, count] = process.argv.slice(2);
if (!count) {
    console.error("expected PAGE FOLDER COUNT");
    process.exit(2);
}

await inBrowser(async (browser) => {
    const { page } = await openPage(browser, path, { width: WIDTH, height: HEIGHT, scale: PIXELS_WIDE / WIDTH });
    await page.getByRole("button", { name: "Settings" }).click();
    await page.mouse.move(WIDTH / 2, HEIGHT / 2);
    await page.evaluate((places) => {
        const { photosurface } = globalThis;
        photosurface.views.renderer.setAnimationLoop(null);
        document.querySelector(".toast").hidden = true;
        photosurface.drawNow();
        const size = document.getElementById("outside-view").getBoundingClientRect();
        photosurface.views.outside.frame(places, [0, 0, -1], size);
    }, NEAR);
    for (let frame = 0; frame < Number(count); frame++) {
        await page.evaluate(
            ([part, now]) => {
                const line = document.querySelector(".film input[type=range]");
                line.value = part * Number(line.max);
                line.dispatchEvent(new Event("input"));
                globalThis.photosurface.drawNow(now);
            },
            // Readings are taken some times a second.
            [frame / (count - 1), 1e9 + 1000 * frame],
        );
        await page.screenshot({ path: join(folder, `${String(frame).padStart(3, "0")}.png`) });
    }
});
