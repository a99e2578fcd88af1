//! Edits of a scene, and taking them back.

use crate::{
    names::{labels, with_labels},
    protocol::told,
};
use std::{
    collections::HashSet,
    path::{Path, PathBuf},
    sync::Arc,
};
use steradian::{
    formats::{Options, native},
    scene::{Family, Node, NodeId, Param, SceneDesc, Transform, Value, names::did_you_mean},
};

/// Begins the names of placements that are no node's own.
const PLACEMENT: &str = "placement";
/// Name of the parameter for placements.
pub const PLACE: &str = "to_world";

/// A change of the scene.
#[derive(Clone, Debug)]
pub struct Edit {
    /// Subject of the change.
    pub what: What,
    /// True if the next edit of the same replaces it.
    pub moving: bool,
}

/// Subject of an edit, with its new value.
#[derive(Clone, Debug)]
pub enum What {
    /// A parameter of a node, or where a shape or a group is placed, is set, or taken away.
    Parameter {
        /// The node's name, or the placement's.
        node: String,
        /// The parameter's.
        parameter: String,
        /// In Steradian's own language.
        value: Option<String>,
    },
    /// An environment map takes the place of all environment lights.
    Environment {
        /// The file's name.
        name: String,
        /// Its bytes.
        picture: Arc<[u8]>,
        /// Turns it; of its own, +y is up.
        to_world: Transform,
    },
}

impl Edit {
    /// Bytes that it brings.
    pub fn bytes(&self) -> usize {
        match &self.what {
            What::Parameter { .. } => 0,
            What::Environment { picture, .. } => picture.len(),
        }
    }
}

impl What {
    /// True if the other edit changes the same.
    fn is_of_same(&self, other: &Self) -> bool {
        let of = |what: &Self| match what {
            Self::Parameter { node, parameter, .. } => Some((node.clone(), parameter.clone())),
            Self::Environment { .. } => None,
        };
        of(self).is_some() && of(self) == of(other)
    }
}

/// An edit that was made, with what was there before; taken back, with what it had put there.
#[derive(Debug)]
pub struct Change {
    /// The edit.
    pub edit: Edit,
    held: Held,
    /// Number of nodes before it, and the nodes that it added.
    count: usize,
    added: Vec<Node>,
}

/// Former value.
#[derive(Debug)]
enum Held {
    Params(NodeId, Vec<Param>),
    Place(Placement, Transform),
    Lights(Vec<NodeId>),
}

/// Something that is placed: a shape of the world, a shape of a group, an instance of a group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Placement {
    Shape(usize),
    Grouped(usize, usize),
    Instance(usize),
}

impl Placement {
    /// All of a scene, with the nodes of shapes.
    fn all(desc: &SceneDesc) -> impl Iterator<Item = (Self, Option<NodeId>)> + '_ {
        let shapes = desc.shapes.iter().enumerate().map(|(k, s)| (Self::Shape(k), Some(s.node)));
        let groups = desc.groups.iter().enumerate();
        let grouped = groups.flat_map(|(g, group)| {
            group.shapes.iter().enumerate().map(move |(k, s)| (Self::Grouped(g, k), Some(s.node)))
        });
        shapes.chain(grouped).chain((0..desc.instances.len()).map(|k| (Self::Instance(k), None)))
    }

    fn of(self, desc: &mut SceneDesc) -> &mut Transform {
        match self {
            Self::Shape(k) => &mut desc.shapes[k].world_from_object,
            Self::Grouped(g, k) => &mut desc.groups[g].shapes[k].world_from_object,
            Self::Instance(k) => &mut desc.instances[k].world_from_group,
        }
    }

    fn get(self, desc: &SceneDesc) -> Transform {
        match self {
            Self::Shape(k) => desc.shapes[k].world_from_object,
            Self::Grouped(g, k) => desc.groups[g].shapes[k].world_from_object,
            Self::Instance(k) => desc.instances[k].world_from_group,
        }
    }
}

/// Placement, as pages are told.
pub struct Placed {
    /// The name of what is placed, that of a shape's node where it is placed once.
    pub id: String,
    /// Kind of the thing that is placed.
    pub kind: String,
    /// Transform.
    pub place: Transform,
}

/// All placements of a scene under their names, given the names of its nodes: of a shape that is placed once, its
/// node's.
pub fn placements(desc: &SceneDesc, ids: &[String]) -> Vec<Placed> {
    all(desc, ids).into_iter().map(|(id, kind, at)| Placed { id, kind, place: at.get(desc) }).collect()
}

fn all(desc: &SceneDesc, ids: &[String]) -> Vec<(String, String, Placement)> {
    let mut times = vec![0_u32; desc.nodes.len()];
    Placement::all(desc).filter_map(|(_, node)| node).for_each(|node| times[node.0 as usize] += 1);
    let taken: HashSet<&str> = ids.iter().map(String::as_str).collect();
    let numbered = |k: usize| match format!("{PLACEMENT} {}", k + 1) {
        name if taken.contains(name.as_str()) => format!("#{name}"),
        name => name,
    };
    let named = |(k, (at, node)): (usize, (Placement, Option<NodeId>))| {
        let index = node.map(|n| n.0 as usize);
        let kind = match (at, index) {
            (Placement::Instance(i), _) => desc.groups.get(desc.instances[i].group).map(|g| g.name.clone()),
            (_, index) => index.map(|i| ids[i].clone()),
        };
        let id = index.filter(|i| times[*i] == 1).map_or_else(|| numbered(k), |i| ids[i].clone());
        (id, kind.unwrap_or_default(), at)
    };
    Placement::all(desc).enumerate().map(named).collect()
}

