/** The commands that the page offers to copy: the program takes them, and means what the page shows. */

import assert from "node:assert/strict";
import { existsSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { momentOfFlight } from "../../src/page/spacetime/flight.js";
import { advance, momentOf, observerOf } from "../../src/page/spacetime/moment.js";
import { exportCommand, renderCommand, shellWord } from "../../src/page/ui/command.js";
import { inFolder, pixelsOf, run, runLine } from "./program.mjs";

const STATE = {
    model: "seen",
    doppler: "none",
    searchlight: false,
    exposure: 0,
    fieldOfViewDeg: 60,
    look: [0, 0],
};

const SCENE = { input: "--example cube", background: "#14171c", flight: [], effects: { searchlight: false } };

const MOMENT = momentOf({
    time: 0.1 + 0.2,
    position: [1, -2e-7, 3],
    rapidity: 1.5,
    direction: [-1, 0.2, 0],
    orientation: [0, 0.6, 0, 0.8],
});

function runs(line, file) {
    inFolder((folder) => {
        const { status, stderr } = runLine(line, folder);
        assert.equal(status, 0, `${line}\n${stderr}`);
        assert.ok(existsSync(join(folder, file)));
    });
}

test("the program takes the commands of every state", () => {
    for (const model of ["seen", "delayed", "contracted", "rest"]) {
        for (const [doppler, searchlight] of [
            ["none", false],
            ["spectrum", true],
            ["ramp", false],
        ]) {
            const state = {
                ...STATE,
                model,
                doppler,
                searchlight,
                exposure: -0.5,
                look: [3, -1.2],
                fieldOfViewDeg: 101.5,
            };
            runs(renderCommand(SCENE, MOMENT, state, { width: 32, height: 20 }), "seen.png");
            runs(`${exportCommand(SCENE, MOMENT, state)} --tolerance 0.1`, "photosurface.glb");
        }
    }
});

test("numbers of a command are those of the moment", () => {
    const moment = advance(MOMENT, [0.5, 0.2, 0], [0, 0.1, 0.7], 2);
    const { time, position, rapidity, direction, orientation } = observerOf(moment);
    const words = renderCommand(SCENE, moment, STATE, { width: 640.4, height: 360 }).split(" ");
    const value = (flag) => words[words.indexOf(flag) + 1].split(",").map(Number);
    assert.deepEqual(value("--time"), [time]);
    assert.deepEqual(value("--observer"), position);
    assert.deepEqual(value("--rapidity"), [rapidity]);
    assert.deepEqual(value("--direction"), direction);
    assert.deepEqual(value("--orientation"), orientation);
    assert.deepEqual(value("--look"), [0, 0, -1]);
    assert.equal(words[words.indexOf("--size") + 1], "640x360");
    assert.ok(!words.includes("--no-flight") && !words.includes("--no-searchlight"));
    // The program reads them as what they are.
    const flags = ["--observer", "--time", "--rapidity", "--direction", "--orientation", "--steps"];
    const given = flags.flatMap((flag) => [flag, words[words.indexOf(flag) + 1]]);
    const [read] = JSON.parse(run(["flight", "--example", "cube", ...given, "--json", "-"])).moments;
    assert.equal(read.time, time);
    assert.deepEqual(read.position, position);
    assert.equal(read.rapidity, rapidity);
});

test("a command switches off what the scene has on", () => {
    const scene = { ...SCENE, flight: [{ steer: "free" }, { steer: "coordinated" }], effects: { searchlight: true } };
    const off = exportCommand(scene, MOMENT, STATE);
    assert.ok(off.includes(" --no-searchlight") && off.includes(" --no-flight"), off);
    const on = exportCommand(scene, MOMENT, { ...STATE, searchlight: true });
    assert.ok(on.includes(" --searchlight") && !on.includes("--no-searchlight"), on);
    const free = exportCommand({ ...scene, flight: [{ steer: "free" }] }, MOMENT, STATE);
    assert.ok(!free.includes("--no-flight"), free);
});

test("words of a command survive a shell", () => {
    assert.equal(shellWord("a/b-c_1.json"), "a/b-c_1.json");
    inFolder((folder) => {
        for (const word of ["", " ", "#14171c", "it's", '"$HOME" `ls` \\', "a\nb", "ä;|&<>(){}*?~!", "-x"]) {
            const { stdout } = runLine(`printf %s ${shellWord(word)}`, folder);
            assert.equal(stdout, word);
        }
    });
});

/** Renders two commands, and counts the pixels that differ by more than rounding. */
function differing(first, second) {
    return inFolder((folder) => {
        const [a, b] = [first, second].map((line) => {
            const { status, stderr } = runLine(line, folder);
            assert.equal(status, 0, `${line}\n${stderr}`);
            return pixelsOf(readFileSync(join(folder, "seen.png")));
        });
        assert.deepEqual([a.width, a.height], [b.width, b.height]);
        assert.ok(new Set(a.rows.flatMap((row) => [...row])).size > 8, "the picture is empty");
        const pixels = Array.from({ length: a.width * a.height }, (_, pixel) => {
            const [row, column] = [Math.floor(pixel / a.width), pixel % a.width];
            const channels = Array.from({ length: a.channels }, (_, channel) => a.channels * column + channel);
            return channels.some((at) => Math.abs(a.rows[row][at] - b.rows[row][at]) > 2);
        });
        return pixels.filter(Boolean).length;
    });
}

test("a command makes the picture of its moment in the scene's own flight", () => {
    const flights = {
        flight: [2.1, 3],
        takeoff: [1.5],
    };
    for (const [example, times] of Object.entries(flights)) {
        const { observer, effects } = JSON.parse(run(["example", example]));
        const { moments } = JSON.parse(run(["flight", "--example", example, "--steps", "0", "--json", "-"]));
        const [{ time, position, rapidity, velocity }] = moments;
        const direction = rapidity > 0 ? velocity : [0, 0, -1];
        const start = { time, position, rapidity, direction, orientation: [0, 0, 0, 1] };
        assert.equal(observer.orientation, undefined);
        const segments = observer.flight.map((segment) => ({ turn_rate: [0, 0, 0], steer: "free", ...segment }));
        const scene = { ...SCENE, input: `--example ${example}`, flight: segments };
        assert.equal(effects, undefined);
        for (const properTime of times) {
            const moment = momentOfFlight(start, segments, properTime);
            const command = renderCommand(scene, moment, STATE, { width: 160, height: 90 });
            const own = `photosurface render --example ${example} --steps ${properTime} --fov 60 --look 0,0,-1 --size 160x90 --projection perspective -o seen.png`;
            const count = differing(command, own);
            // Edges that rays meet exactly are on either side of them by rounding.
            assert.ok(count <= 160 * 90 * 1e-3, `${count} pixels of ${command}`);
        }
    }
});

test("a camera that looks elsewhere is that of the page", () => {
    // A sphere, small, in the direction of the look: it is in the middle of the picture.
    inFolder((folder) => {
        const head = { ...STATE, look: [2, 0.7] };
        const observer = momentOf({ ...observerOf(MOMENT), rapidity: 0, position: [0, 0, 0] });
        const words = renderCommand({ ...SCENE, input: "scene.json" }, observer, head, { width: 33, height: 21 });
        const look = words.split("--look ")[1].split(" ")[0].split(",").map(Number);
        // Turned by the orientation: (0, .6, 0, .8) is by 73.74 degrees about y.
        const [sin, cos] = [2 * 0.6 * 0.8, 0.8 * 0.8 - 0.6 * 0.6];
        const position = [look[0] * cos + look[2] * sin, look[1], look[2] * cos - look[0] * sin].map(
            (part) => part * 9,
        );
        const sphere = { name: "s", shape: { sphere: { radius: 0.5 } }, color: "#ffffff", position };
        writeFileSync(join(folder, "scene.json"), JSON.stringify({ objects: [sphere] }));
        const { status, stderr } = runLine(words.replace("seen.png", "middle.png"), folder);
        assert.equal(status, 0, stderr);
        const { rows, channels, width, height } = pixelsOf(readFileSync(join(folder, "middle.png")));
        const brightness = rows.map((row) => Array.from({ length: width }, (_, column) => row[channels * column]));
        const middle = brightness[(height - 1) / 2][(width - 1) / 2];
        assert.ok(middle > 150 && brightness[0][0] < 50, `${middle}`);
        // As much to the left as to the right, as much above as below.
        const sums = [0, 0];
        brightness.forEach((row, y) => {
            row.forEach((value, x) => {
                sums[0] += (value - brightness[0][0]) * (x - (width - 1) / 2);
                sums[1] += (value - brightness[0][0]) * (y - (height - 1) / 2);
            });
        });
        assert.ok(Math.abs(sums[0]) < 0.2 * middle && Math.abs(sums[1]) < 0.2 * middle, `${sums}`);
    });
});
