//! The scene graph: transforms, and what hangs on nodes.

use super::{Reader, json::At, mesh::Skin};
use glam::DQuat;
use std::collections::HashMap;
use steradian_math::{DMat4, DVec3, Transform};
use steradian_scene::{Family, Node};

/// glTF looks along −z, cameras here along +z.
const TURN: DMat4 = DMat4::from_cols_array_2d(&[
    [1.0, 0.0, 0.0, 0.0],
    [0.0, 1.0, 0.0, 0.0],
    [0.0, 0.0, -1.0, 0.0],
    [0.0, 0.0, 0.0, 1.0],
]);

impl Reader<'_> {
    /// Builds the chosen scene; without scenes all nodes that are nobody's children.
    pub(super) fn scene(&mut self, root: &At<'_>) {
        if root.count("nodes") == 0 {
            // A library of meshes: each is shown where it was modelled.
            for (index, mesh) in root.list("meshes").enumerate() {
                let weights = self.weights(&mesh, &mesh);
                self.mesh(root, index, &mesh, &weights, None, &[DMat4::IDENTITY]);
            }
            return;
        }
        let world = self.places(root);
        let mut order: Vec<(usize, DMat4)> = world.iter().map(|(index, place)| (*index, *place)).collect();
        order.sort_by_key(|node| node.0);
        for (index, place) in order {
            let Some(node) = root.get("nodes").and_then(|n| n.item(index)) else { continue };
            if node.extension("KHR_node_visibility").is_some_and(|v| v.value["visible"] == false) {
                continue;
            }
            let end = self.ends.get(&index).copied().filter(|end| *end != place);
            if node.get("mesh").is_some() {
                self.moved = end.filter(|_| place.determinant().abs() > 1e-30).map(|end| end * place.inverse());
                self.mesh_node(root, &node, place, &world);
                self.moved = None;
            }
            if node.get("camera").is_some() {
                self.camera(root, &node, place, end);
            }
            if let Some(light) = node.extension("KHR_lights_punctual") {
                self.light(root, &light, place);
            }
        }
    }

    /// World transforms of the nodes of the chosen scene.
    pub(super) fn places(&mut self, root: &At<'_>) -> HashMap<usize, DMat4> {
        let roots = self.roots(root);
        self.world_transforms(root, &roots)
    }

    fn roots(&mut self, root: &At<'_>) -> Vec<usize> {
        let count = root.count("nodes");
        let scenes = root.count("scenes");
        if scenes == 0 {
            let mut is_child = vec![false; count];
            for child in root.list("nodes").flat_map(|n| n.list("children").collect::<Vec<_>>()) {
                if let Some(flag) = child.value.as_u64().and_then(|c| is_child.get_mut(c as usize)) {
                    *flag = true;
                }
            }
            return (0..count).filter(|k| !is_child[*k]).collect();
        }
        let wanted = match self.options.defines.get("scene") {
            Some(text) => {
                let by_name = || root.list("scenes").position(|s| s.label().as_ref() == Some(text));
                let number = text.parse().ok().filter(|n| *n < scenes).or_else(by_name);
                if number.is_none() {
                    self.error(root, format!("there is no scene '{text}'; there are {scenes}, numbered from 0"));
                }
                number.unwrap_or(0)
            }
            None if root.get("scene").is_some() => self.index(root, root, "scene", "scenes").map_or(0, |s| s.0),
            None => 0,
        };
        let Some(scene) = root.get("scenes").and_then(|s| s.item(wanted)) else { return Vec::new() };
        let mut roots = Vec::new();
        for node in scene.list("nodes") {
            match node.value.as_u64().filter(|n| (*n as usize) < count) {
                Some(n) => roots.push(n as usize),
                None => self.error(&node, format!("there is no such node: there are {count}")),
            }
        }
        roots
    }

    /// World transforms of the nodes below `roots`. A node that is met twice (in a cycle, or under two parents) is an
    /// error.
    fn world_transforms(&mut self, root: &At<'_>, roots: &[usize]) -> HashMap<usize, DMat4> {
        let mut world = HashMap::new();
        let mut open: Vec<(usize, DMat4)> = roots.iter().map(|r| (*r, DMat4::IDENTITY)).collect();
        let count = root.count("nodes");
        while let Some((index, parent)) = open.pop() {
            let Some(node) = root.get("nodes").and_then(|n| n.item(index)) else { continue };
            let place = parent * self.local_transform(&node);
            if world.insert(index, place).is_some() {
                self.error(&node, "this node is met twice: nodes must form trees");
                return world;
            }
            for child in node.list("children") {
                match child.value.as_u64().filter(|n| (*n as usize) < count) {
                    Some(n) => open.push((n as usize, place)),
                    None => self.error(&child, format!("there is no such node: there are {count}")),
                }
            }
        }
        world
    }

    fn local_transform(&mut self, node: &At<'_>) -> DMat4 {
        if node.get("matrix").is_some() {
            return DMat4::from_cols_array(&self.numbers(node, "matrix", DMat4::IDENTITY.to_cols_array()));
        }
        let t = self.numbers(node, "translation", [0.0; 3]);
        let s = self.numbers(node, "scale", [1.0; 3]);
        let r = DQuat::from_array(self.numbers(node, "rotation", [0.0, 0.0, 0.0, 1.0]));
        let r = if r.length_squared() > 1e-12 { r.normalize() } else { DQuat::IDENTITY };
        DMat4::from_scale_rotation_translation(DVec3::from(s), r, DVec3::from(t))
    }

    fn mesh_node(&mut self, root: &At<'_>, node: &At<'_>, place: DMat4, world: &HashMap<usize, DMat4>) {
        let Some((index, mesh)) = self.index(root, node, "mesh", "meshes") else { return };
        let weights = self.weights(node, &mesh);
        let skin = match node.get("skin") {
            Some(_) => match self.skin(root, node, world) {
                Some(skin) => Some(skin),
                None => return,
            },
            None => None,
        };
        let places = match node.extension("EXT_mesh_gpu_instancing") {
            Some(extension) => self.instances(root, &extension, place),
            // A skin places its vertices in the world by itself.
            None if skin.is_some() => vec![DMat4::IDENTITY],
            None => vec![place],
        };
        self.mesh(root, index, &mesh, &weights, skin.as_ref(), &places);
    }

    /// Weights of morph targets: the node's, else the mesh's.
    fn weights(&mut self, node: &At<'_>, mesh: &At<'_>) -> Vec<f64> {
        let of = |at: &At<'_>| -> Option<Vec<f64>> {
            Some(
                at.get("weights")?
                    .value
                    .as_array()?
                    .iter()
                    .map(|w| w.as_f64().unwrap_or(0.0).clamp(-1e6, 1e6))
                    .collect(),
            )
        };
        of(node).or_else(|| of(mesh)).unwrap_or_default()
    }

    fn skin(&mut self, root: &At<'_>, node: &At<'_>, world: &HashMap<usize, DMat4>) -> Option<Skin> {
        let (_, skin) = self.index(root, node, "skin", "skins")?;
        let count = skin.count("joints");
        let inverse = match skin.get("inverseBindMatrices") {
            Some(_) => self.floats::<16>(root, &skin, "inverseBindMatrices")?,
            None => vec![DMat4::IDENTITY.as_mat4().to_cols_array(); count],
        };
        if inverse.len() < count {
            self.error(&skin, format!("{} matrices are too few for {count} joints", inverse.len()));
            return None;
        }
        let mut joints = Vec::with_capacity(count);
        for (joint, inverse) in skin.list("joints").zip(inverse) {
            let place = joint.value.as_u64().and_then(|j| world.get(&(j as usize)));
            let Some(place) = place else {
                self.error(&joint, "this joint is not a node of the scene");
                return None;
            };
            joints.push(*place * DMat4::from_cols_array(&inverse.map(f64::from)));
        }
        Some(Skin { joints })
    }

    /// Places of EXT_mesh_gpu_instancing.
    fn instances(&mut self, root: &At<'_>, extension: &At<'_>, place: DMat4) -> Vec<DMat4> {
        let Some(attributes) = extension.get("attributes") else { return vec![place] };
        let mut of = |name: &str| match attributes.get(name) {
            Some(_) if name == "ROTATION" => self.floats::<4>(root, &attributes, name),
            Some(_) => self
                .floats::<3>(root, &attributes, name)
                .map(|v| v.into_iter().map(|[x, y, z]| [x, y, z, 0.0]).collect()),
            None => Some(Vec::new()),
        };
        let (Some(t), Some(r), Some(s)) = (of("TRANSLATION"), of("ROTATION"), of("SCALE")) else { return Vec::new() };
        let count = t.len().max(r.len()).max(s.len());
        if [&t, &r, &s].iter().any(|v| !v.is_empty() && v.len() != count) || count > self.options.limits.instances {
            self.error(extension, format!("{count} instances: their attributes differ in number, or are too many"));
            return Vec::new();
        }
        let at = |v: &[[f32; 4]], k: usize, default: [f64; 4]| v.get(k).map_or(default, |v| v.map(f64::from));
        (0..count)
            .map(|k| {
                let [x, y, z, _] = at(&t, k, [0.0; 4]);
                let [a, b, c, _] = at(&s, k, [1.0; 4]);
                let q = DQuat::from_array(at(&r, k, [0.0, 0.0, 0.0, 1.0]));
                let q = if q.length_squared() > 1e-12 { q.normalize() } else { DQuat::IDENTITY };
                place * DMat4::from_scale_rotation_translation(DVec3::new(a, b, c), q, DVec3::new(x, y, z))
            })
            .collect()
    }

    /// The planes between which a camera sees; without `zfar` there is no end.
    fn clipping(&mut self, lens: &At<'_>, camera: &mut Node) {
        let near = self.number(lens, "znear", 0.0, (0.0, 1e12));
        let far = self.number(lens, "zfar", f64::INFINITY, (0.0, f64::INFINITY));
        // Planes in another order are a broken rule, of which the check of the document warns.
        if near < far {
            camera.set("near", near, None);
            if far.is_finite() {
                camera.set("far", far, None);
            }
        }
    }

    fn camera(&mut self, root: &At<'_>, node: &At<'_>, place: DMat4, end: Option<DMat4>) {
        let Some((_, camera)) = self.index(root, node, "camera", "cameras") else { return };
        let span = self.span(&camera);
        // A camera keeps its shape whatever the scale of its nodes is.
        let to_world = |place: DMat4| {
            let (_, rotation, translation) = place.to_scale_rotation_translation();
            let rotation = if rotation.is_finite() { rotation.normalize() } else { DQuat::IDENTITY };
            Transform { matrix: DMat4::from_rotation_translation(rotation, translation) * TURN }
        };
        let kind = camera.text("type").unwrap_or_default();
        let mut aspect = 4.0 / 3.0;
        let lens = camera.get(kind);
        let mut description = match (kind, &lens) {
            ("perspective", Some(p)) => {
                let fov = self.number(p, "yfov", 0.8, (1e-3, 3.1)).to_degrees();
                aspect = self.number(p, "aspectRatio", aspect, (1e-2, 1e2));
                Node::new(Family::Camera, "perspective", span).with("fov", fov).with("fov_axis", "y")
            }
            ("orthographic", Some(o)) => {
                let x = self.number(o, "xmag", 1.0, (-1e9, 1e9)).abs().max(1e-9);
                let y = self.number(o, "ymag", 1.0, (-1e9, 1e9)).abs().max(1e-9);
                aspect = x / y;
                Node::new(Family::Camera, "orthographic", span).with("screen_window", vec![-x, x, -y, y])
            }
            _ => {
                self.error(&camera, "a camera has the type 'perspective' or 'orthographic' and its parameters");
                return;
            }
        };
        if let Some(lens) = &lens {
            self.clipping(lens, &mut description);
        }
        description.set("to_world", to_world(place), None);
        if let Some(end) = end {
            description.set("to_world_end", to_world(end), None);
        }
        description.name = node.label().or_else(|| camera.label());
        let desc = &mut self.import.desc;
        let id = desc.add(description);
        desc.cameras.push(id);
        if desc.film.is_none() {
            let width = (768.0 * aspect.clamp(0.05, 20.0)).round().max(1.0) as i64;
            let film = Node::new(Family::Film, "rgb", None).with("width", width).with("height", 768);
            desc.film = Some(desc.add(film));
        }
    }
}
