//! A tree of boxes: what a ray may meet, and what may hold a point, without asking everything.
//!
//! Of a tree that others keep, three things are asked here that `parry3d`'s does not have: it is at most
//! [`MAX_LEVELS`] deep, whatever lies where; flat boxes are weighed by their area, not their volume, which is nothing; and
//! bundles of slivers have slanted boxes ([`super::slant`]).
//!
//! A tree is built by divisions in two. Each of its nodes holds the boxes of two levels of that, which a ray is held against
//! at once, where the processor has vector instructions (`pulp` detects them).

use glam::DVec3;
use pulp::{Arch, NullaryFnOnce};

use super::bounds::Bounds;
use super::ray::{Ray, Slabs};
use super::slant::{Slant, Sliver};

/// Boxes with so many things or fewer are not divided.
const FEW: usize = 2;

/// Places where a box may be divided, one more than these.
const BINS: usize = 16;

/// So many levels of a tree are divided where it is best; further ones at the middle of what there is, so that even
/// 2^32 things need no more than [`MAX_LEVELS`].
const BEST_LEVELS: usize = 48;
pub(super) const MAX_LEVELS: usize = BEST_LEVELS + 32;

/// So many boxes a node has: those of [`LEVELS`] levels of divisions.
const LANES: usize = 4;
const LEVELS: usize = LANES.ilog2() as usize;

/// No more boxes than these wait to be looked into: those beside the one that is, on every level of nodes.
const MAX_WAITING: usize = (LANES - 1) * MAX_LEVELS.div_ceil(LEVELS) + LANES;

/// Boxes are larger by this part of all lengths that take part: a ray that the test of a triangle takes, roundings and all,
/// must not be lost at a box.
const MARGIN: f64 = 64.0 * f64::EPSILON;

/// Boxes that are entered farther away than what was found, by no more than this part, are looked into:
/// the distance of a hit with a sliver is rounded by more than that of a box.
const NEAR_MARGIN: f64 = 1.0 + 1e-12;

/// No slanted box.
const NONE: u32 = u32::MAX;

/// Boxes within boxes, around things that have numbers.
pub(super) struct Tree {
    /// The first has the boxes around everything; there is none if there is nothing.
    nodes: Vec<Node>,
    slants: Vec<Slant>,
    /// Numbers of things, those of a box beside each other.
    things: Vec<u32>,
    /// A box around everything.
    whole: Bounds,
    middle: DVec3,
    /// From corner to corner.
    size: f64,
    arch: Arch,
}

/// Boxes beside each other.
struct Node {
    /// How many there are.
    boxes: usize,
    /// For each axis the lower and the upper sides.
    sides: [[[f64; LANES]; 2]; 3],
    slants: [u32; LANES],
    /// The first of a box's things, or the node of the boxes within it if it has no things.
    firsts: [u32; LANES],
    counts: [u32; LANES],
}

/// A box that is divided in two, or has things.
struct Division {
    bounds: Bounds,
    slant: u32,
    /// The first of its things, or of its two divisions if it has no things.
    first: u32,
    count: u32,
}

/// Triangles whose slivers get slanted boxes.
struct Slivers<'a> {
    corners: &'a dyn Fn(u32) -> [DVec3; 3],
    /// For every triangle.
    slivers: Vec<Option<Sliver>>,
}

impl Tree {
    /// A tree of things of any kind.
    pub(super) fn new(bounds: &[Bounds]) -> Self {
        Self::of(bounds, None)
    }

    /// A tree of triangles, fewer than 2^32.
    pub(super) fn of_triangles(count: usize, corners: &dyn Fn(u32) -> [DVec3; 3]) -> Self {
        let all = (0..count as u32).map(corners);
        let bounds: Vec<_> = all.clone().map(|c| Bounds::around(c.into_iter())).collect();
        let slivers: Vec<_> = all.map(Sliver::of).collect();
        let slivers = Slivers { corners, slivers };
        Self::of(&bounds, Some(&slivers))
    }

