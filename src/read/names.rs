//! Names for several parts that come from one thing with a name.

/// The name itself for one part; with several, the name followed by those of their materials where that
/// tells them apart, else by their numbers from 1.
pub(super) fn tell_apart(name: &str, materials: &[Option<String>]) -> Vec<String> {
    if materials.len() == 1 {
        return vec![name.to_owned()];
    }
    let mut distinct = materials.to_vec();
    distinct.sort();
    distinct.dedup();
    let differ = distinct.len() == materials.len() && !distinct.contains(&None);
    let suffixed = |(i, material): (usize, &Option<String>)| match material {
        Some(material) if differ => format!("{name}_{material}"),
        _ => format!("{name}_{}", i + 1),
    };
    materials.iter().enumerate().map(suffixed).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn materials_tell_parts_apart_only_if_all_differ() {
        let some = |name: &str| Some(name.to_owned());
        assert_eq!(tell_apart("car", &[None]), ["car"]);
        let materials = [some("paint"), some("glass")];
        assert_eq!(tell_apart("car", &materials), ["car_paint", "car_glass"]);
        let materials = [some("paint"), some("glass"), some("paint")];
        assert_eq!(tell_apart("car", &materials), ["car_1", "car_2", "car_3"]);
        assert_eq!(
            tell_apart("car", &[some("paint"), None]),
            ["car_1", "car_2"]
        );
    }
}
