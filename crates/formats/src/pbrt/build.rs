//! Making one node from one directive: each line names pbrt's parameter, Steradian's, and pbrt's default.

use super::{
    dict::Dict,
    param::Type,
    scene::Scene,
    spectrum::{self, Role},
};
use steradian_scene::{Family, Node, NodeId, Span, SpectrumValue, Value};

/// A node under construction.
pub(super) struct Build<'a, 'o> {
    pub scene: &'a mut Scene<'o>,
    pub dict: &'a Dict,
    pub node: Node,
}

impl<'a, 'o> Build<'a, 'o> {
    pub fn new(scene: &'a mut Scene<'o>, dict: &'a Dict, family: Family, kind: &str) -> Self {
        Self { scene, dict, node: Node::new(family, kind, Some(dict.span)) }
    }

    /// Reports what was not asked for and adds the node to the scene.
    pub fn finish(self) -> NodeId {
        self.dict.report_unused(&mut self.scene.report, self.node.family.noun());
        self.scene.desc.add(self.node)
    }

    pub fn set(&mut self, to: &str, value: impl Into<Value>) {
        self.node.set(to, value, None);
    }

    fn set_default(&mut self, to: &str, default: Option<impl Into<Value>>) {
        if let Some(v) = default {
            self.set(to, v);
        }
    }

    fn set_from(&mut self, from: &str, to: &str, value: impl Into<Value>) {
        let span = self.dict.span_of(from);
        self.node.set(to, value, Some(span));
    }

    pub fn error(&mut self, from: &str, message: impl Into<String>) {
        let span = self.dict.span_of(from);
        self.scene.report.error(span, message);
    }

    /// Takes a parameter that has no effect on the picture, and notes why.
    pub fn no_effect(&mut self, from: &'static str, ty: Type, why: &str) {
        self.dict.no_effect(&mut self.scene.report, self.node.family.noun(), from, ty, why);
    }

    /// A number; without a default it stays unset where the file does not give it.
    pub fn float(&mut self, from: &'static str, to: &str, default: impl Into<Option<f64>>) {
        match self.dict.float(&mut self.scene.report, from) {
            Some(v) => self.set_from(from, to, v),
            None => self.set_default(to, default.into()),
        }
    }

    /// A number that must be above zero.
    pub fn positive(&mut self, from: &'static str, to: &str, default: impl Into<Option<f64>>) {
        self.float(from, to, default);
        if self.node.float(to).is_some_and(|v| v <= 0.0) {
            self.error(from, format!("parameter '{from}' must be above 0"));
        }
    }

    pub fn int(&mut self, from: &'static str, to: &str, default: impl Into<Option<i64>>) {
        match self.dict.int(&mut self.scene.report, from) {
            Some(v) => self.set_from(from, to, i64::from(v)),
            None => self.set_default(to, default.into()),
        }
    }

    pub fn bool(&mut self, from: &'static str, to: &str, default: impl Into<Option<bool>>) {
        match self.dict.bool(&mut self.scene.report, from) {
            Some(v) => self.set_from(from, to, v),
            None => self.set_default(to, default.into()),
        }
    }

    pub fn text(&mut self, from: &'static str, to: &str, default: impl Into<Option<&'static str>>) {
        match self.dict.text(&mut self.scene.report, from) {
            Some((v, span)) => {
                self.node.set(to, v, Some(span));
            }
            None => self.set_default(to, default.into()),
        }
    }

    /// One of some words, given with what they are called here; an error for any other.
    pub fn choice(&mut self, from: &'static str, to: &str, choices: &[(&str, &str)], default: &str) {
        let mut word = default;
        if let Some((v, span)) = self.dict.text(&mut self.scene.report, from) {
            match choices.iter().find(|(theirs, _)| *theirs == v) {
                Some((_, ours)) => word = ours,
                None => {
                    let help = steradian_scene::names::did_you_mean(v, choices.iter().map(|c| c.0));
                    self.scene.report.error_help(span, format!("parameter '{from}' cannot be '{v}'"), help);
                }
            }
        }
        self.set_from(from, to, word);
    }

    /// A file, found on the search path. Returns whether the parameter is there, even if the file is not.
    pub fn file(&mut self, from: &'static str, to: &str) -> bool {
        let Some((name, span)) = self.dict.text(&mut self.scene.report, from).filter(|(n, _)| !n.is_empty()) else {
            return false;
        };
        match self.scene.search.find(name) {
            Ok(path) => {
                self.node.set(to, path, Some(span));
            }
            Err(fault) => self.scene.report.error(span, fault.to_string()),
        }
        true
    }

    /// A file that the model cannot do without.
    pub fn required_file(&mut self, from: &'static str, to: &str) {
        if !self.file(from, to) {
            let message = format!("{} '{}' needs \"string {from}\"", self.node.family.noun(), self.dict.kind);
            self.scene.report.error(self.dict.span, message);
        }
    }

    pub fn vec3(&mut self, from: &'static str, to: &str, ty: Type, default: impl Into<Option<[f64; 3]>>) {
        match self.dict.vec3(&mut self.scene.report, from, ty) {
            Some(v) => self.set_from(from, to, v),
            None => self.set_default(to, default.into()),
        }
    }

    /// A list of numbers, unset where absent.
    pub fn floats(&mut self, from: &'static str, to: &str, ty: Type) {
        if let Some(v) = self.dict.floats(&mut self.scene.report, from, ty) {
            self.set_from(from, to, v.to_vec());
        }
    }

