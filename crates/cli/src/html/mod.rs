//! Parts of pages that stand alone: one file with its pictures inside, which fetches nothing.

mod scales;
pub mod slider;

pub use scales::{FULL, Scale, signed};

use base64::{display::Base64Display, prelude::BASE64_STANDARD};
use steradian::image::{self, FileKind, Image, WriteOptions};

/// Style, light and dark.
const STYLE: &str = include_str!("style.css");

/// End of a page that [`head`] began.
pub const END: &str = "</main>\n</body>\n</html>\n";

/// Beginning of a page, to its heading; `title` is escaped already, `style` is added to that of all pages.
pub fn head(title: &str, style: &str) -> String {
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n\
         <title>{title}</title>\n<style>\n{STYLE}{style}</style>\n</head>\n<body>\n<main>\n<h1>{title}</h1>\n"
    )
}

/// An element with a picture as PNG; `alt` is escaped already.
///
/// # Errors
/// Faults of encoding the picture.
pub fn img(picture: &Image, options: &WriteOptions, alt: &str) -> image::Result<String> {
    let png = image::encode(FileKind::Png, picture, options)?;
    Ok(format!(
        "<img width=\"{}\" height=\"{}\" alt=\"{alt}\" src=\"data:image/png;base64,{}\">",
        picture.width(),
        picture.height(),
        Base64Display::new(&png, &BASE64_STANDARD),
    ))
}

/// A number of five digits, with an exponent where it is tiny or huge.
pub fn number(number: f64) -> String {
    match number.abs() {
        0.0 => "0".into(),
        size if (1e-3..1e5).contains(&size) => {
            let digits = (4.0 - size.log10().floor()).max(0.0) as usize;
            format!("{number:.digits$}")
        }
        _ => format!("{number:.4e}"),
    }
}

/// A word, quoted where POSIX shells need that.
pub fn quoted(word: &str) -> String {
    let is_plain = !word.is_empty() && word.chars().all(|c| c.is_alphanumeric() || "_@%+=:,./-".contains(c));
    if is_plain { word.into() } else { format!("'{}'", word.replace('\'', r"'\''")) }
}

/// The command, quoted as POSIX shells read it.
pub fn command_line() -> String {
    let words = std::env::args_os().skip(1).map(|word| quoted(&word.to_string_lossy()));
    std::iter::once("steradian".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}

/// Text for elements and for attributes in double quotes.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_five_digits() {
        let all = [0.0, 1.0, 31.517_917, 0.001_234_567, -12345.6, 1.5e-7, f64::INFINITY].map(number);
        assert_eq!(all, ["0", "1.0000", "31.518", "0.0012346", "-12346", "1.5000e-7", "inf"]);
    }
}
