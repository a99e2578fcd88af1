//! The text of attribute values: numbers, vectors, colours, spectra.

use steradian_math::Transform;
use steradian_scene::SpectrumValue;

/// Splits at commas and white space, as Mitsuba does.
pub(super) fn tokens(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| c == ',' || c.is_ascii_whitespace()).filter(|t| !t.is_empty())
}

/// A finite number, or what is wrong with it.
pub(super) fn number(text: &str) -> Result<f64, String> {
    let trimmed = text.trim();
    let unsigned = trimmed.strip_prefix('+').unwrap_or(trimmed);
    match fast_float2::parse::<f64, _>(unsigned) {
        Ok(v) if v.is_finite() => Ok(v),
        Ok(_) => Err(format!("'{trimmed}' is not a finite number")),
        Err(_) => Err(format!("'{trimmed}' is not a number")),
    }
}

/// A list of numbers separated by commas or spaces.
pub(super) fn numbers(text: &str) -> Result<Vec<f64>, String> {
    tokens(text).map(number).collect()
}

/// A whole number.
pub(super) fn integer(text: &str) -> Result<i64, String> {
    text.trim().parse().map_err(|_| format!("'{}' is not a whole number", text.trim()))
}

/// `true` or `false` in any case.
pub(super) fn boolean(text: &str) -> Result<bool, String> {
    match text.trim() {
        t if t.eq_ignore_ascii_case("true") => Ok(true),
        t if t.eq_ignore_ascii_case("false") => Ok(false),
        t => Err(format!("'{t}' is neither 'true' nor 'false'")),
    }
}

/// Three numbers, or one that stands for all three.
pub(super) fn triple(text: &str) -> Result<[f64; 3], String> {
    match numbers(text)?[..] {
        [v] => Ok([v; 3]),
        [x, y, z] => Ok([x, y, z]),
        ref other => Err(format!("one or three numbers are needed, not {}", other.len())),
    }
}

/// Linear colour components: one or three numbers, or `#rrggbb` in 255ths.
pub(super) fn rgb(text: &str) -> Result<[f64; 3], String> {
    let Some(hex) = text.trim().strip_prefix('#') else { return triple(text) };
    let bad = || format!("'#{hex}' is not a colour of the form #rrggbb");
    if hex.len() != 6 || !hex.is_ascii() {
        return Err(bad());
    }
    let byte = |i: usize| u8::from_str_radix(&hex[i..i + 2], 16).map(|v| f64::from(v) / 255.0).map_err(|_| bad());
    Ok([byte(0)?, byte(2)?, byte(4)?])
}

