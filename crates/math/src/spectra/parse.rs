//! Text files of spectral samples (`.spd`, `.spectrum`): a wavelength in nm and a value per line, `#` starts a comment.
//! pbrt-v4 and Mitsuba read the same format.

use super::Curve;
use crate::Error;

/// Parses the text of a spectrum file. The pairs are separated by white space (commas are taken for it); a pair may
/// span lines, as pbrt-v4 allows. Wavelengths must increase. Errors carry the line.
pub fn parse_spd(text: &str) -> Result<Curve, Error> {
    let (mut lambda, mut value) = (Vec::new(), Vec::new());
    let mut last_line = 1;
    for (line, content) in text.lines().enumerate().map(|(i, l)| (i + 1, l)) {
        let samples = content.split('#').next().unwrap_or("");
        for word in samples.split(|c: char| c.is_whitespace() || c == ',').filter(|w| !w.is_empty()) {
            let v = number(word).map_err(|reason| Error::SpectrumFile { line, reason })?;
            if lambda.len() > value.len() {
                value.push(v);
                continue;
            }
            if let Some(&previous) = lambda.last()
                && v <= previous
            {
                let reason = format!("wavelengths must increase, but {v} nm follows {previous} nm");
                return Err(Error::SpectrumFile { line, reason });
            }
            lambda.push(v);
            last_line = line;
        }
    }
    let fail = |reason: &str| Err(Error::SpectrumFile { line: last_line, reason: reason.into() });
    if lambda.len() > value.len() {
        return fail("the last wavelength has no value");
    }
    if lambda.is_empty() {
        return fail("no samples");
    }
    Curve::new(lambda, value)
}

pub(super) fn number(word: &str) -> Result<f32, String> {
    match word.parse::<f32>() {
        Ok(v) if v.is_finite() => Ok(v),
        Ok(_) => Err(format!("`{}` is not a finite number", excerpt(word))),
        Err(_) => Err(format!("`{}` is not a number", excerpt(word))),
    }
}

/// At most 40 characters of a word, for messages.
fn excerpt(word: &str) -> String {
    word.chars().take(40).chain((word.chars().count() > 40).then_some('…')).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_blank_lines_and_line_ends() {
        let c = parse_spd("# header\r\n\r\n 400 1.5 # first\r\n500\t2e0\n600 3").unwrap();
        assert_eq!((c.lambda(), c.values()), (&[400.0, 500.0, 600.0][..], &[1.5, 2.0, 3.0][..]));
        assert_eq!(parse_spd("400 1 500\n 2").unwrap().lambda().len(), 2);
        assert_eq!(parse_spd("400, 1\n500, 2").unwrap().values(), &[1.0, 2.0]);
    }

    #[test]
    fn faults_are_reported_with_their_line() {
        for (text, line, what) in [
            ("", 1, "no samples"),
            ("# nothing\n\n", 1, "no samples"),
            ("400 1\n500 two\n", 2, "`two` is not a number"),
            ("400 1\n\n500 inf\n", 3, "not a finite number"),
            ("400 1\n390 2\n", 2, "390 nm follows 400 nm"),
            ("400 1\n400 2\n", 2, "must increase"),
            ("400 1\n500\n", 2, "no value"),
            ("400 1\n500 1e99", 2, "not a finite number"),
        ] {
            match parse_spd(text).unwrap_err() {
                Error::SpectrumFile { line: l, reason } => {
                    assert_eq!(l, line, "{text:?}: {reason}");
                    assert!(reason.contains(what), "{text:?}: {reason}");
                }
                e => panic!("{e}"),
            }
        }
        let long = "x".repeat(100_000);
        assert!(parse_spd(&long).unwrap_err().to_string().chars().count() < 100);
    }

    #[test]
    #[expect(clippy::print_stdout, reason = "says that it was skipped")]
    fn measured_files_agree_with_the_tables_of_the_same_metals() {
        let dir = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/assets/spectra");
        for metal in ["Ag", "Al", "Au", "Cu"] {
            for part in ["eta", "k"] {
                let Ok(text) = std::fs::read_to_string(format!("{dir}/{metal}.{part}.spd")) else {
                    println!("skipped: no {metal}.{part}.spd");
                    continue;
                };
                let file = parse_spd(&text).unwrap();
                let table = super::super::named(&format!("metal-{metal}-{part}")).unwrap();
                for l in [400.0, 500.0, 600.0, 700.0, 800.0] {
                    assert!((file.eval(l) - table.eval(l)).abs() < 1e-3 * table.eval(l), "{metal} {part} {l}");
                }
            }
        }
    }
}
