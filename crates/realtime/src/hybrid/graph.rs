//! The passes of a hybrid frame as a graph: each names what it reads and what it writes, from which the order follows.

use std::fmt;

/// Resources of the frame graph: pictures of the frame, or their inputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Resource {
    /// Which primitive each pixel sees.
    Visibility,
    /// Surfaces that are seen: position, normal, albedo, motion.
    Surfaces,
    /// Emission of visible surfaces, and the background.
    Emission,
    /// Light of lights, shadowed by rays, over albedo.
    Direct,
    /// Light after one diffuse bounce, over albedo.
    Indirect,
    /// Light by glossy and mirror reflection.
    Reflections,
    /// Light that was let through.
    Transparency,
    /// The part of the hemisphere that is open nearby.
    Occlusion,
    /// The frame before.
    History,
    /// [`Resource::Direct`] without noise; and so on.
    FilteredDirect,
    FilteredIndirect,
    FilteredReflections,
    FilteredTransparency,
    FilteredOcclusion,
    /// All light together.
    Picture,
}

impl Resource {
    /// Its name in options and in the picture of the graph.
    pub fn name(self) -> &'static str {
        match self {
            Self::Visibility => "visibility",
            Self::Surfaces => "surfaces",
            Self::Emission => "emission",
            Self::Direct => "direct",
            Self::Indirect => "indirect",
            Self::Reflections => "reflections",
            Self::Transparency => "transparency",
            Self::Occlusion => "occlusion",
            Self::History => "history",
            Self::FilteredDirect => "filtered direct",
            Self::FilteredIndirect => "filtered indirect",
            Self::FilteredReflections => "filtered reflections",
            Self::FilteredTransparency => "filtered transparency",
            Self::FilteredOcclusion => "filtered occlusion",
            Self::Picture => "picture",
        }
    }
}

/// A step of a frame.
#[derive(Clone, Copy, Debug)]
pub struct Node {
    /// Its name.
    pub name: &'static str,
    /// Resources that it reads.
    pub reads: &'static [Resource],
    /// Resources that it writes.
    pub writes: &'static [Resource],
}

/// Why passes are no graph.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Fault {
    /// A pass reads what no pass writes.
    Unwritten(&'static str, Resource),
    /// Two passes write the same.
    WrittenTwice(&'static str, &'static str, Resource),
    /// Passes wait for each other.
    Circle(Vec<&'static str>),
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unwritten(pass, resource) => write!(f, "pass {pass} reads {}, which no pass writes", resource.name()),
            Self::WrittenTwice(a, b, resource) => write!(f, "passes {a} and {b} both write {}", resource.name()),
            Self::Circle(names) => write!(f, "passes wait for each other: {}", names.join(", ")),
        }
    }
}

/// The passes that a result needs, in an order in which each comes after those that it reads from.
#[derive(Clone, Debug)]
pub struct Graph {
    nodes: Vec<Node>,
}

impl Graph {
    /// Orders those passes that some resources need; `given` are there from the start. Passes keep the order in which
    /// they are listed where nothing speaks against it.
    ///
    /// # Errors
    /// What makes them no graph.
    pub fn new(passes: &[Node], given: &[Resource], wanted: &[Resource]) -> Result<Self, Fault> {
        let writer = |resource: Resource| passes.iter().position(|p| p.writes.contains(&resource));
        // Each resource needs exactly one writer, or must be given.
        for (k, pass) in passes.iter().enumerate() {
            for &resource in pass.writes {
                if let Some(other) = writer(resource).filter(|other| *other < k) {
                    return Err(Fault::WrittenTwice(passes[other].name, pass.name, resource));
                }
            }
            let unwritten = |r: &&Resource| writer(**r).is_none() && !given.contains(r);
            if let Some(resource) = pass.reads.iter().find(unwritten) {
                return Err(Fault::Unwritten(pass.name, *resource));
            }
        }
        // From what is wanted back.
        let mut needed = vec![false; passes.len()];
        let mut open: Vec<usize> = wanted.iter().filter_map(|r| writer(*r)).collect();
        while let Some(k) = open.pop() {
            if !std::mem::replace(&mut needed[k], true) {
                open.extend(passes[k].reads.iter().filter_map(|r| writer(*r)));
            }
        }
        // Topological sort (Kahn 1962): take the first listed pass whose inputs are all written.
        let mut left: Vec<usize> = (0..passes.len()).filter(|k| needed[*k]).collect();
        let mut nodes = Vec::with_capacity(left.len());
        while !left.is_empty() {
            // A pass is ready when no writer of its inputs is left.
            let is_ready = |k: &usize| {
                let waits = |r: &Resource| writer(*r).is_some_and(|w| left.contains(&w));
                !passes[*k].reads.iter().any(waits)
            };
            // Nothing is ready but passes are left: a cycle.
            let Some(next) = left.iter().position(is_ready) else {
                return Err(Fault::Circle(left.iter().map(|k| passes[*k].name).collect()));
            };
            nodes.push(passes[left.remove(next)]);
        }
        Ok(Self { nodes })
    }

    /// The passes in order.
    pub fn passes(&self) -> &[Node] {
        &self.nodes
    }

    /// For each pass, how many passes come one after the other before it.
    pub fn levels(&self) -> Vec<usize> {
        // Longest path from a source: one more than the highest level among the writers of its inputs.
        let mut levels: Vec<usize> = Vec::with_capacity(self.nodes.len());
        for node in &self.nodes {
            let before =
                self.nodes.iter().zip(&levels).filter(|(n, _)| node.reads.iter().any(|r| n.writes.contains(r)));
            levels.push(before.map(|(_, level)| level + 1).max().unwrap_or(0));
        }
        levels
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Resource::{Direct, Emission, History, Picture, Surfaces, Visibility};

    const fn node(name: &'static str, reads: &'static [Resource], writes: &'static [Resource]) -> Node {
        Node { name, reads, writes }
    }

    #[test]
    fn passes_come_after_what_they_read_and_only_if_needed() {
        let passes = [
            node("sum", &[Emission, Direct], &[Picture]),
            node("light", &[Surfaces, History], &[Direct]),
            node("glow", &[Surfaces], &[Emission]),
            node("surfaces", &[Visibility], &[Surfaces]),
            node("raster", &[], &[Visibility]),
        ];
        let names = |wanted: &[Resource]| {
            let graph = Graph::new(&passes, &[History], wanted).expect("a graph");
            (graph.passes().iter().map(|p| p.name).collect::<Vec<_>>(), graph.levels())
        };
        assert_eq!(names(&[Picture]), (vec!["raster", "surfaces", "light", "glow", "sum"], vec![0, 1, 2, 2, 3]));
        assert_eq!(names(&[Emission]).0, ["raster", "surfaces", "glow"]);
        assert!(names(&[]).0.is_empty());
    }

    #[test]
    fn what_is_no_graph_is_said() {
        let a = node("a", &[Direct], &[Emission]);
        let fault = |passes: &[Node]| Graph::new(passes, &[], &[Emission]).expect_err("no graph").to_string();
        assert_eq!(fault(&[a]), "pass a reads direct, which no pass writes");
        assert_eq!(fault(&[a, node("b", &[], &[Direct, Emission])]), "passes a and b both write emission");
        assert_eq!(fault(&[a, node("b", &[Emission], &[Direct])]), "passes wait for each other: a, b");
    }
}
