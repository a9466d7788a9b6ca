//! Names of photosurfaces in files.

use std::collections::{HashMap, HashSet};

/// How a step is called in names of files and of things in them: `step003`.
pub fn step_label(step: usize) -> String {
    format!("step{step:03}")
}

/// Makes names that are unique and mean the same to every reader: ASCII letters, digits, `_` and `-`.
#[derive(Default)]
pub(super) struct UniqueNames {
    taken: HashSet<String>,
    /// The number that was last tried behind a name: 20,000 parts may have one name.
    tried: HashMap<String, usize>,
}

impl UniqueNames {
    /// `wanted` with other characters replaced by `_`, and with a number behind it if it was taken.
    pub(super) fn unique(&mut self, wanted: &str) -> String {
        let plain: String = wanted
            .chars()
            .map(|c| {
                if c.is_ascii_alphanumeric() || c == '-' {
                    c
                } else {
                    '_'
                }
            })
            .collect();
        if self.taken.insert(plain.clone()) {
            return plain;
        }
        let number = self.tried.entry(plain.clone()).or_insert(1);
        loop {
            *number += 1;
            let name = format!("{plain}_{number}");
            if self.taken.insert(name.clone()) {
                return name;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_plain_and_unique() {
        let mut names = UniqueNames::default();
        let made: Vec<_> = ["a b", "a.b", "a_b_2", "a_b", "Großes Rad", "-"]
            .iter()
            .map(|n| names.unique(n))
            .collect();
        assert_eq!(
            made,
            ["a_b", "a_b_2", "a_b_2_2", "a_b_3", "Gro_es_Rad", "-"]
        );
    }

    /// Each name knows how far its numbers are used up, or this would take hours.
    #[test]
    fn many_things_of_one_name_take_no_longer_than_others() {
        let mut names = UniqueNames::default();
        names.unique("bolt_3");
        let made: Vec<String> = (0..300_000).map(|_| names.unique("bolt")).collect();
        assert_eq!(made[..3], ["bolt", "bolt_2", "bolt_4"]);
        assert_eq!(made[299_999], "bolt_300001");
    }
}
