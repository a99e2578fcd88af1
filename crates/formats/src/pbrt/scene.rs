//! Objects described by directives, on their way into a [`SceneDesc`].
//!
//! Shapes, lights and media are translated where they stand. Textures and materials wait until everything is read, as
//! in pbrt: their order of making is what decides which names they may use. References to them are settled last.

use super::{
    dict::Dict,
    light, material, medium,
    mesh_files::MeshFiles,
    report::Report,
    shape,
    state::{self, MaterialRef, NameRef, State},
    texture::{self, Values},
};
use crate::{Options, files::SearchPath};
use std::{
    collections::{HashMap, HashSet},
    path::PathBuf,
    sync::Arc,
};
use steradian_scene::{
    Family, Group, Instance, Movement, Node, NodeId, SceneDesc, Shape, Span, SpectrumValue, Transform,
};

/// A texture to be translated.
struct PendingTexture {
    name: String,
    values: Values,
    dict: Dict,
    ctm: Transform,
}

/// Named references of a shape.
struct Attached {
    material: MaterialRef,
    media: Option<(Option<NameRef>, Option<NameRef>)>,
    span: Span,
}

/// A use of an object, whose definition may come later.
struct PendingInstance {
    name: NameRef,
    transform: Transform,
    movement: Option<Movement>,
}

/// The scene so far.
pub(super) struct Scene<'o> {
    pub options: &'o Options,
    pub report: Report,
    pub desc: SceneDesc,
    pub search: SearchPath,
    pub meshes: MeshFiles,
    /// When transforms that change begin and end to do so.
    pub transform_times: [f64; 2],
    /// The factor of `Option "displacementedgescale"` on the lengths of edges.
    pub edge_scale: f64,
    /// Spectrum files that were read; `None` for faulty ones.
    pub spectra: HashMap<PathBuf, Option<SpectrumValue>>,
    textures: HashMap<(Values, String), Option<NodeId>>,
    pending_textures: Vec<PendingTexture>,
    texture_names: HashSet<(Values, String)>,
    materials: Vec<Dict>,
    pending_named: Vec<(String, Dict)>,
    named_names: HashSet<String>,
    named: HashMap<String, Option<NodeId>>,
    media: HashMap<Arc<str>, Option<NodeId>>,
    object_names: HashMap<String, usize>,
    world: Vec<Attached>,
    grouped: Vec<Vec<Attached>>,
    instances: Vec<PendingInstance>,
    shape_textures: Vec<(NodeId, &'static str, String, Span)>,
    node_media: Vec<(NodeId, NameRef)>,
}

impl<'o> Scene<'o> {
    pub fn new(options: &'o Options, search: SearchPath) -> Self {
        Self {
            options,
            report: Report::default(),
            desc: SceneDesc::default(),
            search,
            meshes: MeshFiles::default(),
            transform_times: [0.0, 1.0],
            edge_scale: 1.0,
            spectra: HashMap::new(),
            textures: HashMap::new(),
            pending_textures: Vec::new(),
            texture_names: HashSet::new(),
            materials: Vec::new(),
            pending_named: Vec::new(),
            named_names: HashSet::new(),
            named: HashMap::new(),
            media: HashMap::new(),
            object_names: HashMap::new(),
            world: Vec::new(),
            grouped: Vec::new(),
            instances: Vec::new(),
            shape_textures: Vec::new(),
            node_media: Vec::new(),
        }
    }

    pub fn add_texture(&mut self, name: String, values: Values, dict: Dict, ctm: Transform, span: Span) {
        if self.texture_names.insert((values, name.clone())) {
            self.pending_textures.push(PendingTexture { name, values, dict, ctm });
        } else {
            self.report.error(span, format!("the {} texture '{name}' is defined twice", values.name()));
        }
    }

    /// Adds a `Material` and returns its index.
    pub fn add_material(&mut self, dict: Dict) -> usize {
        self.materials.push(dict);
        self.materials.len() - 1
    }

    pub fn add_named_material(&mut self, name: String, dict: Dict, span: Span) {
        if self.named_names.insert(name.clone()) {
            self.pending_named.push((name, dict));
        } else {
            self.report.error(span, format!("the material '{name}' is defined twice"));
        }
    }

