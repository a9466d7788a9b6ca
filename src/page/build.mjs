/**
 * Bundles the page into `bundle/page.js`, the same bytes on every machine. With `--check` it writes nothing, and fails where
 * the bundle is not that of the sources.
 */

import { readFile, writeFile } from "node:fs/promises";
import { fileURLToPath } from "node:url";

import { build } from "esbuild";

const here = new URL(".", import.meta.url);
const bundle = new URL("bundle/page.js", here);

const { outputFiles } = await build({
    absWorkingDir: fileURLToPath(here),
    entryPoints: ["main.js"],
    bundle: true,
    minify: true,
    format: "iife",
    target: "es2022",
    charset: "utf8",
    legalComments: "inline",
    loader: { ".glsl": "text" },
    write: false,
});
const built = outputFiles[0].contents;

if (process.argv.includes("--check")) {
    const committed = await readFile(bundle).catch(() => null);
    if (committed === null || Buffer.compare(committed, built) !== 0) {
        console.error("src/page/bundle/page.js is not the bundle of the sources; run `npm run build` in src/page");
        process.exit(1);
    }
} else {
    await writeFile(bundle, built);
    console.error(`src/page/bundle/page.js: ${built.length} bytes`);
}
