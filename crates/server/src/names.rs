//! Names of nodes as pages show them, and edits give them: those of the file, or the kind and its place among the
//! nameless of its kind, as `sphere 2`.

use std::collections::{HashMap, HashSet};
use steradian::{
    formats::native,
    scene::{NodeId, SceneDesc, Shape},
};

/// A name for each node that no other has. Of [`native::ids`] they are those of a description whose nodes have these
/// names.
pub fn labels(desc: &SceneDesc) -> Vec<String> {
    let ids = native::ids(desc);
    let given = |name: &Option<String>| name.clone().filter(|name| !name.is_empty());
    let mut taken: HashSet<String> = desc.nodes.iter().filter_map(|node| given(&node.name)).collect();
    let mut counts: HashMap<String, u32> = HashMap::new();
    let mut free = |stem: &str, of: &dyn Fn(u32) -> String| {
        let count = counts.entry(stem.to_owned()).or_default();
        loop {
            *count += 1;
            let name = of(*count);
            if taken.insert(name.clone()) {
                return name;
            }
        }
    };
    let label = |(node, id): (&steradian::scene::Node, String)| match given(&node.name) {
        None => {
            let kind = node.kind.replace(['_', '#'], " ");
            free(&kind, &|count| format!("{kind} {count}"))
        }
        Some(name) if name == id || name.contains('#') => id,
        // Further nodes of a name count from two.
        Some(name) => free(&format!("{name} ("), &|count| format!("{name} ({})", count + 1)),
    };
    desc.nodes.iter().zip(ids).map(label).collect()
}

/// Does something to a description whose nodes have their labels as names.
pub fn with_labels<T>(desc: &mut SceneDesc, labels: &[String], act: impl FnOnce(&mut SceneDesc) -> T) -> T {
    let label = |(node, label): (&mut steradian::scene::Node, &String)| {
        let own = node.name.clone();
        if !label.contains('#') {
            node.name = Some(label.clone());
        }
        own
    };
    let own: Vec<Option<String>> = desc.nodes.iter_mut().zip(labels).map(label).collect();
    let done = act(desc);
    desc.nodes.iter_mut().zip(own).for_each(|(node, own)| node.name = own);
    done
}

/// Nodes that belong to a shape's node.
#[derive(Clone, Copy, Debug)]
struct Parts {
    material: Option<NodeId>,
    emission: Option<NodeId>,
    /// True if it is placed once, in the world itself.
    is_single: bool,
}

/// Names of a scene's nodes, and the nodes that belong to its shapes.
#[derive(Debug, Default)]
pub struct Names {
    labels: Vec<String>,
    parts: HashMap<u32, Parts>,
}

/// Names of a shape, its material and its light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfaceNames<'a> {
    /// Shape.
    pub object: Option<&'a str>,
    /// Material.
    pub material: Option<&'a str>,
    /// Area light.
    pub light: Option<&'a str>,
}

impl Names {
    /// Names of a scene.
    pub fn new(desc: &SceneDesc) -> Self {
        let of_world = desc.shapes.iter().map(|shape| (shape, true));
        let grouped = desc.groups.iter().flat_map(|group| &group.shapes).map(|shape| (shape, false));
        let mut parts: HashMap<u32, Parts> = HashMap::new();
        for (Shape { node, material, emission, .. }, is_single) in of_world.chain(grouped) {
            let new = Parts { material: *material, emission: *emission, is_single };
            parts.entry(node.0).and_modify(|known| known.is_single = false).or_insert(new);
        }
        Self { labels: labels(desc), parts }
    }

    /// Number of nodes that have names.
    pub fn count(&self) -> usize {
        self.labels.len()
    }

    /// Names of what a first hit's shape is, which counts from one; none for zero.
    pub fn of(&self, shape: u32) -> SurfaceNames<'_> {
        let label = |node: NodeId| self.labels.get(node.0 as usize).map(String::as_str);
        let found = shape.checked_sub(1).and_then(|node| self.parts.get_key_value(&node));
        let Some((node, parts)) = found else { return SurfaceNames::default() };
        SurfaceNames {
            object: label(NodeId(*node)),
            material: parts.material.and_then(label),
            light: parts.emission.and_then(label),
        }
    }

    /// Number of the shape of a name, as first hits have it, and true if it is placed once, in the world itself.
    pub fn shape(&self, name: &str) -> Option<(u32, bool)> {
        let node = self.labels.iter().position(|label| label == name)? as u32;
        self.parts.get(&node).map(|parts| (node + 1, parts.is_single))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian::scene::{Family, Node};

    #[test]
    fn every_node_has_a_name_of_its_own() {
        let mut desc = SceneDesc::default();
        let names = [None, Some("sphere 2"), None, Some("ball"), Some("ball"), Some("ball"), Some("a#b"), Some("")];
        for name in names {
            desc.add(Node { name: name.map(String::from), ..Node::new(Family::Shape, "sphere", None) });
        }
        desc.add(Node::new(Family::Material, "coated_diffuse", None));
        let found = labels(&desc);
        let expected = ["sphere 1", "sphere 2", "sphere 3", "ball", "ball (2)", "ball (3)", "a#b#6", "sphere 4"];
        assert_eq!(found[..8], expected);
        assert_eq!(found[8], "coated diffuse 1");
        let before = desc.nodes.clone();
        with_labels(&mut desc, &found, |desc| assert_eq!(native::ids(desc), found));
        assert_eq!(desc.nodes, before);
    }
}
