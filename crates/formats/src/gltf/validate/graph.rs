//! Nodes, scenes and skins: the trees that they form, and what nodes carry.

use super::{
    Issues,
    document::{Document, list, numbers, wrong_format},
    meshes,
    usage::{Use, Uses},
};
use serde_json::Value;
use std::collections::HashSet;
use steradian_math::DMat4;

/// Tolerance of the length of unit quaternions: the quantisation error of 8-bit components.
pub(super) const UNIT_TOLERANCE: f64 = 0.007;
/// Most scenes that are asked for the joints of a node.
const MOST_SCENES: usize = 16;

/// The nodes as a forest: of several parents the first counts.
struct Forest {
    parents: Vec<Option<usize>>,
    /// The root above each node; `None` for nodes of loops and what is below them.
    roots: Vec<Option<usize>>,
    /// When each node is entered and left, as the trees are walked.
    times: Vec<(usize, usize)>,
}

impl Forest {
    fn new(document: &Document<'_>, issues: &mut Issues) -> Self {
        let nodes = document.list("nodes");
        let count = nodes.len();
        let mut parents: Vec<Option<usize>> = vec![None; count];
        let mut children: Vec<Vec<usize>> = vec![Vec::new(); count];
        for (k, node) in nodes.iter().enumerate() {
            for (n, child) in list(node, "children").iter().enumerate() {
                let Some(child) = child.as_u64().map(|c| c as usize).filter(|c| *c < count) else { continue };
                match parents[child] {
                    None => {
                        parents[child] = Some(k);
                        children[k].push(child);
                    }
                    Some(parent) if parent != k => {
                        let message = format!("node {child} is a child of node {parent} already");
                        issues.add(format!("/nodes/{k}/children/{n}"), message);
                    }
                    Some(_) => {}
                }
            }
        }
        let mut forest = Self { parents, roots: vec![None; count], times: vec![(0, 0); count] };
        let mut clock = 0;
        for root in 0..count {
            if forest.parents[root].is_some() {
                continue;
            }
            let mut open = vec![(root, false)];
            while let Some((node, is_done)) = open.pop() {
                clock += 1;
                if is_done {
                    forest.times[node].1 = clock;
                    continue;
                }
                forest.times[node].0 = clock;
                forest.roots[node] = Some(root);
                open.push((node, true));
                open.extend(children[node].iter().map(|c| (*c, false)));
            }
        }
        forest.report_loops(issues);
        forest
    }

    /// Nodes that no root leads to hang below loops: parents of these lead into one.
    fn report_loops(&self, issues: &mut Issues) {
        let mut walk_of = vec![usize::MAX; self.parents.len()];
        let mut in_loop = vec![false; self.parents.len()];
        for start in 0..self.parents.len() {
            if self.roots[start].is_some() {
                continue;
            }
            let mut at = start;
            while walk_of[at] == usize::MAX {
                walk_of[at] = start;
                match self.parents[at] {
                    Some(parent) => at = parent,
                    None => break,
                }
            }
            while walk_of[at] == start && !in_loop[at] {
                in_loop[at] = true;
                match self.parents[at] {
                    Some(parent) => at = parent,
                    None => break,
                }
            }
        }
        for node in (0..in_loop.len()).filter(|k| in_loop[*k]) {
            issues.add(format!("/nodes/{node}"), "this node is its own descendant: nodes must form trees");
        }
    }

    fn is_above(&self, above: usize, below: usize) -> bool {
        let (a, b) = (self.times[above], self.times[below]);
        self.roots[above].is_some() && self.roots[below].is_some() && a.0 <= b.0 && b.1 <= a.1
    }
}

