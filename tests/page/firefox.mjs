/**
 * Firefox, told what to do by its own protocol, Marionette. Without a screen it has no WebGL on a machine without a graphics
 * processor, so it gets one in memory.
 */

import { spawn, spawnSync } from "node:child_process";
import { once } from "node:events";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { connect } from "node:net";
import { join } from "node:path";
import { setTimeout as wait } from "node:timers/promises";

const FIREFOX = process.env.FIREFOX ?? "firefox-esr";

/** Settings of the profile: the processor draws, and nothing is asked of the network. */
const SETTINGS = {
    "marionette.port": 0,
    "webgl.force-enabled": true,
    "browser.shell.checkDefaultBrowser": false,
    "datareporting.policy.dataSubmissionEnabled": false,
    "toolkit.telemetry.reportingpolicy.firstRun": false,
    "browser.startup.homepage_override.mstone": "ignore",
    "network.captive-portal-service.enabled": false,
    "network.connectivity-service.enabled": false,
    "app.update.disabledForTesting": true,
};

/** How long Firefox may take to start, in milliseconds. */
const PATIENCE = 60_000;

/**
 * Calls a function with a Firefox, which is gone afterwards: `send(command, parameters)` returns the answer.
 * @param {string} folder For its profile.
 */
export async function inFirefox(folder, work) {
    for (const [name, flag] of [
        [FIREFOX, "--version"],
        ["Xvfb", "-help"],
    ]) {
        if (spawnSync(name, [flag]).error) {
            throw new Error(`${name} is missing: apt-get install firefox-esr xvfb libgl1-mesa-dri`);
        }
    }
    const profile = join(folder, "profile");
    mkdirSync(profile);
    const lines = Object.entries(SETTINGS).map(([name, value]) => `user_pref("${name}", ${JSON.stringify(value)});\n`);
    writeFileSync(join(profile, "user.js"), lines.join(""));
    const screen = spawn("Xvfb", ["-displayfd", "1", "-screen", "0", "1280x1024x24", "-nolisten", "tcp"], {
        stdio: ["ignore", "pipe", "ignore"],
    });
    const [line] = await once(screen.stdout, "data");
    const program = spawn(FIREFOX, ["--no-remote", "--marionette", "--profile", profile], {
        stdio: "ignore",
        env: { ...process.env, HOME: folder, DISPLAY: `:${String(line).trim()}`, MOZ_CRASHREPORTER_DISABLE: "1" },
    });
    const ended = [screen, program].map((each) => once(each, "exit"));
    try {
        const socket = connect(await portOf(profile), "127.0.0.1");
        const { send } = conversation(socket);
        await send("WebDriver:NewSession", {});
        const result = await work(send);
        socket.destroy();
        return result;
    } finally {
        program.kill();
        await ended[1];
        screen.kill();
        await ended[0];
    }
}

async function portOf(profile) {
    for (let waited = 0; waited < PATIENCE; waited += 100) {
        try {
            return Number(readFileSync(join(profile, "MarionetteActivePort"), "utf8"));
        } catch {
            await wait(100);
        }
    }
    throw new Error("Firefox did not start");
}

/** Messages are JSON after their length: `[0, number, command, parameters]`, and `[1, number, error, result]` in answer. */
function conversation(socket) {
    const waiting = new Map();
    let bytes = Buffer.alloc(0);
    socket.on("data", (more) => {
        bytes = Buffer.concat([bytes, more]);
        for (;;) {
            const colon = bytes.indexOf(":");
            const length = Number(bytes.toString("latin1", 0, Math.max(colon, 0)));
            if (colon < 0 || bytes.length < colon + 1 + length) {
                return;
            }
            const message = JSON.parse(bytes.toString("utf8", colon + 1, colon + 1 + length));
            bytes = bytes.subarray(colon + 1 + length);
            // The first message is a greeting.
            if (Array.isArray(message)) {
                const [, number, error, result] = message;
                const { resolve, reject } = waiting.get(number);
                waiting.delete(number);
                error ? reject(new Error(`${error.error}: ${error.message}`)) : resolve(result);
            }
        }
    });
    socket.on("error", (error) => waiting.forEach(({ reject }) => reject(error)));
    let last = 0;
    const send = (command, parameters) =>
        new Promise((resolve, reject) => {
            last += 1;
            waiting.set(last, { resolve, reject });
            const text = JSON.stringify([0, last, command, parameters]);
            socket.write(`${Buffer.byteLength(text)}:${text}`);
        });
    return { send };
}
