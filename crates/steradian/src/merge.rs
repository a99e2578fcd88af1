//! One picture of several: of renders with different seeds, as if all their samples were of one render, and of parts of
//! a frame, which are put in their places.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use steradian_image::{Image, Value, Window};

/// Reason why pictures are not merged.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MergeError {
    /// Nothing tells how much a picture counts.
    #[error("'{0}' does not tell its samples per pixel (samplesPerPixel), by which parts are weighed")]
    NoSamples(String),
    /// Pictures of different things.
    #[error("'{a}' and '{b}' differ in {what}")]
    Different {
        /// Names of the pictures.
        a: String,
        /// The other one.
        b: String,
        /// In words, with both values.
        what: String,
    },
    /// Two pictures of one seed.
    #[error("'{a}' and '{b}' have the same seed ({seed}): their samples are the same")]
    SameSeed {
        /// Names of the pictures.
        a: String,
        /// The other one.
        b: String,
        /// Their seed.
        seed: String,
    },
    /// Parts of a frame that are neither alike nor apart.
    #[error("'{a}' and '{b}' overlap in part; parts of a frame are of the same pixels, or share none")]
    Overlap {
        /// Names of the pictures.
        a: String,
        /// The other one.
        b: String,
    },
    /// Pixels that no part has.
    #[error("the parts leave gaps: they have {have} of the {all} pixels of the rectangle about them")]
    Gap {
        /// Pixels that are there.
        have: u64,
        /// Pixels that the picture would have.
        all: u64,
    },
    /// Layers that cannot be made.
    #[error(transparent)]
    Image(#[from] steradian_image::Error),
}

/// A picture with its name in messages.
pub type Part = (String, Image);

/// Metadata in which parts must agree, and what they are called in messages.
const ALIKE: [(&str, &str); 6] = [
    ("steradian:scene", "the scene"),
    ("steradian:integrator", "the integrator"),
    ("steradian:color", "the colour arithmetic"),
    ("Software", "the program"),
    ("worldToCamera", "the camera"),
    ("whiteLuminance", "the exposure"),
];
const SAMPLES: &str = "samplesPerPixel";
const SEED: &str = "steradian:seed";
const SECONDS: &str = "renderTimeSeconds";
/// Metadata of a part that a whole does not have.
const OF_PARTS: [&str; 2] = ["steradian:relative_error", "steradian:unreliable"];

/// Merges pictures: those of the same pixels are averaged by their samples, and what comes of these is put in its
/// place in the frame.
///
/// # Errors
/// Which pictures do not go together, and why.
pub fn merge(parts: Vec<Part>) -> Result<Image, MergeError> {
    let Some((first, rest)) = parts.split_first() else { return Ok(Image::default()) };
    rest.iter().try_for_each(|part| check(first, part))?;
    let seconds: f64 = parts.iter().filter_map(|(_, image)| number(image, SECONDS)).sum();
    // Pictures of the same pixels, in the order of these.
    let mut places: BTreeMap<[i32; 2], Vec<Part>> = BTreeMap::new();
    for (name, image) in parts {
        let at = [image.offset[1], image.offset[0]];
        let there = places.entry(at).or_default();
        if let Some((other, same)) = there.first()
            && (same.width(), same.height()) != (image.width(), image.height())
        {
            return Err(MergeError::Overlap { a: other.clone(), b: name });
        }
        there.push((name, image));
    }
    let tiles = places.into_values().map(mean).collect::<Result<Vec<Part>, _>>()?;
    let mut image = assembled(tiles)?;
    image.metadata.set(SECONDS, Value::Float(seconds as f32));
    image
        .metadata
        .entries
        .retain(|(name, _)| !OF_PARTS.contains(&name.as_str()) && !name.starts_with("steradian:error_scale"));
    Ok(image)
}

