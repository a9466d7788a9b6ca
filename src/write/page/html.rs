//! The HTML of a page, from its template.

use std::io::Write;

use base64::engine::general_purpose::STANDARD;
use base64::prelude::Engine;
use base64::write::EncoderWriter;
use sha2::{Digest, Sha256};

use crate::write::WriteError;

/// The viewer: sources in `src/page`, bundled.
const TEMPLATE: &str = include_str!("../../page/page.html");
const STYLE: &str = include_str!("../../page/page.css");
const SCRIPT: &str = include_str!("../../page/bundle/page.js");

/// A title of more characters than this tells nobody more, and fills the title of a window.
const MAX_TITLE: usize = 200;

/// What a page shows.
#[derive(Clone, Debug, PartialEq)]
pub struct PageContent {
    /// The title of the page, as text.
    pub title: String,
    /// What the viewer reads about the scene: JSON.
    pub scene: String,
    /// The meshes at rest: a GLB.
    pub meshes: Vec<u8>,
    /// The table of colours under the Doppler effect: see [`ShaderTable::rest`](crate::effects::ShaderTable::rest).
    pub colors: Vec<u8>,
}

/// Writes a page: one HTML file that needs no other and sends no request.
///
/// Titles and names of a scene are text of the page, whatever characters they have. The file forbids its own program, by a
/// Content-Security-Policy, to load anything, and a browser to run any other program in it.
///
/// # Errors
///
/// `out` fails.
pub fn write_page(content: &PageContent, out: &mut dyn Write) -> Result<(), WriteError> {
    // Each piece is written as it is: what is filled in is not looked at again.
    let mut rest = TEMPLATE;
    while let Some((text, after)) = rest.split_once("{{") {
        let (name, after) = after.split_once("}}").expect("the template is tested");
        out.write_all(text.as_bytes())?;
        match name {
            "csp" => out.write_all(policy().as_bytes())?,
            "title" => out.write_all(escaped(&content.title).as_bytes())?,
            "style" => out.write_all(STYLE.as_bytes())?,
            "script" => out.write_all(SCRIPT.as_bytes())?,
            "scene" => out.write_all(within_script(&content.scene).as_bytes())?,
            "meshes" => write_base64(&content.meshes, out)?,
            "colors" => write_base64(&content.colors, out)?,
            _ => unreachable!("the template is tested"),
        }
        rest = after;
    }
    Ok(out.write_all(rest.as_bytes())?)
}

/// The Content-Security-Policy: the page's own program and style and no others, pictures that are in it, no connection.
fn policy() -> String {
    let hash = |text: &str| format!("'sha256-{}'", STANDARD.encode(Sha256::digest(text)));
    let (script, style) = (hash(SCRIPT), hash(STYLE));
    format!(
        "default-src 'none'; script-src {script}; style-src {style}; img-src blob: data:; connect-src 'none'; \
         base-uri 'none'; form-action 'none'"
    )
}

/// Text as HTML has it, cut to a length that a title may have.
fn escaped(title: &str) -> String {
    let mut html = String::new();
    for (number, character) in title.chars().enumerate() {
        match character {
            _ if number == MAX_TITLE => {
                html.push('…');
                break;
            }
            '&' => html.push_str("&amp;"),
            '<' => html.push_str("&lt;"),
            '>' => html.push_str("&gt;"),
            '"' => html.push_str("&quot;"),
            '\0' => html.push('\u{fffd}'),
            _ => html.push(character),
        }
    }
    html
}

/// JSON that no reader of HTML takes for the end of its element: the characters of markup are only within strings.
fn within_script(json: &str) -> String {
    json.replace('<', "\\u003c")
        .replace('>', "\\u003e")
        .replace('&', "\\u0026")
}

fn write_base64(bytes: &[u8], out: &mut dyn Write) -> Result<(), WriteError> {
    let mut encoder = EncoderWriter::new(out, &STANDARD);
    encoder.write_all(bytes)?;
    encoder.finish()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn page(title: &str, scene: &str) -> String {
        let content = PageContent {
            title: title.into(),
            scene: scene.into(),
            meshes: vec![1, 2, 3, 4],
            colors: vec![255; 3],
        };
        let mut out = Vec::new();
        write_page(&content, &mut out).unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn every_place_of_the_template_is_filled() {
        let whole = page("a title", "{}");
        for name in [
            "csp", "title", "style", "script", "scene", "meshes", "colors",
        ] {
            assert_eq!(TEMPLATE.matches(&format!("{{{{{name}}}}}")).count(), 1);
        }
        assert!(whole.contains("<title>a title</title>"));
        assert!(whole.contains("AQIDBA=="), "the meshes");
        assert!(whole.ends_with("</html>\n"));
        assert!(!SCRIPT.contains("</script") && !SCRIPT.contains("<!--"));
        assert!(!STYLE.contains("</style"));
    }

    #[test]
    fn words_of_a_scene_are_text() {
        let wild = "</title></script><script>alert(1)</script>{{script}}<!--\"'&amp;";
        let scene = serde_json::json!({ "title": wild, "name": "\u{2028}" }).to_string();
        let whole = page(wild, &scene);
        let plain = page("", "{}");
        for markup in ["<script", "</script", "<title", "</title", "<!--"] {
            assert_eq!(
                whole.matches(markup).count(),
                plain.matches(markup).count(),
                "{markup}"
            );
        }
        assert!(whole.contains("{{script}}&lt;!--&quot;'&amp;amp;</title>"));
        let (_, after) = whole.split_once("id=\"scene\">").unwrap();
        let (json, _) = after.split_once("</script>").unwrap();
        let read: serde_json::Value = serde_json::from_str(json).unwrap();
        assert_eq!(
            (&read["title"], &read["name"]),
            (&wild.into(), &"\u{2028}".into())
        );
    }

    #[test]
    fn long_titles_are_cut() {
        let whole = page(&"ä".repeat(1_000_000), "{}");
        let (_, after) = whole.split_once("<title>").unwrap();
        let (title, _) = after.split_once("</title>").unwrap();
        assert_eq!(title.chars().count(), MAX_TITLE + 1);
    }
}
