/**
 * The coordinated turn: the direction of motion keeps its place in the observer's own axes, as that of an airplane.
 *
 * Let `n` be the direction of motion in the observer's own axes, `a_par` and `a_perp` the parts of the acceleration along
 * and across it, `c` the direction of the latter, `b = n x c`, `eta` the rapidity in the scene frame. With the turn rate
 * `b a_perp / beta` the rapidity changes by `eta' = a_par`, and the direction of motion turns in the scene by
 * `phi' = a_perp / sinh(eta)` about `b`, so that
 *
 *     eta = eta0 + a_par T,      phi = a_perp / a_par  ln( tanh(eta / 2) / tanh(eta0 / 2) )
 *
 * From the frame at the beginning to that at the end lead the boost back by `eta0`, the turn and the boost by `eta`:
 *
 *     cos(phi/2) cosh((eta - eta0)/2) + sigma . ( n cos(phi/2) sinh((eta - eta0)/2)
 *         + c sin(phi/2) sinh((eta + eta0)/2) - i b sin(phi/2) cosh((eta + eta0)/2) )
 *
 * Where that has large numbers, the turn in the scene is put before the frame and the boost of `eta - eta0` after it.
 *
 * The place is the integral of the four-velocity: elementary at constant speed; otherwise by Gauss and Legendre's rule of
 * 16 points on pieces so short that it is right to rounding.
 */

import { piecesOf } from "./segment.js";
import { sinc, sincBelow1, sinhc } from "./smooth.js";
import { boost, eventOf, spinorOf } from "./spinor.js";
import { cross, dot, length, scaled, subtract, sum, unit } from "./vector.js";

/** @typedef {import("./vector.js").Vec3} Vec3 */
/** @typedef {import("./segment.js").Piece} Piece */

/** Up to this rapidity an observer is at rest: what is left of a speed that an earlier segment took away. */
const AT_REST = 1e-12;

/**
 * The largest angle, in radians, of a turn at changing speed, whose integral takes time in proportion.
 */
const MAX_TURN = 1e5;

/**
 * @typedef {{ ahead: Vec3, aside: Vec3, rapidity: number, along: number, across: number }} Turn direction of motion and
 *     that of the acceleration across it, in own axes; rapidity at the beginning; parts of the acceleration
 */

/**
 * The turn of an observer who moves with `celerity` in its own axes. None at rest, straight ahead, and where the observer
 * would come to rest while it turns: the turn rate would be infinite there.
 * @param {Readonly<Vec3>} celerity @param {Readonly<Vec3>} acceleration @param {number} properTime
 * @returns {Turn | null}
 */
export function turnOf(celerity, acceleration, properTime) {
    const rapidity = Math.asinh(length(celerity));
    if (!(rapidity > AT_REST)) {
        return null;
    }
    const ahead = unit(celerity, [0, 0, -1]);
    const along = dot(acceleration, ahead);
    const sideways = subtract(acceleration, scaled(ahead, along));
    const across = length(sideways);
    const end = rapidity + along * properTime;
    if (!(across > 0) || !(end > AT_REST)) {
        return null;
    }
    // Of rounded numbers a part along the motion may be left.
    const rest = subtract(sideways, scaled(ahead, dot(sideways, ahead)));
    const turn = { ahead, aside: unit(rest, [1, 0, 0]), rapidity, along, across };
    return along !== 0 && !(Math.abs(angleOf(turn, properTime)) <= MAX_TURN) ? null : turn;
}

/** The turn rate at the beginning, in own axes. @param {Turn} turn */
export function turnRateOf({ ahead, aside, rapidity, across }) {
    return scaled(cross(ahead, aside), across / Math.tanh(rapidity));
}

/** The angle by which the direction of motion has turned in the scene. @param {Turn} turn @param {number} properTime */
function angleOf({ rapidity, along, across }, properTime) {
    const gained = along * properTime;
    // tanh(eta/2) / tanh(eta0/2) = 1 + sinh(gained/2) / (cosh(eta/2) sinh(eta0/2))
    const [half, later] = [0.5 * rapidity, 0.5 * (rapidity + gained)];
    const perGained = (0.5 * sinhc(0.5 * gained)) / (Math.cosh(later) * Math.sinh(half));
    const ratio = perGained * gained;
    return across * properTime * perGained * (ratio === 0 ? 1 : Math.log1p(ratio) / ratio);
}

/**
 * In how many pieces a turn is flown.
 * @param {Turn} turn @param {number} properTime
 */
export function piecesOfTurn(turn, properTime) {
    return piecesOf(Math.abs(turn.along * properTime));
}

/**
 * Whether the observer leaves the frame in which it began far behind: then a turn is right to rounding in the scene, not
 * beside something as fast.
 * @param {Turn} turn @param {number} properTime
 */
export function isWide(turn, properTime) {
    const end = turn.rapidity + turn.along * properTime;
    return Math.abs(angleOf(turn, properTime)) * Math.sinh(Math.max(turn.rapidity, end)) > 1;
}

/**
 * The turn for so much proper time, in the frame of its beginning.
 * @param {Turn} turn @param {number} properTime @returns {Piece}
 */