    fn of(bounds: &[Bounds], slivers: Option<&Slivers>) -> Self {
        let whole = Bounds::of_all(bounds.iter().copied());
        let mut tree = Self {
            nodes: Vec::new(),
            slants: Vec::new(),
            things: (0..bounds.len() as u32).collect(),
            whole,
            middle: whole.middle(),
            size: (whole.high - whole.low).length(),
            arch: Arch::new(),
        };
        if bounds.is_empty() {
            return tree;
        }
        let mut things = std::mem::take(&mut tree.things);
        let mut divisions = vec![Division::undivided()];
        let mut undivided = vec![(0, 0..things.len(), 0)];
        while let Some((number, range, level)) = undivided.pop() {
            let own = &mut things[range.clone()];
            let around = Bounds::of_all(own.iter().map(|&thing| bounds[thing as usize]));
            let slant = slivers.and_then(|slivers| slivers.slant(own, tree.middle, &around));
            let made = &mut divisions[number];
            made.bounds = around;
            if let Some(slant) = slant {
                made.slant = tree.slants.len() as u32;
                tree.slants.push(slant);
            }
            if own.len() <= FEW {
                (made.first, made.count) = (range.start as u32, own.len() as u32);
                continue;
            }
            let middle = range.start + divide(own, bounds, level);
            let first = divisions.len();
            divisions[number].first = first as u32;
            divisions.extend([Division::undivided(), Division::undivided()]);
            undivided.push((first, range.start..middle, level + 1));
            undivided.push((first + 1, middle..range.end, level + 1));
        }
        tree.things = things;
        tree.nodes = nodes(&divisions);
        tree
    }

    /// A box around everything, if there is something.
    pub(super) fn bounds(&self) -> Option<Bounds> {
        (!self.nodes.is_empty()).then_some(self.whole)
    }

    /// Visits everything whose box a ray enters before `limit`, what is nearer mostly first; what `visit` gives is the limit
    /// from then on.
    pub(super) fn along(&self, ray: &Ray, limit: f64, visit: impl FnMut(u32) -> f64) {
        if !self.nodes.is_empty() {
            self.arch.dispatch(Along {
                tree: self,
                ray,
                limit,
                visit,
            });
        }
    }

    /// Visits everything whose box holds `place`.
    pub(super) fn holding(&self, place: DVec3, mut visit: impl FnMut(u32)) {
        let mut waiting = [0; MAX_WAITING];
        let mut count = usize::from(!self.nodes.is_empty());
        while count > 0 {
            count -= 1;
            let node = &self.nodes[waiting[count] as usize];
            #[cfg(test)]
            counted::add(node);
            for lane in 0..node.boxes {
                if !node.bounds(lane).holds(place) {
                    continue;
                }
                match node.counts[lane] {
                    0 => {
                        waiting[count] = node.firsts[lane];
                        count += 1;
                    }
                    _ => self.things_of(node, lane).for_each(&mut visit),
                }
            }
        }
    }

    /// The things of a box that has some.
    fn things_of(&self, node: &Node, lane: usize) -> impl Iterator<Item = u32> {
        let first = node.firsts[lane] as usize;
        let things = &self.things[first..first + node.counts[lane] as usize];
        things.iter().copied()
    }
}

/// What a ray meets in a tree that is not empty.
struct Along<'a, V> {
    tree: &'a Tree,
    ray: &'a Ray,
    limit: f64,
    visit: V,
}

impl<V: FnMut(u32) -> f64> NullaryFnOnce for Along<'_, V> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self {
            tree,
            ray,
            mut limit,
            mut visit,
        } = self;
        let reach = (ray.origin() - tree.middle).length() + tree.size;
        let margin = reach * MARGIN;
        // Nothing is met by what is not a number.
        if margin.is_nan() || ray.direction().is_nan() {
            return;
        }
        let slabs = Slabs::new(ray.origin(), ray.direction(), margin);
        // Numbers of boxes that are entered, and where.
        let mut waiting = [(0, 0.0); MAX_WAITING];
        let (mut number, mut count) = (0, 0);
        loop {
            let node = &tree.nodes[number];
            #[cfg(test)]
            counted::add(node);
            let entered = slabs.enters_each(&node.sides);
            let before = count;
            for (lane, mut near) in entered.into_iter().enumerate().take(node.boxes) {
                if !(near <= limit * NEAR_MARGIN) {
                    continue;
                }
                if node.slants[lane] != NONE {
                    let slant = &tree.slants[node.slants[lane] as usize];
                    match slant.enters(ray, tree.middle, margin) {
                        Some(slanted) => near = near.max(slanted),
                        None => continue,
                    }
                }
                // The nearest comes last.
                let mut place = count;
                while place > before && waiting[place - 1].1 < near {
                    waiting[place] = waiting[place - 1];
                    place -= 1;
                }
                waiting[place] = (LANES * number + lane, near);
                count += 1;
            }
            number = loop {
                if count == 0 {
                    return;
                }
                count -= 1;
                let (own, near) = waiting[count];
                if !(near <= limit * NEAR_MARGIN) {
                    continue;
                }
                let (node, lane) = (&tree.nodes[own / LANES], own % LANES);
                if node.counts[lane] == 0 {
                    break node.firsts[lane] as usize;
                }
                for thing in tree.things_of(node, lane) {
                    limit = visit(thing);
                }
            };
        }
    }
}

