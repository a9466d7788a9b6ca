//! Division of a triangle that is too thin to be triangulated on the sky.

use super::Allowance;
use super::pieces::{Corner, Pieces};

/// Divides a triangle that is so thin that it has no plane, at least in `f64`: a strip of triangles joins its two long
/// sides.
pub(super) fn strip(boundary: &[Corner], allowance: &Allowance) -> Pieces {
    let side_length = |side: usize| {
        let on = |corner: &&Corner| corner.sides >> side & 1 == 1 && corner.sides.count_ones() == 2;
        let mut ends = boundary.iter().filter(on);
        match (ends.next(), ends.next()) {
            (Some(a), Some(b)) => a.offset.distance(b.offset),
            _ => 0.0,
        }
    };
    let longest = (0..3).fold(0, |l, side| {
        if side_length(side) > side_length(l) {
            side
        } else {
            l
        }
    });
    // The boundary is rotated so that it begins with the longest side; this side ends at the second corner in the new
    // order.
    let is_corner = |corner: &Corner| corner.sides.count_ones() == 2;
    let starts_at = |corner: &Corner| is_corner(corner) && corner.weights[longest] == 1.0;
    let start = boundary.iter().position(starts_at).unwrap_or(0);
    let count = boundary.len();
    let order: Vec<u32> = (0..count).map(|i| ((start + i) % count) as u32).collect();
    let end = 1 + order[1..]
        .iter()
        .position(|&i| is_corner(&boundary[i as usize]))
        .unwrap_or(0);
    // Both chains go from the start to the end of the longest side.
    let lower = &order[..=end];
    let upper: Vec<u32> = std::iter::once(order[0])
        .chain(order[end..].iter().rev().copied())
        .collect();

    let along = boundary[order[end] as usize].offset - boundary[order[0] as usize].offset;
    let parameter = |index: u32| boundary[index as usize].offset.dot(along);
    let mut pieces = Pieces {
        complete: true,
        ..Pieces::default()
    };
    let (mut low, mut up) = (1, 1);
    let mut add = |triangle: [u32; 3]| {
        let offsets = triangle.map(|index| boundary[index as usize].offset);
        pieces.measure(offsets, allowance, f64::INFINITY);
        pieces.triangles.push(triangle);
    };
    add([lower[0], lower[1], upper[1]]);
    while low + 1 < lower.len() || up + 1 < upper.len() {
        let lower_next = lower.get(low + 1).filter(|_| low + 1 < lower.len());
        let upper_next = upper.get(up + 1).filter(|_| up + 1 < upper.len());
        let take_lower = match (lower_next, upper_next) {
            (Some(&l), Some(&u)) => parameter(l) <= parameter(u),
            (l, _) => l.is_some(),
        };
        if take_lower {
            // Both chains end at the same corner; the chain that reaches it last closes the strip.
            if lower[low + 1] != upper[up] {
                add([lower[low], lower[low + 1], upper[up]]);
            }
            low += 1;
        } else {
            if upper[up + 1] != lower[low] {
                add([lower[low], upper[up + 1], upper[up]]);
            }
            up += 1;
        }
    }
    pieces
}
