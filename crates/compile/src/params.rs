//! Reading the parameters of nodes: types and ranges are checked here, once.
//!
//! Defaults are those of the schema's rows. Where a default is computed, or another one counts under a condition, the
//! caller gives it (`float_or` and so on).

use super::Compiler;
use std::sync::Arc;
use steradian_math::{
    DVec3, Vec3,
    color::{RgbSpace, space},
    spectra::{
        self, Blackbody, Curve, Spd,
        role::{Color, Role},
    },
};
use steradian_scene::{ColorSpace, Format, Node, NodeId, Param, SpectrumValue, Transform, Value, names};
use steradian_schema::Parameter;
use steradian_texture::{FloatTexture, SpectrumTexture};

/// The RGB space of the mathematics crate.
pub fn rgb_space(space: ColorSpace) -> &'static RgbSpace {
    match space {
        ColorSpace::Srgb => &space::REC709,
        ColorSpace::DciP3 => &space::DCI_P3,
        ColorSpace::Rec2020 => &space::REC2020,
        ColorSpace::Aces => &space::ACES2065_1,
    }
}

/// Default of a parameter by the schema, as `read` takes it from the row.
pub(super) fn default_of<T>(node: &Node, name: &str, read: impl FnOnce(&'static Parameter) -> Option<T>) -> Option<T> {
    node.family.parameter(&node.kind, name).and_then(read)
}

impl Compiler<'_> {
    /// A node of the description, for as long as the description lives.
    pub(super) fn node<'n>(&self, id: NodeId) -> &'n Node
    where
        Self: 'n,
    {
        self.desc.node(id)
    }

    fn wrong_type(&mut self, node: &Node, p: &Param, expected: &str) {
        let what = format!("parameter '{}' of {} '{}' must be {expected}", p.name, node.family.noun(), node.kind);
        self.error(p.span.or(node.span), what);
    }

    /// A value of a type, if it is there; one of another type is reported.
    pub(super) fn typed<'n, T>(
        &mut self,
        node: &'n Node,
        name: &str,
        expected: &str,
        get: impl FnOnce(&'n Node) -> Option<T>,
    ) -> Option<T> {
        let p = node.param(name)?;
        let value = get(node);
        if value.is_none() {
            self.wrong_type(node, p, expected);
        }
        value
    }

    /// Default of a parameter by the schema. Rows that lack one are a fault of the schema where it has the node's kind;
    /// the fault is reported.
    fn default<T>(&mut self, node: &Node, name: &str, read: impl FnOnce(&'static Parameter) -> Option<T>) -> Option<T> {
        let kinds = self.options.registry.kinds();
        let default = kinds.parameter(node.family, &node.kind, name).and_then(read);
        if default.is_none() && self.model_of(node).is_some() {
            let what = format!("the schema lacks a default of '{name}' of {} '{}'", node.family.noun(), node.kind);
            debug_assert!(false, "{what}");
            self.diagnostics.warn(&self.desc.sources, node.span, what);
        }
        default
    }

    /// Default of a number by the schema.
    pub(super) fn default_number(&mut self, node: &Node, name: &str) -> f64 {
        self.default(node, name, Parameter::default_number).unwrap_or_default()
    }

    /// Default of a spectrum by the schema: a number, or the three of a colour.
    pub(super) fn default_spectrum(&mut self, node: &Node, name: &str) -> SpectrumValue {
        let read = |p: &'static Parameter| match p.default_number() {
            Some(v) => Some(SpectrumValue::Constant(v)),
            None => p.default_numbers().map(|rgb| SpectrumValue::Rgb(rgb, ColorSpace::Srgb)),
        };
        self.default(node, name, read).unwrap_or(SpectrumValue::Constant(0.0))
    }

    /// A whole number, if it is there.
    pub(super) fn given_int(&mut self, node: &Node, name: &str) -> Option<i64> {
        self.typed(node, name, "a whole number", |n| n.int(name))
    }

    /// A whole number.
    pub(super) fn int(&mut self, node: &Node, name: &str) -> i64 {
        let default = self.default(node, name, |p| p.usual_default().parse().ok()).unwrap_or_default();
        self.given_int(node, name).unwrap_or(default)
    }

    /// A word, if it is there.
    pub(super) fn given_word<'n>(&mut self, node: &'n Node, name: &str) -> Option<&'n str> {
        self.typed(node, name, "a string", |n| n.string(name))
    }

    /// A word.
    pub(super) fn word<'n>(&mut self, node: &'n Node, name: &str) -> &'n str {
        let default = self.default(node, name, |p| Some(p.usual_default())).unwrap_or_default();
        self.given_word(node, name).unwrap_or(default)
    }

    /// A reference to another node, if it is there.
    pub(super) fn reference(&mut self, node: &Node, name: &str) -> Option<NodeId> {
        self.typed(node, name, "a reference to another node", |n| n.node(name))
    }

    /// A transform; the identity where it is absent.
    pub(super) fn transform(&mut self, node: &Node, name: &str) -> Transform {
        self.typed(node, name, "a transform", |n| n.transform(name)).unwrap_or_default()
    }

    /// A point or vector in the range of `f32`.
    pub(super) fn vec3(&mut self, node: &Node, name: &str) -> Vec3 {
        self.dvec3(node, name).as_vec3()
    }

    /// As [`Self::vec3`], with all digits.
    pub(super) fn dvec3(&mut self, node: &Node, name: &str) -> DVec3 {
        let default = self.default(node, name, Parameter::default_numbers);
        self.dvec3_or(node, name, default.map_or(DVec3::ZERO, DVec3::from_array))
    }

    /// As [`Self::dvec3`], with a default of the caller's.
    pub(super) fn dvec3_or(&mut self, node: &Node, name: &str, default: DVec3) -> DVec3 {
        let Some(v) = self.typed(node, name, "three numbers", |n| n.vec3(name)) else { return default };
        let v = DVec3::from(v);
        if !v.as_vec3().is_finite() {
            self.too_large(node, name);
            return default;
        }
        v
    }

    /// A list of numbers in the range of `f32`, if it is there.
    pub(super) fn list(&mut self, node: &Node, name: &str) -> Option<Vec<f32>> {
        let list = self.typed(node, name, "a list of numbers", |n| n.floats(name))?;
        let list: Vec<f32> = list.iter().map(|v| *v as f32).collect();
        if !list.iter().all(|v| v.is_finite()) {
            self.too_large(node, name);
            return None;
        }
        Some(list)
    }

    fn too_large(&mut self, node: &Node, name: &str) {
        let span = node.param(name).and_then(|p| p.span).or(node.span);
        self.error(span, format!("parameter '{name}' of {} '{}' is too large a number", node.family.noun(), node.kind));
    }

    /// A number that counts where it is above zero.
    pub(super) fn if_positive(&mut self, node: &Node, name: &str) -> Option<f32> {
        Some(self.float_or(node, name, 0.0)).filter(|v| *v > 0.0)
    }

    /// A finite number.
    pub(super) fn float(&mut self, node: &Node, name: &str) -> f32 {
        let default = self.default_number(node, name);
        self.float_or(node, name, default)
    }

    /// A finite number, with a default of the caller's.
    pub(super) fn float_or(&mut self, node: &Node, name: &str, default: f64) -> f32 {
        let Some(p) = node.param(name) else { return default as f32 };
        match node.float(name) {
            Some(v) if (v as f32).is_finite() => v as f32,
            Some(v) => {
                self.error(p.span.or(node.span), format!("parameter '{name}' is {v}, which is not a usable number"));
                default as f32
            }
            None => {
                self.wrong_type(node, p, "a number");
                default as f32
            }
        }
    }

    /// A finite number of which all digits count.
    pub(super) fn double(&mut self, node: &Node, name: &str) -> f64 {
        let default = self.default_number(node, name);
        // Reports what is wrong with it.
        self.float_or(node, name, default);
        node.float(name).filter(|v| v.is_finite()).unwrap_or(default)
    }

    /// A number greater than zero.
    pub(super) fn positive(&mut self, node: &Node, name: &str) -> f32 {
        let default = self.default_number(node, name);
        self.positive_or(node, name, default)
    }

    /// A number greater than zero, with a default of the caller's.
    pub(super) fn positive_or(&mut self, node: &Node, name: &str, default: f64) -> f32 {
        let v = self.float_or(node, name, default);
        if v > 0.0 {
            return v;
        }
        let span = node.param(name).and_then(|p| p.span).or(node.span);
        self.error(
            span,
            format!(
                "parameter '{name}' of {} '{}' is {v}; it must be greater than zero",
                node.family.noun(),
                node.kind
            ),
        );
        default as f32
    }

    /// A truth value.
    pub(super) fn bool(&mut self, node: &Node, name: &str) -> bool {
        let default = self.default(node, name, Parameter::default_flag).unwrap_or_default();
        self.bool_or(node, name, default)
    }

    /// A truth value, with a default of the caller's.
    pub(super) fn bool_or(&mut self, node: &Node, name: &str, default: bool) -> bool {
        let Some(p) = node.param(name) else { return default };
        node.bool(name).unwrap_or_else(|| {
            self.wrong_type(node, p, "true or false");
            default
        })
    }

    /// A word from a table, which has the schema's default.
    pub(super) fn choice<T: Copy, const N: usize>(&mut self, node: &Node, name: &str, table: &[(&str, T); N]) -> T {
        const { assert!(N > 0) };
        let default = self.default(node, name, |p| table.iter().find(|t| t.0 == p.usual_default()));
        self.choice_or(node, name, default.unwrap_or(&table[0]).1, table)
    }

    /// A word from a table, with a default of the caller's.
    pub(super) fn choice_or<T: Copy>(&mut self, node: &Node, name: &str, default: T, table: &[(&str, T)]) -> T {
        let Some(p) = node.param(name) else { return default };
        let Some(word) = node.string(name) else {
            self.wrong_type(node, p, "a string");
            return default;
        };
        match table.iter().find(|t| t.0 == word) {
            Some(t) => t.1,
            None => {
                let known = table.iter().map(|t| t.0);
                let list = table.iter().map(|t| t.0).collect::<Vec<_>>().join(", ");
                self.error_help(
                    p.span.or(node.span),
                    format!("'{word}' is not a {name}; known are {list}"),
                    names::did_you_mean(word, known),
                );
                default
            }
        }
    }

    /// A spectrum in a role. Errors are reported and give black.
    pub(super) fn color(&mut self, node: &Node, p: Option<&Param>, value: &SpectrumValue, role: Role) -> Color {
        let span = p.and_then(|p| p.span).or(node.span);
        let name = p.map_or("value", |p| p.name.as_str());
        match value {
            SpectrumValue::Constant(v) if (*v as f32).is_finite() => match role {
                Role::Albedo => Color::constant((*v as f32).clamp(0.0, 1.0)),
                _ => Color::constant((*v as f32).max(0.0)),
            },
            SpectrumValue::Rgb(v, space) if v.iter().all(|v| (*v as f32).is_finite()) => {
                let rgb = Vec3::new(v[0] as f32, v[1] as f32, v[2] as f32);
                // Mitsuba takes the spectrum of a reflectance for coefficients of media too, where there is one.
                let mitsuba = self.desc.format == Format::Mitsuba && rgb.max_element() <= 1.0;
                let role = if matches!(role, Role::Unbounded | Role::Index) && mitsuba { Role::Albedo } else { role };
                Color::rgb(rgb, rgb_space(*space), role, self.mode)
            }
            SpectrumValue::Constant(_) | SpectrumValue::Rgb(..) => {
                self.error(span, format!("parameter '{name}' has a value that is not a finite number"));
                Color::BLACK
            }
            SpectrumValue::Sampled { lambdas, values } => match Curve::new(lambdas.clone(), values.clone()) {
                Ok(curve) => Color::curve(&Spd::Curve(Arc::new(curve)), role, self.mode),
                Err(e) => {
                    self.error(span, format!("parameter '{name}': {e}"));
                    Color::BLACK
                }
            },
            SpectrumValue::Blackbody(kelvin) if kelvin.is_finite() && *kelvin > 0.0 => {
                Color::curve(&Spd::Blackbody(Blackbody::normalized(*kelvin)), role, self.mode)
            }
            SpectrumValue::Blackbody(kelvin) => {
                self.error(span, format!("a black body cannot have the temperature {kelvin} K"));
                Color::BLACK
            }
            SpectrumValue::Named(word) => match spectra::named(word) {
                Some(curve) => {
                    // In RGB mode Mitsuba takes the colours of its metals' constants as if these were emitted.
                    let is_metal = self.mode == spectra::ColorMode::Rgb
                        && self.desc.format == Format::Mitsuba
                        && word.starts_with("metal-");
                    Color::curve(
                        &Spd::Curve(Arc::new(curve)),
                        if is_metal { Role::Illuminant } else { role },
                        self.mode,
                    )
                }
                None => {
                    self.error_help(
                        span,
                        format!("unknown spectrum '{word}'"),
                        names::did_you_mean(word, spectra::named::names()),
                    );
                    Color::BLACK
                }
            },
        }
    }

    /// A spectrum or texture in a role.
    pub(super) fn spectrum(&mut self, node: &Node, name: &str, role: Role) -> SpectrumTexture {
        let default = self.default_spectrum(node, name);
        self.spectrum_or(node, name, role, default)
    }

    /// A spectrum or texture in a role, with a default of the caller's.
    pub(super) fn spectrum_or(
        &mut self,
        node: &Node,
        name: &str,
        role: Role,
        default: SpectrumValue,
    ) -> SpectrumTexture {
        let Some(p) = node.param(name) else {
            return SpectrumTexture::Constant(self.color(node, None, &default, role));
        };
        match &p.value {
            Value::Float(v) => SpectrumTexture::Constant(self.color(node, Some(p), &SpectrumValue::Constant(*v), role)),
            Value::Int(v) => {
                SpectrumTexture::Constant(self.color(node, Some(p), &SpectrumValue::Constant(*v as f64), role))
            }
            Value::Spectrum(s) => SpectrumTexture::Constant(self.color(node, Some(p), s, role)),
            Value::Node(id) => self.texture(*id, role),
            _ => {
                self.wrong_type(node, p, "a number, a spectrum or a texture");
                SpectrumTexture::Constant(self.color(node, None, &default, role))
            }
        }
    }

    /// A constant spectrum in a role; the first value of textures, which are reported.
    pub(super) fn constant_color(&mut self, node: &Node, name: &str, role: Role) -> Color {
        let default = self.default_spectrum(node, name);
        self.constant_color_or(node, name, role, default)
    }

    /// As [`Self::constant_color`], with a default of the caller's.
    pub(super) fn constant_color_or(&mut self, node: &Node, name: &str, role: Role, default: SpectrumValue) -> Color {
        match self.spectrum_or(node, name, role, default) {
            SpectrumTexture::Constant(c) => c,
            SpectrumTexture::Texture(..) => {
                let span = node.param(name).and_then(|p| p.span).or(node.span);
                self.approximated(span, format!("parameter '{name}' cannot be textured here; one is used"));
                Color::constant(1.0)
            }
        }
    }

    /// A number or texture.
    pub(super) fn float_texture(&mut self, node: &Node, name: &str) -> FloatTexture {
        let default = self.default_number(node, name);
        self.float_texture_or(node, name, default)
    }

    /// A number or texture, with a default of the caller's.
    pub(super) fn float_texture_or(&mut self, node: &Node, name: &str, default: f64) -> FloatTexture {
        let Some(p) = node.param(name) else { return FloatTexture::Constant(default as f32) };
        match &p.value {
            Value::Node(id) => match self.texture(*id, Role::Unbounded) {
                SpectrumTexture::Texture(id, _) => FloatTexture::Texture(id),
                SpectrumTexture::Constant(c) => FloatTexture::Constant(c.luminance(self.mode)),
            },
            Value::Spectrum(SpectrumValue::Rgb(v, _)) => {
                let mean = (v.iter().sum::<f64>() / 3.0) as f32;
                if !mean.is_finite() {
                    self.too_large(node, name);
                    return FloatTexture::Constant(default as f32);
                }
                FloatTexture::Constant(mean)
            }
            _ => FloatTexture::Constant(self.float_or(node, name, default)),
        }
    }

    /// The value of a spectral parameter at the sodium line (589.3 nm), for what cannot depend on the wavelength.
    pub(super) fn at_sodium_line(&mut self, node: &Node, name: &str) -> f32 {
        let value = match node.get(name) {
            Some(Value::Spectrum(SpectrumValue::Named(word))) => spectra::named(word).map(|c| c.eval(589.3)),
            Some(Value::Spectrum(SpectrumValue::Sampled { lambdas, values })) => {
                Curve::new(lambdas.clone(), values.clone()).ok().map(|c| c.extended().eval(589.3))
            }
            Some(Value::Spectrum(SpectrumValue::Rgb(v, _))) => Some(v[1] as f32),
            _ => return self.float(node, name),
        };
        match value {
            Some(v) if v.is_finite() => v,
            _ => {
                // Reports what is wrong with it.
                self.constant_color(node, name, Role::Index);
                self.default_number(node, name) as f32
            }
        }
    }
}
