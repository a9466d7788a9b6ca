//! The word that was meant, for messages about one that nobody knows.

use strsim::osa_distance;

/// The known word that `word` most likely stands for: the one with the fewest slips of the pen between them, at most
/// one for each three letters, or the one that it abbreviates or spells out.
pub(super) fn nearest<'a>(word: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let plain = |text: &str| text.to_lowercase().replace(['-', ' '], "_");
    let wanted = plain(word);
    let allowed = wanted.chars().count().div_ceil(3);
    let scored = known.filter_map(|candidate| {
        let candidate_plain = plain(candidate);
        let is_part = |part: &str, whole: &str| part.len() >= 3 && whole.starts_with(part);
        let slips = osa_distance(&wanted, &candidate_plain);
        let is_near = slips <= allowed
            || is_part(&wanted, &candidate_plain)
            || is_part(&candidate_plain, &wanted);
        is_near.then_some((slips, candidate))
    });
    let best = scored.min_by_key(|(slips, _)| *slips);
    best.map(|(_, candidate)| candidate)
}

/// Other words for shapes.
const SYNONYMS: [(&str, &str); 7] = [
    ("ball", "sphere"),
    ("cube", "box"),
    ("cuboid", "box"),
    ("donut", "torus"),
    ("plane", "grid"),
    ("ring", "torus"),
    ("stick", "rod"),
];

/// A message about an unknown word, which stands in backticks before the known ones, with the one that was meant.
pub(super) fn with_nearest(message: String) -> String {
    let is_unknown = ["unknown key", "unknown variant", "unknown shape"]
        .iter()
        .any(|start| message.starts_with(start));
    let Some((before, expected)) = message.split_once(", expected ").filter(|_| is_unknown) else {
        return message;
    };
    let Some(word) = before.split('`').nth(1) else {
        return message;
    };
    // A key may be as long as the scene.
    if word.len() > 60 {
        return message;
    }
    let word = SYNONYMS
        .iter()
        .find(|(tried, _)| *tried == word)
        .map_or(word, |(_, meant)| meant);
    let expected = expected.strip_prefix("one of ").unwrap_or(expected);
    let separators = |c: char| matches!(c, ',' | '`' | ' ' | '"');
    let known = expected
        .split(separators)
        .filter(|known| !known.is_empty() && *known != "or");
    match nearest(word, known) {
        Some(meant) => format!("{message}; did you mean `{meant}`?"),
        None => message,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_meant_is_found_and_nothing_else() {
        let known = ["name", "position", "velocity", "rotation", "one_minus_beta"];
        for (word, expected) in [
            ("postion", Some("position")),
            ("pos", Some("position")),
            ("Position", Some("position")),
            ("positions", Some("position")),
            ("velocty", Some("velocity")),
            ("oneMinusBeta", Some("one_minus_beta")),
            ("one-minus-beta", Some("one_minus_beta")),
            ("title", None),
            ("x", None),
            ("", None),
        ] {
            assert_eq!(nearest(word, known.into_iter()), expected, "{word}");
        }
    }

    #[test]
    fn messages_name_the_nearest_of_the_words_that_they_list() {
        for (message, meant) in [
            (
                "unknown key `raduis`, expected `radius` or `resolution`",
                Some("radius"),
            ),
            (
                "unknown key `tol`, expected one of `title`, `tolerance`",
                Some("tolerance"),
            ),
            (
                "unknown shape `shpere`, expected one of sphere, box",
                Some("sphere"),
            ),
            ("unknown key `zzz`, expected `radius` or `resolution`", None),
            ("found a list, expected a shape", None),
        ] {
            let said = with_nearest(message.to_owned());
            match meant {
                Some(meant) => assert_eq!(said, format!("{message}; did you mean `{meant}`?")),
                None => assert_eq!(said, message),
            }
        }
    }
}