/// The nodes of all divisions.
fn nodes(divisions: &[Division]) -> Vec<Node> {
    let mut nodes = vec![Node::without_boxes()];
    let mut left = vec![(0, 0)];
    while let Some((number, division)) = left.pop() {
        let mut own: Vec<usize> = vec![division];
        for _ in 0..LEVELS {
            let within = own.iter().flat_map(|&own| match divisions[own].count {
                0 => {
                    let first = divisions[own].first as usize;
                    vec![first, first + 1]
                }
                _ => vec![own],
            });
            own = within.collect();
        }
        for own in own {
            let division = &divisions[own];
            let mut first = division.first;
            if division.count == 0 {
                first = nodes.len() as u32;
                nodes.push(Node::without_boxes());
                left.push((first as usize, own));
            }
            nodes[number].add(division, first);
        }
    }
    nodes
}

impl Node {
    fn without_boxes() -> Self {
        Self {
            boxes: 0,
            sides: [[[f64::INFINITY; LANES], [f64::NEG_INFINITY; LANES]]; 3],
            slants: [NONE; LANES],
            firsts: [0; LANES],
            counts: [0; LANES],
        }
    }

    fn add(&mut self, division: &Division, first: u32) {
        let lane = self.boxes;
        self.boxes += 1;
        for (axis, [low, high]) in self.sides.iter_mut().enumerate() {
            low[lane] = division.bounds.low[axis];
            high[lane] = division.bounds.high[axis];
        }
        self.slants[lane] = division.slant;
        self.firsts[lane] = first;
        self.counts[lane] = division.count;
    }

    fn bounds(&self, lane: usize) -> Bounds {
        let side = |which: usize| DVec3::from_array(self.sides.map(|sides| sides[which][lane]));
        Bounds {
            low: side(0),
            high: side(1),
        }
    }
}

impl Division {
    fn undivided() -> Self {
        Self {
            bounds: Bounds::NOTHING,
            slant: NONE,
            first: 0,
            count: 0,
        }
    }
}

impl Slivers<'_> {
    /// The slanted box of triangles, if most of them are slivers and it pays.
    fn slant(&self, triangles: &[u32], middle: DVec3, plain: &Bounds) -> Option<Slant> {
        let slivers = triangles.iter().filter_map(|&t| self.slivers[t as usize]);
        if 2 * slivers.clone().count() < triangles.len() {
            return None;
        }
        let corners = triangles.iter().map(|&triangle| (self.corners)(triangle));
        Slant::around(corners, slivers, middle, plain)
    }
}

/// Divides things in two, by the surface of the boxes on either side times what they hold; how many come first, at
/// least one and not all.
fn divide(things: &mut [u32], bounds: &[Bounds], level: usize) -> usize {
    let middle = |thing: u32| bounds[thing as usize].middle();
    let middles = Bounds::around(things.iter().map(|&thing| middle(thing)));
    let axis = (middles.high - middles.low).max_position();
    let (start, length) = (middles.low[axis], middles.high[axis] - middles.low[axis]);
    // What is not a number is in the first bin, and nothing beyond the last.
    let bin = |thing: u32| {
        let part = (middle(thing)[axis] - start) / length;
        ((part * BINS as f64) as usize).min(BINS - 1)
    };
    if level < BEST_LEVELS
        && let Some(last_left) = best_bin(things, bounds, bin)
    {
        return partition(things, |thing| bin(thing) <= last_left);
    }
    let half = things.len() / 2;
    things.select_nth_unstable_by(half, |&a, &b| {
        let order = middle(a)[axis].total_cmp(&middle(b)[axis]);
        order.then(a.cmp(&b))
    });
    half
}

