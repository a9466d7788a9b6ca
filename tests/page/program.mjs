/** The program as the page's oracle, and numbers at random that are the same at every run. */

import { execFileSync, spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { inflateSync } from "node:zlib";

/** The program `photosurface`. */
export function binary() {
    const path = process.env.PHOTOSURFACE_BINARY;
    if (!path) {
        throw new Error(
            "PHOTOSURFACE_BINARY is not set, expected the path of the program `photosurface` (cargo build)",
        );
    }
    return path;
}

/** Runs the program and returns what it writes to stdout. */
export function run(args, input) {
    return execFileSync(binary(), args, {
        input,
        encoding: "utf8",
        stdio: ["pipe", "pipe", "pipe"],
        maxBuffer: 2 ** 28,
    });
}

/** Runs a line of a POSIX shell in a folder, in which `photosurface` is the program. */
export function runLine(line, folder) {
    const shell = `photosurface() { "$PROGRAM" "$@"; }\n${line}`;
    const env = { ...process.env, PROGRAM: resolve(binary()) };
    return spawnSync("sh", ["-c", shell], { cwd: folder, encoding: "utf8", env });
}

/** Calls a function with a folder that is gone afterwards. */
export function inFolder(work) {
    const folder = mkdtempSync(join(tmpdir(), "photosurface-page-"));
    try {
        return work(folder);
    } finally {
        rmSync(folder, { recursive: true });
    }
}

/** What an observer is at these proper times, as the program has it. */
export function momentsOf(observer, steps) {
    const objects = [{ name: "point", shape: { sphere: { radius: 1 } } }];
    const scene = JSON.stringify({ observer, objects, steps });
    return JSON.parse(run(["flight", "-", "--json", "-"], scene)).moments;
}

/** Where the vertices of meshes are seen, as the program has it: `meshes` are lists of triangles of vertices. */
export function verticesSeen(observer, objects, step, meshes) {
    return inFolder((folder) => {
        const files = objects.map((object, index) => {
            const vertices = meshes[index].flat();
            const faces = meshes[index].map((_, face) => `f ${3 * face + 1} ${3 * face + 2} ${3 * face + 3}`);
            const lines = [...vertices.map((vertex) => `v ${vertex.join(" ")}`), ...faces];
            writeFileSync(join(folder, `${index}.obj`), `${lines.join("\n")}\n`);
            return { name: `object${index}`, file: `${index}.obj`, ...object };
        });
        const [scene, ply] = [join(folder, "scene.json"), join(folder, "seen.ply")];
        writeFileSync(scene, JSON.stringify({ observer, objects: files, steps: [step] }));
        const args = ["export", scene, "--no-subdivide", "--normals", "none", "-q", "-o", ply];
        const { status, stderr } = spawnSync(binary(), args, { encoding: "utf8" });
        if (status !== 0 && status !== 1) {
            throw new Error(`${args.join(" ")}: ${stderr}`);
        }
        return verticesOfPly(readFileSync(ply));
    });
}

function verticesOfPly(bytes) {
    const end = "end_header\n";
    const headerSize = bytes.indexOf(end) + end.length;
    const header = bytes.toString("latin1", 0, headerSize);
    const count = Number(/element vertex (\d+)/.exec(header)[1]);
    const properties = header.split("element face")[0].match(/property (\w+) \w+/g);
    const sizes = properties.map((property) => ({ double: 8, float: 4 })[property.split(" ")[1]]);
    const stride = sizes.reduce((sum, size) => sum + size);
    return Array.from({ length: count }, (_, vertex) =>
        [0, 8, 16].map((at) => bytes.readDoubleLE(headerSize + vertex * stride + at)),
    );
}

/** The rows of a PNG of 8 bits for each channel, as the program writes them. */
export function pixelsOf(png) {
    const [width, height] = [png.readUInt32BE(16), png.readUInt32BE(20)];
    const channels = { 0: 1, 2: 3, 6: 4 }[png[25]];
    if (png[24] !== 8 || png[28] !== 0 || !channels) {
        throw new Error("expected a PNG of 8 bits, in colour, not interlaced");
    }
    const parts = [];
    for (let at = 8; at < png.length; at += 12 + png.readUInt32BE(at)) {
        if (png.toString("latin1", at + 4, at + 8) === "IDAT") {
            parts.push(png.subarray(at + 8, at + 8 + png.readUInt32BE(at)));
        }
    }
    const bytes = inflateSync(Buffer.concat(parts));
    const stride = width * channels;
    const rows = [];
    for (let y = 0; y < height; y++) {
        const filter = bytes[y * (stride + 1)];
        const row = Uint8Array.from(bytes.subarray(y * (stride + 1) + 1, (y + 1) * (stride + 1)));
        const above = rows[y - 1] ?? new Uint8Array(stride);
        for (let at = 0; at < stride; at++) {
            const [left, corner] = at < channels ? [0, 0] : [row[at - channels], above[at - channels]];
            row[at] += [0, left, above[at], (left + above[at]) >> 1, nearest(left, above[at], corner)][filter];
        }
        rows.push(row);
    }
    return { width, height, channels, rows };
}

/** Paeth's prediction. */
function nearest(left, above, corner) {
    const sum = left + above - corner;
    const gaps = [left, above, corner].map((value) => Math.abs(sum - value));
    return [left, above, corner][gaps.indexOf(Math.min(...gaps))];
}

/** Numbers from 0 to 1 that look random: mulberry32. */
export function numbers(seed) {
    let state = seed;
    return () => {
        state = (state + 0x6d2b79f5) | 0;
        let mixed = Math.imul(state ^ (state >>> 15), 1 | state);
        mixed = (mixed + Math.imul(mixed ^ (mixed >>> 7), 61 | mixed)) ^ mixed;
        return ((mixed ^ (mixed >>> 14)) >>> 0) / 2 ** 32;
    };
}

/** A vector of length up to `size`, from such numbers. */
export function vectorFrom(next, size = 1) {
    return [0, 0, 0].map(() => (2 * next() - 1) * size);
}

/** A unit quaternion. */
export function quaternionFrom(next) {
    const numbers = [0, 0, 0, 0].map(() => 2 * next() - 1);
    const size = Math.hypot(...numbers);
    return numbers.map((number) => number / size);
}
