/** Chromium, and pages that the program writes. */

import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { binary } from "./program.mjs";

/** Debian's; Playwright's own browsers are not installed. */
const CHROMIUM = process.env.CHROMIUM ?? "/usr/bin/chromium";

const FLAGS = [
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
    "--enable-precise-memory-info",
    "--js-flags=--expose-gc",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
];

/** Packages of `package.json`, from the folder that has them installed. */
export function installed(name) {
    return packages()(name);
}

/** The path of a file of such a package. */
export function installedFile(path) {
    return packages().resolve(path);
}

function packages() {
    const home = process.env.PHOTOSURFACE_PAGE_TESTS ?? new URL(".", import.meta.url).pathname;
    return createRequire(join(home, "tests.cjs"));
}

/** Calls a function with a browser and a folder, which are gone afterwards. */
export async function inBrowser(work) {
    const { chromium } = installed("playwright-core");
    const folder = mkdtempSync(join(tmpdir(), "photosurface-page-"));
    let browser = null;
    try {
        browser = await chromium.launch({ executablePath: CHROMIUM, args: FLAGS });
        return await work(browser, folder);
    } finally {
        await browser?.close();
        rmSync(folder, { recursive: true });
    }
}

/** Writes the page of a scene: words after `photosurface page`, or a scene. `change` edits the HTML. */
export function writePage(folder, input, change = (html) => html) {
    let words = input;
    if (!Array.isArray(input)) {
        writeFileSync(join(folder, "scene.json"), JSON.stringify(input));
        words = ["scene.json"];
    }
    execFileSync(binary(), ["page", ...words, "-q", "-o", "page.html"], {
        cwd: folder,
        stdio: ["ignore", "pipe", "pipe"],
    });
    const path = join(folder, "page.html");
    writeFileSync(path, change(readFileSync(path, "utf8")));
    return path;
}

/**
 * Opens a page. Beside Playwright's page: what went wrong in it, what it asked a network for, and how to draw a state.
 */
export async function openPage(browser, path, { width = 640, height = 480, scale = 1, before = null } = {}) {
    const context = await browser.newContext({ viewport: { width, height }, deviceScaleFactor: scale });
    const page = await context.newPage();
    const failures = [];
    const requests = [];
    page.on("pageerror", (error) => failures.push(String(error.stack ?? error)));
    page.on("console", (message) => {
        // SwiftShader tells how slow it is.
        if (["error", "warning"].includes(message.type()) && !/GPU stall|GL Driver Message/.test(message.text())) {
            failures.push(message.text());
        }
    });
    page.on("request", (request) => requests.push(request.url()));
    await page.addInitScript(() => {
        globalThis.copied = [];
        Object.defineProperty(navigator, "clipboard", {
            value: { writeText: async (text) => globalThis.copied.push(text) },
        });
        document.addEventListener("securitypolicyviolation", (event) => {
            console.error(`forbidden: ${event.violatedDirective} ${event.blockedURI}`);
        });
    });
    if (before) {
        await before(page);
    }
    const address = pathToFileURL(path).href;
    await page.goto(address);
    await page
        .waitForFunction(() => globalThis.photosurface !== undefined, null, { timeout: 120_000 })
        .catch((error) => {
            throw new Error(`the page did not start: ${failures.join("\n")}\n${error}`);
        });
    return {
        page,
        context,
        failures,
        requests: () => requests.filter((url) => !/^(data|blob):/.test(url) && url !== address),
    };
}

/** What the page shows in a test unless the test says otherwise: the observer's view alone, standing still. */
export const STILL = { paused: true, film: false, help: false, layout: "observer", look: [0, 0] };

/** Shows a state and a moment; both as the page has them. */
export async function show(page, state, moment) {
    await page.evaluate(
        ([state, moment]) => {
            const { store } = globalThis.photosurface;
            store.change(state);
            globalThis.photosurface.moment = moment;
            globalThis.photosurface.drawNow();
        },
        [{ ...STILL, ...state }, moment],
    );
}

/** The pixels of the canvas as a PNG, drawn now. */
export async function pictureOf(page) {
    const url = await page.evaluate(() => {
        globalThis.photosurface.drawNow();
        return document.getElementById("canvas").toDataURL();
    });
    return Buffer.from(url.slice(url.indexOf(",") + 1), "base64");
}
