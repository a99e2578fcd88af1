//! Choice of a picture's colour channels, by their names.
//!
//! Channels of a layer are named `layer.R`; layers may be nested (`View.Combined.R`), and some programs write a dot
//! before names without a layer (`.R`) or small letters.

/// The suffixes of red, green, blue and alpha.
const SUFFIXES: [[&str; 4]; 2] = [["R", "G", "B", "A"], ["r", "g", "b", "a"]];

/// Names of layers that hold the whole picture.
const BEAUTY: [&str; 8] = ["", "rgba", "rgb", "combined", "beauty", "color", "colour", "composite"];

/// Names of layers that hold no colours, though their channels may be called R, G, B.
const DATA: [&str; 20] = [
    "n",
    "normal",
    "normals",
    "ns",
    "ng",
    "p",
    "position",
    "pos",
    "uv",
    "st",
    "motion",
    "motionvector",
    "vector",
    "velocity",
    "id",
    "objectid",
    "object_id",
    "depth",
    "z",
    "index",
];

/// The last part of a layer's name, in small letters.
fn last_part(layer: &str) -> String {
    layer.trim_end_matches('.').rsplit('.').next().unwrap_or_default().to_ascii_lowercase()
}

fn is_data(layer: &str) -> bool {
    let name = last_part(layer);
    DATA.contains(&name.as_str()) || name.starts_with("crypto")
}

/// A layer that has red, green and blue.
struct Layer<'a> {
    /// Prefix of its channels' names: empty, or with a dot at its end.
    prefix: &'a str,
    /// Red, green and blue.
    rgb: [usize; 3],
    alpha: Option<usize>,
}

impl Layer<'_> {
    /// The place among layers of which one is chosen; the least is.
    fn rank(&self) -> (u8, bool) {
        let name = last_part(self.prefix);
        let kind = match name.as_str() {
            _ if self.prefix.is_empty() => 0,
            name if BEAUTY.contains(&name) => 1,
            _ if is_data(self.prefix) => 3,
            _ => 2,
        };
        (kind, self.alpha.is_none())
    }
}

/// The channel `layer` + `suffix`.
fn find(names: &[&str], layer: &str, suffix: &str) -> Option<usize> {
    names.iter().position(|n| n.strip_prefix(layer).is_some_and(|rest| rest == suffix))
}

/// All layers that have red, green and blue, in the order of the channels.
fn layers<'a>(names: &[&'a str]) -> Vec<Layer<'a>> {
    let of = |name: &'a str| {
        SUFFIXES.iter().find_map(|[r, g, b, a]| {
            let prefix = name.strip_suffix(r).filter(|p| p.is_empty() || p.ends_with('.'))?;
            let channel = |suffix: &str| find(names, prefix, suffix);
            Some(Layer { prefix, rgb: [channel(r)?, channel(g)?, channel(b)?], alpha: channel(a) })
        })
    };
    names.iter().filter_map(|name| of(name)).collect()
}

/// The red, green and blue of each layer that holds colours.
pub(crate) fn groups(names: &[&str]) -> Vec<[usize; 3]> {
    layers(names).into_iter().filter(|layer| !is_data(layer.prefix)).map(|layer| layer.rgb).collect()
}

/// True if the chosen channels are the red, green and blue of a layer that holds colours.
pub(crate) fn holds_colours(names: &[&str], chosen: &[Option<usize>]) -> bool {
    chosen.len() >= 3 && groups(names).iter().any(|group| group.map(Some)[..] == chosen[..3])
}

/// Indices of the picture's colour among the named channels: `[r, g, b]`, `[r, g, b, a]`, `[y]` or `[y, a]`. `None`
/// stands for a red, green or blue that no layer has, which is zero.
pub(crate) fn channels(names: &[&str]) -> Option<Vec<Option<usize>>> {
    choice(names).map(|choice| choice.channels)
}

/// Channels chosen by [`channels`].
struct Choice<'a> {
    /// Prefix of its channels' names.
    prefix: &'a str,
    channels: Vec<Option<usize>>,
}

fn choice<'a>(names: &[&'a str]) -> Option<Choice<'a>> {
    let all = layers(names);
    let of = |layer: &Layer<'a>| {
        let channels = layer.rgb.into_iter().chain(layer.alpha).map(Some).collect();
        Choice { prefix: layer.prefix, channels }
    };
    let root = all.iter().find(|layer| layer.prefix.is_empty()).map(of);
    let only = || {
        let [name] = names else { return None };
        Some(Choice { prefix: &name[..name.rfind('.').map_or(0, |dot| dot + 1)], channels: vec![Some(0)] })
    };
    root.or_else(|| grey(names, ""))
        .or_else(only)
        .or_else(|| all.iter().min_by_key(|layer| layer.rank()).map(of))
        .or_else(|| part(names))
}