pub(super) fn check(document: &Document<'_>, uses: &mut Uses, issues: &mut Issues) {
    let forest = Forest::new(document, issues);
    let mut scenes_of: Vec<Vec<usize>> = vec![Vec::new(); forest.parents.len()];
    let mut in_scene = HashSet::new();
    for (k, scene) in document.list("scenes").iter().enumerate() {
        for (n, node) in list(scene, "nodes").iter().enumerate() {
            let Some(node) = node.as_u64().map(|v| v as usize).filter(|v| *v < scenes_of.len()) else { continue };
            if let Some(parent) = forest.parents[node] {
                let message = format!("node {node} is a child of node {parent}; a scene lists roots only");
                issues.add(format!("/scenes/{k}/nodes/{n}"), message);
            }
            scenes_of[node].push(k);
            in_scene.insert((k, node));
        }
    }
    for (k, node) in document.list("nodes").iter().enumerate() {
        let place = format!("/nodes/{k}");
        check_transform(node, &place, issues);
        let Some((_, mesh)) = document.item(node, "mesh", "meshes") else { continue };
        let (weights, targets) = (list(node, "weights").len(), meshes::targets(mesh));
        if node.get("weights").is_some() && weights != targets {
            issues.add(format!("{place}/weights"), format!("{weights} weights stand here for {targets} morph targets"));
        }
        let Some((number, skin)) = document.item(node, "skin", "skins") else { continue };
        if !list(mesh, "primitives").iter().any(|p| p["attributes"].get("JOINTS_0").is_some()) {
            issues.add(&place, "this node has a skin, but its mesh has no attribute 'JOINTS_0'");
        }
        let joint = list(skin, "joints").first().and_then(Value::as_u64).map(|j| j as usize);
        let root = |node: usize| forest.roots.get(node).copied().flatten();
        let (Some(own), Some(joint)) = (root(k), joint.and_then(root)) else { continue };
        if scenes_of[own].iter().take(MOST_SCENES).any(|scene| !in_scene.contains(&(*scene, joint))) {
            issues.add(&place, format!("the joints of skin {number} are not in the scene of this node"));
        }
    }
    for (k, skin) in document.list("skins").iter().enumerate() {
        check_skin(document, &forest, skin, &format!("/skins/{k}"), issues);
        check_matrices(document, skin, &format!("/skins/{k}/inverseBindMatrices"), uses, issues);
    }
}

fn check_transform(node: &Value, place: &str, issues: &mut Issues) {
    if let Some(q) = numbers::<4>(node, "rotation") {
        let length = q.iter().map(|v| v * v).sum::<f64>().sqrt();
        if (length - 1.0).abs() > UNIT_TOLERANCE {
            issues.add(format!("{place}/rotation"), format!("a rotation has length 1, not {length:.4}"));
        }
    }
    if node.get("matrix").is_none() {
        return;
    }
    if ["translation", "rotation", "scale"].iter().any(|name| node.get(name).is_some()) {
        let message = "a node has either a matrix or translation, rotation and scale, not both";
        issues.add(format!("{place}/matrix"), message);
    }
    if let Some(matrix) = numbers::<16>(node, "matrix") {
        let matrix = DMat4::from_cols_array(&matrix);
        // Without shear the axes are orthogonal.
        let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|axis| axis.truncate().normalize_or_zero());
        let is_affine = matrix.row(3).abs_diff_eq(DMat4::IDENTITY.row(3), 1e-6);
        let shear = x.dot(y).abs().max(y.dot(z).abs()).max(z.dot(x).abs());
        if !is_affine || shear > 1e-3 || matrix.determinant() == 0.0 {
            let message = "this matrix is no product of a translation, a rotation and a scale";
            issues.add(format!("{place}/matrix"), message);
        }
    }
}

fn check_skin(document: &Document<'_>, forest: &Forest, skin: &Value, place: &str, issues: &mut Issues) {
    let count = forest.roots.len();
    let joints = list(skin, "joints").iter().filter_map(Value::as_u64).map(|j| j as usize).filter(|j| *j < count);
    let joints: Vec<usize> = joints.collect();
    let root = joints.first().and_then(|j| forest.roots[*j]);
    if joints.iter().any(|j| forest.roots[*j] != root) {
        issues.add(format!("{place}/joints"), "the joints must have one root node in common");
    }
    if let Some((skeleton, _)) = document.item(skin, "skeleton", "nodes")
        && let Some(joint) = joints.iter().find(|j| !forest.is_above(skeleton, **j))
    {
        let message = format!("node {skeleton} is neither joint {joint} nor above it, as the skeleton's root must be");
        issues.add(format!("{place}/skeleton"), message);
    }
}

fn check_matrices(document: &Document<'_>, skin: &Value, place: &str, uses: &mut Uses, issues: &mut Issues) {
    let Some((number, accessor)) = document.accessor(skin, "inverseBindMatrices") else { return };
    uses.accessor(document, number, Use::InverseBindMatrices, place, issues);
    if !accessor.is(&["MAT4"], &[(5126, false)]) {
        wrong_format(issues, place, accessor, "MAT4 of FLOAT");
    }
    let joints = list(skin, "joints").len() as u64;
    if accessor.count < joints {
        issues.add(place, format!("{} matrices are too few for {joints} joints", accessor.count));
    }
}