    pub fn add_medium(&mut self, name: &str, dict: &Dict, ctm: Transform, span: Span) {
        if self.media.contains_key(name) {
            return self.report.error(span, format!("the medium '{name}' is defined twice"));
        }
        let id = match dict.text(&mut self.report, "type") {
            Some((kind, _)) => medium::translate(self, dict, kind, ctm),
            None => {
                self.report.error(span, format!("the medium '{name}' needs \"string type\""));
                None
            }
        };
        if let Some(id) = id {
            self.desc.node_mut(id).name = Some(name.into());
        }
        self.media.insert(name.into(), id);
    }

    pub fn add_light(&mut self, dict: &Dict, ctm: Transform, medium: Option<&NameRef>) {
        if let Some(id) = light::translate(self, dict, ctm, medium) {
            self.desc.lights.push(id);
        }
    }

    /// Adds a shape to the world or to the object with this index.
    pub fn add_shape(&mut self, dict: &Dict, state: &State, object: Option<usize>) {
        let transform = state.transform();
        if transform.inverse().is_none() {
            self.report.error(dict.span, "the transform in force at the shape cannot be inverted");
            return;
        }
        let Some((node, mesh)) = shape::translate(self, dict) else { return };
        let mut emission = state.area_light;
        if object.is_some() && emission.take().is_some() {
            self.report.dropped(dict.span, "shapes of objects do not emit light: pbrt has no area lights in them");
        }
        let mut movement = self.movement(state);
        if movement.is_some() && object.is_some() {
            self.report.approximated(dict.span, state::STANDS_STILL);
            movement = None;
        }
        let media = state.medium_boundary();
        let shape = Shape {
            node,
            mesh,
            world_from_object: if movement.is_some() { Transform::IDENTITY } else { transform },
            reverse_orientation: state.reverse_orientation,
            material: None,
            emission,
            interior: None,
            exterior: None,
            is_medium_boundary: media.is_some(),
        };
        let attached = Attached { material: state.material.clone(), media, span: dict.span };
        // What moves by itself is the one instance of an object of its own.
        let object = object.or_else(|| {
            let group = movement.is_some().then(|| self.add_hidden_object())?;
            let span = Some(dict.span);
            self.desc.instances.push(Instance { movement, span, ..Instance::new(group, transform) });
            Some(group)
        });
        match object {
            None => {
                self.desc.shapes.push(shape);
                self.world.push(attached);
            }
            Some(i) => {
                self.desc.groups[i].shapes.push(shape);
                self.grouped[i].push(attached);
            }
        }
    }

    /// Starts an object; `None` where the name is taken.
    pub fn add_object(&mut self, name: String, span: Span) -> Option<usize> {
        if self.object_names.contains_key(&name) {
            self.report.error(span, format!("the object '{name}' is defined twice"));
            return None;
        }
        let index = self.desc.groups.len();
        self.object_names.insert(name.clone(), index);
        self.desc.groups.push(Group { name, shapes: Vec::new() });
        self.grouped.push(Vec::new());
        Some(index)
    }

    /// Starts an object that nothing can refer to.
    pub fn add_hidden_object(&mut self) -> usize {
        self.desc.groups.push(Group::default());
        self.grouped.push(Vec::new());
        self.desc.groups.len() - 1
    }

    /// Motion of an object under a graphics state; `None` where the transform is not animated.
    pub fn movement(&self, state: &State) -> Option<Movement> {
        state.is_animated().then(|| Movement { end: state.ctm[1], times: self.transform_times })
    }

    pub fn add_instance(&mut self, name: NameRef, state: &State) {
        let (transform, movement) = (state.transform(), self.movement(state));
        if self.instances.len() >= self.options.limits.instances {
            if self.report.first_time("instances") {
                let message = format!("more than {} instances", self.options.limits.instances);
                self.report.error(name.span, message);
            }
            return;
        }
        if transform.inverse().is_none() {
            self.report.error(name.span, "the transform in force at the instance cannot be inverted");
            return;
        }
        self.instances.push(PendingInstance { name, transform, movement });
    }