/// The luminance of a layer, and its alpha.
fn grey<'a>(names: &[&str], prefix: &'a str) -> Option<Choice<'a>> {
    // `N.Y` beside `N.X` is no luminance.
    let is_vector = find(names, prefix, "X").is_some();
    let y = find(names, prefix, "Y").filter(|_| !is_vector)?;
    Some(Choice { prefix, channels: [Some(y), find(names, prefix, "A")].into_iter().flatten().map(Some).collect() })
}

/// Choice among layers none of which has all colours: the layer that has most of red, green and blue; one with a
/// luminance counts as one that has all. The only colour of a layer is taken for grey.
fn part<'a>(names: &[&'a str]) -> Option<Choice<'a>> {
    let of = |prefix: &'a str| {
        grey(names, prefix).map(|choice| (0, choice)).or_else(|| {
            let lettered = SUFFIXES.iter().map(|[r, g, b, a]| {
                let [r, g, b, a] = [r, g, b, a].map(|suffix| find(names, prefix, suffix));
                ([r, g, b], a)
            });
            let (rgb, alpha) = lettered.max_by_key(|(rgb, _)| rgb.iter().flatten().count())?;
            let there: Vec<usize> = rgb.into_iter().flatten().collect();
            let lead = match there[..] {
                [] => return None,
                [one] => vec![Some(one)],
                _ => rgb.to_vec(),
            };
            let channels = lead.into_iter().chain(alpha.map(Some)).collect();
            Some((3 - there.len(), Choice { prefix, channels }))
        })
    };
    let found = prefixes(names).into_iter().filter(|prefix| !is_data(prefix)).filter_map(of);
    let place = |(lacks, choice): &(usize, Choice<'_>)| (*lacks, !BEAUTY.contains(&last_part(choice.prefix).as_str()));
    found.min_by_key(place).map(|(_, choice)| choice)
}

/// Name prefix of each layer, in the order of the channels.
fn prefixes<'a>(names: &[&'a str]) -> Vec<&'a str> {
    let mut prefixes: Vec<&str> = Vec::new();
    for name in names {
        let prefix = &name[..name.rfind('.').map_or(0, |dot| dot + 1)];
        if !prefixes.contains(&prefix) {
            prefixes.push(prefix);
        }
    }
    prefixes
}

/// A message about [`channels`] where the names leave a doubt: one layer of several was chosen, colours are missing, or
/// the picture is a depth.
pub(crate) fn note(names: &[&str]) -> Option<String> {
    let choice = choice(names)?;
    if let [name] = names {
        let is_depth = matches!(last_part(name).as_str(), "z" | "depth") || last_part(name).starts_with("depth");
        return is_depth
            .then(|| format!("the only channel of this picture is a depth, '{name}', which is taken for grey"));
    }
    let shown = |prefix: &str| prefix.trim_end_matches('.').to_owned();
    let said = [lacking(names, &choice), left_out(names, &choice)].into_iter().flatten();
    let said: Vec<String> = said.collect();
    let subject = match choice.prefix {
        "" => "the colour of this picture is its channels without a layer".to_owned(),
        prefix => format!("the layer '{}' of this picture is its colour", shown(prefix)),
    };
    (!said.is_empty()).then(|| format!("{subject}; {}", said.join("; ")))
}

/// Message about the colours that the chosen layer lacks.
fn lacking(names: &[&str], choice: &Choice<'_>) -> Option<String> {
    let [red, green, blue, ..] = choice.channels[..] else {
        // One colour of a layer that is no luminance.
        let &[Some(first), ..] = &choice.channels[..] else { return None };
        let suffix = names[first].strip_prefix(choice.prefix)?;
        let is_colour = SUFFIXES.iter().any(|letters| letters[..3].contains(&suffix));
        return is_colour.then(|| format!("it has '{suffix}' alone, which is taken for grey"));
    };
    let lacks = [("red", red), ("green", green), ("blue", blue)].into_iter().filter(|(_, found)| found.is_none());
    let lacks: Vec<&str> = lacks.map(|(name, _)| name).collect();
    (!lacks.is_empty()).then(|| format!("it has no {}, which is taken for zero", lacks.join(" and no ")))
}

