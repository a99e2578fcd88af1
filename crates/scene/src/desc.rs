//! The description of a whole scene.

use crate::{
    mesh::Mesh,
    node::{Node, NodeId, Value},
    source::{Sources, Span},
};
use serde::{Deserialize, Serialize};
use std::{
    any::Any,
    collections::BTreeMap,
    fmt,
    path::{Path, PathBuf},
    sync::Arc,
};
use steradian_math::Transform;

/// Source format of a description; decides the defaults the format promises.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Format {
    /// Made in code.
    #[default]
    Native,
    /// pbrt-v4 text: spectral by definition.
    Pbrt,
    /// Mitsuba XML.
    Mitsuba,
    /// A bare model (OBJ, PLY): framed and lit by us.
    Model,
    /// glTF 2.0.
    Gltf,
}

/// A piece of geometry with all that is attached to it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Shape {
    /// Kind and parameters (family `Shape`).
    pub node: NodeId,
    /// Index into [`SceneDesc::meshes`], for the kinds made of one.
    pub mesh: Option<usize>,
    /// Places it in the world, or in its group.
    pub world_from_object: Transform,
    /// Turns the normals over.
    pub reverse_orientation: bool,
    /// Family `Material`; `None` is a grey diffuse surface (no surface at all when only media are given: use kind
    /// `interface`).
    pub material: Option<NodeId>,
    /// Family `Light`, kind `area`.
    pub emission: Option<NodeId>,
    /// Family `Medium`: what fills the side the normals point away from. `None` on both sides: the shape does not
    /// change the medium.
    pub interior: Option<NodeId>,
    /// Family `Medium`: what is on the side the normals point to.
    pub exterior: Option<NodeId>,
    /// True if the shape separates media: with it `interior`/`exterior` of `None` mean vacuum.
    pub is_medium_boundary: bool,
}

impl Shape {
    /// A shape where its own space is the world's, with nothing attached.
    pub fn new(node: NodeId) -> Self {
        Self {
            node,
            mesh: None,
            world_from_object: Transform::IDENTITY,
            reverse_orientation: false,
            material: None,
            emission: None,
            interior: None,
            exterior: None,
            is_medium_boundary: false,
        }
    }
}

/// Shapes that are placed many times.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Group {
    /// The name the file gave it.
    pub name: String,
    /// Its shapes, in group space.
    pub shapes: Vec<Shape>,
}

/// One placement of a group.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Instance {
    /// Index into [`SceneDesc::groups`].
    pub group: usize,
    /// Places group space in the world; where it moves, at the beginning of its motion.
    pub world_from_group: Transform,
    /// Motion of the instance, if any.
    pub movement: Option<Movement>,
    /// Source span in the file.
    pub span: Option<Span>,
}

impl Instance {
    /// One that stands still.
    pub fn new(group: usize, world_from_group: Transform) -> Self {
        Self { group, world_from_group, movement: None, span: None }
    }
}

/// The end of a motion: between its times translation, rotation and stretch are interpolated
/// ([`steradian_math::Motion`]); before and after it nothing moves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Movement {
    /// The transform at the end.
    pub end: Transform,
    /// When it begins and ends, on the clock of the camera's `shutter_open` and `shutter_close`.
    pub times: [f64; 2],
}

/// Animation of a document, which can be read as of a moment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Animation {
    /// Its name in the document.
    pub name: Option<String>,
    /// Times of its first and last key frame, seconds.
    pub times: [f64; 2],
    /// Number of values it changes.
    pub channels: usize,
}

