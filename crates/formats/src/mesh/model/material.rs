//! Materials of MTL libraries in Steradian's vocabulary.
//!
//! MTL describes Phong shading by numbered illumination models, later writers add physically based numbers; both are
//! read. Phong's exponent n becomes the microfacet roughness α = √(2 / (n + 2)) (Walter et al. 2007, section 5.2, from
//! the widths of the lobes).

use super::{Look, Opener, file_name};
use crate::mesh::mtl;
use steradian_scene::{ColorSpace, Family, Node, NodeId, SpectrumValue, Value};

/// Index of refraction where none is given, or none that is meant.
const GLASS: f64 = 1.5;
/// Height in units of the bounding box that a bump map of full contrast stands for.
const BUMP_HEIGHT: f64 = 0.01;

fn rgb(c: [f32; 3]) -> SpectrumValue {
    SpectrumValue::Rgb(c.map(f64::from), ColorSpace::Srgb)
}

fn clamped(c: [f32; 3]) -> [f32; 3] {
    c.map(|v| v.clamp(0.0, 1.0))
}

fn is_black(c: [f32; 3]) -> bool {
    c.iter().all(|&v| v <= 0.0)
}

/// Contents of an image.
#[derive(Clone, Copy, PartialEq)]
enum Holds {
    Colors,
    Numbers,
}

