/** States of the page that are hard to draw: scenes, moments, and what is set otherwise than at first. */

const AHEAD = [0, 0, -1];

/** Meshes that a scene may name are beside it. */
const MESHES = ["asteroid.glb", "colors_f32.glb"].map(
    (name) => new URL(`../../fixtures/meshes/${name}`, import.meta.url),
);

/** A turn by an angle in degrees about an axis. */
function turn(degrees, [x, y, z]) {
    const half = (degrees * Math.PI) / 360;
    const size = Math.sin(half) / Math.hypot(x, y, z);
    return [x * size, y * size, z * size, Math.cos(half)];
}

function rapidity(gamma) {
    return Math.acosh(gamma);
}

function observer(position, gamma, direction = AHEAD, orientation = [0, 0, 0, 1], time = 0) {
    return { time, position, rapidity: rapidity(gamma), direction, orientation };
}

/** Objects of three velocities about the same place. */
const MOVING = {
    observer: { position: [0, 0, 0] },
    objects: [
        { name: "ground", shape: { grid: { size: 40, cells: 20 } }, position: [0, -2, 0] },
        {
            name: "ball",
            shape: { sphere: { radius: 1 } },
            position: [-3, 0, -7],
            velocity: { gamma: 3, direction: [1, 0, 0] },
        },
        {
            name: "crate",
            shape: { box: { size: [2, 1, 3] } },
            position: [2, 1, -9],
            rotation: turn(30, [1, 2, 0]),
            velocity: { beta: 0.9, direction: [0, 0.2, 1] },
        },
        { name: "ring", shape: { torus: { major_radius: 2, minor_radius: 0.4 } }, position: [0, 2, -12] },
    ],
};

/** Walls nearer than a hundredth of their length. */
const WALLS = {
    observer: { position: [0, 0, 0] },
    objects: [
        { name: "wall", shape: { box: { size: [1, 8, 40] } }, position: [1.52, 0, -10] },
        { name: "far", shape: { box: { size: [1, 8, 40] } }, position: [-4, 0, -10] },
        { name: "end", shape: { grid: { size: 16, cells: 16 } }, position: [0, -3, -12] },
    ],
};

/** Round shapes of all kinds, turned and scaled. */
const ROUND = {
    observer: { position: [0, 0, 0] },
    objects: [
        { name: "ball", shape: { sphere: { radius: 1 } }, position: [-2, 1.4, -5], scale: [1, 0.6, 1.5] },
        {
            name: "cone",
            shape: { cone: { radius: 1, height: 2 } },
            position: [2, 1.4, -5],
            rotation: turn(40, [1, 0, 1]),
        },
        {
            name: "column",
            shape: { cylinder: { radius: 0.8, height: 2 } },
            position: [-2, -1.4, -5],
            rotation: turn(70, [1, 1, 0]),
        },
        {
            name: "ring",
            shape: { torus: { major_radius: 1, minor_radius: 0.3 } },
            position: [2, -1.4, -5],
            rotation: turn(-50, [1, 0, 0]),
        },
        {
            name: "rod",
            shape: { rod: { radius: 0.1, length: 4 } },
            position: [0, 0, -6],
            rotation: turn(15, [0, 0, 1]),
        },
    ],
};

/** Meshes of files: a texture, and colours of vertices. */
const FILES = {
    observer: { position: [0, 0, 0] },
    objects: [
        { name: "rock", file: "asteroid.glb", position: [-1.2, 0, -4] },
        { name: "card", file: "colors_f32.glb", position: [0.5, -1.5, -4] },
    ],
};

const FLIGHT = ["--example", "flight"];
const LATTICE = ["--example", "lattice"];

export const STATES = [
    { name: "the built-in flight", input: FLIGHT, observer: observer([0, 2, 0], 3.2) },
    { name: "gamma 20", input: FLIGHT, observer: observer([0, 2, 0], 20) },
    {
        name: "gamma 20, nearly on the ground",
        input: FLIGHT,
        observer: observer([1.3, 0.05, -14.3], 20, [0.6, 0, -0.8], turn(-30, [0, 1, 0])),
    },
    { name: "grazing a wall", input: WALLS, observer: observer([0.97, 0, 0], 5) },
    { name: "in a lattice", input: LATTICE, observer: observer([0.5, 0.5, 0.2], 2.3) },
    {
        name: "in a lattice at gamma 20",
        input: LATTICE,
        observer: observer([0.5, 0.4, -3.2], 20, [0.02, 0.01, -1]),
        state: { fieldOfViewDeg: 8 },
    },
    {
        name: "objects of different velocities",
        input: MOVING,
        observer: observer([0.5, 0, 1], 1.2, [-1, 0, 0.4], turn(12, [0, 1, 1]), 2.5),
    },
    { name: "round shapes", input: ROUND, observer: observer([0, 0.2, 1], 6, [0.3, 0.1, -1]) },
    { name: "Doppler effect", input: FLIGHT, observer: observer([0, 2, 0], 2), state: { doppler: "spectrum" } },
    { name: "Doppler factor", input: MOVING, observer: observer([0, 0.5, 1], 1.5), state: { doppler: "ramp" } },
    {
        name: "searchlight",
        input: FLIGHT,
        observer: observer([0, 2, 0], 1.5),
        state: { doppler: "spectrum", searchlight: true, exposure: -3 },
    },
    {
        name: "travel time alone",
        input: MOVING,
        observer: observer([0.5, 0, 1], 2, AHEAD, turn(90, [0, 0, 1])),
        state: { model: "delayed" },
    },
    {
        name: "contraction alone",
        input: ROUND,
        observer: observer([0, 0, 1], 3, [1, 0, 0]),
        state: { model: "contracted", look: [0.2, -0.1] },
    },
    {
        name: "texture and colours of vertices",
        input: FILES,
        files: MESHES,
        observer: observer([0, 0, 0], 1.6, [0.5, 0, -1]),
    },
];
