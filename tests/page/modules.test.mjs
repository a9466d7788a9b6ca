/** The sources of the page as a house: each folder uses only those above it, and no file uses itself through others. */

import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { dirname, join, relative } from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";

const SOURCE = fileURLToPath(new URL("../../src/page/", import.meta.url));

/** What the files of a folder may import, beside each other; files of the page's own folder may import all. */
const MAY_USE = {
    spacetime: [],
    effects: [],
    light_cone: ["spacetime"],
    shape: ["spacetime"],
    tessellation: ["light_cone", "shape", "spacetime"],
    surface: ["effects", "light_cone", "shape", "spacetime", "tessellation"],
    views: ["spacetime", "surface"],
    controls: ["spacetime"],
    ui: ["controls", "spacetime"],
    vr: ["controls", "ui"],
};

/** Files by their paths, each with the files that it imports. */
function imports() {
    const files = readdirSync(SOURCE, { recursive: true, encoding: "utf8" }).filter(
        (file) => file.endsWith(".js") && !/^(node_modules|bundle)\//.test(file),
    );
    return new Map(
        files.map((file) => {
            const text = readFileSync(join(SOURCE, file), "utf8");
            const named = [...text.matchAll(/^(?:import|export) [^;]*?from "(\.[^"]+)";/gms)].map(([, path]) => path);
            return [file, named.map((path) => relative(SOURCE, join(SOURCE, dirname(file), path)))];
        }),
    );
}

test("each folder of the page uses only what it may", () => {
    const folders = Object.keys(MAY_USE);
    for (const [folder, used] of Object.entries(MAY_USE)) {
        assert.ok(used.every((other) => folders.indexOf(other) < folders.indexOf(folder)), `${folder} is below what it uses`);
    }
    for (const [file, used] of imports()) {
        const folder = dirname(file);
        for (const other of used.filter((path) => dirname(path) !== folder && folder !== ".")) {
            const room = dirname(other);
            // Words and data are there for all.
            const mayUse = room === "." ? /^(texts|data)\.js$/.test(other) : MAY_USE[folder]?.includes(room);
            assert.ok(mayUse, `${file} imports ${other}`);
        }
    }
});

test("no file of the page imports itself through others", () => {
    const files = imports();
    const done = new Set();
    const visit = (file, path) => {
        assert.ok(!path.includes(file), `${[...path, file].join(" imports ")}`);
        if (!done.has(file)) {
            files.get(file)?.filter((other) => other.endsWith(".js")).forEach((other) => visit(other, [...path, file]));
            done.add(file);
        }
    };
    for (const file of files.keys()) {
        visit(file, []);
    }
    assert.ok(files.size > 30);
});
