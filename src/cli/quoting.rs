//! Words as a shell of POSIX reads them.

/// A word, quoted where a shell would read it as more or less than it is.
pub(super) fn quoted(word: &str) -> String {
    let is_plain = |character: char| {
        character.is_ascii_alphanumeric()
            || matches!(
                character,
                '_' | '-' | '.' | '/' | ',' | ':' | '=' | '+' | '@' | '%'
            )
    };
    match !word.is_empty() && word.chars().all(is_plain) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', r"'\''")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_with_odd_characters_are_quoted() {
        assert_eq!(quoted("scenes/cube.json"), "scenes/cube.json");
        assert_eq!(quoted("my scene.json"), "'my scene.json'");
        assert_eq!(quoted("it's $HOME"), r"'it'\''s $HOME'");
        assert_eq!(quoted(""), "''");
        assert_eq!(quoted("größe"), "'größe'");
    }
}