/// The linear value of an sRGB-encoded component (IEC 61966-2-1).
pub(super) fn srgb_to_linear(v: f64) -> f64 {
    if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

/// A spectrum from pairs of wavelength and value.
pub(super) fn sampled(pairs: &[(f64, f64)]) -> Result<SpectrumValue, String> {
    if pairs.len() < 2 {
        return Err("a sampled spectrum needs at least two wavelengths".into());
    }
    let lambdas: Vec<f32> = pairs.iter().map(|p| p.0 as f32).collect();
    let values: Vec<f32> = pairs.iter().map(|p| p.1 as f32).collect();
    if let Some(i) = lambdas.windows(2).position(|w| w[0] >= w[1]) {
        return Err(format!("wavelengths must increase, but {} follows {}", pairs[i + 1].0, pairs[i].0));
    }
    if lambdas.iter().chain(&values).any(|v| !v.is_finite()) {
        return Err("a value of the spectrum is out of range".into());
    }
    Ok(SpectrumValue::Sampled { lambdas, values })
}

/// A spectrum in an attribute: one number, or `wavelength:value` pairs. Before version 2 three bare numbers are a
/// colour.
pub(super) fn spectrum(text: &str, legacy: bool) -> Result<SpectrumValue, String> {
    if legacy && text.trim().starts_with('#') {
        return Ok(SpectrumValue::Rgb(rgb(text)?, Default::default()));
    }
    if !text.contains(':') {
        return match numbers(text)?[..] {
            [v] => Ok(SpectrumValue::Constant(v)),
            [r, g, b] if legacy => Ok(SpectrumValue::Rgb([r, g, b], Default::default())),
            ref other => Err(format!("one number or wavelength:value pairs are needed, not {} numbers", other.len())),
        };
    }
    let pair = |t: &str| match t.split_once(':') {
        Some((l, v)) => Ok((number(l)?, number(v)?)),
        None => Err(format!("'{t}' is not a wavelength:value pair")),
    };
    sampled(&tokens(text).map(pair).collect::<Result<Vec<_>, _>>()?)
}

/// A spectrum in a file: two columns, `#` starts a comment. Faults name the line.
pub(super) fn spectrum_file(text: &str) -> Result<SpectrumValue, String> {
    let mut pairs = Vec::new();
    for (i, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default();
        let values = numbers(line).map_err(|e| format!("line {}: {e}", i + 1))?;
        match values[..] {
            [] => {}
            [lambda, value] => pairs.push((lambda, value)),
            _ => return Err(format!("line {}: a wavelength and a value are needed", i + 1)),
        }
    }
    sampled(&pairs)
}

/// Planck's law in W/(m² sr nm) at a temperature in kelvin, every 5 nm of a range of wavelengths.
pub(super) fn blackbody(temperature: f64, range: [f64; 2], scale: f64) -> Result<SpectrumValue, String> {
    const C: f64 = 299_792_458.0;
    const H: f64 = 6.626_070_15e-34;
    const K: f64 = 1.380_649e-23;
    if temperature <= 0.0 || range[0] <= 0.0 || range[1] <= range[0] || range[1] - range[0] > 1e5 {
        return Err("a black body needs a temperature above zero and a range of wavelengths".into());
    }
    let steps = ((range[1] - range[0]) / 5.0).ceil().max(1.0) as usize;
    let radiance = |nm: f64| {
        let lambda = nm * 1e-9;
        let exponent = H * C / (lambda * K * temperature);
        scale * 1e-9 * 2.0 * H * C * C / (lambda.powi(5) * exponent.exp_m1())
    };
    let lambda = |i: usize| range[0] + (range[1] - range[0]) * i as f64 / steps as f64;
    sampled(&(0..=steps).map(|i| (lambda(i), radiance(lambda(i)))).collect::<Vec<_>>())
}

/// An affine transform from 16 numbers row by row, or 9 of its linear part.
pub(super) fn matrix(text: &str) -> Result<Transform, String> {
    let m = numbers(text)?;
    let rows: [f64; 16] = match m[..] {
        [a, b, c, d, e, f, g, h, i] => [a, b, c, 0.0, d, e, f, 0.0, g, h, i, 0.0, 0.0, 0.0, 0.0, 1.0],
        ref m => m.try_into().map_err(|_| format!("a matrix has 9 or 16 numbers, not {}", m.len()))?,
    };
    if rows[12..15] != [0.0; 3] || rows[15] == 0.0 {
        return Err("the last row of the matrix is not '0 0 0 1': it is not affine".into());
    }
    Ok(Transform::from_rows(rows.map(|v| v / rows[15])))
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::DVec3;

    #[test]
    fn numbers_are_finite_or_refused() {
        assert_eq!(number(" +1.5e2 "), Ok(150.0));
        assert_eq!(number(".5"), Ok(0.5));
        for bad in ["nan", "inf", "-infinity", "1e999", "", "1,5", "0x10", "1.2.3"] {
            assert!(number(bad).is_err(), "{bad}");
        }
        assert!(integer("3.0").is_err());
        assert_eq!(boolean("True"), Ok(true));
    }

    #[test]
    fn triples_and_colours() {
        assert_eq!(triple("1, 2,3"), Ok([1.0, 2.0, 3.0]));
        assert_eq!(triple("4"), Ok([4.0; 3]));
        assert!(triple("1 2").is_err());
        assert_eq!(rgb("#ff0033"), Ok([1.0, 0.0, 0.2]));
        assert!(rgb("#ff00é3").is_err());
        assert!(rgb("#ff003").is_err());
    }

    #[test]
    fn spectra_in_all_spellings() {
        assert_eq!(spectrum("0.5", false), Ok(SpectrumValue::Constant(0.5)));
        let pairs = SpectrumValue::Sampled { lambdas: vec![400.0, 700.0], values: vec![0.25, 1.0] };
        assert_eq!(spectrum("400:0.25, 700:1", false), Ok(pairs.clone()));
        assert_eq!(spectrum_file("# comment\n400 0.25\n\n700, 1 # end\n"), Ok(pairs));
        assert!(spectrum("700:1, 400:2", false).is_err());
        assert!(spectrum("1 2 3", false).is_err());
        assert_eq!(spectrum("1 2 3", true), Ok(SpectrumValue::Rgb([1.0, 2.0, 3.0], Default::default())));
        assert!(spectrum_file("400\n").unwrap_err().starts_with("line 1"));
    }

    #[test]
    fn planck_has_its_known_value() {
        // B(500 nm, 5777 K) = 2.6378e13 W/(m² sr m)
        let SpectrumValue::Sampled { lambdas, values } = blackbody(5777.0, [400.0, 600.0], 1.0).unwrap() else {
            panic!()
        };
        let i = lambdas.iter().position(|&l| l == 500.0).unwrap();
        assert!((values[i] / 2.6378e4 - 1.0).abs() < 2e-3, "{}", values[i]);
    }

    #[test]
    fn matrices_are_affine() {
        let m = matrix("2 0 0 1  0 2 0 2  0 0 2 3  0 0 0 2").unwrap();
        assert_eq!(m.matrix.w_axis.truncate(), DVec3::new(0.5, 1.0, 1.5));
        assert!(matrix("1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1").is_err());
        assert!(matrix("1 2 3").is_err());
        assert_eq!(matrix("1 2 3 4 5 6 7 8 9").unwrap().matrix.y_axis.truncate(), DVec3::new(2.0, 5.0, 8.0));
    }
}
