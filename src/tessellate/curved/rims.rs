//! Where rims are divided: chords that are equally far from their arcs, as few as are near enough.

use glam::DVec3;

use super::sight::Sight;
use crate::shape::{Body, LEAST_PARTS, Piece, Spot};

/// The distance of chords that is aimed at, as a part of what is allowed.
const AIM: f64 = 0.95;

/// How many places of a rim are looked at: so many at first, and then between those that differ much.
const LOOKS: usize = 64;
const MOST_LOOKS: usize = 4096;

/// How much the number of chords may change between two looks, as a part of a chord or of their number until there.
const SMOOTH: f64 = 0.25;

/// The turns of the vertices on each rim of a round shape, at most `most` of them.
pub(super) fn divided_rims(pieces: &[Piece], sights: &[Sight], most: usize) -> Vec<Vec<f64>> {
    let rims = 1..=Body::rims(pieces) as u8;
    rims.map(|rim| {
        let lengths = Lengths::of_rim(pieces, sights, rim);
        let parts = (lengths.whole() / AIM.sqrt()).ceil() as usize;
        lengths.equal_parts(parts.clamp(LEAST_PARTS, most.max(LEAST_PARTS)))
    })
    .collect()
}

/// The fewest chords that theory allows for each rim, and about how many there will be.
pub(super) fn chords_of_rims(pieces: &[Piece], sight: &Sight) -> Vec<[f64; 2]> {
    let rims = 1..=Body::rims(pieces) as u8;
    rims.map(|rim| {
        let whole = Lengths::of_rim(pieces, std::slice::from_ref(sight), rim).whole();
        [whole, (whole / AIM.sqrt()).ceil().max(LEAST_PARTS as f64)]
    })
    .collect()
}

/// How many chords a whole turn of a rim would need if it were everywhere like at one place.
///
/// A chord is an eighth of the second derivative from its arc, as far as that is across the arc.
fn chords_per_turn(piece: &Piece, sights: &[Sight], rim: u8, turns: f64) -> f64 {
    let spot = Spot::on_rim(turns, rim);
    let jet = piece.jet(piece.parameters(&spot));
    let of_sight = |sight: &Sight| {
        let offset = sight.offset(jet.place);
        let r = offset.length();
        let toward = offset / r;
        let jacobian = sight.jacobian_vector(toward);
        let seen = |vector: DVec3| vector + sight.motion * jacobian.dot(vector);
        let (first, second) = (sight.at_rest(jet.first[0]), sight.at_rest(jet.second[0]));
        let across = first - toward * toward.dot(first);
        let slid = sight.motion * (sight.gamma_beta * across.length_squared() / r);
        let (along, bent) = (seen(first).normalize_or_zero(), seen(second) + slid);
        let aside = (bent - along * along.dot(bent)).length();
        let allowed = sight.allowed_at(sight.seen_at(offset).length());
        (aside / (8.0 * allowed)).sqrt()
    };
    let most = sights
        .iter()
        .map(of_sight)
        .filter(|chords| chords.is_finite());
    most.fold(0.0, f64::max)
}

/// The number of chords from the start of a rim on, as a function of the turns.
struct Lengths {
    turns: Vec<f64>,
    until: Vec<f64>,
}

impl Lengths {
    fn of_rim(pieces: &[Piece], sights: &[Sight], rim: u8) -> Self {
        Self::new(|turns| chords_per_turn(&pieces[0], sights, rim, turns))
    }

    fn new(density: impl Fn(f64) -> f64) -> Self {
        let mut looks: Vec<(f64, f64)> = (0..=LOOKS)
            .map(|k| k as f64 / LOOKS as f64)
            .map(|turns| (turns, density(turns)))
            .collect();
        while looks.len() < MOST_LOOKS {
            let mut finer = Vec::with_capacity(2 * looks.len());
            for pair in looks.windows(2) {
                let [(from, a), (to, b)] = [pair[0], pair[1]];
                finer.push(pair[0]);
                let differ = (to - from) * (a - b).abs();
                if differ > SMOOTH * ((to - from) * a.min(b)).max(SMOOTH) {
                    let middle = 0.5 * (from + to);
                    finer.push((middle, density(middle)));
                }
            }
            finer.push(looks[looks.len() - 1]);
            if finer.len() == looks.len() {
                break;
            }
            looks = finer;
        }
        let mut until = vec![0.0];
        for pair in looks.windows(2) {
            let [(from, a), (to, b)] = [pair[0], pair[1]];
            until.push(until[until.len() - 1] + 0.5 * (to - from) * (a + b));
        }
        Self {
            turns: looks.into_iter().map(|(turns, _)| turns).collect(),
            until,
        }
    }

    fn whole(&self) -> f64 {
        self.until[self.until.len() - 1]
    }

    /// The turns at which equal parts begin, none longer than an eighth of a turn.
    fn equal_parts(&self, parts: usize) -> Vec<f64> {
        let whole = self.whole();
        let at = |part: f64| {
            let wanted = part * whole;
            let k = self
                .until
                .partition_point(|&until| until <= wanted)
                .clamp(1, self.until.len() - 1);
            let (from, to) = (self.until[k - 1], self.until[k]);
            let inside = if to > from {
                (wanted - from) / (to - from)
            } else {
                0.0
            };
            self.turns[k - 1] + inside.clamp(0.0, 1.0) * (self.turns[k] - self.turns[k - 1])
        };
        let mut found: Vec<f64> = (0..parts).map(|k| at(k as f64 / parts as f64)).collect();
        // Arcs longer than an eighth of a turn are divided.
        let mut index = 0;
        while index < found.len() {
            let next = found.get(index + 1).copied().unwrap_or(1.0);
            let arc = next - found[index];
            let pieces = (arc * LEAST_PARTS as f64 - 1e-9).ceil().max(1.0) as usize;
            for k in (1..pieces).rev() {
                found.insert(index + 1, found[index] + arc * k as f64 / pieces as f64);
            }
            index += pieces;
        }
        found
    }
}
