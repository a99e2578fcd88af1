//! Carrying out directives.

use super::{
    lexer::{Kind, Token},
    light,
    reader::{Done, Given, Reader},
    state::{self, Active, MaterialRef, NameRef, TARGETS, Target},
    texture::Values,
};
use std::rc::Rc;
use steradian_scene::{Span, Transform, names};

/// Directives that must come before `WorldBegin`.
const BEFORE_WORLD: [&str; 8] =
    ["Accelerator", "Camera", "Film", "Integrator", "PixelFilter", "Sampler", "TransformTimes", "WorldBegin"];

/// Directives that must come after `WorldBegin`.
const IN_WORLD: [&str; 17] = [
    "AreaLightSource",
    "AttributeBegin",
    "AttributeEnd",
    "Import",
    "LightSource",
    "MakeNamedMaterial",
    "Material",
    "NamedMaterial",
    "ObjectBegin",
    "ObjectEnd",
    "ObjectInstance",
    "ReverseOrientation",
    "Shape",
    "Texture",
    "TransformBegin",
    "TransformEnd",
    "WorldEnd",
];

/// Directives that may stand anywhere.
const ANYWHERE: [&str; 16] = [
    "ActiveTransform",
    "Attribute",
    "ColorSpace",
    "ConcatTransform",
    "CoordinateSystem",
    "CoordSysTransform",
    "Identity",
    "Include",
    "LookAt",
    "MakeNamedMedium",
    "MediumInterface",
    "Option",
    "Rotate",
    "Scale",
    "Transform",
    "Translate",
];

/// Parameters that one target of `Attribute` may collect.
const MAX_ATTRIBUTES: usize = 1000;

