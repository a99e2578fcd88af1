//! Which channels of a picture are its colour, by their names.
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
    /// What its channels' names begin with: empty, or with a dot at its end.
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

/// Whether the chosen channels are the red, green and blue of a layer that holds colours.
pub(crate) fn holds_colours(names: &[&str], chosen: &[usize]) -> bool {
    chosen.len() >= 3 && groups(names).iter().any(|group| group[..] == chosen[..3])
}

/// Which of the named channels are the picture's colour: `[r, g, b]`, `[r, g, b, a]`, `[y]` or `[y, a]`.
pub(crate) fn channels(names: &[&str]) -> Option<Vec<usize>> {
    let grey = |layer: &str| {
        // `N.Y` beside `N.X` is no luminance.
        let is_vector = find(names, layer, "X").is_some();
        let y = find(names, layer, "Y").filter(|_| !is_vector)?;
        Some([Some(y), find(names, layer, "A")].into_iter().flatten().collect::<Vec<_>>())
    };
    let all = layers(names);
    let of = |layer: &Layer<'_>| layer.rgb.into_iter().chain(layer.alpha).collect();
    let only = || (names.len() == 1).then(|| vec![0]);
    let root = all.iter().find(|layer| layer.prefix.is_empty());
    root.map(of).or_else(|| grey("")).or_else(only).or_else(|| all.iter().min_by_key(|l| l.rank()).map(of)).or_else(
        || {
            let prefixes = names.iter().filter_map(|n| n.strip_suffix('Y').filter(|layer| layer.ends_with('.')));
            prefixes.into_iter().find_map(grey)
        },
    )
}

/// A message about [`channels`] where the names leave a doubt: one layer of several was chosen, or the picture is a
/// depth.
pub(crate) fn note(names: &[&str]) -> Option<String> {
    let chosen = channels(names)?;
    if let [name] = names {
        let is_depth = matches!(last_part(name).as_str(), "z" | "depth") || last_part(name).starts_with("depth");
        return is_depth
            .then(|| format!("the only channel of this picture is a depth, '{name}', which is taken for grey"));
    }
    let all = layers(names);
    let shown = |layer: &Layer<'_>| layer.prefix.trim_end_matches('.').to_owned();
    let used = all.iter().find(|layer| layer.rgb[..] == chosen[..chosen.len().min(3)] && !layer.prefix.is_empty())?;
    let others: Vec<String> =
        all.iter().filter(|l| l.prefix != used.prefix).map(|l| format!("'{}'", shown(l))).collect();
    (!others.is_empty()).then(|| {
        let name = shown(used);
        format!("the layer '{name}' of this picture is its colour; other layers are left out: {}", others.join(", "))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chosen<'a>(names: &[&'a str]) -> Option<Vec<&'a str>> {
        channels(names).map(|indices| indices.into_iter().map(|i| names[i]).collect())
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
        assert_eq!(chosen(&["R", "G"]), None);
    }
}