    pub fn spectrum(&mut self, from: &'static str, to: &str, role: Role, default: impl Into<Option<SpectrumValue>>) {
        match spectrum::find(self.scene, self.dict, from, role) {
            Some((v, span)) => {
                self.node.set(to, v, Some(span));
            }
            None => self.set_default(to, default.into()),
        }
    }

    /// A number or a spectrum, as the indices of refraction of dielectrics are.
    pub fn number_or_spectrum(&mut self, from: &'static str, to: &str, default: f64) {
        if self.dict.has(from, &[Type::Float]) {
            self.positive(from, to, None);
        } else {
            self.spectrum(from, to, Role::Unbounded, None);
        }
        if self.node.get(to).is_none() {
            self.set(to, default);
        }
    }

    /// A number or a texture of numbers. Returns whether it is given.
    pub fn float_texture(&mut self, from: &'static str, to: &str, default: impl Into<Option<f64>>) -> bool {
        if self.dict.has(from, &[Type::Texture]) {
            if let Some((name, span)) = self.dict.texture(&mut self.scene.report, from) {
                if let Some(id) = self.scene.float_texture(name, span) {
                    self.node.set(to, id, Some(span));
                }
                return true;
            }
        } else if self.dict.has(from, &[Type::Float]) {
            self.float(from, to, None);
            return true;
        }
        // Asks with the types for the sake of the message about any other.
        self.dict.find(&mut self.scene.report, from, &[Type::Float, Type::Texture]);
        self.set_default(to, default.into());
        false
    }

    /// A spectrum or a texture of spectra. Returns whether it is given.
    pub fn spectrum_texture(
        &mut self,
        from: &'static str,
        to: &str,
        role: Role,
        default: impl Into<Option<SpectrumValue>>,
    ) -> bool {
        if self.dict.has(from, &[Type::Texture]) {
            if let Some((name, span)) = self.dict.texture(&mut self.scene.report, from) {
                if let Some(id) = self.scene.spectrum_texture(name, span) {
                    self.node.set(to, id, Some(span));
                }
                return true;
            }
        } else if self.dict.has(from, &spectrum::TYPES) {
            self.spectrum(from, to, role, None);
            return true;
        }
        let [rgb, table, blackbody] = spectrum::TYPES;
        self.dict.find(&mut self.scene.report, from, &[rgb, table, blackbody, Type::Texture]);
        self.set_default(to, default.into());
        false
    }
}

/// A table entry is enough for models that keep pbrt's own parameters.
#[derive(Clone, Copy, Debug)]
pub(super) enum Field {
    Float(&'static str, f64),
    Int(&'static str, i64),
    Text(&'static str),
    FloatTexture(&'static str, f64),
    /// Unset where absent.
    OptionalFloatTexture(&'static str),
    SpectrumTexture(&'static str, Role, f64),
    /// Unset where absent.
    OptionalSpectrumTexture(&'static str, Role),
    /// Number or spectrum.
    Index(&'static str, f64),
    Spectrum(&'static str, Role, f64),
    /// Unset where absent.
    OptionalSpectrum(&'static str, Role),
    Point(&'static str, [f64; 3]),
    Floats(&'static str),
    /// A list of `rgb`.
    Colors(&'static str),
}

impl Build<'_, '_> {
    /// Reads the parameters of a model of a program's own; `None` for kinds that it does not have.
    pub fn own(&mut self) -> Option<()> {
        use steradian_schema::Type as Kind;
        let model = self.scene.options.kinds.own(self.node.family).find(|m| m.kind == self.node.kind)?;
        for p in model.all() {
            let n = p.name;
            match p.kind {
                Kind::Texture => _ = self.spectrum_texture(n, n, Role::Albedo, None),
                Kind::Spectrum => self.spectrum(n, n, Role::Unbounded, None),
                Kind::Scalar => _ = self.float_texture(n, n, None),
                Kind::Number => self.float(n, n, None),
                Kind::Integer => self.int(n, n, None),
                Kind::Flag => self.bool(n, n, None),
                Kind::Word(_) | Kind::Text => self.text(n, n, None),
                Kind::Vector => self.vec3(n, n, Type::Vector3, None),
                Kind::List => self.floats(n, n, Type::Float),
                // Others are no parameters of models of one's own, but of groups, which have pbrt's own names here.
                _ => {}
            }
        }
        Some(())
    }

    /// Reads parameters that keep their names.
    pub fn fields(&mut self, fields: &[Field]) {
        let constant = SpectrumValue::Constant;
        for &field in fields {
            match field {
                Field::Float(n, v) => self.float(n, n, v),
                Field::Int(n, v) => self.int(n, n, v),
                Field::Text(n) => self.text(n, n, None),
                Field::FloatTexture(n, v) => _ = self.float_texture(n, n, v),
                Field::OptionalFloatTexture(n) => _ = self.float_texture(n, n, None),
                Field::SpectrumTexture(n, role, v) => _ = self.spectrum_texture(n, n, role, constant(v)),
                Field::OptionalSpectrumTexture(n, role) => _ = self.spectrum_texture(n, n, role, None),
                Field::Index(n, v) => self.number_or_spectrum(n, n, v),
                Field::Spectrum(n, role, v) => self.spectrum(n, n, role, constant(v)),
                Field::OptionalSpectrum(n, role) => self.spectrum(n, n, role, None),
                Field::Point(n, v) => self.vec3(n, n, Type::Point3, v),
                Field::Floats(n) => self.floats(n, n, Type::Float),
                Field::Colors(n) => self.floats(n, n, Type::Rgb),
            }
        }
    }

    /// Source span of the model's name in the directive.
    pub fn span(&self) -> Span {
        self.dict.span
    }
}
