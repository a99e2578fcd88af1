//! Warnings of parameters that nothing has, for scenes made in code; readers give them for files.

use super::Compiler;

impl Compiler<'_> {
    /// Reports parameters that no model has, with the nearest that there is. Readers of files know their own names.
    pub(super) fn check_names(&mut self) {
        let is_code = self.desc.path.is_none() && self.desc.sources.paths().next().is_none();
        if !is_code {
            return;
        }
        for node in &self.desc.nodes {
            for param in &node.params {
                let kinds = self.options.registry.kinds();
                if let Some(help) = kinds.unknown(node.family, &node.kind, &param.name) {
                    let what = format!("{} '{}' has no parameter '{}'", node.family.noun(), node.kind, param.name);
                    self.diagnostics.unused(&self.desc.sources, param.span.or(node.span), what, help);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{Options, compile};
    use steradian_scene::{Family, Fidelity, Node, SceneDesc, Shape};

    fn messages(material: Node, shape: Node) -> Vec<String> {
        let mut desc = SceneDesc::default();
        let material = desc.add(material);
        let shape = desc.add(shape);
        desc.shapes.push(Shape { material: Some(material), ..Shape::new(shape) });
        let camera = desc.add(Node::new(Family::Camera, "perspective", None));
        desc.cameras.push(camera);
        let compiled = compile(&desc, &Options { size: Some((4, 4)), ..Options::default() });
        compiled.diagnostics.iter().filter(|d| d.fidelity.is_some()).map(ToString::to_string).collect()
    }

    #[test]
    fn misspelt_names_in_code_are_told_as_those_of_files() {
        let ball = || Node::new(Family::Shape, "sphere", None);
        let diffuse = |kind: &str, name: &str| Node::new(Family::Material, kind, None).with(name, 0.5);
        let found = messages(diffuse("diffuse", "reflectence"), ball().with("raduis", 2.0));
        assert!(
            found.iter().any(|m| m.contains("no parameter 'reflectence'") && m.contains("'reflectance'")),
            "{found:?}"
        );
        assert!(found.iter().any(|m| m.contains("no parameter 'raduis'") && m.contains("'radius'")), "{found:?}");
        let found = messages(diffuse("difuse", "reflectance"), ball());
        assert!(found.iter().any(|m| m.contains("'difuse'") && m.contains("did you mean 'diffuse'?")), "{found:?}");
        assert_eq!(messages(diffuse("diffuse", "reflectance"), ball().with("radius", 2.0)), Vec::<String>::new());
        assert!(compile_fidelity_is_unused());
    }

    fn compile_fidelity_is_unused() -> bool {
        let mut desc = SceneDesc::default();
        desc.add(Node::new(Family::Film, "rgb", None).with("widht", 3_i64));
        let compiled = compile(&desc, &Options::default());
        compiled.diagnostics.iter().any(|d| d.fidelity == Some(Fidelity::Unused))
    }
}
