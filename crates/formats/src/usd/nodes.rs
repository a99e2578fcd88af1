//! The walk over the prims of a stage: what is seen, where, and with which material.

use super::{
    Loss, Reader,
    layer::{MOST_NESTED, Specifier},
    solids::solid,
    stage::Prim,
    value::Value,
    volume::Filled,
    xform::unit,
};
use glam::DQuat;
use std::{collections::HashMap, rc::Rc};
use steradian_math::{DMat4, DVec3, Transform};
use steradian_scene::{Family, Group, Instance, Node, NodeId, Shape};

/// From so many places on, a mesh is stored once and placed as instances.
const INSTANCED_FROM: usize = 16;
/// Most prims of a stage, instances counted.
const MOST_PRIMS: usize = 1_000_000;

/// Most surfaces, instances counted.
pub(super) const MOST_DRAWN: usize = 10_000_000;
/// Deepest nesting of instancers in prototypes of instancers.
const MOST_INSTANCERS: usize = 8;

/// Prims that draw nothing of their own.
const SILENT: &[&str] = &[
    "",
    "Xform",
    "Scope",
    "Material",
    "Shader",
    "NodeGraph",
    "GeomSubset",
    "OpenVDBAsset",
    "SkelRoot",
    "RenderProduct",
    "RenderVar",
    "RenderPass",
    "PhysicsScene",
    "Backdrop",
];

/// State that prims inherit.
#[derive(Clone, Debug)]
pub(super) struct Inherited {
    pub place: DMat4,
    /// Purpose of what is below, such as `render`.
    purpose: String,
    /// The bound material's path.
    pub material: Option<String>,
    /// True if the binding is stronger than those below.
    is_strong: bool,
}

/// A surface that is drawn.
#[derive(Clone, Debug)]
pub(super) struct Drawn {
    pub name: String,
    pub form: Form,
    pub place: DMat4,
    pub material: Option<NodeId>,
    pub emission: Option<NodeId>,
}

#[derive(Clone, Debug)]
pub(super) enum Form {
    /// Mesh data, with the kind of its tangents.
    Mesh { mesh: usize, tangents: bool },
    /// The unit sphere.
    Ball,
    /// A medium in a box.
    Volume(Box<Filled>),
    /// Another kind of shape.
    Solid(Node),
}