/// The last bin on the left where a division is best; none if all things are in one bin.
fn best_bin(things: &[u32], bounds: &[Bounds], bin: impl Fn(u32) -> usize) -> Option<usize> {
    let mut bins = [(Bounds::NOTHING, 0_usize); BINS];
    for &thing in things {
        let (around, count) = &mut bins[bin(thing)];
        *around = around.with(bounds[thing as usize]);
        *count += 1;
    }
    let cost = |bins: &[(Bounds, usize)]| {
        let count: usize = bins.iter().map(|bin| bin.1).sum();
        let around = Bounds::of_all(bins.iter().filter(|bin| bin.1 > 0).map(|bin| bin.0));
        (count > 0).then(|| around.half_area() * count as f64)
    };
    let divisions = (1..BINS).filter_map(|first_right| {
        let (left, right) = bins.split_at(first_right);
        Some((first_right - 1, cost(left)? + cost(right)?))
    });
    let best = divisions.min_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(best.0)
}

/// Puts what `is_left` says first, both in their order; how many these are.
fn partition(things: &mut [u32], is_left: impl Fn(u32) -> bool) -> usize {
    let right: Vec<u32> = things.iter().copied().filter(|&t| !is_left(t)).collect();
    let mut left = 0;
    for index in 0..things.len() {
        if is_left(things[index]) {
            things[left] = things[index];
            left += 1;
        }
    }
    things[left..].copy_from_slice(&right);
    left
}

/// What tests count.
#[cfg(test)]
pub(super) mod counted {
    use std::cell::Cell;

    use super::Node;

    thread_local! {
        pub(in super::super) static BOXES: Cell<u64> = const { Cell::new(0) };
    }

    /// Counts the boxes of a node.
    pub(super) fn add(node: &Node) {
        BOXES.set(BOXES.get() + node.boxes as u64);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How many levels of nodes there are.
    fn depth(tree: &Tree) -> usize {
        let mut deepest = 0;
        let mut waiting = vec![(0, 1)];
        while let Some((number, level)) = waiting.pop() {
            deepest = deepest.max(level);
            let node: &Node = &tree.nodes[number];
            let within = (0..node.boxes).filter(|&lane| node.counts[lane] == 0);
            waiting.extend(within.map(|lane| (node.firsts[lane] as usize, level + 1)));
        }
        deepest
    }

    fn cube(middle: DVec3, half: f64) -> Bounds {
        Bounds {
            low: middle - half,
            high: middle + half,
        }
    }

    /// However things lie: beside each other, each 1.01 times as far away as the last, all at one place, infinite.
    #[test]
    fn no_tree_is_deeper_than_its_limit() {
        let count = 30_000;
        let places: [&dyn Fn(i32) -> f64; 4] =
            [&|k| f64::from(k), &|k| 1.01f64.powi(k), &|_| 1.0, &|k| {
                if k % 2 == 0 { f64::INFINITY } else { f64::NAN }
            }];
        for (which, place) in places.into_iter().enumerate() {
            let all: Vec<_> = (0..count)
                .map(|k| cube(DVec3::new(place(k), 0.0, 0.0), 0.1))
                .collect();
            let tree = Tree::new(&all);
            let most = MAX_LEVELS.div_ceil(LEVELS) + 1;
            assert!(depth(&tree) <= most, "{which}: {}", depth(&tree));
            let mut things = tree.things.clone();
            things.sort_unstable();
            assert!(things.into_iter().eq(0..count as u32));
            let ray = Ray::new(DVec3::new(0.0, 0.0, 5.0), DVec3::NEG_Z);
            tree.along(&ray, f64::MAX, |_| f64::MAX);
            tree.holding(DVec3::X, |_| ());
        }
    }

    /// Things far apart: a ray and a place are held against a number of boxes that grows like the number of levels.
    #[test]
    fn work_grows_like_the_number_of_levels() {
        for side in [10, 30, 100] {
            let all = (0..side * side).map(|k| {
                let place = DVec3::new(f64::from(k % side), f64::from(k / side), 0.0);
                cube(3.0 * place, 1.0)
            });
            let tree = Tree::new(&all.collect::<Vec<_>>());
            let levels = depth(&tree) as u64;
            assert!(levels < 13, "{levels}");
            for k in 0..side * side {
                let place = 3.0 * DVec3::new(f64::from(k % side), f64::from(k / side), 0.0);
                counted::BOXES.set(0);
                let mut found = Vec::new();
                tree.holding(place, |thing| found.push(thing));
                assert!(found.contains(&(k as u32)) && found.len() <= FEW);
                let ray = Ray::new(place + DVec3::Z * 50.0, DVec3::NEG_Z);
                let mut met = Vec::new();
                tree.along(&ray, f64::MAX, |thing| {
                    met.push(thing);
                    f64::MAX
                });
                assert!(met.contains(&(k as u32)) && met.len() <= FEW);
                assert!(counted::BOXES.get() <= 12 * levels);
            }
        }
    }
}
