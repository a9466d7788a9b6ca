//! Values of flags that several commands have: numbers, counts, vectors.

use std::num::NonZeroUsize;
use std::ops::Range;

use anyhow::{Context, anyhow, ensure};
use photosurface::DVec3;

/// `X,Y,Z`
pub(super) fn vector(text: &str) -> anyhow::Result<DVec3> {
    let numbers = list(text, "expected three numbers, X,Y,Z like 0,0.5,-0.9")?;
    let &[x, y, z] = numbers.as_slice() else {
        anyhow::bail!("has {} numbers, expected 3: X,Y,Z", numbers.len());
    };
    Ok(DVec3::new(x, y, z))
}

/// The numbers of a list with commas; `forms` says what the list may be.
pub(super) fn list(text: &str, forms: &str) -> anyhow::Result<Vec<f64>> {
    let numbers = numbers(text);
    numbers.map_err(|_| anyhow!("\"{text}\" has a word that is no number; {forms}"))
}

/// `A,B,C`
pub(super) fn numbers(text: &str) -> anyhow::Result<Vec<f64>> {
    text.split(',').map(number).collect()
}

pub(super) fn number(text: &str) -> anyhow::Result<f64> {
    let text = text.trim();
    let number: f64 = text
        .parse()
        .with_context(|| format!("\"{text}\" is not a number (expected e.g. 0.5)"))?;
    ensure!(number.is_finite(), "{text} is not finite");
    Ok(number)
}

/// `1000000` or `1e6`
pub(super) fn whole_number(text: &str) -> anyhow::Result<u64> {
    let number: f64 = text.trim().parse().unwrap_or(f64::NAN);
    // Below 2^53 every whole number is one in f64 too.
    let is_whole = (0.0..9e15).contains(&number) && number.fract() == 0.0;
    ensure!(is_whole, "expected a whole number such as 1000000 or 1e6");
    Ok(number as u64)
}

/// As [`whole_number`], and not zero.
pub(super) fn count(text: &str) -> anyhow::Result<NonZeroUsize> {
    let number = usize::try_from(whole_number(text)?).ok();
    let number = number.and_then(NonZeroUsize::new);
    number.with_context(|| format!("{text} is too small, expected at least 1"))
}

/// `A..B`
pub(super) fn part(text: &str) -> anyhow::Result<Range<usize>> {
    let whole = |text: &str| text.trim().parse::<usize>().ok();
    let ends = text.split_once("..");
    let range = ends.and_then(|(from, to)| Some(whole(from)?..whole(to)?));
    let range = range.filter(|range| !range.is_empty());
    range.with_context(|| {
        format!("\"{text}\" is no part, expected A..B with A below B, like 10..20 for the numbers 10 to 19")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_may_have_an_exponent() {
        assert_eq!(whole_number("0").unwrap(), 0);
        assert_eq!(whole_number("20000000").unwrap(), 20_000_000);
        assert_eq!(whole_number("1e6").unwrap(), 1_000_000);
        for wrong in ["", "-5", "1.5", "1e20", "inf", "nan", "many"] {
            assert!(whole_number(wrong).is_err(), "{wrong}");
        }
        assert_eq!(count("1").unwrap().get(), 1);
        assert!(count("0").unwrap_err().to_string().contains("at least 1"));
    }

    #[test]
    fn vectors_are_read_as_people_write_them() {
        assert_eq!(vector("1,-2.5, 3e2").unwrap(), DVec3::new(1.0, -2.5, 300.0));
        let error = |text: &str| vector(text).unwrap_err().to_string();
        assert!(error("1,2").contains("expected 3"));
        assert!(error("1,2,x").contains("X,Y,Z like 0,0.5,-0.9"));
        assert!(vector("1,2,inf").is_err());
    }
}
