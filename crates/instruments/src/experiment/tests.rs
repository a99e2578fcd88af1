//! Laws of all experiments.

use super::*;
use rayon::prelude::*;

fn strings(given: &[(&str, &str)]) -> Vec<(String, String)> {
    given.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect()
}

fn all() -> impl Iterator<Item = &'static Experiment> {
    FAMILIES.iter().flat_map(|f| f.2)
}

fn picture() -> Picture {
    Picture::from_fn(24, 16, |x, y| [x as f32 / 23.0, y as f32 / 15.0, 0.3])
}

/// Runs with the defaults: numbers are finite, curves have points, charts and tables are written, pictures are finite
/// and not negative.
#[test]
fn every_experiment_runs_with_its_defaults() {
    for e in all() {
        let picture = picture();
        let report =
            e.run(&[], e.needs_picture().then_some(&picture)).unwrap_or_else(|why| panic!("{}: {why}", e.name));
        assert!(!report.quantities.is_empty(), "{}", e.name);
        for q in &report.quantities {
            assert!(q.value.is_finite(), "{}: {} is {}", e.name, q.name, q.value);
        }
        if let Some(chart) = &report.chart {
            let svg = chart.svg();
            assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n") && !svg.contains("NaN"), "{}", e.name);
            assert!(
                chart.table().lines().count() > 2 && chart.series.iter().all(|s| !s.points.is_empty()),
                "{}",
                e.name
            );
        }
        if let Some(image) = &report.picture {
            for c in image.channels() {
                assert!(c.data.iter().all(|v| v.is_finite() && *v >= 0.0), "{}: {}", e.name, c.name);
            }
            assert!(image.channels().iter().any(|c| c.data.iter().any(|v| *v > 0.0)), "{} is black", e.name);
        }
        assert!(report.chart.is_some() || report.picture.is_some(), "{}", e.name);
    }
}

/// The ends of every range and every choice: a report or a message, never a panic, and no number that is not one.
/// Counts are kept small.
#[test]
fn every_end_of_every_range_is_answered() {
    all().collect::<Vec<_>>().into_par_iter().for_each(|e| {
        let picture = picture();
        let quick: Vec<(&str, &str)> = e
            .parameters
            .iter()
            .filter_map(|p| match p.name {
                "samples" | "points" | "pixels" | "estimates" => Some((p.name, "64")),
                "resolution" => Some((p.name, "256")),
                "size" if matches!(p.kind, Kind::Count { .. }) => Some((p.name, "64")),
                _ => None,
            })
            .collect();
        for p in e.parameters {
            let ends: Vec<String> = match p.kind {
                Kind::Number { min, max, .. } => vec![min.to_string(), max.to_string()],
                Kind::Count { min, max, .. } => vec![min.to_string(), max.min(256).max(min).to_string()],
                Kind::Name(names) => names.iter().map(|n| (*n).to_owned()).collect(),
            };
            for end in ends {
                let mut given = strings(&quick);
                given.push((p.name.to_owned(), end.clone()));
                match e.run(&given, e.needs_picture().then_some(&picture)) {
                    Err(Error::Impossible(why)) => assert!(why.len() > 20, "{} {}={end}: {why}", e.name, p.name),
                    Err(other) => panic!("{} {}={end}: {other}", e.name, p.name),
                    Ok(report) => {
                        for q in &report.quantities {
                            assert!(!q.value.is_nan(), "{} {}={end}: {}", e.name, p.name, q.name);
                        }
                        if let Some(chart) = &report.chart {
                            assert!(!chart.svg().contains("NaN"), "{} {}={end}", e.name, p.name);
                        }
                        if let Some(image) = &report.picture {
                            let is_sound = image.channels().iter().all(|c| c.data.iter().all(|v| v.is_finite()));
                            assert!(is_sound, "{} {}={end}", e.name, p.name);
                        }
                    }
                }
            }
        }
    });
}

#[test]
fn what_is_wrong_is_told() {
    let slits = find("optics", "slits").unwrap();
    let message = |given: &[(&str, &str)]| slits.run(&strings(given), None).unwrap_err().to_string();
    assert_eq!(message(&[("widht", "3")]), "'slits' has no parameter 'widht'; did you mean 'width'?");
    assert_eq!(message(&[("wavelength", "-5")]), "parameter 'wavelength': '-5' is not a number from 1 to 1000000 (nm)");
    assert_eq!(message(&[("count", "2.5")]), "parameter 'count': '2.5' is not a whole number from 1 to 1000");
    assert_eq!(message(&[("light", "blue")]), "parameter 'light': 'blue' is not one of line|white");
    assert!(message(&[("width", "NaN")]).contains("is not a number"));
    assert!(find("optics", "cones").is_none());
    let cones = find("vision", "cones").unwrap();
    assert!(cones.run(&[], None).unwrap_err().to_string().contains("needs a picture"));
    assert!(slits.run(&[], Some(&picture())).unwrap_err().to_string().contains("takes no picture"));
}

/// Names are unique in a family, defaults lie in their ranges, and every parameter is documented.
#[test]
fn registries_are_sound() {
    for (family, _, experiments) in FAMILIES {
        for (k, e) in experiments.iter().enumerate() {
            assert!(experiments[..k].iter().all(|o| o.name != e.name), "{family} {}", e.name);
            assert!(!e.doc.is_empty() && !e.source.is_empty());
            for p in e.parameters {
                assert!(!p.doc.is_empty());
                let given = strings(&[(p.name, &p.default_text())]);
                assert!(Values::resolve(e, &given).is_ok(), "{} {}", e.name, p.name);
            }
        }
    }
}

/// In every chart all text stays within the picture, and the legend is below the axes, where no curve is.
#[test]
fn charts_are_not_cut_off_and_legends_cover_nothing() {
    // A letter of DejaVu Sans is 0.55 of the size of the letters on average.
    const LETTER: f64 = 0.55 * 15.0;
    for e in FAMILIES.iter().flat_map(|f| f.2).filter(|e| !e.needs_picture()) {
        let Some(chart) = e.run(&[], None).unwrap().chart else { continue };
        let svg = chart.svg();
        let number = |tag: &str, name: &str| -> Option<f64> {
            tag.split(&format!(" {name}=\"")).nth(1)?.split('"').next()?.parse().ok()
        };
        let height = number(&svg, "height").unwrap();
        let clip = svg.split("<clipPath").nth(1).unwrap();
        let bottom = number(clip, "y").unwrap() + number(clip, "height").unwrap();
        let mut legend = 0;
        for tag in svg.split("<text").skip(1) {
            let (x, y) = (number(tag, "x").unwrap(), number(tag, "y").unwrap());
            let text = tag.split('>').nth(1).unwrap().split('<').next().unwrap();
            let length = LETTER * text.chars().count() as f64;
            let left = match () {
                () if tag.contains("text-anchor=\"end\"") => x - length,
                () if tag.contains("text-anchor=\"middle\"") => x - 0.5 * length,
                () => x,
            };
            assert!(left >= -4.0 && left + length <= 604.0 && y >= 15.0 && y <= height - 2.0, "{}: {tag}", e.name);
            legend += usize::from(y > bottom + 50.0 && !tag.contains("text-anchor"));
        }
        let named = chart.series.iter().filter(|s| !s.name.is_empty()).count();
        assert!(legend == if named > 1 { named.min(16) } else { 0 }, "{}: {legend} of {named}", e.name);
    }
}
