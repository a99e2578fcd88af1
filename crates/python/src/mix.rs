//! Pictures mixed anew of the light of their groups of lights.

use pyo3::FromPyObject;
use std::collections::HashMap;
use steradian::{
    Layer,
    denoise::{GUIDES, OIDN_GUIDES},
    image::{Channel, Image},
    scene::names::did_you_mean,
};

/// Beginning of the names of layers of groups.
const GROUP: &str = "RGBA_";
const RGB: [&str; 3] = ["R", "G", "B"];

/// Weight of a group: a number, or one for each colour.
#[derive(FromPyObject)]
pub enum Weight {
    All(f32),
    Each([f32; 3]),
}

impl Weight {
    pub fn rgb(self) -> [f32; 3] {
        match self {
            Self::All(weight) => [weight; 3],
            Self::Each(weights) => weights,
        }
    }
}

/// The weighted sum of the groups of a picture; those without a weight count as they are, and one that is put out adds
/// nothing, whatever it holds. Layers of groups are weighted alike. Of other layers those of first hits stay, which no
/// light changes.
pub fn mixed(picture: &Image, weights: &HashMap<String, [f32; 3]>) -> Result<Image, String> {
    let of_group = |channel: &Channel| {
        let name = channel.name.strip_prefix(GROUP)?;
        Some(name.strip_suffix(".R")?.to_owned())
    };
    let groups: Vec<String> = picture.channels().iter().filter_map(of_group).collect();
    if groups.is_empty() {
        return Err("the picture has no groups of lights: render it with layers=[\"light_groups\"]".into());
    }
    let mut by_group: HashMap<String, [f32; 3]> = HashMap::new();
    for (name, weight) in weights {
        // Dots part layers in names of channels, so that groups lose theirs.
        let group = name.replace(['.', '\0'], "_");
        if !groups.contains(&group) {
            let hint = did_you_mean(name, groups.iter().map(String::as_str));
            let hint = hint.map(|hint| format!("; {hint}")).unwrap_or_default();
            return Err(format!("there is no group of lights '{name}'{hint} (known: {})", groups.join(", ")));
        }
        if weight.iter().any(|w| !(w.is_finite() && *w >= 0.0)) {
            return Err(format!("the weight of '{name}' is a number of 0 or more, or three of them, not {weight:?}"));
        }
        by_group.insert(group, *weight);
    }
    let mut mixed = Image::new(picture.width(), picture.height());
    (mixed.offset, mixed.frame, mixed.metadata) = (picture.offset, picture.frame, picture.metadata.clone());
    let mut sums = [(); 3].map(|()| vec![0.0_f32; picture.width() * picture.height()]);
    let mut planes = Vec::new();
    for group in &groups {
        let weight = by_group.get(group).copied().unwrap_or([1.0; 3]);
        for c in 0..3 {
            let name = format!("{GROUP}{group}.{}", RGB[c]);
            let light = picture.channel(&name).ok_or_else(|| format!("the picture has no channel '{name}'"))?;
            let scale = |v: &f32| if weight[c] > 0.0 { weight[c] * v } else { 0.0 };
            let plane: Vec<f32> = light.iter().map(scale).collect();
            sums[c].iter_mut().zip(&plane).for_each(|(sum, v)| *sum += v);
            planes.push((name, plane));
        }
    }
    let colours = RGB.iter().map(|name| (*name).to_owned()).zip(sums);
    let guides = GUIDES.iter().chain(&OIDN_GUIDES).filter(|layer| **layer != Layer::VARIANCE);
    let kept: Vec<&str> = guides.map(|layer| layer.prefix()).chain(["A"]).collect();
    let is_kept = |channel: &&Channel| channel.name.split('.').next().is_some_and(|layer| kept.contains(&layer));
    let others = picture.channels().iter().filter(is_kept).map(|channel| (channel.name.clone(), channel.data.clone()));
    for (name, plane) in colours.chain(planes).chain(others) {
        mixed.push(name, plane).map_err(|e| e.to_string())?;
    }
    Ok(mixed)
}