/// Refuses pictures of different scenes, programs, frames or layers.
fn check((a, first): &Part, (b, other): &Part) -> Result<(), MergeError> {
    let different = |what: String| MergeError::Different { a: a.clone(), b: b.clone(), what };
    for (name, called) in ALIKE {
        let (ours, theirs) = (first.metadata.get(name), other.metadata.get(name));
        if ours != theirs {
            return Err(different(match (ours, theirs) {
                (Some(Value::Text(ours)), Some(Value::Text(theirs))) => format!("{called}: {ours}, {theirs}"),
                _ => called.to_owned(),
            }));
        }
    }
    let [ours, theirs] = [first, other].map(frame_of);
    if ours != theirs {
        let shown = |w: Window| format!("{} x {}", w.max[0] - w.min[0], w.max[1] - w.min[1]);
        return Err(different(format!("the size of the frame: {}, {}", shown(ours), shown(theirs))));
    }
    let names = |image: &Image| image.channels().iter().map(|c| c.name.clone()).collect::<BTreeSet<_>>();
    let (ours, theirs) = (names(first), names(other));
    match ours.symmetric_difference(&theirs).next() {
        Some(channel) => Err(different(format!("their layers: only one has '{channel}'"))),
        None => Ok(()),
    }
}

/// The whole frame of which a picture shows a part, or all.
fn frame_of(image: &Image) -> Window {
    let max = |i: usize, length: usize| image.offset[i].saturating_add(length as i32);
    let own = Window { min: image.offset, max: [max(0, image.width()), max(1, image.height())] };
    image.frame.unwrap_or(own)
}

fn number(image: &Image, name: &str) -> Option<f64> {
    match image.metadata.get(name)? {
        Value::Int(value) => Some(f64::from(*value)),
        Value::Float(value) => Some(f64::from(*value)),
        _ => None,
    }
}

/// The mean of pictures of the same pixels, by their samples. One alone stays as it is.
fn mean(parts: Vec<Part>) -> Result<Part, MergeError> {
    let samples = |(name, image): &Part| {
        let samples = number(image, SAMPLES).filter(|n| *n > 0.0 && n.is_finite());
        samples.ok_or_else(|| MergeError::NoSamples(name.clone()))
    };
    let counts = parts.iter().map(samples).collect::<Result<Vec<f64>, _>>()?;
    if let [_] = &*parts {
        return Ok(parts.into_iter().next().unwrap_or_default());
    }
    let mut seeds: HashMap<String, &str> = HashMap::new();
    for (name, image) in &parts {
        let Some(seed) = image.metadata.get(SEED).map(|seed| format!("{seed:?}")) else { continue };
        if let Some(other) = seeds.insert(seed, name) {
            let seed = number(image, SEED).map(|seed| seed.to_string()).unwrap_or_default();
            return Err(MergeError::SameSeed { a: other.into(), b: name.clone(), seed });
        }
    }
    let (name, first) = &parts[0];
    let mut image = Image::new(first.width(), first.height());
    (image.offset, image.frame, image.metadata) = (first.offset, first.frame, first.metadata.clone());
    // Samples of each pixel of each part, where they are told.
    let weights: Vec<Vec<f64>> = parts
        .iter()
        .zip(&counts)
        .map(|((_, part), count)| match part.channel("samples.Y") {
            Some(samples) => samples.iter().map(|n| f64::from(*n)).collect(),
            None => vec![*count; part.pixel_count()],
        })
        .collect();
    let mattes = mattes(&parts, &weights);
    for channel in first.channels() {
        let planes: Vec<&[f32]> = parts.iter().filter_map(|(_, part)| part.channel(&channel.name)).collect();
        let of_pixel = |at: usize| planes.iter().zip(&weights).map(move |(plane, w)| (f64::from(plane[at]), w[at]));
        let value: Box<dyn Fn(usize) -> f64> = match &*channel.name {
            name if mattes.contains_key(name) => {
                let plane = &mattes[name];
                Box::new(|at| f64::from(plane[at]))
            }
            "samples.Y" => Box::new(|at| of_pixel(at).map(|(n, _)| n).sum()),
            // Numbers of things have no mean.
            "object_id.Y" | "material_id.Y" => Box::new(|at| f64::from(planes[0][at])),
            // Variance of a weighted mean: ∑ w² v / (∑ w)².
            name if name.starts_with("variance.") => Box::new(|at| {
                let sum: f64 = of_pixel(at).map(|(_, w)| w).sum();
                of_pixel(at).map(|(v, w)| w * w * v).sum::<f64>() / (sum * sum).max(f64::MIN_POSITIVE)
            }),
            // Distances are those of what is hit, and infinite where nothing is.
            _ => Box::new(|at| {
                let finite = || of_pixel(at).filter(|(v, w)| v.is_finite() && *w > 0.0);
                let sum: f64 = finite().map(|(_, w)| w).sum();
                if sum > 0.0 { finite().map(|(v, w)| v * w).sum::<f64>() / sum } else { f64::from(planes[0][at]) }
            }),
        };
        let data = (0..image.pixel_count()).map(|at| value(at) as f32).collect();
        drop(value);
        image.push(channel.name.clone(), data)?;
    }
    let total: f64 = counts.iter().sum();
    let is_whole = total.fract() == 0.0 && total <= f64::from(i32::MAX);
    image.metadata.set(SAMPLES, if is_whole { Value::Int(total as i32) } else { Value::Float(total as f32) });
    let seeds = parts.iter().filter_map(|(_, part)| number(part, SEED)).map(|seed| seed.to_string());
    image.metadata.set_text("steradian:seeds", seeds.collect::<Vec<_>>().join(" "));
    Ok((name.clone(), image))
}

