//! Which of many things are equal, in little memory.

use std::hash::{BuildHasher, Hash, RandomState};

/// For each of the numbers from 0 to below `count` the first one with an equal value.
///
/// A hash table of numbers alone: the values are computed again wherever two are compared. Its hashes are others on every
/// run, so that no file can be made for which many are the same; what it finds is not.
pub(super) fn first_alike<T: Hash + Eq>(count: usize, value: impl Fn(u32) -> T) -> Vec<u32> {
    const FREE: u32 = u32::MAX;
    // At most three quarters full.
    let slots = (count + count / 3 + 1).next_power_of_two();
    let mut table = vec![FREE; slots];
    let hashes = RandomState::new();
    let first = |number: u32| {
        let own = value(number);
        let mut slot = hashes.hash_one(&own) as usize & (slots - 1);
        loop {
            match table[slot] {
                FREE => {
                    table[slot] = number;
                    return number;
                }
                other if value(other) == own => return other,
                _ => slot = (slot + 1) & (slots - 1),
            }
        }
    };
    (0..count as u32).map(first).collect()
}

/// Numbers things from 0 in the order of the first ones of those that are alike, in place of the first ones, and returns
/// these.
pub(super) fn number(firsts: &mut [u32]) -> Vec<u32> {
    let mut found = vec![];
    for index in 0..firsts.len() {
        let first = firsts[index] as usize;
        if first == index {
            firsts[index] = found.len() as u32;
            found.push(index as u32);
        } else {
            // Those before have been numbered.
            firsts[index] = firsts[first];
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;

    #[test]
    fn numbers_are_those_of_a_map_in_order() {
        for (count, different) in [(0, 1), (1, 1), (1000, 1), (1000, 70), (5000, 5000)] {
            let value = |index: u32| (u64::from(index) * 7919 % different, "same");
            let mut numbers = first_alike(count, value);
            let found = number(&mut numbers);
            let mut known = HashMap::new();
            for (index, &number) in numbers.iter().enumerate() {
                let next = known.len() as u32;
                assert_eq!(number, *known.entry(value(index as u32)).or_insert(next));
                assert!(found[number as usize] as usize <= index);
            }
            assert_eq!(found.len(), known.len());
        }
    }
}