impl Change {
    /// Makes an edit. What is typed into a page names no file elsewhere than `reading` allows.
    ///
    /// # Errors
    /// What is wrong with it; nothing is changed then.
    pub fn make(desc: &mut SceneDesc, edit: Edit, reading: &Options) -> Result<Self, String> {
        let count = desc.nodes.len();
        let held = match &edit.what {
            What::Parameter { node, parameter, value } => {
                set(desc, (node, parameter), value.as_deref().unwrap_or("null"), reading)?
            }
            What::Environment { name, picture, to_world } => set_environment(desc, name, picture, *to_world),
        };
        Ok(Self { edit, held, count, added: Vec::new() })
    }

    /// True if the next edit goes on with it.
    pub fn goes_on(&self, next: &Edit) -> bool {
        self.edit.moving && self.edit.what.is_of_same(&next.what)
    }

    /// Takes it back.
    pub fn undo(&mut self, desc: &mut SceneDesc) {
        self.swap(desc);
        self.added = desc.nodes.split_off(self.count);
    }

    /// Makes it again.
    pub fn redo(&mut self, desc: &mut SceneDesc) {
        desc.nodes.append(&mut self.added);
        self.swap(desc);
    }

    fn swap(&mut self, desc: &mut SceneDesc) {
        match &mut self.held {
            Held::Params(node, params) => std::mem::swap(&mut desc.node_mut(*node).params, params),
            Held::Place(at, place) => std::mem::swap(at.of(desc), place),
            Held::Lights(lights) => std::mem::swap(&mut desc.lights, lights),
        }
    }
}

/// Sets a parameter, or a place.
fn set(desc: &mut SceneDesc, at: (&str, &str), value: &str, reading: &Options) -> Result<Held, String> {
    let (id, parameter) = at;
    let ids = labels(desc);
    let node = ids.iter().position(|known| known == id).map(|k| NodeId(k as u32));
    let is_node = node.is_some_and(|n| desc.node(n).family != Family::Shape || parameter != PLACE);
    if let Some(node) = node.filter(|_| is_node) {
        let params = desc.node(node).params.clone();
        let set = |desc: &mut SceneDesc| native::set(desc, node, parameter, value, reading).map_err(|d| told(&d));
        with_labels(desc, &ids, set)?;
        return Ok(Held::Params(node, params));
    }
    let all = all(desc, &ids);
    let Some((.., at)) = all.iter().find(|(known, ..)| known == id) else {
        if node.is_some() {
            let several = all.iter().filter(|(_, kind, _)| kind == id).map(|(id, ..)| id.as_str());
            let several = several.take(8).collect::<Vec<_>>().join(", ");
            return Err(format!("'{id}' is placed several times, as {several}"));
        }
        let hint = did_you_mean(id, ids.iter().chain(all.iter().map(|(id, ..)| id)).map(String::as_str));
        let hint = hint.map(|h| format!("; {h}")).unwrap_or_default();
        return Err(format!("there is no node '{id}'{hint}"));
    };
    if parameter != PLACE {
        return Err(format!("a placement has no parameter '{parameter}', but '{PLACE}'"));
    }
    let before = std::mem::replace(at.of(desc), transform(id, value)?);
    Ok(Held::Place(*at, before))
}

/// A transform in Steradian's own language; `null` is none.
fn transform(of: &str, text: &str) -> Result<Transform, String> {
    let mut desc = SceneDesc::default();
    let node = desc.add(Node { name: Some(of.into()), ..Node::new(Family::Camera, "perspective", None) });
    native::set(&mut desc, node, PLACE, text, &Options::default()).map_err(|d| told(&d))?;
    match desc.node(node).get(PLACE) {
        Some(Value::Transform(place)) if place.inverse().is_some() => Ok(*place),
        Some(Value::Transform(_)) => Err(format!("{of}.{PLACE}: this transform is singular")),
        Some(_) => Err(format!("{of}.{PLACE}: a transform is expected, as {{translate: [x, y, z]}}, not '{text}'")),
        None => Ok(Transform::IDENTITY),
    }
}

/// Lights the scene by an environment map.
fn set_environment(desc: &mut SceneDesc, name: &str, picture: &Arc<[u8]>, to_world: Transform) -> Held {
    // The same name for the same picture, and no other's.
    let known = |path: &Path| desc.embedded.get(path).is_some_and(|bytes| bytes != picture);
    let mut path = PathBuf::from(name);
    for k in 1.. {
        if !known(&path) {
            break;
        }
        path = PathBuf::from(format!("{k}-{name}"));
    }
    desc.embedded.insert(path.clone(), picture.clone());
    let mut node = Node::new(Family::Light, "environment", None).with("file", path).with("parametrization", "latlong");
    if to_world != Transform::IDENTITY {
        node = node.with(PLACE, Value::Transform(to_world));
    }
    node.name = Some("environment".into());
    let light = desc.add(node);
    let before = desc.lights.clone();
    desc.lights.retain(|l| !matches!(desc.nodes[l.0 as usize].kind.as_str(), "environment" | "sky" | "atmosphere"));
    desc.lights.push(light);
    Held::Lights(before)
}
