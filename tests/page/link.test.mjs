/** Links: there and back, and nonsense in them. */

import assert from "node:assert/strict";
import { test } from "node:test";
import { advance, momentOf, observerOf } from "../../src/page/spacetime/moment.js";
import { readLink, writeLink } from "../../src/page/ui/link.js";
import { numbers, quaternionFrom, vectorFrom } from "./program.mjs";

const START = { time: 1, position: [1, 2, 3], rapidity: 0.5, direction: [0, 0, -1], orientation: [0, 0, 0, 1] };

const STATE = {
    paused: true,
    timeScale: 0.1 + 0.2,
    steering: "coordinated",
    layout: "outside",
    doppler: "ramp",
    searchlight: true,
    exposure: -1.5,
    model: "delayed",
    ghostAtRest: true,
    ghostContracted: false,
    fieldOfViewDeg: 71.3,
    look: [-3, 1.5],
    diagram: true,
};

test("a link leads back to what it was made of", () => {
    const next = numbers(41);
    for (let round = 0; round < 50; round++) {
        const far = 10 ** (40 * next() - 20);
        const start = momentOf({
            time: far,
            position: vectorFrom(next, far),
            rapidity: round === 0 ? 0 : 15 * next(),
            direction: vectorFrom(next),
            orientation: quaternionFrom(next),
        });
        const moment = advance(start, vectorFrom(next), vectorFrom(next), next());
        const link = writeLink(moment, STATE);
        assert.match(link, /^[\w=&.,-]+$/);
        const { moment: found, state } = readLink(round % 2 === 0 ? link : `#${link}`, START);
        assert.deepEqual(state, STATE);
        assert.equal(found.time, moment.time);
        assert.deepEqual(found.position, moment.position);
        assert.equal(found.properTime, moment.properTime);
        const [now, then] = [observerOf(found), observerOf(moment)];
        assert.ok(Math.abs(now.rapidity - then.rapidity) <= 4e-15 * Math.max(1, then.rapidity));
        for (const key of ["direction", "orientation"]) {
            now[key].forEach((part, index) => {
                assert.ok(Math.abs(part - then[key][index]) < 1e-15, key);
            });
        }
    }
});

test("a link that says a part leaves the rest", () => {
    assert.deepEqual(readLink("", START), { moment: null, state: {} });
    assert.deepEqual(readLink("#model=rest", START), { moment: null, state: { model: "rest" } });
    const { moment, state } = readLink("place=4,5,6&fov=30", START);
    assert.deepEqual(state, { fieldOfViewDeg: 30 });
    assert.deepEqual([moment.time, moment.position, moment.properTime], [1, [4, 5, 6], 0]);
});

test("nonsense in a link says nothing", () => {
    const nothing = { moment: null, state: {} };
    for (const text of [
        "#",
        "&&==&",
        "%",
        "#%E0%A4%A",
        "time=",
        "time=NaN",
        "time=Infinity",
        "time=1e999",
        "time=0x10",
        "time=1,2",
        "time= 1",
        "place=1,2",
        "place=1,2,3,4",
        "place=1,,3",
        "place=1,2,1e99",
        "rapidity=-1",
        "rapidity=1e9",
        "direction=0,0,0",
        "direction=1,2,x",
        "orientation=0,0,0,0",
        "fov=0",
        "fov=180",
        "pace=0",
        "pace=-1",
        "exposure=65",
        "look=0,2",
        "look=4,0",
        "paused=true",
        "model=constructor",
        "model=",
        "doppler=__proto__",
        "__proto__=1",
        "steering=Free",
        "layout=<script>",
        `time=${"1".repeat(5000)}`,
    ]) {
        assert.deepEqual(readLink(text, START), nothing, text);
    }
    const next = numbers(43);
    const signs = "0123456789eE+-.,&=#%abmplacetimodelrapidity";
    for (let round = 0; round < 3000; round++) {
        const text = Array.from({ length: 60 * next() }, () => signs[Math.floor(next() * signs.length)]).join("");
        const { moment } = readLink(`rapidity=${text}&place=${text}`, START);
        assert.ok(moment === null || [moment.time, ...moment.position, ...moment.frame].every(Number.isFinite), text);
    }
});
