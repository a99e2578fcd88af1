//! Light and media that OpenPBR surfaces say themselves, as those of the shapes that carry them.
//!
//! The medium inside has the extinction `−ln(transmission_color)/transmission_depth` and the scattering
//! `transmission_scatter/transmission_depth`; absorption that is below zero is raised in all channels alike (OpenPBR
//! 1.1, 3.4.2). Light of the base passes the coat once: `√coat_color` in proportion to `coat_weight`.

use crate::{
    desc::{SceneDesc, Shape},
    node::{ColorSpace, Node, NodeId, SpectrumValue, Value},
};
use steradian_schema::Family;

/// Least transmittance that counts.
const DARKEST: f64 = 1e-4;

/// The description with such light and media as those of shapes, where a shape has them and none of its own, and
/// messages about materials of which something is left out; `None` where there are none.
pub fn carried(desc: &SceneDesc) -> Option<(SceneDesc, Vec<(NodeId, String)>)> {
    let shapes = || desc.groups.iter().flat_map(|g| &g.shapes).chain(&desc.shapes);
    if !shapes().any(|shape| {
        surface(desc, shape.material).is_some_and(|(_, node)| {
            (shape.emission.is_none() && shines(node)) || (!shape.is_medium_boundary && has_depth(node))
        })
    }) {
        return None;
    }
    let mut made = Made { desc: desc.clone(), told: Vec::new(), lights: Vec::new(), media: Vec::new() };
    let (mut groups, mut shapes) = (std::mem::take(&mut made.desc.groups), std::mem::take(&mut made.desc.shapes));
    groups.iter_mut().flat_map(|g| &mut g.shapes).chain(&mut shapes).for_each(|shape| made.complete(shape));
    (made.desc.groups, made.desc.shapes) = (groups, shapes);
    Some((made.desc, made.told))
}

/// The OpenPBR surface of a shape, under a mask, too.
fn surface(desc: &SceneDesc, material: Option<NodeId>) -> Option<(NodeId, &Node)> {
    let mut id = material?;
    for _ in 0..8 {
        let node = desc.nodes.get(id.0 as usize)?;
        match node.kind.as_str() {
            "openpbr" => return Some((id, node)),
            "mask" => id = node.node("material")?,
            _ => return None,
        }
    }
    None
}

fn shines(node: &Node) -> bool {
    node.float("emission_luminance").is_some_and(|v| v > 0.0)
}

fn has_depth(node: &Node) -> bool {
    let refracts = node.get("transmission_weight").is_some_and(|_| node.float("transmission_weight") != Some(0.0));
    refracts
        && node.float("transmission_depth").is_some_and(|v| v > 0.0)
        && node.bool("geometry_thin_walled") != Some(true)
}

/// Colour of a constant parameter; `None` where it is no number and no colour.
fn color(node: &Node, name: &str, default: f64) -> Option<[f64; 3]> {
    match node.get(name) {
        None => Some([default; 3]),
        Some(Value::Spectrum(SpectrumValue::Rgb(color, _))) => Some(*color),
        Some(Value::Spectrum(SpectrumValue::Constant(v))) => Some([*v; 3]),
        Some(_) => node.float(name).map(|v| [v; 3]),
    }
}

fn rgb(color: [f64; 3]) -> Value {
    Value::Spectrum(SpectrumValue::Rgb(color, ColorSpace::Srgb))
}

struct Made {
    desc: SceneDesc,
    told: Vec<(NodeId, String)>,
    /// Light and media by material.
    lights: Vec<(NodeId, NodeId)>,
    media: Vec<(NodeId, Option<NodeId>)>,
}

impl Made {
    fn complete(&mut self, shape: &mut Shape) {
        let Some((id, node)) = surface(&self.desc, shape.material) else { return };
        let node = node.clone();
        if shape.emission.is_none() && shines(&node) {
            shape.emission = Some(self.light(id, &node));
        }
        if !shape.is_medium_boundary
            && has_depth(&node)
            && let Some(medium) = self.medium(id, &node)
        {
            (shape.interior, shape.is_medium_boundary) = (Some(medium), true);
        }
    }

    fn light(&mut self, id: NodeId, node: &Node) -> NodeId {
        if let Some((_, light)) = self.lights.iter().find(|known| known.0 == id) {
            return *light;
        }
        let scale = node.float("emission_luminance").unwrap_or_default();
        let coat = node.float("coat_weight").unwrap_or_default().clamp(0.0, 1.0);
        let passes = match color(node, "coat_color", 1.0) {
            Some(color) => color.map(|c| 1.0 + coat * (c.clamp(0.0, 1.0).sqrt() - 1.0)),
            None => {
                self.told.push((id, "a textured coat does not colour the light of 'emission_luminance'".into()));
                [1.0; 3]
            }
        };
        let is_thin = node.bool("geometry_thin_walled") == Some(true);
        let emitted = match (color(node, "emission_color", 1.0), node.get("emission_color")) {
            (Some(color), _) => rgb(std::array::from_fn(|k| color[k] * passes[k])),
            (None, Some(value)) => value.clone(),
            (None, None) => rgb(passes),
        };
        let light = Node::new(Family::Light, "area", node.span).with("radiance", emitted).with("scale", scale);
        let light = Node { name: node.name.clone(), ..light.with("two_sided", is_thin) };
        let light = self.desc.add(light);
        self.lights.push((id, light));
        light
    }

    fn medium(&mut self, id: NodeId, node: &Node) -> Option<NodeId> {
        if let Some((_, medium)) = self.media.iter().find(|known| known.0 == id) {
            return *medium;
        }
        let depth = node.float("transmission_depth").unwrap_or(1.0);
        let parts = (color(node, "transmission_color", 1.0), color(node, "transmission_scatter", 0.0));
        let medium = match parts {
            (Some(kept), Some(scatter)) => {
                let extinction = kept.map(|c| -c.clamp(DARKEST, 1.0).ln() / depth);
                let scattering = scatter.map(|s| s.max(0.0) / depth);
                let absorbed: [f64; 3] = std::array::from_fn(|k| extinction[k] - scattering[k]);
                let lack = absorbed.into_iter().fold(0.0, f64::min);
                let g = node.float("transmission_scatter_anisotropy").unwrap_or_default();
                let medium = Node::new(Family::Medium, "homogeneous", node.span)
                    .with("sigma_a", rgb(absorbed.map(|a| a - lack)))
                    .with("sigma_s", rgb(scattering))
                    .with("g", g);
                Some(self.desc.add(medium))
            }
            _ => {
                let what =
                    "the medium of 'transmission_depth' is left out: its colours are numbers or RGB, not textures";
                self.told.push((id, what.into()));
                None
            }
        };
        self.media.push((id, medium));
        medium
    }
}
