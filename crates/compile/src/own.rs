//! Compiling models of a program's own.

use super::{
    Compiler,
    registry::{Make, OwnParameter, Values},
    shapes::Placed,
};
use std::sync::Arc;
use steradian_bsdf::OwnScatter;
use steradian_core::{
    camera::Projection,
    light::{Light, Own},
    material::OwnMaterial,
    medium::{Field, Medium, Variation},
    shape::{LevelSet, Shape, level::Function},
};
use steradian_scene::Node;
use steradian_schema::{Family, Model, Parameter, Type};
use steradian_texture::Texture;

impl Compiler<'_> {
    /// The model of a node's kind: of the schema, or of the program's own.
    pub(super) fn model_of(&self, node: &Node) -> Option<&'static Model> {
        self.options.registry.kinds().model(node.family, &node.kind)
    }

    /// "did you mean …?" for a kind that is not there.
    pub(super) fn nearest_kind(&self, node: &Node) -> Option<String> {
        steradian_scene::names::did_you_mean(&node.kind, self.options.registry.kinds().names(node.family))
    }

    /// All kinds of a family, with commas between them.
    pub(super) fn all_kinds(&self, family: Family) -> String {
        self.options.registry.kinds().names(family).collect::<Vec<_>>().join(", ")
    }

    /// A material of the program's own.
    pub(super) fn own_material(&mut self, node: &Node) -> Option<OwnMaterial> {
        let scatter: Arc<dyn OwnScatter> = Arc::clone(self.options.registry.own_material(&node.kind)?);
        let model = self.model_of(node)?;
        Some(OwnMaterial { model: scatter, inputs: self.input_textures(node, model) })
    }

    /// A texture of the program's own; nothing where it is refused.
    pub(super) fn own_texture(&mut self, node: &Node) -> Option<Texture> {
        let make = self.options.registry.own_texture(&node.kind)?.clone();
        let own = self.made(node, &make)?;
        Some(Texture::Own(own, Box::new(self.mapping(node))))
    }

    /// A shape of the program's own; `None` for kinds that it does not have.
    pub(super) fn own_shape(&mut self, placed: &Placed<'_>) -> Option<Vec<Shape>> {
        let make = self.options.registry.own_shape(&placed.node.kind)?.clone();
        let Some(own) = self.made(placed.node, &make) else { return Some(Vec::new()) };
        let corners = own.corners();
        match LevelSet::new(Function::Own(own), corners, placed.place, placed.reverse) {
            Some(surface) => Some(vec![Shape::Level(Arc::new(surface))]),
            None => {
                let what = format!("the box of shape '{}' is empty or not finite", placed.node.kind);
                self.error(placed.node.span, what);
                Some(Vec::new())
            }
        }
    }

    /// A light of the program's own; `None` for kinds that it does not have.
    pub(super) fn own_light(&mut self, node: &Node) -> Option<Option<Light>> {
        let make = self.options.registry.own_light(&node.kind)?.clone();
        Some(self.own_light_of(node, &make))
    }

    fn own_light_of(&mut self, node: &Node, make: &Make<dyn steradian_core::light::OwnLight>) -> Option<Light> {
        let distribution = self.made(node, make)?;
        let world_from_light = self.light_place(node)?;
        let position = world_from_light.point(self.vec3(node, "position"));
        if !position.is_finite() {
            self.error(node.span, "the position of this light is not finite");
            return None;
        }
        let (color, scale) = self.emission_color(node, "intensity");
        let mut own = Own { position, world_from_light, intensity: color, distribution };
        let power = self.luminous_target(node, "power", own.intensity.luminance(self.mode));
        let factor = match power {
            // Flux of one unit of luminous intensity.
            Some(power) => {
                let luminance = own.intensity.luminance(self.mode).max(f32::MIN_POSITIVE);
                let share = steradian_core::light::PunctualLight::flux(&own, self.mode) / luminance;
                if share > 0.0 { scale * power / share } else { 0.0 }
            }
            None => scale,
        };
        own.intensity = own.intensity.scaled(factor);
        Some(own.into())
    }

    /// A medium of the program's own; `None` for kinds that it does not have.
    pub(super) fn own_medium(&mut self, node: &Node) -> Option<Option<Medium>> {
        let make = self.options.registry.own_medium(&node.kind)?.clone();
        let Some(own) = self.made(node, &make) else { return Some(None) };
        let Some(place) = self.place(node) else { return Some(None) };
        let bounds = own.bounds();
        let Some(field) = Field::new(&bounds, &place, Variation::Own(own), self.mode) else {
            self.error(node.span, "the box of this medium has no volume");
            return Some(None);
        };
        Some(Some(Medium { field: Some(Arc::new(field)), ..self.homogeneous(node) }))
    }

    /// A projection of the program's own; `None` for kinds that it does not have.
    pub(super) fn own_projection(&mut self, node: &Node) -> Option<Option<Projection>> {
        let make = self.options.registry.own_camera(&node.kind)?.clone();
        Some(self.made(node, &make).map(Projection::Own))
    }

    /// Result of a constructor for a node's parameters; its refusal is reported.
    fn made<T: ?Sized>(&mut self, node: &Node, make: &Make<T>) -> Option<Arc<T>> {
        let node = &*self.within_ranges(node);
        let values = self.values(node)?;
        match make(&values) {
            Ok(made) => Some(made),
            Err(why) => {
                self.error(node.span, format!("{} '{}': {why}", node.family.noun(), node.kind));
                None
            }
        }
    }

    /// Values of the parameters of a node, which is of the program's own.
    fn values(&mut self, node: &Node) -> Option<Values> {
        let mut values = Values::default();
        for p in self.model_of(node)?.parameters {
            let value = match p.kind {
                Type::Flag => OwnParameter::Flag(self.bool_or(node, p.name, p.default_flag().unwrap_or_default())),
                Type::Vector => OwnParameter::Vector(self.dvec3(node, p.name)),
                Type::List => OwnParameter::List(self.list(node, p.name).unwrap_or_default()),
                Type::Word(_) => OwnParameter::Word(self.one_of(node, p)),
                Type::Text => OwnParameter::Word(self.word(node, p.name).to_owned()),
                Type::Integer => OwnParameter::Number(self.int(node, p.name) as f64),
                _ => OwnParameter::Number(self.double(node, p.name)),
            };
            values.0.insert(p.name, value);
        }
        Some(values)
    }

    /// One of the words of a parameter.
    fn one_of(&mut self, node: &Node, p: &'static Parameter) -> String {
        let words: Vec<_> = p.words().map(|word| (word, word)).collect();
        self.choice_or(node, p.name, p.usual_default(), &words).to_owned()
    }
}
