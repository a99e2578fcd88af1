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

/// Names of a scene's nodes, and the nodes that belong to its shapes.
#[derive(Debug, Default)]
pub struct Names {
    labels: Vec<String>,
    /// Material and emission by the nodes of shapes.
    parts: HashMap<u32, [Option<NodeId>; 2]>,
}

/// Names of a shape, its material and its light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Named<'a> {
    /// Shape.
    pub object: Option<&'a str>,
    /// Material.
    pub material: Option<&'a str>,
    /// Area light.
    pub light: Option<&'a str>,
}

impl Names {
    /// Those of a scene.
    pub fn new(desc: &SceneDesc) -> Self {
        let shapes = desc.shapes.iter().chain(desc.groups.iter().flat_map(|group| &group.shapes));
        let mut parts = HashMap::new();
        for Shape { node, material, emission, .. } in shapes {
            parts.entry(node.0).or_insert([*material, *emission]);
        }
        Self { labels: labels(desc), parts }
    }

    /// Number of nodes that have names.
    pub fn count(&self) -> usize {
        self.labels.len()
    }

    /// Names of what a first hit's shape is, which counts from one; none for zero.
    pub fn of(&self, shape: u32) -> Named<'_> {
        let label = |node: NodeId| self.labels.get(node.0 as usize).map(String::as_str);
        let found = shape.checked_sub(1).and_then(|node| self.parts.get_key_value(&node));
        let Some((node, [material, light])) = found else { return Named::default() };
        Named { object: label(NodeId(*node)), material: material.and_then(label), light: light.and_then(label) }
    }

    /// Number of the shape of a name, as first hits have it.
    pub fn shape(&self, name: &str) -> Option<u32> {
        let node = self.labels.iter().position(|label| label == name)? as u32;
        self.parts.contains_key(&node).then_some(node + 1)
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