impl Reader<'_> {
    pub(super) fn walk(&mut self, place: DMat4) {
        let root = Rc::new(self.stage.root());
        let start = Inherited { place, purpose: "default".into(), material: None, is_strong: false };
        self.subtree(root, start, true);
    }

    /// All that is below a prim, and the prim itself unless it is the root.
    fn subtree(&mut self, prim: Rc<Prim>, start: Inherited, is_root: bool) {
        let mut open = vec![(prim, start, is_root, 0)];
        while let Some((prim, above, is_root, depth)) = open.pop() {
            self.prims += 1;
            if self.prims > MOST_PRIMS {
                return self.stage.error(None, format!("the stage has more than {MOST_PRIMS} prims"));
            }
            if self.stage.import.diagnostics.is_full() && self.stage.import.diagnostics.has_errors() {
                return;
            }
            let below = match is_root {
                true => Some(above),
                false => self.visit(&prim, above),
            };
            let Some(below) = below else { continue };
            if depth > MOST_NESTED {
                self.stage.error(None, format!("{}: prims are nested deeper than {MOST_NESTED}", prim.path));
                continue;
            }
            let names = self.stage.children(&prim);
            for name in names.into_iter().rev() {
                let child = Rc::new(self.stage.child(&prim, &name));
                open.push((child, below.clone(), false, depth + 1));
            }
        }
    }

    /// Draws a prim; what its children inherit, where they are walked.
    fn visit(&mut self, prim: &Prim, above: Inherited) -> Option<Inherited> {
        let is_active = self.stage.field(prim, "active").and_then(Value::bool) != Some(false);
        if !is_active || self.stage.specifier(prim) != Specifier::Def {
            return None;
        }
        let kind = self.stage.type_name(prim);
        if matches!(kind.as_str(), "Material" | "Shader" | "NodeGraph" | "GeomSubset") {
            return None;
        }
        if self.word(prim, "visibility").as_deref() == Some("invisible") {
            return None;
        }
        let (local, resets) = self.local(prim);
        let mut state = above;
        // What resets its transforms is still turned as the stage is.
        state.place = if resets { self.root_place() * local } else { state.place * local };
        if !state.place.as_mat4().is_finite() {
            self.stage.error(None, format!("{}: its place is out of the range of single precision", prim.path));
            return None;
        }
        if let Some(purpose) = self.word(prim, "purpose") {
            state.purpose = purpose;
        }
        self.bind(prim, &mut state);
        self.tell_unread(prim);
        let is_shown = matches!(state.purpose.as_str(), "default" | "render");
        match kind.as_str() {
            "Camera" => self.camera(prim, state.place),
            "PointInstancer" => {
                if is_shown {
                    self.instancer(prim, &state);
                }
                return None;
            }
            _ if !is_shown => {}
            "RenderSettings" => {
                self.count(
                    Loss::Dropped("render settings are not taken: those of this program are".into()),
                    prim,
                    None,
                );
            }
            "LightFilter" => self.count(Loss::Dropped("filters of lights are left out".into()), prim, None),
            "Mesh" => self.mesh(prim, false, &state),
            "BasisCurves" => self.mesh(prim, true, &state),
            "Points" => self.points(prim, &state),
            "Volume" => self.volume(prim, &state),
            "Sphere" | "Cube" | "Cylinder" | "Cylinder_1" | "Cone" | "Capsule" | "Capsule_1" | "Plane" => {
                self.solid(prim, kind.trim_end_matches("_1"), &state);
            }
            kind if kind.ends_with("Light") || kind == "DomeLight_1" => self.light(prim, kind, state.place),
            kind if SILENT.contains(&kind) => {}
            kind => self.count(Loss::Dropped(format!("prims of type '{kind}' are left out")), prim, None),
        }
        Some(state)
    }

    /// Tells of movements that are not read.
    fn tell_unread(&mut self, prim: &Prim) {
        if self.stage.field(prim, "clips").is_some() {
            self.count(Loss::Dropped("value clips are not read".into()), prim, None);
        }
        for name in self.stage.properties(prim) {
            if self.stage.has_spline(prim, &name) {
                let what = format!("the spline of '{name}' is not read: its value is the default");
                self.count(Loss::Dropped(what), prim, Some(&name));
                continue;
            }
            let what = match name.as_str() {
                "primvars:skel:jointIndices" => "its skeleton does not move it: it is in its rest pose",
                "skel:blendShapes" => "its blend shapes are not added",
                "creaseIndices" | "cornerIndices" => "creases of its subdivision surface are left out",
                _ => continue,
            };
            self.count(Loss::Dropped(what.into()), prim, Some(&name));
        }
    }

    /// The transform of the stage's axes to ours.
    pub(super) fn root_place(&self) -> DMat4 {
        match self.stage.head("upAxis").as_ref().and_then(Value::text) {
            Some("Z") => DMat4::from_rotation_x(-std::f64::consts::FRAC_PI_2),
            _ => DMat4::IDENTITY,
        }
    }

    /// Follows the prim's own binding of a material.
    fn bind(&mut self, prim: &Prim, state: &mut Inherited) {
        if state.is_strong {
            return;
        }
        if let Some((path, is_strong)) = self.binding(prim) {
            state.material = Some(path);
            state.is_strong = is_strong;
        }
    }

    /// The material that a prim binds for final pictures, and whether that is stronger than what is below.
    pub(super) fn binding(&mut self, prim: &Prim) -> Option<(String, bool)> {
        if self.stage.properties(prim).iter().any(|name| name.starts_with("material:binding:collection")) {
            self.count(Loss::Dropped("materials that are bound to collections are left out".into()), prim, None);
        }
        ["material:binding:full", "material:binding"].into_iter().find_map(|name| {
            let path = self.stage.targets(prim, name, "targets").into_iter().next()?;
            let strength = self.stage.property_field(prim, name, "bindMaterialAs").and_then(Value::text);
            Some((path, strength == Some("strongerThanDescendants")))
        })
    }

    /// UsdGeomPointInstancer.
    fn instancer(&mut self, prim: &Prim, state: &Inherited) {
        let of = |reader: &mut Self, name: &str| -> Vec<f64> {
            reader.stage.value(prim, name).and_then(|v| v.numbers().map(|n| n.into_owned())).unwrap_or_default()
        };
        let (indices, positions) = (of(self, "protoIndices"), of(self, "positions"));
        let (mut turns, scales) = (of(self, "orientationsf"), of(self, "scales"));
        if turns.is_empty() {
            turns = of(self, "orientations");
        }
        let (ids, hidden) = (of(self, "ids"), of(self, "invisibleIds"));
        let hidden: std::collections::HashSet<u64> = hidden.iter().map(|v| v.to_bits()).collect();
        let count = indices.len();
        let is_wrong = positions.len() != 3 * count
            || !turns.is_empty() && turns.len() != 4 * count
            || !scales.is_empty() && scales.len() != 3 * count;
        if is_wrong {
            let found = positions.len() / 3;
            return self.fault(
                prim,
                "protoIndices",
                format!("{count} instances have {found} positions, or another number of orientations or scales"),
            );
        }
        if count > self.stage.options.limits.instances {
            return self.fault(prim, "protoIndices", format!("{count} instances are too many"));
        }
        let paths = self.stage.targets(prim, "prototypes", "targets");
        let mut places: Vec<Vec<DMat4>> = vec![Vec::new(); paths.len()];
        for (k, index) in indices.iter().enumerate() {
            let id = ids.get(k).copied().unwrap_or(k as f64);
            if hidden.contains(&id.to_bits()) {
                continue;
            }
            let at = |v: &[f64], width: usize, i: usize, default: f64| v.get(width * k + i).copied().unwrap_or(default);
            let vector =
                |v: &[f64], default| DVec3::new(at(v, 3, 0, default), at(v, 3, 1, default), at(v, 3, 2, default));
            let turn = DQuat::from_xyzw(
                at(&turns, 4, 1, 0.0),
                at(&turns, 4, 2, 0.0),
                at(&turns, 4, 3, 0.0),
                at(&turns, 4, 0, 1.0),
            );
            let place =
                DMat4::from_scale_rotation_translation(vector(&scales, 1.0), unit(turn), vector(&positions, 0.0));
            let Some(list) = places.get_mut(*index as usize).filter(|_| *index >= 0.0) else {
                let there = paths.len();
                return self.fault(prim, "protoIndices", format!("there is no prototype {index}: there are {there}"));
            };
            list.push(state.place * place);
        }
        for (path, places) in paths.iter().zip(places) {
            self.prototype(prim, path, state, places);
        }
    }

    /// Draws what is below a prototype at some places.
    fn prototype(&mut self, instancer: &Prim, path: &str, state: &Inherited, places: Vec<DMat4>) {
        let Some(prim) = self.stage.prim(path) else {
            return self.fault(instancer, "prototypes", format!("there is no prim '{path}'"));
        };
        if self.instancers >= MOST_INSTANCERS {
            return self.fault(instancer, "prototypes", format!("instancers are nested deeper than {MOST_INSTANCERS}"));
        }
        self.instancers += 1;
        let outer = std::mem::take(&mut self.drawn);
        self.subtree(prim, Inherited { place: DMat4::IDENTITY, ..state.clone() }, false);
        let parts = std::mem::replace(&mut self.drawn, outer);
        self.instancers -= 1;
        let count = parts.len().saturating_mul(places.len());
        let needed = (count as u64).saturating_mul((size_of::<Drawn>() + size_of::<Instance>()) as u64);
        let limits = &self.stage.options.limits;
        if count.saturating_add(self.drawn.len()) > limits.instances.min(MOST_DRAWN)
            || limits.shortage(needed).is_some()
        {
            return self.fault(instancer, "protoIndices", "these are too many instances".into());
        }
        for part in parts {
            self.drawn.extend(places.iter().map(|place| Drawn { place: *place * part.place, ..part.clone() }));
        }
    }

    // Drawing.

    /// Draws a surface, whose box is given in its own space.
    pub(super) fn draw(&mut self, drawn: Drawn) {
        self.drawn.push(drawn);
    }

    /// Puts what is drawn into the description: what has many places, as instances.
    pub(super) fn place_drawn(&mut self) {
        let drawn = std::mem::take(&mut self.drawn);
        let key = |d: &Drawn| match &d.form {
            Form::Mesh { mesh, tangents } => Some((Some(*mesh), *tangents, d.material)),
            Form::Ball => Some((None, false, d.material)),
            Form::Volume(_) | Form::Solid(_) => None,
        };
        let mut counts: HashMap<_, usize> = HashMap::new();
        drawn.iter().filter(|d| d.emission.is_none()).filter_map(key).for_each(|k| *counts.entry(k).or_default() += 1);
        let (mut groups, mut boxes) = (HashMap::new(), HashMap::new());
        for drawn in drawn {
            if !(drawn.place.is_finite() && drawn.place.determinant().abs() > 1e-30) {
                continue;
            }
            self.include(&drawn, &mut boxes);
            let key =
                key(&drawn).filter(|k| drawn.emission.is_none() && counts.get(k).is_some_and(|n| *n >= INSTANCED_FROM));
            let place = Transform { matrix: drawn.place };
            let desc = &mut self.stage.import.desc;
            if let Some(group) = key.and_then(|key| groups.get(&key)) {
                desc.instances.push(Instance::new(*group, place));
                continue;
            }
            let mut interior = None;
            let (mut node, mesh) = match drawn.form {
                Form::Mesh { mesh, tangents } => {
                    let mut node = Node::new(Family::Shape, "mesh", None);
                    if tangents {
                        node.set("tangents", "mikktspace", None);
                    }
                    (node, Some(mesh))
                }
                Form::Ball => (solid("sphere"), None),
                Form::Volume(filled) => {
                    let inside = Transform { matrix: drawn.place * filled.place };
                    interior = Some(desc.add(filled.medium.with("to_world", inside)));
                    (Node::new(Family::Shape, "mesh", None), Some(filled.mesh))
                }
                Form::Solid(node) => (node, None),
            };
            node.name = Some(drawn.name);
            let shape = Shape {
                mesh,
                material: drawn.material,
                emission: drawn.emission,
                interior,
                is_medium_boundary: interior.is_some(),
                ..Shape::new(desc.add(node))
            };
            match key {
                Some(key) => {
                    desc.groups.push(Group { name: String::new(), shapes: vec![shape] });
                    let group = desc.groups.len() - 1;
                    groups.insert(key, group);
                    desc.instances.push(Instance::new(group, place));
                }
                None => desc.shapes.push(Shape { world_from_object: place, ..shape }),
            }
        }
    }

    /// Extends the bounds of the scene.
    fn include(&mut self, drawn: &Drawn, boxes: &mut HashMap<usize, [DVec3; 2]>) {
        let mut of_mesh = |mesh: usize| {
            *boxes.entry(mesh).or_insert_with(|| {
                let positions = self.stage.import.desc.meshes.get(mesh).map(|m| m.positions.as_slice());
                let all = positions.unwrap_or_default().iter().map(|p| DVec3::from(p.map(f64::from)));
                all.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], p| [low.min(p), high.max(p)])
            })
        };
        let [low, high] = match &drawn.form {
            Form::Mesh { mesh, .. } => of_mesh(*mesh),
            Form::Volume(filled) => of_mesh(filled.mesh),
            Form::Ball => [DVec3::NEG_ONE, DVec3::ONE],
            Form::Solid(node) => {
                let r = node.float("radius").unwrap_or(1.0);
                let [a, b] = ["z_min", "z_max"].map(|name| node.float(name));
                let (a, b) = (a.unwrap_or(-r), b.or(node.float("height")).unwrap_or(r));
                [DVec3::new(-r, -r, a.min(b)), DVec3::new(r, r, a.max(b))]
            }
        };
        for k in 0..8 {
            let pick = |bit: usize| if k >> bit & 1 == 0 { low } else { high };
            let p = drawn.place.transform_point3(DVec3::new(pick(0).x, pick(1).y, pick(2).z));
            let [low, high] = &mut self.bounds;
            (*low, *high) = (low.min(p), high.max(p));
        }
    }
}
