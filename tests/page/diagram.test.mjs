/** The history of a flight, and the diagram of it. */

import assert from "node:assert/strict";
import { test } from "node:test";
import { advance, coast, momentOf } from "../../src/page/spacetime/moment.js";
import { Diagram, frameOf, tickOf, tickText } from "../../src/page/ui/diagram.js";
import { History } from "../../src/page/ui/history.js";

const START = { time: 0, position: [0, 0, 0], rapidity: 1, direction: [1, 2, 2], orientation: [0, 0, 0, 1] };

test("a history of hours takes no more room than one of seconds, and leaves no part out", () => {
    const history = new History();
    let moment = momentOf(START);
    let most = 0;
    for (let frame = 0; frame < 100_000; frame++) {
        history.record(moment);
        most = Math.max(most, history.events.length);
        // A quarter of the time spent in a standstill.
        moment = {
            ...moment,
            time: moment.time + (frame % 4 === 0 ? 0 : 1),
            properTime: moment.properTime + (frame % 4 === 0 ? 0 : 0.5),
        };
    }
    assert.ok(most <= 512 && history.events.length > 128, `${most} ${history.events.length}`);
    assert.equal(history.events[0].time, 0);
    const gaps = history.events.map(({ time }, index) => time - (history.events[index - 1]?.time ?? 0));
    assert.ok(Math.max(...gaps) < 75_000 / 100, `${Math.max(...gaps)}`);
    history.record(momentOf(START));
    assert.equal(history.events.length, 1);
});

test("a frame shows all at one scale", () => {
    const { place, scale, low, high } = frameOf(
        { width: 220, height: 180 },
        [
            { x: -3, t: 1 },
            { x: 5, t: 2 },
        ],
        1,
    );
    const [left, right] = [place({ x: -3, t: 1 }), place({ x: 5, t: 2 })];
    assert.ok(left[0] > 0 && right[0] < 220 && left[1] < 180 && right[1] > 0);
    assert.ok(Math.abs(right[0] - left[0] - 8 * scale) < 1e-9 && Math.abs(left[1] - right[1] - scale) < 1e-9);
    assert.ok(low.x < -3 && high.x > 5 && low.t < 1 && high.t > 2);
    assert.deepEqual([0.9, 4, 10, 25, 1e-7].map(tickOf), [0.2, 1, 2, 5, 2e-8]);
    assert.deepEqual(
        [tickText(-20, 10), tickText(0.4, 0.2), tickText(2e5, 1e5), tickText(0, 1e5), tickText(3e-7, 1e-7)],
        ["−20", "0.4", "2e5", "0", "3e−7"],
    );
});

/** A canvas that keeps what is drawn. */
function canvas() {
    const calls = [];
    const pen = new Proxy(
        {},
        {
            get: (target, name) => target[name] ?? ((...args) => calls.push([name, ...args])),
            set: (target, name, value) => {
                target[name] = value;
                return true;
            },
        },
    );
    return { clientWidth: 220, clientHeight: 220, width: 0, height: 0, calls, getContext: () => pen };
}

test("a diagram is drawn ten times a second, with finite numbers, at any speed", () => {
    const bodies = [
        { position: [0, 0, -5], rapidity: 0, direction: [0, 0, 0] },
        { position: [1, 0, 0], rapidity: 3, direction: [1, 0, 0] },
    ];
    for (const rapidity of [0, 1, 15]) {
        const page = canvas();
        const diagram = new Diagram(page, bodies, 10);
        let moment = momentOf({ ...START, rapidity });
        let drawn = 0;
        for (let frame = 0; frame < 120; frame++) {
            diagram.record(moment);
            const before = page.calls.length;
            const isDrawn = diagram.show(moment, (frame * 1000) / 60);
            assert.equal(page.calls.length > before, isDrawn);
            drawn += isDrawn ? 1 : 0;
            moment = frame < 60 ? advance(moment, [0.3, 0, -1], [0, 1, 0], 0.1) : coast(moment, 0.1);
        }
        assert.ok(drawn >= 17 && drawn <= 21, `${drawn}`);
        assert.equal(page.width, 220);
        for (const [name, ...args] of page.calls) {
            const places = args.filter((arg) => typeof arg === "number");
            assert.ok(places.every(Number.isFinite), `${name} ${args}`);
        }
        assert.ok(page.calls.some(([name]) => name === "fillText"));
    }
});