/// Planes of Cryptomatte: coverages of an id are averaged, and ranked anew.
fn mattes(parts: &[Part], weights: &[Vec<f64>]) -> HashMap<String, Vec<f32>> {
    let first = &parts[0].1;
    let is_matte = |name: &str| name.starts_with("crypto") && name.ends_with("00.r");
    let layers = first.channels().iter().filter(|c| is_matte(&c.name)).map(|c| c.name.trim_end_matches("00.r"));
    let mut planes = HashMap::new();
    for layer in layers {
        // Channels of ids and of coverages, rank by rank.
        let ranks = (0..100_usize).map(|rank| {
            let [id, coverage] = [["r", "g"], ["b", "a"]][rank % 2];
            [id, coverage].map(|channel| format!("{layer}{:02}.{channel}", rank / 2))
        });
        let ranks: Vec<[String; 2]> =
            ranks.take_while(|names| names.iter().all(|name| first.channel(name).is_some())).collect();
        let mut merged = vec![[vec![0.0; first.pixel_count()], vec![0.0; first.pixel_count()]]; ranks.len()];
        for at in 0..first.pixel_count() {
            let mut covered: BTreeMap<u32, f64> = BTreeMap::new();
            let total: f64 = weights.iter().map(|w| w[at]).sum();
            for ((_, part), weight) in parts.iter().zip(weights) {
                for [id, coverage] in &ranks {
                    let value = |name: &str| part.channel(name).map_or(0.0, |plane| plane[at]);
                    let (id, coverage) = (value(id), f64::from(value(coverage)));
                    if coverage > 0.0 {
                        *covered.entry(id.to_bits()).or_default() += coverage * weight[at] / total;
                    }
                }
            }
            let mut sorted: Vec<(u32, f64)> = covered.into_iter().collect();
            sorted.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
            for (plane, (id, coverage)) in merged.iter_mut().zip(sorted) {
                (plane[0][at], plane[1][at]) = (f32::from_bits(id), coverage as f32);
            }
        }
        planes.extend(ranks.into_iter().flatten().zip(merged.into_iter().flatten()));
    }
    planes
}