impl Reader<'_> {
    pub(super) fn directive(&mut self, token: Token) -> Done {
        let lexer = self.lexer();
        let span = lexer.token_span(token);
        let word = if token.kind == Kind::Word { String::from_utf8_lossy(lexer.bytes(token)) } else { "".into() };
        let word = word.into_owned();
        self.check_place(&word, span);
        match word.as_str() {
            "Shape" => self.shape(),
            "AttributeBegin" | "TransformBegin" => self.begin(span, false),
            "AttributeEnd" | "TransformEnd" => {
                self.end(&word, span, false);
                Ok(())
            }
            "Material" => {
                let dict = self.dict(Some(Target::Material))?;
                self.state.material = MaterialRef::Index(self.scene.add_material(dict));
                Ok(())
            }
            "NamedMaterial" => {
                self.state.material = MaterialRef::Named(self.name_ref()?);
                Ok(())
            }
            "MakeNamedMaterial" => {
                let dict = self.dict(Some(Target::Material))?;
                let (name, span) = (dict.kind.clone(), dict.span);
                self.scene.add_named_material(name, dict, span);
                Ok(())
            }
            "Texture" => self.texture(),
            "LightSource" => self.light_source(),
            "AreaLightSource" => self.area_light_source(),
            "MakeNamedMedium" => self.make_named_medium(),
            "MediumInterface" => self.medium_interface(),
            "ReverseOrientation" => {
                self.state.reverse_orientation ^= true;
                Ok(())
            }
            "ObjectBegin" => self.object_begin(span),
            "ObjectEnd" => {
                self.object_end(span);
                Ok(())
            }
            "ObjectInstance" => self.object_instance(span),
            "Identity" | "Translate" | "Scale" | "Rotate" | "LookAt" | "Transform" | "ConcatTransform"
            | "CoordinateSystem" | "CoordSysTransform" => self.transform(&word, span),
            "ActiveTransform" => self.active_transform(),
            "TransformTimes" => self.transform_times(span),
            "Attribute" => self.attribute(),
            "ColorSpace" => self.color_space(),
            "Option" => self.option(),
            "Include" => self.include(false),
            "Import" => self.include(true),
            "WorldBegin" => {
                self.begin_world();
                Ok(())
            }
            "WorldEnd" => {
                self.scene.report.note(span, "WorldEnd is of pbrt-v3 and has no effect");
                Ok(())
            }
            "Camera" => self.camera(span),
            "Film" | "PixelFilter" | "Sampler" | "Integrator" | "Accelerator" => self.global(&word, span),
            _ => self.unknown(token, span),
        }
    }

    fn light_source(&mut self) -> Done {
        let dict = self.dict(Some(Target::Light))?;
        self.warn_if_animated(dict.span);
        let (ctm, medium) = (self.state.transform(), self.state.exterior.as_ref());
        self.scene.add_light(&dict, ctm, medium);
        Ok(())
    }

    fn area_light_source(&mut self) -> Done {
        let dict = self.dict(Some(Target::Light))?;
        // An empty name ends the emission of what follows.
        self.state.area_light = if dict.kind.is_empty() { None } else { light::area(&mut self.scene, &dict) };
        Ok(())
    }

    fn make_named_medium(&mut self) -> Done {
        let dict = self.dict(Some(Target::Medium))?;
        self.warn_if_animated(dict.span);
        let (name, span) = (dict.kind.clone(), dict.span);
        self.scene.add_medium(&name, &dict, self.state.transform(), span);
        Ok(())
    }

    fn transform_times(&mut self, span: Span) -> Done {
        self.scene.transform_times = self.numbers::<2>()?;
        if self.scene.transform_times[0] >= self.scene.transform_times[1] {
            return self.refuse(span, "the end of the motion is not after its beginning");
        }
        Ok(())
    }

    fn color_space(&mut self) -> Done {
        let (name, span) = self.quoted()?;
        match state::color_space(&name) {
            Some(space) => self.state.space = space,
            None => {
                let help = names::did_you_mean(&name, state::COLOR_SPACES.iter().map(|c| c.0));
                self.scene.report.error_help(span, format!("unknown colour space '{name}'"), help);
            }
        }
        Ok(())
    }

    fn camera(&mut self, span: Span) -> Done {
        let dict = self.dict(None)?;
        if let Some(inverse) = self.state.ctm[0].inverse() {
            let end = self.state.ctm[1].inverse().unwrap_or(inverse);
            self.coordinate_systems.insert("camera".into(), [inverse, end]);
        }
        self.warn_if_replaced("Camera", self.globals.camera.is_some(), span);
        self.globals.camera = Some((dict, self.state.clone()));
        Ok(())
    }

    /// A setting of which the scene has one, other than the camera.
    fn global(&mut self, word: &str, span: Span) -> Done {
        let dict = self.dict(None)?;
        let g = &mut self.globals;
        let slot = match word {
            "Film" => &mut g.film,
            "PixelFilter" => &mut g.filter,
            "Sampler" => &mut g.sampler,
            "Integrator" => &mut g.integrator,
            _ => &mut g.accelerator,
        };
        let replaced = slot.replace(dict).is_some();
        self.warn_if_replaced(word, replaced, span);
        Ok(())
    }

    /// Reports what is no directive.
    fn unknown(&mut self, token: Token, span: Span) -> Done {
        let found = self.lexer().excerpt(token);
        let known = BEFORE_WORLD.iter().chain(&IN_WORLD).chain(&ANYWHERE).copied();
        let (message, help) = match token.kind {
            Kind::Word if found.starts_with(|c: char| c.is_ascii_alphabetic()) => {
                (format!("unknown directive '{found}'"), names::did_you_mean(&found, known))
            }
            _ => (format!("expected a directive, found '{found}'"), None),
        };
        // What follows is not wrong because of a slip here.
        if !self.in_world && help.as_deref().is_some_and(|h| h.contains("'WorldBegin'")) {
            self.begin_world();
        }
        self.scene.report.error_help(span, message, help);
        Err(Given)
    }

    fn begin_world(&mut self) {
        self.in_world = true;
        self.state.ctm = [Transform::IDENTITY; 2];
        self.state.active = Active::All;
        self.coordinate_systems.insert("world".into(), self.state.ctm);
    }

    /// Reports directives on the wrong side of `WorldBegin`, each kind once, and lets them be carried out all the same.
    pub(super) fn check_place(&mut self, word: &str, span: Span) {
        if self.in_world && BEFORE_WORLD.contains(&word) {
            if self.scene.report.first_time(word) {
                self.scene.report.error(span, format!("{word} must come before WorldBegin"));
            }
        } else if !self.in_world && IN_WORLD.contains(&word) && self.scene.report.first_time(word) {
            self.scene.report.error(span, format!("{word} must come after WorldBegin"));
        }
    }

    pub(super) fn warn_if_replaced(&mut self, word: &str, replaced: bool, span: Span) {
        if replaced {
            self.scene.report.warn(span, format!("{word} is given twice; the last one counts"));
        }
    }

    pub(super) fn warn_if_animated(&mut self, span: Span) {
        if self.state.is_animated() {
            self.scene.report.approximated(span, state::STANDS_STILL);
        }
    }

    pub(super) fn shape(&mut self) -> Done {
        let dict = self.dict(Some(Target::Shape))?;
        self.scene.add_shape(&dict, &self.state, self.object.map(|(index, _)| index));
        Ok(())
    }

    pub(super) fn texture(&mut self) -> Done {
        let (name, span) = self.quoted()?;
        let (ty, ty_span) = self.quoted()?;
        let dict = self.dict(Some(Target::Texture))?;
        self.warn_if_animated(dict.span);
        let values = match ty.as_str() {
            "float" => Values::Float,
            // The word of pbrt-v3.
            "spectrum" | "color" => Values::Spectrum,
            _ => {
                let help = names::did_you_mean(&ty, ["float", "spectrum"]);
                self.scene.report.error_help(ty_span, format!("unknown texture type '{ty}'"), help);
                return Ok(());
            }
        };
        self.scene.add_texture(name, values, dict, self.state.transform(), span);
        Ok(())
    }

    pub(super) fn medium_interface(&mut self) -> Done {
        let interior = self.name_ref()?;
        let exterior = match self.peek()?.kind {
            Kind::Quoted => self.name_ref()?,
            _ => interior.clone(),
        };
        let named = |m: NameRef| (!m.name.is_empty()).then_some(m);
        self.state.interior = named(interior);
        self.state.exterior = named(exterior);
        Ok(())
    }

    pub(super) fn attribute(&mut self) -> Done {
        let dict = self.dict(None)?;
        let Some(target) = TARGETS.iter().position(|t| *t == dict.kind) else {
            let help = names::did_you_mean(&dict.kind, TARGETS);
            let message = format!("unknown target '{}'; known are {}", dict.kind, TARGETS.join(", "));
            self.scene.report.error_help(dict.span, message, help);
            return Ok(());
        };
        let span = dict.span;
        let list = Rc::make_mut(&mut self.state.attributes[target]);
        list.extend(dict.into_params().map(Rc::new));
        if list.len() > MAX_ATTRIBUTES {
            list.truncate(MAX_ATTRIBUTES);
            self.scene.report.error(span, format!("more than {MAX_ATTRIBUTES} attributes for one target"));
        }
        Ok(())
    }
}