    /// Sets the medium around a camera or light when all media are known.
    pub fn set_medium_later(&mut self, id: NodeId, medium: NameRef) {
        self.node_media.push((id, medium));
    }

    /// Sets a parameter of a shape when all textures are known.
    pub fn set_texture_later(&mut self, id: NodeId, parameter: &'static str, texture: String, span: Span) {
        self.shape_textures.push((id, parameter, texture, span));
    }

    pub fn float_texture(&mut self, name: &str, span: Span) -> Option<NodeId> {
        self.texture(Values::Float, name, span)
    }

    pub fn spectrum_texture(&mut self, name: &str, span: Span) -> Option<NodeId> {
        self.texture(Values::Spectrum, name, span)
    }

    fn texture(&mut self, values: Values, name: &str, span: Span) -> Option<NodeId> {
        let key = (values, name.to_string());
        // A faulty texture was reported where it stands.
        if let Some(&known) = self.textures.get(&key) {
            return known;
        }
        let wanted = values.name();
        let other = if values == Values::Float { Values::Spectrum } else { Values::Float };
        let (message, help) = if self.texture_names.contains(&key) {
            (format!("the {wanted} texture '{name}' is used before it is defined"), None)
        } else if self.texture_names.contains(&(other, key.1)) {
            (format!("'{name}' is a {} texture, but a {wanted} texture is needed here", other.name()), None)
        } else {
            let known = self.texture_names.iter().filter(|t| t.0 == values).map(|t| t.1.as_str());
            (format!("there is no {wanted} texture '{name}'"), self.report.did_you_mean(name, known))
        };
        self.report.error_help(span, message, help);
        None
    }

    /// The material of that name among those translated so far.
    pub fn named_material(&mut self, name: &str, span: Span) -> Option<NodeId> {
        if let Some(&known) = self.named.get(name) {
            return known;
        }
        let (message, help) = match self.named_names.contains(name) {
            true => (format!("the material '{name}' is used before it is defined"), None),
            false => {
                let known = self.named_names.iter().map(String::as_str);
                (format!("there is no material '{name}'"), self.report.did_you_mean(name, known))
            }
        };
        self.report.error_help(span, message, help);
        None
    }

    /// Settles all that waited. Called once, when the text is read.
    pub fn finish(&mut self) {
        self.make_textures();
        let materials = self.make_materials();
        self.attach(&materials);
        self.place_instances();
        for (id, parameter, name, span) in std::mem::take(&mut self.shape_textures) {
            if let Some(texture) = self.float_texture(&name, span) {
                self.desc.node_mut(id).set(parameter, texture, Some(span));
            }
        }
        self.settle_media();
        let limits = &self.options.limits;
        self.meshes.read(&mut self.desc, &mut self.report, limits);
    }

    /// Sets the media around lights and cameras.
    pub fn settle_media(&mut self) {
        for (id, medium) in std::mem::take(&mut self.node_media) {
            if let Some(node) = self.medium(&medium) {
                self.desc.node_mut(id).set("medium", node, Some(medium.span));
            }
        }
    }

    /// pbrt's order: image files, then the other float textures, then the other spectrum textures.
    fn make_textures(&mut self) {
        let mut pending = std::mem::take(&mut self.pending_textures);
        pending.sort_by_key(|t| match (texture::is_file(&t.dict.kind), t.values) {
            (true, _) => 0,
            (false, Values::Float) => 1,
            (false, Values::Spectrum) => 2,
        });
        for t in pending {
            let id = texture::translate(self, &t.dict, t.values, t.ctm);
            if let Some(id) = id {
                self.desc.node_mut(id).name = Some(t.name.clone());
            }
            self.textures.insert((t.values, t.name), id);
        }
    }

