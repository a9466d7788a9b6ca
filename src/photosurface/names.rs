//! Names of photosurfaces in files.

use std::collections::HashSet;

/// How a step is called in names of files and of things in them: `step003`.
pub fn step_label(step: usize) -> String {
    format!("step{step:03}")
}

/// Makes names that are unique and mean the same to every reader: ASCII letters, digits, `_` and `-`.
#[derive(Default)]
pub(super) struct UniqueNames(HashSet<String>);

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
        let mut name = plain.clone();
        let mut number = 1;
        while !self.0.insert(name.clone()) {
            number += 1;
            name = format!("{plain}_{number}");
        }
        name
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
}
