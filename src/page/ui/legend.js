/** The scale of the Doppler factor's colours, shown where surfaces have them. */

import { words } from "../texts.js";
import { element } from "./fields.js";

/**
 * @param {import("../data.js").ColorTables["ramp"]} ramp
 */
export function rampLegend({ log2_from: from, log2_to: to, colors }) {
    const made = element("div", "legend-ramp");
    const canvas = element("canvas", "ramp");
    canvas.width = colors.length;
    canvas.height = 1;
    const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
    colors.forEach((color, column) => {
        context.fillStyle = `rgb(${color.map((channel) => Math.round(255 * encoded(channel)))})`;
        context.fillRect(column, 0, 1, 1);
    });
    const ticks = element("div", "ticks");
    for (let octave = from; octave <= to; octave += 1) {
        ticks.append(element("span", "", octave < 0 ? `1/${2 ** -octave}` : String(2 ** octave)));
    }
    made.append(element("span", "label", words.dopplers.ramp), canvas, ticks);
    return made;
}

/**
 * sRGB of a linear channel.
 * @param {number} linear
 */
function encoded(linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055;
}
