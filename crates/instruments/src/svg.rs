//! Shared parts of SVG pictures: text of a known width, so that nothing is cut off, and legends below the plot. They
//! are 600 wide with letters of 15, so that these have 10 pixels where the picture has 400.

use std::fmt::Write;

/// Width of a picture.
pub const WIDTH: f64 = 600.0;
/// Size of letters.
pub const FONT: f64 = 15.0;
/// Free space at the sides.
pub const MARGIN: f64 = 16.0;
/// From a line of text to the next.
pub const LINE: f64 = 20.0;

/// Text that may stand in XML.
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// The width of text in the widest of the usual sans-serif fonts (DejaVu Sans, Verdana).
pub fn width(text: &str) -> f64 {
    let em = |c: char| match c {
        'i' | 'j' | 'l' | 't' | 'f' | 'r' | ' ' | '.' | ',' | ':' | ';' | '\'' | '|' | '!' | '(' | ')' | '/' | '-' => {
            0.42
        }
        'm' | 'w' | 'M' | 'W' | '%' | '@' | '—' | '…' => 1.0,
        c if c.is_uppercase() || "=+−×<>~".contains(c) => 0.84,
        _ => 0.65,
    };
    FONT * text.chars().map(em).sum::<f64>()
}

/// Text in lines that are no wider than `most`, broken at spaces, and within words that are wider still.
pub fn wrap(text: &str, most: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if width(line) + width(" ") + width(word) <= most => {
                line.push(' ');
                line.push_str(word);
                continue;
            }
            _ => lines.push(String::new()),
        }
        for c in word.chars() {
            let more = width(c.encode_utf8(&mut [0; 4]));
            match lines.last_mut() {
                Some(line) if line.is_empty() || width(line) + more <= most => line.push(c),
                _ => lines.push(c.into()),
            }
        }
    }
    lines
}

/// Lines of text from the left margin, the first at a height; how much room they take.
pub fn paragraph(svg: &mut String, text: &str, top: f64, style: &str) -> f64 {
    let lines = wrap(text, WIDTH - 2.0 * MARGIN);
    for (k, line) in lines.iter().enumerate() {
        let y = top + LINE * k as f64;
        let _ = writeln!(svg, "<text x=\"{MARGIN}\" y=\"{y:.1}\" {style}>{}</text>", escape(line));
    }
    LINE * lines.len() as f64
}

/// An entry of a legend.
pub struct Entry<'a> {
    /// The line beside it, as attributes of a path or, of dots, of a circle.
    pub stroke: String,
    /// True for a dot.
    pub is_dot: bool,
    /// Text of the entry.
    pub text: &'a str,
}

/// A legend in rows as wide as the picture, below a height; how much room it takes.
pub fn legend(svg: &mut String, entries: &[Entry<'_>], top: f64) -> f64 {
    const SWATCH: f64 = 24.0;
    let (mut x, mut row) = (MARGIN, 0);
    for e in entries {
        let lines = wrap(e.text, WIDTH - 2.0 * MARGIN - SWATCH - 6.0);
        let text = lines.first().map_or("", String::as_str);
        let length = SWATCH + 6.0 + width(text);
        if x > MARGIN && x + length > WIDTH - MARGIN {
            (x, row) = (MARGIN, row + 1);
        }
        let y = top + LINE * f64::from(row) + FONT;
        let middle = y - 5.0;
        let _ = if e.is_dot {
            write!(svg, "<circle cx=\"{:.1}\" cy=\"{middle:.1}\" r=\"4\" {}/>", x + SWATCH / 2.0, e.stroke)
        } else {
            write!(svg, "<path d=\"M{x:.1} {middle:.1}h{SWATCH}\" fill=\"none\" stroke-width=\"3\" {}/>", e.stroke)
        };
        let at = x + SWATCH + 6.0;
        let _ = writeln!(svg, "<text x=\"{at:.1}\" y=\"{y:.1}\">{}</text>", escape(text));
        x += length + 20.0;
    }
    if entries.is_empty() { 0.0 } else { LINE * f64::from(row + 1) + 8.0 }
}

/// Text that can be read on any ground: light letters on a dark rim.
pub fn rimmed(svg: &mut String, [x, y]: [f64; 2], text: &str) {
    let text = escape(text);
    let place = format!("x=\"{x:.1}\" y=\"{y:.1}\"");
    let _ = writeln!(
        svg,
        "<text {place} fill=\"#222\" stroke=\"#222\" stroke-width=\"4\" stroke-linejoin=\"round\">{text}</text>\
         <text {place} fill=\"white\">{text}</text>"
    );
}

/// The beginning of a picture of this height.
pub fn open(height: f64) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" \
         viewBox=\"0 0 {WIDTH} {height:.0}\" width=\"{WIDTH}\" height=\"{height:.0}\" font-family=\"sans-serif\" font-size=\"{FONT}\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    )
}

/// A number for an axis: in digits where it is short, else as `2·10⁶`.
pub fn number(v: f64) -> String {
    if v == 0.0 || (1e-3..1e5).contains(&v.abs()) {
        // Seven digits, without those that say nothing.
        let digits = (6 - v.abs().max(1.0).log10() as i32).clamp(0, 9) as usize;
        let text = format!("{v:.digits$}");
        let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
        return if text == "-0" { "0".into() } else { text.replace('-', "−") };
    }
    let text = format!("{v:.3e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let mantissa = mantissa.trim_end_matches('0').trim_end_matches('.');
    let power = power_of_ten(exponent.parse().unwrap_or(0));
    if mantissa == "1" { power } else { format!("{mantissa}·{power}").replace('-', "−") }
}

/// `10ⁿ` with a superscript.
pub fn power_of_ten(e: i32) -> String {
    let plain = e.to_string();
    let digits = plain.chars().map(|c| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        d => char::from_u32(0x2070 + d.to_digit(10).unwrap_or(0)).unwrap_or(d),
    });
    format!("10{}", digits.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (v, text) in
            [(0.0, "0"), (-0.25, "−0.25"), (0.1 + 0.2, "0.3"), (2e6, "2·10⁶"), (1e-7, "10⁻⁷"), (1500.0, "1500")]
        {
            assert_eq!(number(v), text);
        }
    }

    /// Lines keep all words, and none is wider than asked for.
    #[test]
    fn text_is_broken_at_spaces() {
        let text = "outer circle: 2.5 per steradian; dashed: specular lobes";
        let lines = wrap(text, 200.0);
        assert!(lines.len() > 1 && lines.iter().all(|l| width(l) <= 200.0), "{lines:?}");
        assert_eq!(lines.join(" "), text);
        let long = wrap(&"x".repeat(500), 200.0);
        assert!(long.iter().all(|l| width(l) <= 200.0) && long.concat().len() == 500);
    }
}