/// The layers that are not chosen, where there is none without a name that is.
fn left_out(names: &[&str], choice: &Choice<'_>) -> Option<String> {
    if choice.prefix.is_empty() {
        return None;
    }
    let is_colour = |prefix: &&str| {
        let letters = SUFFIXES.iter().flat_map(|letters| &letters[..3]).chain([&"Y"]);
        **prefix != *choice.prefix && letters.into_iter().any(|suffix| find(names, prefix, suffix).is_some())
    };
    let others: Vec<String> = prefixes(names)
        .into_iter()
        .filter(is_colour)
        .map(|prefix| format!("'{}'", prefix.trim_end_matches('.')))
        .collect();
    (!others.is_empty()).then(|| format!("other layers are left out: {}", others.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chosen<'a>(names: &[&'a str]) -> Option<Vec<&'a str>> {
        channels(names).map(|indices| indices.into_iter().map(|i| i.map_or("", |i| names[i])).collect())
    }

    #[test]
    fn the_beauty_layer_is_the_colour() {
        let rgb = ["AO.B", "AO.G", "AO.R", "rgba.A", "rgba.B", "rgba.G", "rgba.R"];
        assert_eq!(chosen(&rgb).unwrap(), ["rgba.R", "rgba.G", "rgba.B", "rgba.A"]);
        let said = note(&rgb).unwrap();
        assert!(said.contains("layer 'rgba'") && said.ends_with("left out: 'AO'"), "{said}");
        let nested = ["A.Normal.B", "A.Normal.G", "A.Normal.R", "V.Combined.B", "V.Combined.G", "V.Combined.R"];
        assert_eq!(chosen(&nested).unwrap(), ["V.Combined.R", "V.Combined.G", "V.Combined.B"]);
        // Layers of data come last, whatever their place.
        let data = ["N.B", "N.G", "N.R", "diffuse.B", "diffuse.G", "diffuse.R"];
        assert_eq!(chosen(&data).unwrap(), ["diffuse.R", "diffuse.G", "diffuse.B"]);
        assert_eq!(groups(&data), [[5, 4, 3]]);
        // Those without a layer come first, and then nothing is in doubt.
        let root = ["AO.B", "AO.G", "AO.R", "B", "G", "R"];
        assert_eq!((chosen(&root).unwrap(), note(&root)), (vec!["R", "G", "B"], None));
        assert_eq!(note(&["beauty.B", "beauty.G", "beauty.R", "Z"]), None);
    }

    #[test]
    fn small_letters_and_dots_are_read() {
        assert_eq!(chosen(&["a", "b", "g", "r"]).unwrap(), ["r", "g", "b", "a"]);
        assert_eq!(chosen(&[".A", ".B", ".G", ".R"]).unwrap(), [".R", ".G", ".B", ".A"]);
        assert_eq!(chosen(&["l.A", "l.Y"]).unwrap(), ["l.Y", "l.A"]);
    }

    #[test]
    fn depths_and_normals_are_no_colours() {
        assert!(note(&["Z"]).unwrap().contains("depth, 'Z'") && note(&["Depth.Z"]).is_some());
        assert_eq!((chosen(&["Z"]).unwrap(), note(&["Y"]), note(&["R"])), (vec!["Z"], None, None));
        assert_eq!(chosen(&["N.X", "N.Y", "N.Z"]), None);
        assert_eq!(chosen(&["N.B", "N.G", "Depth.Z"]), None);
    }

    #[test]
    fn layers_without_all_colours_are_read_and_told() {
        let named = ["AO.Y", "depth.Z", "diffuse.R"];
        assert_eq!(chosen(&named).unwrap(), ["AO.Y"]);
        let said = note(&named).unwrap();
        assert!(said.contains("layer 'AO'") && said.ends_with("left out: 'diffuse'"), "{said}");
        let part = ["depth.Z", "diffuse.R", "spec.A", "spec.G", "spec.R"];
        assert_eq!(chosen(&part).unwrap(), ["spec.R", "spec.G", "", "spec.A"]);
        let said = note(&part).unwrap();
        assert!(said.contains("'spec'") && said.contains("no blue") && said.ends_with("left out: 'diffuse'"), "{said}");
        let one = ["depth.Z", "diffuse.R"];
        assert_eq!(chosen(&one).unwrap(), ["diffuse.R"]);
        assert!(note(&one).unwrap().contains("it has 'R' alone, which is taken for grey"));
        assert_eq!(chosen(&["R", "G"]).unwrap(), ["R", "G", ""]);
        assert!(note(&["R", "G"]).unwrap().contains("no blue, which is taken for zero"));
    }
}
