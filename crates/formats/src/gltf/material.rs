//! Materials: metallic-roughness with its extensions, specular-glossiness, unlit.

use super::{
    Reader,
    json::At,
    mesh::Channels,
    texture::Holds::{Colors, Numbers},
};
use steradian_scene::{ColorSpace, Family, Node, NodeId, SpectrumValue, Value};

/// Key of a translated material: index of the material, and presence of vertex colours and of vertex opacities.
pub(super) type Key = (Option<usize>, bool, bool);

/// Translated material of a primitive.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Look {
    pub material: Option<NodeId>,
    pub emission: Option<NodeId>,
    pub interior: Option<NodeId>,
    /// True if it has a normal map or is anisotropic.
    pub uses_tangents: bool,
    /// True if back faces are culled: not `doubleSided`, and opaque.
    pub is_single_sided: bool,
}

fn rgb(c: [f64; 3]) -> SpectrumValue {
    SpectrumValue::Rgb(c, ColorSpace::Srgb)
}

impl Reader<'_> {
    /// The look of a primitive.
    pub(super) fn look(&mut self, root: &At<'_>, primitive: &At<'_>, channels: Channels) -> Look {
        let material = self.chosen_material(root, primitive);
        let key = (material.as_ref().map(|m| m.0), channels.color, channels.alpha);
        if let Some(look) = self.materials.get(&key) {
            return *look;
        }
        let look = match material {
            Some((_, at)) => self.material(root, &at, channels),
            None => self.material(root, &At { value: &serde_json::Value::Null, pointer: String::new() }, channels),
        };
        self.materials.insert(key, look);
        look
    }

    /// The material of a primitive: that of the variant that `-D variant=NAME` names, else its own.
    fn chosen_material<'r>(&mut self, root: &At<'r>, primitive: &At<'_>) -> Option<(usize, At<'r>)> {
        if let Some(wanted) = self.options.defines.get("variant").cloned() {
            let named = root.extension("KHR_materials_variants");
            let number =
                named.as_ref().and_then(|v| v.list("variants").position(|v| v.label().as_ref() == Some(&wanted)));
            let Some(number) = number else {
                let names: Vec<_> = named.iter().flat_map(|v| v.list("variants")).filter_map(|v| v.label()).collect();
                self.error(root, format!("there is no variant '{wanted}'; there are: {}", names.join(", ")));
                return None;
            };
            let mapping = primitive.extension("KHR_materials_variants").and_then(|v| {
                v.list("mappings").find(|m| m.list("variants").any(|n| n.value.as_u64() == Some(number as u64)))
            });
            if let Some(mapping) = mapping {
                return self.index(root, &mapping, "material", "materials");
            }
        }
        self.index(root, primitive, "material", "materials")
    }

    fn material(&mut self, root: &At<'_>, m: &At<'_>, channels: Channels) -> Look {
        let span = self.span(m).filter(|_| !m.pointer.is_empty());
        let attribute = |reader: &mut Self, name: &str| {
            let node = Node::new(Family::Texture, "mesh_attribute", None).with("name", name).with("domain", "vertex");
            reader.import.desc.add(node)
        };
        let vertex_color = channels.color.then(|| attribute(self, "color"));
        let glossy = m.extension("KHR_materials_pbrSpecularGlossiness");
        let empty = At { value: &serde_json::Value::Null, pointer: String::new() };
        let pbr = glossy.clone().or_else(|| m.get("pbrMetallicRoughness")).unwrap_or(empty);
        let (factor, map) = match glossy {
            Some(_) => ("diffuseFactor", "diffuseTexture"),
            None => ("baseColorFactor", "baseColorTexture"),
        };
        let [r, g, b, opacity] = self.numbers(&pbr, factor, [1.0; 4]);
        let base = [r, g, b].map(|v| v.clamp(0.0, 1.0));
        let base_map = self.texture(root, &pbr, map, Colors);
        // Of a picture whose alpha is opacity nobody sees the colours that lie below nothing.
        if let (Some(map), Some("MASK" | "BLEND")) = (base_map, m.text("alphaMode")) {
            self.import.desc.node_mut(map).set("bleed", true, None);
        }
        let base_color = self.tinted(&[base_map, vertex_color], base);
        let is_two_sided = m.value["doubleSided"] == true;

        let passes = ["KHR_materials_transmission", "KHR_materials_volume", "KHR_materials_diffuse_transmission"]
            .iter()
            .any(|name| m.extension(name).is_some());
        let mut look = Look { is_single_sided: !is_two_sided && !passes, ..Look::default() };
        let mut node = if m.extension("KHR_materials_unlit").is_some() {
            // Surfaces that look the same in any light: they are black and emit their colour.
            let light = Node::new(Family::Light, "area", span).with("radiance", base_color);
            let light = light.with("two_sided", is_two_sided);
            look.emission = Some(self.import.desc.add(light));
            Node::new(Family::Material, "diffuse", span).with("reflectance", rgb([0.0; 3]))
        } else {
            look.emission = self.emission(root, m, is_two_sided);
            let mut node = Node::new(Family::Material, "metallic_roughness", span).with("base_color", base_color);
            if glossy.is_some() {
                self.specular_glossiness(root, &pbr, &mut node);
            } else {
                for (name, channel, parameter) in
                    [("metallicFactor", "b", "metallic"), ("roughnessFactor", "g", "roughness")]
                {
                    let factor = self.number(&pbr, name, 1.0, (0.0, 1.0));
                    let texture = self.texture(root, &pbr, "metallicRoughnessTexture", Numbers(channel));
                    let value = self.scaled_number(texture, factor);
                    node.set(parameter, value, None);
                }
            }
            look.uses_tangents = self.extended(root, m, &mut node);
            look.interior = self.volume(m, &mut node);
            node
        };
        if let Some(normal) = m.get("normalTexture")
            && let Some(map) = self.texture(root, m, "normalTexture", Numbers("color"))
        {
            let strength = self.number(&normal, "scale", 1.0, (-100.0, 100.0));
            node.set("normal_map", map, None).set("normal_map_strength", strength, None);
            look.uses_tangents = true;
        }
        if let Some(e) = m.extension("KHR_materials_clearcoat") {
            look.uses_tangents |= self.coat_normals(root, &e, &mut node);
        }
        node.name = m.label();
        let material = self.import.desc.add(node);
        let vertex_alpha = channels.alpha.then(|| attribute(self, "alpha"));
        look.material = Some(self.masked(root, m, &pbr, (map, opacity), vertex_alpha, material));
        look
    }

    /// The coat's own normals: those of the surface, or of a map; tells whether there is a map.
    fn coat_normals(&mut self, root: &At<'_>, e: &At<'_>, node: &mut Node) -> bool {
        let texture = e.get("clearcoatNormalTexture");
        let map = texture.as_ref().and_then(|_| self.texture(root, e, "clearcoatNormalTexture", Numbers("color")));
        if let (Some(info), Some(map)) = (texture, map) {
            let strength = self.number(&info, "scale", 1.0, (-100.0, 100.0));
            node.set("coat_normal_map", map, None).set("coat_normal_map_strength", strength, None);
        } else if node.get("normal_map").is_some() {
            node.set("coat_normals", "own", None);
        }
        map.is_some()
    }

    fn emission(&mut self, root: &At<'_>, m: &At<'_>, is_two_sided: bool) -> Option<NodeId> {
        let factor = self.numbers(m, "emissiveFactor", [0.0; 3]);
        let strength = m
            .extension("KHR_materials_emissive_strength")
            .map_or(1.0, |e| self.number(&e, "emissiveStrength", 1.0, (0.0, 1e12)));
        let color = factor.map(|v| v.max(0.0) * strength);
        if color == [0.0; 3] {
            return None;
        }
        // Up to one, emission is a glow on a surface that something else lights; beyond, it is a lamp.
        self.uses_lights |= color.iter().any(|v| *v > 1.0);
        let map = self.texture(root, m, "emissiveTexture", Colors);
        let radiance = self.tinted(&[map], color);
        let light =
            Node::new(Family::Light, "area", self.span(m)).with("radiance", radiance).with("two_sided", is_two_sided);
        Some(self.import.desc.add(light))
    }

    /// KHR_materials_pbrSpecularGlossiness, as a dielectric whose reflection has the colour that is asked for.
    fn specular_glossiness(&mut self, root: &At<'_>, pbr: &At<'_>, node: &mut Node) {
        self.approximated(pbr, "specular-glossiness is rendered as a dielectric of that specular colour");
        let specular = self.numbers(pbr, "specularFactor", [1.0; 3]).map(|v| v.clamp(0.0, 1.0));
        let map = self.texture(root, pbr, "specularGlossinessTexture", Colors);
        // An index of 1.5 reflects 0.04; the colour multiplies that.
        let color = self.tinted(&[map], specular.map(|v| v / 0.04));
        let gloss = self.number(pbr, "glossinessFactor", 1.0, (0.0, 1.0));
        let roughness = match self.texture(root, pbr, "specularGlossinessTexture", Numbers("a")) {
            None => Value::Float(1.0 - gloss),
            Some(texture) => {
                let curve = Node::new(Family::Texture, "curve", None)
                    .with("input", texture)
                    .with("places", vec![0.0, 1.0])
                    .with("values", vec![1.0, 1.0 - gloss]);
                Value::Node(self.import.desc.add(curve))
            }
        };
        node.set("metallic", 0.0, None).set("specular_color", color, None).set("roughness", roughness, None);
    }

    /// The extensions of metallic-roughness; tells whether any needs tangents.
    fn extended(&mut self, root: &At<'_>, m: &At<'_>, node: &mut Node) -> bool {
        if let Some(e) = m.extension("KHR_materials_ior") {
            let eta = self.number(&e, "ior", 1.5, (0.0, 1e6));
            if eta == 0.0 || eta > 20.0 {
                self.approximated(
                    &e,
                    "an index of 0 or above 20 stands for a perfect mirror of the specular colour; 20 is used",
                );
            }
            node.set("eta", if eta == 0.0 { 20.0 } else { eta.clamp(1.0, 20.0) }, None);
        }
        // Extension, factor, default, texture, channel, parameter.
        let numbers: &[(&str, &str, f64, &str, &'static str, &str)] = &[
            ("KHR_materials_specular", "specularFactor", 1.0, "specularTexture", "a", "specular"),
            ("KHR_materials_transmission", "transmissionFactor", 0.0, "transmissionTexture", "r", "transmission"),
            ("KHR_materials_clearcoat", "clearcoatFactor", 0.0, "clearcoatTexture", "r", "clearcoat"),
            (
                "KHR_materials_clearcoat",
                "clearcoatRoughnessFactor",
                0.0,
                "clearcoatRoughnessTexture",
                "g",
                "clearcoat_roughness",
            ),
            ("KHR_materials_sheen", "sheenRoughnessFactor", 0.0, "sheenRoughnessTexture", "a", "sheen_roughness"),
            ("KHR_materials_anisotropy", "anisotropyStrength", 0.0, "anisotropyTexture", "b", "anisotropy"),
            ("KHR_materials_iridescence", "iridescenceFactor", 0.0, "iridescenceTexture", "r", "iridescence"),
            (
                "KHR_materials_diffuse_transmission",
                "diffuseTransmissionFactor",
                0.0,
                "diffuseTransmissionTexture",
                "a",
                "diffuse_transmission",
            ),
        ];
        for &(extension, factor, default, texture, channel, parameter) in numbers {
            let Some(e) = m.extension(extension) else { continue };
            let factor = self.number(&e, factor, default, (0.0, 1.0));
            let texture = self.texture(root, &e, texture, Numbers(channel));
            let value = self.scaled_number(texture, factor);
            node.set(parameter, value, None);
        }
        let colors: &[(&str, &str, f64, &str, &str)] = &[
            ("KHR_materials_specular", "specularColorFactor", 1.0, "specularColorTexture", "specular_color"),
            ("KHR_materials_sheen", "sheenColorFactor", 0.0, "sheenColorTexture", "sheen_color"),
            (
                "KHR_materials_diffuse_transmission",
                "diffuseTransmissionColorFactor",
                1.0,
                "diffuseTransmissionColorTexture",
                "diffuse_transmission_color",
            ),
        ];
        for &(extension, factor, default, texture, parameter) in colors {
            let Some(e) = m.extension(extension) else { continue };
            let factor = self.numbers(&e, factor, [default; 3]).map(|v| v.max(0.0));
            let texture = self.texture(root, &e, texture, Colors);
            let value = self.tinted(&[texture], factor);
            node.set(parameter, value, None);
        }
        if let Some(e) = m.extension("KHR_materials_dispersion") {
            let dispersion = self.number(&e, "dispersion", 0.0, (0.0, 1e3));
            node.set("dispersion", dispersion, None);
        }
        if let Some(e) = m.extension("KHR_materials_iridescence") {
            let eta = self.number(&e, "iridescenceIor", 1.3, (1.0, 5.0));
            let least = self.number(&e, "iridescenceThicknessMinimum", 100.0, (0.0, 1e5));
            let most = self.number(&e, "iridescenceThicknessMaximum", 400.0, (0.0, 1e5));
            let thickness = match self.texture(root, &e, "iridescenceThicknessTexture", Numbers("g")) {
                None => Value::Float(most),
                Some(texture) => {
                    let mix = Node::new(Family::Texture, "mix", None)
                        .with("a", least)
                        .with("b", most)
                        .with("amount", texture);
                    Value::Node(self.import.desc.add(mix))
                }
            };
            node.set("iridescence_eta", eta, None).set("iridescence_thickness", thickness, None);
        }
        let Some(e) = m.extension("KHR_materials_anisotropy") else { return false };
        let rotation = self.number(&e, "anisotropyRotation", 0.0, (-1e6, 1e6)).to_degrees();
        node.set("anisotropy_rotation", rotation, None);
        if e.get("anisotropyTexture").is_some()
            && let Some(map) = self.texture(root, &e, "anisotropyTexture", Numbers("color"))
        {
            node.set("anisotropy_direction", map, None);
        }
        true
    }

    /// KHR_materials_volume and KHR_materials_volume_scatter: the medium inside.
    fn volume(&mut self, m: &At<'_>, node: &mut Node) -> Option<NodeId> {
        let e = m.extension("KHR_materials_volume")?;
        let thickness = self.number(&e, "thicknessFactor", 0.0, (0.0, 1e12));
        if thickness == 0.0 {
            return None;
        }
        // Light is traced through the volume that the mesh encloses, so its thickness is the mesh's own.
        node.set("thin", false, None);
        let distance = self.number(&e, "attenuationDistance", f64::INFINITY, (1e-12, f64::INFINITY));
        let color = self.numbers(&e, "attenuationColor", [1.0; 3]).map(|c| c.clamp(1e-4, 1.0));
        if !distance.is_finite() || color == [1.0; 3] {
            return None;
        }
        let extinction = color.map(|c| -c.ln() / distance);
        let scatter = m.extension("KHR_materials_volume_scatter");
        let (albedo, g) = match &scatter {
            None => ([0.0; 3], 0.0),
            Some(s) => {
                let multiple = self.numbers(s, "multiscatterColor", [0.0; 3]).map(|c| c.clamp(0.0, 1.0));
                (multiple.map(single_scattering_albedo), self.number(s, "scatterAnisotropy", 0.0, (-0.99, 0.99)))
            }
        };
        let part = |f: &dyn Fn(usize) -> f64| rgb(std::array::from_fn(f));
        let medium = Node::new(Family::Medium, "homogeneous", self.span(&e))
            .with("sigma_a", part(&|k| extinction[k] * (1.0 - albedo[k])))
            .with("sigma_s", part(&|k| extinction[k] * albedo[k]))
            .with("g", g);
        Some(self.import.desc.add(medium))
    }

    /// Alpha modes: `MASK` cuts at a threshold, `BLEND` lets light pass by chance.
    fn masked(
        &mut self,
        root: &At<'_>,
        m: &At<'_>,
        pbr: &At<'_>,
        (map, opacity): (&str, f64),
        vertex_alpha: Option<NodeId>,
        material: NodeId,
    ) -> NodeId {
        let mode = m.text("alphaMode").unwrap_or("OPAQUE");
        if !matches!(mode, "MASK" | "BLEND") {
            if mode != "OPAQUE" {
                self.error(m, format!("'{mode}' is not an alpha mode; there are OPAQUE, MASK and BLEND"));
            }
            return material;
        }
        let texture = self.texture(root, pbr, map, Numbers("a"));
        let textures: Vec<NodeId> = [texture, vertex_alpha].into_iter().flatten().collect();
        let mut value = match textures.as_slice() {
            [] => Value::Float(opacity),
            [one] => self.scaled_number(Some(*one), opacity),
            [one, other, ..] => {
                let both = Node::new(Family::Texture, "scale", None).with("texture", *one).with("scale", *other);
                let both = self.import.desc.add(both);
                self.scaled_number(Some(both), opacity)
            }
        };
        if mode == "MASK" {
            let cutoff = self.number(m, "alphaCutoff", 0.5, (0.0, 1e6));
            value = match value {
                Value::Node(input) => {
                    // Below the cutoff nothing is there; a stop below every alpha gives the curve its zero.
                    let step = Node::new(Family::Texture, "curve", None)
                        .with("input", input)
                        .with("places", vec![-1.0, cutoff])
                        .with("values", vec![0.0, 1.0])
                        .with("interpolation", "step");
                    Value::Node(self.import.desc.add(step))
                }
                Value::Float(v) => Value::Float(if v >= cutoff { 1.0 } else { 0.0 }),
                other => other,
            };
        }
        if matches!(value, Value::Float(v) if v >= 1.0) {
            return material;
        }
        let mask = Node::new(Family::Material, "mask", self.span(m)).with("opacity", value).with("material", material);
        self.import.desc.add(mask)
    }
}

/// The albedo of one scattering event from that of a thick medium (Kulla, Conty 2017, "Revisiting Physically Based
/// Shading at Imageworks").
fn single_scattering_albedo(multiple: f64) -> f64 {
    let r = multiple;
    let s = 4.09712 + 4.20863 * r - (9.59217 + 41.6808 * r + 17.7126 * r * r).sqrt();
    (1.0 - s * s).clamp(0.0, 1.0)
}

/// The albedo of a thick medium from that of one scattering event.
pub(crate) fn multiple_scattering_albedo(single: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if single_scattering_albedo(middle) < single { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn albedos_go_there_and_back() {
        for k in 1..10 {
            let multiple = f64::from(k) / 10.0;
            assert!((multiple_scattering_albedo(single_scattering_albedo(multiple)) - multiple).abs() < 1e-6);
        }
    }

    #[test]
    fn albedos_of_one_event_are_larger() {
        assert!(single_scattering_albedo(0.0) < 0.01 && single_scattering_albedo(1.0) > 0.99);
        for k in 1..20 {
            let a = f64::from(k) / 20.0;
            assert!(
                single_scattering_albedo(a) > a && single_scattering_albedo(a) > single_scattering_albedo(a - 0.05)
            );
        }
    }
}
