//! Participating media and phase functions.

use super::{
    graph::{Category, ObjectId, Prop, Raw},
    reader::Reader,
    texture::Role,
    told::NOISE,
};
use steradian_scene::{Family, NodeId, Span, Transform, Value};

impl Reader<'_> {
    /// A medium node; `None` after an error.
    pub fn medium(&mut self, object: ObjectId) -> Option<NodeId> {
        self.once(object, Role::Unbounded, |r| r.medium_node(object))
    }

    fn medium_node(&mut self, object: ObjectId) -> Option<NodeId> {
        match self.plugin(object) {
            "homogeneous" | "heterogeneous" => {}
            _ if self.is_known(object) => return self.verbatim(object, Family::Medium),
            _ => {
                self.unknown_plugin(object);
                return None;
            }
        }
        let mut node = self.node(Family::Medium, "homogeneous", object);
        if self.graph.has(object, "sigma_s") || self.graph.has(object, "sigma_a") {
            self.put(&mut node, "sigma_s", object, "sigma_s", Role::Unbounded, 0.0);
            self.put(&mut node, "sigma_a", object, "sigma_a", Role::Unbounded, 0.0);
        } else {
            let is_heterogeneous = self.plugin(object) == "heterogeneous";
            let place = if is_heterogeneous { self.constant_volume_place(object) } else { None };
            self.put(&mut node, "sigma_t", object, "sigma_t", Role::Unbounded, 1.0);
            self.put(&mut node, "albedo", object, "albedo", Role::Reflectance, 0.75);
            if is_heterogeneous {
                node.kind = "heterogeneous".into();
                if let Some((place, span)) = place {
                    node.set("to_world", place, Some(span));
                }
            }
        }
        if self.graph.has(object, "material") {
            let span = self.value_span(object, "material");
            self.ignore(object, &["material"]);
            self.dropped(span, "media cannot be named; 'material' is left out");
        }
        let scale = self.float(object, "scale").unwrap_or(1.0);
        node.set("scale", scale, None);
        self.no_effect(object, &["has_spectral_extinction", "sample_emitters"], NOISE);
        self.no_effect(object, &["to_world"], "a medium fills its shape; its volumes have their own places");
        let phases = self.graph.children(object, Category::Phase);
        if let Some((_, extra)) = phases.get(1) {
            self.error(self.span(*extra), "a medium has one phase function");
        }
        let phase = match phases.first() {
            Some(&(_, phase)) => self.phase(phase)?,
            None => self.desc.add(steradian_scene::Node::new(Family::Phase, "isotropic", None)),
        };
        node.set("phase", phase, None);
        Some(self.desc.add(node))
    }

    /// Transform of the unit cube of a `constvolume` of extinction, which bounds a heterogeneous medium.
    fn constant_volume_place(&mut self, medium: ObjectId) -> Option<(Transform, Span)> {
        let Raw::Object(volume) = self.graph.take(medium, "sigma_t")?.value else { return None };
        if self.plugin(volume) != "constvolume" {
            return None;
        }
        Some((self.some_transform(volume, "to_world")?, self.value_span(volume, "to_world")))
    }

    /// A phase function node; `None` after an error.
    pub fn phase(&mut self, object: ObjectId) -> Option<NodeId> {
        self.once(object, Role::Unbounded, |r| {
            r.graph.objects[object].visited = true;
            match r.plugin(object) {
                "isotropic" => {
                    let node = r.node(Family::Phase, "isotropic", object);
                    Some(r.desc.add(node))
                }
                "hg" => {
                    let mut node = r.node(Family::Phase, "hg", object);
                    let (g, span) = (r.float(object, "g").unwrap_or(0.8), r.value_span(object, "g"));
                    if g.abs() >= 1.0 {
                        r.error(span, "'g' lies between -1 and 1, both excluded");
                        return None;
                    }
                    node.set("g", g, Some(span));
                    Some(r.desc.add(node))
                }
                "rayleigh" => {
                    let node = r.node(Family::Phase, "rayleigh", object);
                    Some(r.desc.add(node))
                }
                "tabphase" => {
                    let mut node = r.node(Family::Phase, "tabulated", object);
                    let (text, span) = (r.string(object, "values").unwrap_or_default(), r.value_span(object, "values"));
                    let values = text.split([' ', ',']).filter(|v| !v.is_empty()).map(str::parse::<f64>);
                    let Ok(values) = values.collect::<Result<Vec<_>, _>>() else {
                        r.error(span, "'values' are numbers with spaces or commas between them");
                        return None;
                    };
                    node.set("values", Value::Floats(values), Some(span));
                    Some(r.desc.add(node))
                }
                "blendphase" => r.blended_phase(object),
                _ if r.is_known(object) => r.verbatim(object, Family::Phase),
                _ => {
                    r.unknown_plugin(object);
                    None
                }
            }
        })
    }

    /// A `blendphase` of two phase functions, in the order of the file, as Mitsuba 3.9 takes them whatever their names.
    fn blended_phase(&mut self, object: ObjectId) -> Option<NodeId> {
        let parts = self.graph.children(object, Category::Phase);
        let &[(_, first), (_, second)] = &*parts else {
            self.error(self.span(object), "a 'blendphase' has two phase functions");
            return None;
        };
        let mut node = self.node(Family::Phase, "blend", object);
        let span = self.value_span(object, "weight");
        let varies = |p: &Prop| p.name == "weight" && matches!(p.value, Raw::Object(_));
        if self.graph.objects[object].props.iter().any(varies) {
            self.graph.take(object, "weight");
            self.approximated(span, "the weight of a 'blendphase' that varies is not supported; 0.5 stands in");
        } else {
            node.set("weight", self.float(object, "weight").unwrap_or(0.5), Some(span));
        }
        let parts = [self.phase(first), self.phase(second)];
        for (name, part) in ["first", "second"].into_iter().zip(parts) {
            node.set(name, part?, None);
        }
        Some(self.desc.add(node))
    }
}
