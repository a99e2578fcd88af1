//! Materials: UsdShade networks of UsdPreviewSurface.

use super::{
    Loss, Reader, materialx,
    stage::Prim,
    texture::{Holds, Source},
    value::Value as Field,
};
use std::rc::Rc;
use steradian_scene::{ColorSpace, Family, Node, NodeId, SpectrumValue, Value};

/// Longest chain of connections that is followed.
const MOST_CONNECTIONS: usize = 32;
/// Reflectance of surfaces without a material and a colour.
const GREY: f64 = 0.18;

/// Translated material of a surface.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Look {
    pub material: Option<NodeId>,
    pub emission: Option<NodeId>,
    /// True if it has a normal map.
    pub tangents: bool,
}

/// Values of a mesh that a look may use.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Channels {
    /// True if `displayColor` varies over the mesh.
    pub color: bool,
}

pub(super) fn rgb(color: [f64; 3]) -> SpectrumValue {
    SpectrumValue::Rgb(color, ColorSpace::Srgb)
}

/// The output of a shader.
pub(super) struct Output {
    pub shader: Rc<Prim>,
    pub name: String,
}

impl Reader<'_> {
    /// The look of a prim by the material that is bound to it.
    pub(super) fn look(&mut self, prim: &Prim, material: Option<&str>, channels: Channels) -> Look {
        let Some(path) = material else { return self.plain(prim, channels) };
        let Some(material) = self.stage.prim(path) else {
            self.count(Loss::Dropped(format!("the material '{path}' is not there")), prim, None);
            return self.plain(prim, channels);
        };
        let is_two_sided = self.flag(prim, "doubleSided", false);
        let key = format!("{is_two_sided} {}", material.key());
        if let Some(look) = self.looks.get(&key) {
            return *look;
        }
        let look = self.material(&material, is_two_sided).unwrap_or_else(|| self.plain(prim, channels));
        self.looks.insert(key, look);
        look
    }

    /// A surface without a material: its colour, diffuse.
    fn plain(&mut self, prim: &Prim, channels: Channels) -> Look {
        let reflectance = match channels.color {
            true => {
                let color = Node::new(Family::Texture, "mesh_attribute", None).with("name", "displayColor");
                Value::Node(self.stage.import.desc.add(color.with("domain", "vertex")))
            }
            false => {
                let color = self.stage.value(prim, "primvars:displayColor");
                let color = color.and_then(|v| v.numbers().and_then(|n| Some([*n.first()?, *n.get(1)?, *n.get(2)?])));
                let color = color.filter(|c| c.iter().all(|v| v.is_finite())).unwrap_or([GREY; 3]);
                Value::Spectrum(rgb(color.map(|v| v.clamp(0.0, 1.0))))
            }
        };
        self.diffuse(reflectance, channels)
    }

    /// A diffuse surface of a colour.
    pub(super) fn painted(&mut self, color: [f64; 3]) -> Look {
        self.diffuse(Value::Spectrum(rgb(color)), Channels::default())
    }

    fn diffuse(&mut self, reflectance: Value, channels: Channels) -> Look {
        let key = format!("plain {reflectance:?}");
        if let (false, Some(look)) = (channels.color, self.looks.get(&key)) {
            return *look;
        }
        let node = Node::new(Family::Material, "diffuse", None).with("reflectance", reflectance);
        let look = Look { material: Some(self.stage.import.desc.add(node)), ..Look::default() };
        self.looks.insert(key, look);
        look
    }

    /// The surface of a material; `None`, told, where there is none that is read.
    fn material(&mut self, material: &Rc<Prim>, is_two_sided: bool) -> Option<Look> {
        // What MaterialX says is the whole surface; what is beside it is a preview.
        let names = ["outputs:mtlx:surface", "outputs:surface"];
        let outputs: Vec<Output> = names.iter().filter_map(|name| self.output(material, name)).collect();
        let mut ids = Vec::new();
        for output in &outputs {
            let id = self.word(&output.shader, "info:id").unwrap_or_default();
            if matches!(id.as_str(), "UsdPreviewSurface" | "ND_UsdPreviewSurface_surfaceshader") {
                return Some(self.preview(material, &output.shader, is_two_sided));
            }
            if materialx::is_surface(&id) || self.is_matte(&output.shader, &id) {
                return Some(self.materialx(material, &output.shader, &id, is_two_sided));
            }
            ids.push(id);
        }
        let what = match ids.first() {
            Some(id) => {
                format!(
                    "its shader '{id}' is not read (UsdPreviewSurface, OpenPBR, the standard surface and diffuse ones \
                     are): the surface has its display colour"
                )
            }
            None => "it has no surface: what it is bound to has its display colour".into(),
        };
        self.count(Loss::Dropped(what), material, None);
        None
    }

    /// The shader's output that an attribute is connected to, through interfaces of materials and graphs.
    pub(super) fn output(&mut self, prim: &Rc<Prim>, attribute: &str) -> Option<Output> {
        let (mut prim, mut attribute) = (prim.clone(), attribute.to_owned());
        for _ in 0..MOST_CONNECTIONS {
            let path = self.stage.targets(&prim, &attribute, "connect").into_iter().next()?;
            let (owner, name) = super::layer::split_property(&path)?;
            prim = self.stage.prim(owner)?;
            if let (Some(name), "Shader") = (name.strip_prefix("outputs:"), self.stage.type_name(&prim).as_str()) {
                return Some(Output { shader: prim, name: name.to_owned() });
            }
            attribute = name.to_owned();
        }
        None
    }

    /// The value of an input, its own or one of an interface that it is connected to.
    pub(super) fn input(&mut self, prim: &Rc<Prim>, name: &str) -> Option<(Rc<Prim>, String, Field)> {
        let (mut prim, mut attribute) = (prim.clone(), format!("inputs:{name}"));
        for _ in 0..MOST_CONNECTIONS {
            let Some(path) = self.stage.targets(&prim, &attribute, "connect").into_iter().next() else { break };
            let (owner, name) = super::layer::split_property(&path)?;
            match (self.stage.prim(owner), name.starts_with("inputs:")) {
                (Some(owner), true) => (prim, attribute) = (owner, name.to_owned()),
                _ => break,
            }
        }
        let value = self.stage.value(&prim, &attribute)?;
        Some((prim, attribute, value))
    }

    /// Numbers of an input, held to a range.
    fn constant<const N: usize>(&mut self, shader: &Rc<Prim>, name: &str, default: [f64; N], most: f64) -> [f64; N] {
        let Some((prim, attribute, value)) = self.input(shader, name) else { return default };
        match value.tuple::<N>().filter(|t| t.iter().all(|v| v.is_finite())) {
            Some(tuple) => tuple.map(|v| v.clamp(0.0, most)),
            None => {
                self.fault(&prim, &attribute, format!("{N} finite numbers are expected"));
                default
            }
        }
    }

    /// A colour, or the texture in its place.
    fn color(&mut self, shader: &Rc<Prim>, name: &str, default: [f64; 3], most: f64) -> Value {
        match self.source(shader, name, Holds::Colors) {
            Some(Source::Texture(node)) => Value::Node(node),
            Some(Source::Color(color)) => Value::Spectrum(rgb(color.map(|v| v.clamp(0.0, most)))),
            None => Value::Spectrum(rgb(self.constant(shader, name, default, most))),
        }
    }

    fn scalar(&mut self, shader: &Rc<Prim>, name: &str, default: f64, most: f64) -> Value {
        match self.source(shader, name, Holds::Numbers) {
            Some(Source::Texture(node)) => Value::Node(node),
            Some(Source::Color([v, ..])) => Value::Float(v.clamp(0.0, most)),
            None => Value::Float(self.constant(shader, name, [default], most)[0]),
        }
    }

    /// UsdPreviewSurface, as a metallic-roughness surface.
    fn preview(&mut self, material: &Prim, shader: &Rc<Prim>, is_two_sided: bool) -> Look {
        let span = self.stage.span(shader, None);
        let base = self.color(shader, "diffuseColor", [GREY; 3], 1.0);
        let mut node = Node::new(Family::Material, "metallic_roughness", span).with("base_color", base);
        let specular_workflow = self.constant(shader, "useSpecularWorkflow", [0.0], 1.0)[0] != 0.0;
        if specular_workflow {
            self.count(Loss::Approximated("its specular colour is that of a dielectric".into()), shader, None);
            let color = match self.color(shader, "specularColor", [0.0; 3], 1.0) {
                // An index of 1.5 reflects 0.04; the colour multiplies that.
                Value::Spectrum(SpectrumValue::Rgb(c, space)) => {
                    Value::Spectrum(SpectrumValue::Rgb(c.map(|v| v / 0.04), space))
                }
                Value::Node(id) => {
                    let scaled = Node::new(Family::Texture, "scale", None).with("texture", id).with("scale", 25.0);
                    Value::Node(self.stage.import.desc.add(scaled))
                }
                other => other,
            };
            node.set("metallic", 0.0, None).set("specular_color", color, None);
        } else {
            let metallic = self.scalar(shader, "metallic", 0.0, 1.0);
            let eta = self.constant(shader, "ior", [1.5], 20.0)[0].max(1.0);
            node.set("metallic", metallic, None).set("eta", eta, None);
        }
        for (name, default, parameter) in [
            ("roughness", 0.5, "roughness"),
            ("clearcoat", 0.0, "clearcoat"),
            ("clearcoatRoughness", 0.01, "clearcoat_roughness"),
        ] {
            let value = self.scalar(shader, name, default, 1.0);
            node.set(parameter, value, None);
        }
        let mut look = Look::default();
        if let Some(Source::Texture(map)) = self.source(shader, "normal", Holds::Normals) {
            node.set("normal_map", map, None);
            look.tangents = true;
        }
        for (name, what) in [("displacement", "displacement"), ("occlusion", "")] {
            if !what.is_empty() && self.output(shader, &format!("inputs:{name}")).is_some() {
                self.count(Loss::Dropped(format!("its {what} is left out")), shader, None);
            }
        }
        node.name = Some(material.name().to_owned());
        look.emission = self.emission(shader, is_two_sided);
        let id = self.stage.import.desc.add(node);
        look.material = Some(self.masked(shader, id));
        look
    }

    fn emission(&mut self, shader: &Rc<Prim>, is_two_sided: bool) -> Option<NodeId> {
        let color = self.color(shader, "emissiveColor", [0.0; 3], 1e12);
        if let Value::Spectrum(SpectrumValue::Rgb(rgb, _)) = &color {
            if *rgb == [0.0; 3] {
                return None;
            }
            // Up to one, emission is a glow on a surface that something else lights; beyond, it is a lamp.
            self.uses_lights |= rgb.iter().any(|v| *v > 1.0);
        }
        let light = Node::new(Family::Light, "area", self.stage.span(shader, None)).with("radiance", color);
        Some(self.stage.import.desc.add(light.with("two_sided", is_two_sided)))
    }

    /// The material with its opacity: rays pass by chance, or where it is below a threshold.
    fn masked(&mut self, shader: &Rc<Prim>, material: NodeId) -> NodeId {
        let opacity = self.scalar(shader, "opacity", 1.0, 1.0);
        let threshold = self.constant(shader, "opacityThreshold", [0.0], 1.0)[0];
        let value = match opacity {
            Value::Float(v) if threshold > 0.0 => Value::Float(if v >= threshold { 1.0 } else { 0.0 }),
            Value::Node(input) if threshold > 0.0 => {
                let step = Node::new(Family::Texture, "curve", None)
                    .with("input", input)
                    .with("places", vec![-1.0, threshold])
                    .with("values", vec![0.0, 1.0])
                    .with("interpolation", "step");
                Value::Node(self.stage.import.desc.add(step))
            }
            other => other,
        };
        if matches!(value, Value::Float(v) if v >= 1.0) {
            return material;
        }
        let mode = self.input(shader, "opacityMode").and_then(|i| i.2.text().map(str::to_owned));
        if threshold == 0.0 && mode.as_deref() != Some("presence") {
            let what = "what is not opaque lets light pass unbent, and loses its reflection with it";
            self.count(Loss::Approximated(what.into()), shader, Some("inputs:opacity"));
        }
        let mask = Node::new(Family::Material, "mask", None).with("opacity", value).with("material", material);
        self.stage.import.desc.add(mask)
    }
}