export function pieceOfTurn(turn, properTime) {
    const { ahead, aside, rapidity } = turn;
    const gained = turn.along * properTime;
    const half = 0.5 * angleOf(turn, properTime);
    const mean = rapidity + 0.5 * gained;
    const [cos, sin] = [Math.cos(half), Math.sin(half)];
    const real = sum(scaled(ahead, cos * Math.sinh(0.5 * gained)), scaled(aside, sin * Math.sinh(mean)));
    const imaginary = scaled(cross(ahead, aside), -sin * Math.cosh(mean));
    return {
        way: wayOf(turn, gained === 0 ? atConstantSpeed(turn, properTime) : integral(turn, properTime, fourVelocity)),
        turn: spinorOf([cos * Math.cosh(0.5 * gained), 0], [real, imaginary]),
    };
}

/**
 * The same in the scene: the way, the axis about which the motion turns and the angle, all in the scene's axes turned as the
 * observer's own were; and the boost after which the frame turns.
 * @param {Turn} turn @param {number} properTime
 */
export function wideTurn(turn, properTime) {
    const gained = turn.along * properTime;
    const angle = angleOf(turn, properTime);
    /** @param {Turn} turn @param {number} properTime */
    const inScene = (turn, properTime) => {
        const [now, angle] = [turn.rapidity + turn.along * properTime, angleOf(turn, properTime)];
        return [Math.cosh(now), Math.sinh(now) * Math.cos(angle), Math.sinh(now) * Math.sin(angle)];
    };
    const [sinh, cosh] = [Math.sinh(turn.rapidity), Math.cosh(turn.rapidity)];
    const circle = [cosh, sinh * sinc(angle), sinh * asideOf(angle)].map((part) => part * properTime);
    return {
        way: wayOf(turn, gained === 0 ? circle : integral(turn, properTime, inScene)),
        axis: cross(turn.ahead, turn.aside),
        angle,
        boost: boost(gained, turn.ahead),
    };
}

/** @param {Turn} turn @param {number[]} numbers time, way ahead and way aside */
function wayOf({ ahead, aside }, [time, forward, sideways]) {
    return eventOf(time, sum(scaled(ahead, forward), scaled(aside, sideways)));
}

/** `(1 - cos phi) / phi` @param {number} angle */
function asideOf(angle) {
    return angle === 0 ? 0 : (2 * Math.sin(0.5 * angle) ** 2) / angle;
}

/** Time, way ahead and way aside. @param {Turn} turn @param {number} properTime */
function atConstantSpeed(turn, properTime) {
    const angle = angleOf(turn, properTime);
    const [sinh, cosh] = [Math.sinh(turn.rapidity), Math.cosh(turn.rapidity)];
    const late = sincBelow1(angle);
    return [
        (1 + sinh * sinh * late) * properTime,
        -cosh * sinh * late * properTime,
        sinh * asideOf(angle) * properTime,
    ];
}

/**
 * The same at changing speed.
 * @param {Turn} turn @param {number} properTime @param {(turn: Turn, properTime: number) => number[]} fourVelocity
 */
function integral(turn, properTime, fourVelocity) {
    const sums = [0, 0, 0];
    const parts = [[0, properTime]];
    for (let part = parts.pop(); part; part = parts.pop()) {
        const [from, to] = part;
        const half = 0.5 * (to - from);
        const middle = from + half;
        if (!isShort(turn, from, to) && middle !== from && middle !== to) {
            parts.push([middle, to], [from, middle]);
            continue;
        }
        for (const [node, weight] of GAUSS_LEGENDRE_16) {
            for (const sign of [-1, 1]) {
                const velocity = fourVelocity(turn, middle + sign * node * half);
                for (let i = 0; i < 3; i++) {
                    sums[i] += weight * half * velocity[i];
                }
            }
        }
    }
    return sums;
}

/**
 * Whether the rule is right to rounding on a part: far enough from rest, where the turn rate is infinite, and from the
 * poles of the hyperbolic functions.
 * @param {Turn} turn @param {number} from @param {number} to
 */
function isShort(turn, from, to) {
    const start = turn.rapidity + turn.along * from;
    const end = turn.rapidity + turn.along * to;
    const gained = Math.abs(end - start);
    const angle = Math.abs(angleOf(turn, to) - angleOf(turn, from));
    return gained <= Math.min(start, end) && gained <= 1 && angle <= 1;
}

/** The four-velocity in the frame of the beginning: time, ahead, aside. @param {Turn} turn @param {number} properTime */
function fourVelocity(turn, properTime) {
    const gained = turn.along * properTime;
    const angle = angleOf(turn, properTime);
    const sinh = Math.sinh(turn.rapidity + gained);
    const late = 2 * Math.sin(0.5 * angle) ** 2 * sinh;
    return [
        Math.cosh(gained) + Math.sinh(turn.rapidity) * late,
        Math.sinh(gained) - Math.cosh(turn.rapidity) * late,
        sinh * Math.sin(angle),
    ];
}

/**
 * Nodes and weights of Gauss and Legendre's rule of 16 points on [-1, 1]; each node stands for its negative too.
 *
 * Reference: M. Abramowitz, I. A. Stegun, Handbook of Mathematical Functions, table 25.4.
 */
const GAUSS_LEGENDRE_16 = [
    [0.09501250983763744, 0.1894506104550685],
    [0.2816035507792589, 0.18260341504492358],
    [0.45801677765722737, 0.16915651939500254],
    [0.6178762444026438, 0.14959598881657674],
    [0.755404408355003, 0.12462897125553388],
    [0.8656312023878318, 0.09515851168249279],
    [0.9445750230732326, 0.062253523938647894],
    [0.9894009349916499, 0.027152459411754096],
];