impl Opener<'_> {
    /// The nodes of a material.
    pub(super) fn look(&mut self, m: &mtl::Material) -> Look {
        let base = self.diffuse_or_glossy(m);
        let mut node = match base.kind.as_str() {
            "dielectric" => base,
            _ => {
                let front = self.import.desc.add(base);
                Node::new(Family::Material, "two_sided", m.span).with("front", front)
            }
        };
        node.name = Some(m.name.clone());
        self.surface_detail(m, &mut node);
        if let Some(ambient) = m.ambient {
            node.set("ambient", rgb(clamped(ambient)), m.span);
        }
        let material = self.import.desc.add(node);
        let material = self.masked(m, material);
        Look { material: Some(material), emission: self.emission(m) }
    }

    fn diffuse_or_glossy(&mut self, m: &mtl::Material) -> Node {
        let material = |kind: &str| Node::new(Family::Material, kind, m.span);
        let ior = m.ior.map(f64::from).filter(|n| *n > 1.0 && *n < 10.0);
        let specular = clamped(m.specular.unwrap_or_default());
        let physical =
            m.roughness.is_some() || m.metallic.is_some() || m.roughness_map.is_some() || m.metallic_map.is_some();

        // Illumination models with refraction, and surfaces that let light through and bend it.
        let refracts = matches!(m.illum, Some(4 | 6 | 7));
        let clear = m.opacity.is_some_and(|d| d < 1.0) && ior.is_some_and(|n| n > 1.01);
        if m.opacity_map.is_none() && (refracts || clear) {
            let mut node = material("dielectric").with("eta", ior.unwrap_or(GLASS));
            if let Some(tint) = m.transmission.filter(|t| !is_black(*t)) {
                node.set("specular_transmittance", rgb(clamped(tint)), m.span);
            }
            return node;
        }
        let alpha = match (m.roughness, m.shininess) {
            (Some(r), _) => f64::from(r.clamp(0.0, 1.0)).powi(2),
            (None, Some(n)) => (2.0 / (f64::from(n.max(0.0)) + 2.0)).sqrt(),
            (None, None) => 1.0,
        };
        let metallic = if m.metallic_map.is_some() { m.metallic.unwrap_or(1.0) } else { m.metallic.unwrap_or(0.0) };
        let rough: Value = match m.roughness_map.as_ref().and_then(|map| self.image(map, Holds::Numbers)) {
            Some(image) => {
                self.approximated(m.span, "'map_Pr' is taken for the microfacet alpha itself, not for its square root");
                Value::Node(image)
            }
            None => Value::Float(alpha),
        };
        let with_alpha = |mut node: Node| {
            node.set("alpha_u", rough.clone(), m.span).set("alpha_v", rough.clone(), m.span);
            node
        };

        if physical {
            let color = self.base_color(m);
            let metal = with_alpha(material("conductor").with("reflectance", color.clone()));
            let plastic =
                with_alpha(material("plastic").with("diffuse_reflectance", color).with("eta", ior.unwrap_or(GLASS)));
            let map = m.metallic_map.as_ref().and_then(|map| self.image(map, Holds::Numbers));
            let amount = match map {
                Some(image) => Value::Node(image),
                None if metallic >= 1.0 => return metal,
                None if metallic <= 0.0 => return plastic,
                None => Value::Float(metallic.into()),
            };
            let materials = vec![self.import.desc.add(plastic), self.import.desc.add(metal)];
            return material("mix").with("materials", materials).with("amount", amount);
        }
        let glossy = m.illum.is_none_or(|i| i >= 2)
            && m.shininess.is_some_and(|n| n > 0.0)
            && (!is_black(specular) || m.specular_map.is_some());
        if !glossy {
            return material("diffuse").with("reflectance", self.base_color(m));
        }
        let tint = self.tinted(m.specular_map.as_ref(), if m.specular.is_some() { specular } else { [1.0; 3] });
        let mirror = matches!(m.illum, Some(3 | 5)) && m.diffuse.is_some_and(is_black) && m.diffuse_map.is_none();
        if mirror {
            return with_alpha(material("conductor").with("reflectance", tint));
        }
        let plastic =
            material("plastic").with("diffuse_reflectance", self.base_color(m)).with("specular_reflectance", tint);
        with_alpha(plastic.with("eta", ior.unwrap_or(GLASS)))
    }

    /// `Kd` times `map_Kd`.
    fn base_color(&mut self, m: &mtl::Material) -> Value {
        let map = m.diffuse_map.clone();
        // Some writers leave `Kd 0 0 0` beside a map.
        let color = match m.diffuse {
            Some(c) if map.is_some() && is_black(c) => [1.0; 3],
            Some(c) => clamped(c),
            None if map.is_some() => [1.0; 3],
            None => [0.8; 3],
        };
        self.tinted(map.as_ref(), color)
    }

    /// An image times a colour, or the colour where there is no image.
    fn tinted(&mut self, map: Option<&mtl::Map>, color: [f32; 3]) -> Value {
        let Some(image) = map.and_then(|map| self.image(map, Holds::Colors)) else {
            return Value::Spectrum(rgb(color));
        };
        if color == [1.0; 3] {
            return Value::Node(image);
        }
        let scaled = Node::new(Family::Texture, "scale", None).with("texture", image).with("scale", rgb(color));
        Value::Node(self.import.desc.add(scaled))
    }

    fn emission(&mut self, m: &mtl::Material) -> Option<NodeId> {
        let color = match (m.emission, &m.emission_map) {
            (Some(c), map) if !is_black(c) || map.is_none() => c,
            (_, Some(_)) => [1.0; 3],
            (..) => return None,
        };
        if is_black(color) {
            return None;
        }
        let radiance = self.tinted(m.emission_map.as_ref(), color.map(|v| v.max(0.0)));
        let light = Node::new(Family::Light, "area", m.span).with("radiance", radiance).with("two_sided", true);
        Some(self.import.desc.add(light))
    }

    /// `d` and `map_d`: parts of the surface that are not there.
    fn masked(&mut self, m: &mtl::Material, material: NodeId) -> NodeId {
        let is_glass = self.import.desc.node(material).kind == "dielectric";
        let opacity = if is_glass { 1.0 } else { f64::from(m.opacity.unwrap_or(1.0).clamp(0.0, 1.0)) };
        if opacity == 0.0 {
            let message = format!(
                "the material '{}' is invisible by its 'd 0' or 'Tr 1'; a file that means opaque should have 'd 1'",
                m.name
            );
            self.import.diagnostics.warn(&self.import.desc.sources, m.span, message);
        }
        let map = m.opacity_map.as_ref().and_then(|map| self.image(map, Holds::Numbers));
        let value = match (map, opacity < 1.0) {
            (None, false) => return material,
            (None, true) => Value::Float(opacity),
            (Some(image), false) => Value::Node(image),
            (Some(image), true) => {
                let scaled = Node::new(Family::Texture, "scale", None).with("texture", image).with("scale", opacity);
                Value::Node(self.import.desc.add(scaled))
            }
        };
        let mask = Node::new(Family::Material, "mask", m.span).with("opacity", value).with("material", material);
        self.import.desc.add(mask)
    }

    fn surface_detail(&mut self, m: &mtl::Material, node: &mut Node) {
        if let Some(map) = &m.normal_map
            && let Some(image) = self.image(map, Holds::Numbers)
        {
            node.set("normal_map", image, m.span);
        } else if let Some(map) = m.bump_map.as_ref()
            && let Some(image) = self.image(map, Holds::Numbers)
        {
            let height = Value::Float(f64::from(map.bump) * BUMP_HEIGHT * self.size);
            self.import.desc.node_mut(image).set("scale", height, None);
            self.approximated(
                m.span,
                "MTL gives bump maps no height: full contrast is taken for a hundredth of the model's size",
            );
            node.set("bump", image, m.span);
        }
        if m.displacement_map.is_some() {
            self.dropped(m.span, "'disp' moves no vertices here and is left out");
        }
        if m.clearcoat.is_some_and(|c| c > 0.0) || m.sheen.is_some_and(|s| s > 0.0) {
            self.dropped(m.span, "clear coat and sheen ('Pc', 'Ps') are left out");
        }
        if m.anisotropy.is_some_and(|a| a != 0.0) {
            self.dropped(m.span, "anisotropy ('aniso') is left out");
        }
        if m.shininess_map.is_some() {
            self.dropped(m.span, "'map_Ns' is left out; 'Ns' holds everywhere");
        }
    }

    /// A texture of the colours of a picture; `None`, with a report, where the file is not there.
    pub(super) fn picture(&mut self, file: &str) -> Option<NodeId> {
        let map = mtl::Map { file: file.into(), scale: [1.0; 3], base_gain: [0.0, 1.0], ..mtl::Map::default() };
        self.image(&map, Holds::Colors)
    }

    /// A texture node for an image; `None`, with a report, where the file is not there.
    fn image(&mut self, map: &mtl::Map, holds: Holds) -> Option<NodeId> {
        let found = self.search.find(&map.file);
        let found = found.or_else(|e| file_name(&map.file).and_then(|n| self.search.find(n).ok()).ok_or(e));
        let span = map.span;
        let path = match found {
            Ok(path) => path,
            Err(e) => {
                self.approximated(span, format!("{e}: the material goes without"));
                return None;
            }
        };
        let wrap = if map.clamp { "clamp" } else { "repeat" };
        let mut node = Node::new(Family::Texture, "image", span)
            .with("file", path)
            .with("wrap_u", wrap)
            .with("wrap_v", wrap)
            .with("origin", "bottom");
        if holds == Holds::Numbers {
            node.set("raw", true, span);
        }
        for (name, value, default) in [
            ("scale_u", map.scale[0], 1.0),
            ("scale_v", map.scale[1], 1.0),
            ("delta_u", map.offset[0], 0.0),
            ("delta_v", map.offset[1], 0.0),
            ("scale", map.base_gain[1], 1.0),
        ] {
            if value != default {
                node.set(name, f64::from(value), span);
            }
        }
        if map.base_gain[0] != 0.0 {
            self.approximated(span, "the base value of '-mm' is left out; its gain is kept");
        }
        Some(self.import.desc.add(node))
    }
}