/// A scene as pure data. Importers make it, `compile` turns it into what is rendered.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct SceneDesc {
    /// Source format.
    pub format: Format,
    /// The scene file.
    pub path: Option<PathBuf>,
    /// Every file that was read.
    pub sources: Sources,
    /// Files that are in memory instead of on disk, such as pictures inside a scene file, by the path that nodes name
    /// them with.
    pub embedded: BTreeMap<PathBuf, Arc<[u8]>>,
    /// The arena.
    pub nodes: Vec<Node>,
    /// Mesh data, shared by shapes.
    pub meshes: Vec<Arc<Mesh>>,
    /// Shapes placed in the world.
    pub shapes: Vec<Shape>,
    /// Shapes placed through instances only.
    pub groups: Vec<Group>,
    /// Placements of groups.
    pub instances: Vec<Instance>,
    /// Lights that are not attached to shapes (family `Light`).
    pub lights: Vec<NodeId>,
    /// Cameras; the first is the default.
    pub cameras: Vec<NodeId>,
    /// Family `Film`.
    pub film: Option<NodeId>,
    /// Family `Filter`.
    pub filter: Option<NodeId>,
    /// Family `Sampler`.
    pub sampler: Option<NodeId>,
    /// Family `Integrator`.
    pub integrator: Option<NodeId>,
    /// Animations by which the file can be posed as it is read; the description is of one moment.
    #[serde(default)]
    pub animations: Vec<Animation>,
    /// Folder of files that are there while some copy of the description is, such as those of an unpacked archive.
    #[serde(skip)]
    pub unpacked: Option<Unpacked>,
}

/// A shared owner of temporary files: they go away with the last copy.
#[derive(Clone)]
pub struct Unpacked(pub Arc<dyn Any + Send + Sync>);

impl fmt::Debug for Unpacked {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Unpacked")
    }
}

impl SceneDesc {
    /// Adds a node to the arena.
    pub fn add(&mut self, node: Node) -> NodeId {
        self.nodes.push(node);
        NodeId(self.nodes.len() as u32 - 1)
    }

    /// Adds mesh data and returns its index.
    pub fn add_mesh(&mut self, mesh: impl Into<Arc<Mesh>>) -> usize {
        self.meshes.push(mesh.into());
        self.meshes.len() - 1
    }

    /// The node with this id.
    ///
    /// # Panics
    /// If the id is not of this description (a bug in the caller, not in a file).
    pub fn node(&self, id: NodeId) -> &Node {
        &self.nodes[id.0 as usize]
    }

    /// The node with this id, mutable.
    ///
    /// # Panics
    /// If the id is not of this description.
    pub fn node_mut(&mut self, id: NodeId) -> &mut Node {
        &mut self.nodes[id.0 as usize]
    }

    /// The camera of a name or, where none has it, of a number from 0; by default the first.
    pub fn camera(&self, wanted: Option<&str>) -> Option<NodeId> {
        let Some(wanted) = wanted else { return self.cameras.first().copied() };
        let named = |id: &&NodeId| self.node(**id).name.as_deref() == Some(wanted);
        self.cameras.iter().find(named).or_else(|| self.cameras.get(wanted.parse::<usize>().ok()?)).copied()
    }

    /// Every file that the scene is made of: those that were read for the description, and those that its nodes name,
    /// which compiling reads. Some may come twice.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        let named = self.nodes.iter().flat_map(|node| &node.params).filter_map(|param| match &param.value {
            Value::Path(path) => Some(path.as_path()),
            _ => None,
        });
        self.path.as_deref().into_iter().chain(self.sources.paths()).chain(named)
    }

    /// Triangles and patches of the world, instances counted each time they are placed.
    pub fn face_count(&self) -> u64 {
        let count = |shapes: &[Shape]| -> u64 {
            shapes
                .iter()
                .filter_map(|s| s.mesh.and_then(|m| self.meshes.get(m)))
                .map(|m| (m.triangles.len() + m.patches.len()) as u64)
                .sum()
        };
        let per_group: Vec<u64> = self.groups.iter().map(|g| count(&g.shapes)).collect();
        let placed: u64 = self.instances.iter().filter_map(|i| per_group.get(i.group)).sum();
        count(&self.shapes) + placed
    }
}