    /// Named materials in their order, then the others. The last node is pbrt's default.
    fn make_materials(&mut self) -> Vec<Option<NodeId>> {
        for (name, dict) in std::mem::take(&mut self.pending_named) {
            let kind = dict.text(&mut self.report, "type").map(|(kind, span)| (kind.to_string(), span));
            let id = match kind {
                // Messages about the kind should point at it.
                Some((kind, span)) => material::translate(self, &dict.at(&kind, span), &kind),
                None => {
                    self.report.error(dict.span, format!("the material '{name}' needs \"string type\""));
                    None
                }
            };
            if let Some(id) = id {
                self.desc.node_mut(id).name = Some(name.clone());
            }
            self.named.insert(name, id);
        }
        let unnamed = std::mem::take(&mut self.materials);
        unnamed.iter().map(|dict| material::translate(self, dict, &dict.kind)).collect()
    }

    /// Gives shapes their materials and media.
    fn attach(&mut self, materials: &[Option<NodeId>]) {
        let mut default = None;
        let world = std::mem::take(&mut self.world);
        for (i, attached) in world.into_iter().enumerate() {
            let resolved = self.resolve(&attached, materials, &mut default);
            let shape = &mut self.desc.shapes[i];
            resolved.set(shape);
            // Light from a surface that is not there: pbrt leaves it out.
            let transparent = resolved.material.is_some_and(|m| self.desc.nodes[m.0 as usize].kind == "interface");
            if transparent && self.desc.shapes[i].emission.take().is_some() {
                self.report.dropped(attached.span, "a shape with the material 'interface' does not emit light");
            }
        }
        for (g, group) in std::mem::take(&mut self.grouped).into_iter().enumerate() {
            for (i, attached) in group.into_iter().enumerate() {
                let resolved = self.resolve(&attached, materials, &mut default);
                resolved.set(&mut self.desc.groups[g].shapes[i]);
            }
        }
    }

    fn resolve(&mut self, a: &Attached, materials: &[Option<NodeId>], default: &mut Option<NodeId>) -> Resolved {
        let material = match &a.material {
            MaterialRef::Default => Some(*default.get_or_insert_with(|| {
                let grey = SpectrumValue::Constant(0.5);
                self.desc.add(Node::new(Family::Material, "diffuse", None).with("reflectance", grey))
            })),
            MaterialRef::Index(i) => materials.get(*i).copied().flatten(),
            MaterialRef::Named(m) => match self.named.get(&*m.name) {
                Some(&known) => known,
                None => {
                    let id = self.named_material(&m.name, m.span);
                    self.named.insert(m.name.to_string(), id);
                    id
                }
            },
        };
        let (interior, exterior) = match &a.media {
            Some((interior, exterior)) => {
                let mut find = |m: &Option<NameRef>| m.as_ref().and_then(|m| self.medium(m));
                (find(interior), find(exterior))
            }
            None => (None, None),
        };
        Resolved { material, interior, exterior }
    }

    fn medium(&mut self, m: &NameRef) -> Option<NodeId> {
        if let Some(&known) = self.media.get(&m.name) {
            return known;
        }
        let help = self.report.did_you_mean(&m.name, self.media.keys().map(|k| &**k));
        self.report.error_help(m.span, format!("there is no medium '{}'", m.name), help);
        self.media.insert(m.name.clone(), None);
        None
    }

    fn place_instances(&mut self) {
        let mut unknown = HashSet::new();
        for instance in std::mem::take(&mut self.instances) {
            let NameRef { name, span } = instance.name;
            if let Some(&group) = self.object_names.get(&*name) {
                let placed = Instance {
                    movement: instance.movement,
                    span: Some(span),
                    ..Instance::new(group, instance.transform)
                };
                self.desc.instances.push(placed);
            } else if unknown.insert(name.clone()) {
                let help = self.report.did_you_mean(&name, self.object_names.keys().map(String::as_str));
                self.report.error_help(span, format!("there is no object '{name}'"), help);
            }
        }
    }
}

/// Resolved references of a shape.
struct Resolved {
    material: Option<NodeId>,
    interior: Option<NodeId>,
    exterior: Option<NodeId>,
}

impl Resolved {
    fn set(&self, shape: &mut Shape) {
        shape.material = self.material;
        shape.interior = self.interior;
        shape.exterior = self.exterior;
    }
}
