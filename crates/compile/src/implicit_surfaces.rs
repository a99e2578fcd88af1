//! Compiling surfaces that are given by equations.

use super::{Compiler, shapes::Placed};
use std::sync::Arc;
use steradian_core::shape::{
    LevelSet, Shape,
    level::{Function, Revolution},
};
use steradian_math::{DVec3, Vec3, expression::Expression, intersect::Quadric};
use steradian_scene::{Node, names};

impl Compiler<'_> {
    /// A paraboloid, cone, hyperboloid, quadric or implicit surface; nothing where it is refused.
    pub(super) fn level(&mut self, placed: &Placed<'_>) -> Vec<Shape> {
        let node = placed.node;
        let function = match node.kind.as_str() {
            "quadric" => self.coefficients(placed),
            "implicit" => self.expression(placed),
            kind => self.revolution(kind, placed),
        };
        let Some((function, corners, flip)) = function else { return Vec::new() };
        match LevelSet::new(function, corners, placed.place, flip != placed.reverse) {
            Some(surface) => vec![Shape::Level(Arc::new(surface))],
            None => {
                let what = format!("the box of shape '{}' is empty: 'max' is to be above 'min'", node.kind);
                self.error(node.span, what);
                Vec::new()
            }
        }
    }

    fn coefficients(&mut self, placed: &Placed<'_>) -> Option<(Function, [DVec3; 2], bool)> {
        let node = placed.node;
        let list = self.list(node, "coefficients");
        let Some(&[a, b, c, d, e, f, g, h, i, j]) = list.as_deref() else {
            if list.is_some() || node.get("coefficients").is_none() {
                let span = node.param("coefficients").and_then(|p| p.span).or(node.span);
                let found = list.map_or(0, |l| l.len());
                self.error(span, format!("shape 'quadric' needs ten 'coefficients', A to J; here are {found}"));
            }
            return None;
        };
        if [a, b, c, d, e, f, g, h, i].iter().all(|c| *c == 0.0) {
            self.error(node.span, "all coefficients of this quadric but the constant are zero: it is no surface");
            return None;
        }
        let half = [a, b, c, 0.5 * d, 0.5 * f, 0.5 * e, 0.5 * g, 0.5 * h, 0.5 * i, j].map(f64::from);
        Some((Function::Quadric(Quadric::new(half)), self.corners(placed), false))
    }

    fn expression(&mut self, placed: &Placed<'_>) -> Option<(Function, [DVec3; 2], bool)> {
        let node = placed.node;
        Some((Function::Expression(self.formula(node, "expression", &["x", "y", "z"])?), self.corners(placed), false))
    }

    /// The expression of a parameter, in some variables; `None` where it is refused.
    pub(super) fn formula<const N: usize>(
        &mut self,
        node: &Node,
        name: &str,
        variables: &[&str; N],
    ) -> Option<Expression<N>> {
        let span = node.param(name).and_then(|p| p.span).or(node.span);
        let whose = format!("{} '{}'", node.family.noun(), node.kind);
        if node.get(name).is_none() {
            let (last, first) = variables.split_last().map_or(("", &[][..]), |(last, first)| (*last, first));
            self.error(span, format!("{whose} needs an '{name}' in {} and {last}", first.join(", ")));
        }
        let text = self.given_word(node, name)?;
        let fault = match Expression::new(text, variables) {
            Ok(expression) => return Some(expression),
            Err(fault) => fault,
        };
        let known = Expression::names(variables);
        let help = fault.name.as_deref().and_then(|name| names::did_you_mean(name, known));
        let help = help.map_or(String::new(), |help| format!("; {help}"));
        self.error(span, format!("in '{name}' of {whose}: {fault}{help}"));
        None
    }

    /// The box that a surface is cut by.
    fn corners(&mut self, placed: &Placed<'_>) -> [DVec3; 2] {
        [self.vec3(placed.node, "min"), self.vec3(placed.node, "max")].map(Vec3::as_dvec3)
    }

    fn revolution(&mut self, kind: &str, placed: &Placed<'_>) -> Option<(Function, [DVec3; 2], bool)> {
        let node = placed.node;
        let phi = f64::from(self.float(node, "phi_max").clamp(0.0, 360.0)).to_radians();
        let (surface, flip) = match kind {
            "cone" => {
                let radius = f64::from(self.positive(node, "radius"));
                let height = f64::from(self.positive(node, "height"));
                (Revolution::line(DVec3::X * radius, DVec3::Z * height, phi), false)
            }
            "hyperboloid" => {
                let [a, b] = [self.vec3(node, "p1"), self.vec3(node, "p2")].map(Vec3::as_dvec3);
                (Revolution::line(a, b, phi), b.z < a.z)
            }
            _ => {
                let radius = f64::from(self.positive(node, "radius"));
                let z = [self.float(node, "z_min"), self.float(node, "z_max")].map(f64::from);
                (Revolution::parabola(radius, [z[0].min(z[1]).max(0.0), z[0].max(z[1])], phi), false)
            }
        };
        let Some(surface) = surface else {
            let what = match kind {
                "hyperboloid" => "'p1' and 'p2' of a hyperboloid are to be at different heights; a 'disk' is flat",
                "cone" => "this cone is too flat or too steep for numbers",
                _ => "a paraboloid needs a 'z_max' above 0 and above 'z_min'",
            };
            self.error(node.span, what);
            return None;
        };
        Some((Function::Revolution(surface), surface.corners(), flip))
    }
}