/// Puts parts of a frame, none of which is of the same pixels as another, in their places.
fn assembled(parts: Vec<Part>) -> Result<Image, MergeError> {
    let (_, first) = &parts[0];
    if let [_] = &*parts {
        return Ok(parts.into_iter().next().unwrap_or_default().1);
    }
    let begin = |image: &Image| image.offset.map(i64::from);
    let end = |image: &Image| {
        let [x, y] = begin(image);
        [x + image.width() as i64, y + image.height() as i64]
    };
    for (k, (a, one)) in parts.iter().enumerate() {
        for (b, other) in &parts[k + 1..] {
            if (0..2).all(|i| begin(one)[i] < end(other)[i] && begin(other)[i] < end(one)[i]) {
                return Err(MergeError::Overlap { a: a.clone(), b: b.clone() });
            }
        }
    }
    // Parts that do not overlap leave no gap if they have as many pixels as the rectangle about them.
    let min = [0, 1].map(|i| parts.iter().map(|(_, part)| part.offset[i]).min().unwrap_or(0));
    let [width, height] = [0, 1].map(|i| {
        let max = parts.iter().map(|(_, part)| end(part)[i]).max().unwrap_or(0);
        (max - i64::from(min[i])) as u64
    });
    let (have, all) = (parts.iter().map(|(_, part)| part.pixel_count() as u64).sum(), width.saturating_mul(height));
    if have != all {
        return Err(MergeError::Gap { have, all });
    }
    let (width, height) = (width as usize, height as usize);
    let frame = frame_of(first);
    let mut whole = Image::new(width, height);
    whole.metadata = first.metadata.clone();
    whole.offset = min;
    let max = [min[0].saturating_add(width as i32), min[1].saturating_add(height as i32)];
    whole.frame = (frame != Window { min, max }).then_some(frame);
    for channel in first.channels() {
        let mut plane = vec![0.0; width * height];
        for (_, part) in &parts {
            let Some(values) = part.channel(&channel.name) else { continue };
            for (row, values) in values.chunks(part.width().max(1)).enumerate() {
                let begin = (part.offset[1] - min[1]) as usize + row;
                let begin = begin * width + (part.offset[0] - min[0]) as usize;
                plane[begin..begin + values.len()].copy_from_slice(values);
            }
        }
        whole.push(channel.name.clone(), plane)?;
    }
    Ok(whole)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(seed: i32, samples: i32, value: f32) -> Part {
        let mut image = Image::from_rgb(2, 1, &[[value; 3]; 2]).unwrap();
        for (name, plane) in [
            ("variance.R", [value, 0.0]),
            ("Z", [value, f32::INFINITY]),
            ("object_id.Y", [7.0, 0.0]),
            ("crypto_object00.r", [5.0, 0.0]),
            ("crypto_object00.g", [0.75, 0.0]),
            ("crypto_object00.b", [6.0, 0.0]),
            ("crypto_object00.a", [0.25, 0.0]),
        ] {
            image.push(name, plane.to_vec()).unwrap();
        }
        image.metadata.set(SEED, Value::Int(seed));
        image.metadata.set(SAMPLES, Value::Int(samples));
        image.metadata.set_text("steradian:scene", "a.xml");
        (format!("{seed}.exr"), image)
    }

    /// Means are weighed by samples: 1 with 3 of them and 5 with 1 make 2, whose variance is (9 + 5) / 16.
    #[test]
    fn seeds_are_averaged_by_their_samples() {
        let (mut a, b) = (picture(1, 3, 1.0), picture(2, 1, 5.0));
        // The second thing covers most of the first picture.
        for (name, value) in [("crypto_object00.g", 0.0), ("crypto_object00.a", 1.0)] {
            a.1.channel_mut(name).unwrap()[0] = value;
        }
        let merged = merge(vec![a.clone(), b.clone()]).unwrap();
        let at = |name: &str| merged.channel(name).unwrap()[0];
        assert_eq!([at("R"), at("variance.R"), at("Z"), at("object_id.Y")], [2.0, 14.0 / 16.0, 2.0, 7.0]);
        assert_eq!(merged.channel("Z").unwrap()[1], f32::INFINITY);
        let ranks = ["r", "g", "b", "a"].map(|c| at(&format!("crypto_object00.{c}")));
        assert_eq!(ranks, [6.0, 0.8125, 5.0, 0.1875]);
        assert_eq!(merged.metadata.get(SAMPLES), Some(&Value::Int(4)));
        assert_eq!(merged.metadata.get("steradian:seeds"), Some(&Value::Text("1 2".into())));
        // Order of the parts is of no account.
        let back = merge(vec![b, a]).unwrap();
        assert!(merged.channels().iter().zip(back.channels()).all(|(a, b)| a == b));
    }

    /// Samples of single pixels count where they are told.
    #[test]
    fn pixels_are_weighed_one_by_one() {
        let parts = [(1, [3.0, 0.0], 1.0), (2, [1.0, 2.0], 5.0)].map(|(seed, samples, value)| {
            let mut part = picture(seed, 2, value);
            part.1.push("samples.Y", samples.to_vec()).unwrap();
            part
        });
        let merged = merge(parts.into()).unwrap();
        assert_eq!(merged.channel("R").unwrap(), [2.0, 5.0]);
        assert_eq!(merged.channel("samples.Y").unwrap(), [4.0, 2.0]);
    }

    fn part(name: &str, offset: [i32; 2], width: usize) -> Part {
        let (_, mut image) = picture(1, 4, 0.0);
        let row = (0..width).map(|x| [offset[0].wrapping_add(x as i32) as f32, offset[1] as f32, 0.0]);
        let metadata = image.metadata.clone();
        image = Image::from_rgb(width, 1, &row.collect::<Vec<_>>()).unwrap();
        (image.metadata, image.offset) = (metadata, offset);
        image.frame = Some(Window { min: [0, 0], max: [5, 2] });
        (name.into(), image)
    }

    /// Parts of a frame come to their places, in whichever order they are given.
    #[test]
    fn crops_are_put_in_their_places() {
        let whole = merge(vec![part("b", [2, 0], 3), part("c", [0, 1], 5), part("a", [0, 0], 2)]).unwrap();
        assert_eq!((whole.width(), whole.height(), whole.frame), (5, 2, None));
        for at in 0..10 {
            let [x, y] = ["R", "G"].map(|c| whole.channel(c).unwrap()[at]);
            assert_eq!((x as usize, y as usize), (at % 5, at / 5));
        }
        let row = merge(vec![part("b", [2, 0], 3), part("a", [0, 0], 2)]).unwrap();
        assert_eq!((row.height(), row.frame.map(|f| f.max)), (1, Some([5, 2])));
    }

    #[test]
    fn what_does_not_go_together_is_refused_by_name() {
        let refused = |parts: Vec<Part>| merge(parts).unwrap_err().to_string();
        let changed = |change: fn(&mut Image)| {
            let mut other = picture(2, 4, 1.0);
            change(&mut other.1);
            refused(vec![picture(1, 4, 1.0), other])
        };
        assert!(changed(|i| i.metadata.set_text("steradian:scene", "b.xml")).contains("the scene: a.xml, b.xml"));
        assert!(changed(|i| i.metadata.set(SEED, Value::Int(1))).contains("the same seed (1)"));
        assert!(changed(|i| i.metadata.entries.retain(|e| e.0 != SAMPLES)).contains("'2.exr' does not tell"));
        assert!(changed(|i| i.push("extra", vec![0.0; 2]).unwrap()).contains("'extra'"));
        assert!(changed(|i| i.frame = Some(Window { min: [0, 0], max: [9, 9] })).contains("2 x 1, 9 x 9"));
        assert!(refused(vec![part("a", [0, 0], 3), part("b", [2, 0], 3)]).contains("overlap"));
        assert!(refused(vec![part("a", [0, 0], 3), part("b", [0, 0], 5)]).contains("overlap"));
        assert!(refused(vec![part("a", [0, 0], 2), part("b", [3, 0], 2)]).contains("4 of the 5 pixels"));
        let far = [i32::MIN, i32::MAX].map(|x| part("far", [x, x], 2));
        assert!(refused(far.into()).contains("gaps"));
    }
}
