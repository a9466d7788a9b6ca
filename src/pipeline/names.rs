//! Names of photosurfaces in files.

use std::collections::{HashMap, HashSet};

/// The label of a step in the names of files and of nodes and meshes: `step003`.
pub fn step_label(step: usize) -> String {
    format!("step{step:03}")
}

/// A name that every reading program keeps unchanged: each character that one of them would replace or drop becomes
/// `_`.
///
/// Blender, trimesh, MeshLab and the validator keep all visible characters of all scripts. three.js replaces white
/// space by `_` and drops `[ ] . : /`, which have a meaning in its property paths. Control characters are useless in
/// the names of any program.
pub(super) fn safe_name(wanted: &str) -> String {
    let is_broken =
        |c: char| c.is_control() || c.is_whitespace() || c == '\u{feff}' || "[].:/".contains(c);
    let kept = |c| if is_broken(c) { '_' } else { c };
    wanted.chars().map(kept).collect()
}

/// Makes names that are unique and that every reading program keeps unchanged.
#[derive(Default)]
pub(super) struct UniqueNames {
    taken: HashSet<String>,
    /// For each name that was wanted more than once, the smallest number that may still be free as a suffix.
    next: HashMap<String, usize>,
}

impl UniqueNames {
    /// `wanted` in the characters of [`safe_name`], with a number appended if that name is taken.
    ///
    /// Each call takes the same time, however often the same name is wanted.
    pub(super) fn unique(&mut self, wanted: &str) -> String {
        let safe = safe_name(wanted);
        if self.taken.insert(safe.clone()) {
            return safe;
        }
        let next = self.next.entry(safe.clone()).or_insert(2);
        loop {
            let name = format!("{safe}_{next}");
            *next += 1;
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
            ["a_b", "a_b_2", "a_b_2_2", "a_b_3", "Großes_Rad", "-"]
        );
    }

    #[test]
    fn letters_of_every_script_stay_and_what_a_reader_breaks_does_not() {
        for kept in ["立方体", "куб", "مكعب", "क्यूब", "cube(1)#\"é\"", "🎲"]
        {
            assert_eq!(safe_name(kept), kept);
        }
        assert_eq!(
            safe_name("a[0].b:c/d\u{a0}e\u{1b}\n\u{85}\u{feff}"),
            "a_0__b_c_d_e____"
        );
    }

    /// Each name remembers its next free number; without that this test would take hours.
    #[test]
    fn many_things_of_one_name_take_no_longer_than_others() {
        let mut names = UniqueNames::default();
        names.unique("bolt_3");
        let made: Vec<String> = (0..300_000).map(|_| names.unique("bolt")).collect();
        assert_eq!(made[..3], ["bolt", "bolt_2", "bolt_4"]);
        assert_eq!(made[299_999], "bolt_300001");
    }
}
