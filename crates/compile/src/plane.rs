//! Compiling infinite planes by their three forms: n·x + d = 0, point and normal, point and two directions.

use super::{Compiler, shapes::Placed};
use steradian_core::shape::{Plane, Shape};
use steradian_math::DVec3;

impl Compiler<'_> {
    pub(super) fn plane(&mut self, placed: &Placed<'_>) -> Vec<Shape> {
        let (node, place) = (placed.node, placed.place);
        let has = |name: &str| node.get(name).is_some();
        let point = has("point").then(|| self.dvec3_or(node, "point", DVec3::ZERO).as_vec3());
        let plane = match point {
            Some(p) if has("along") || has("across") => {
                self.superseded(node, "along", &["normal", "distance"]);
                let directions = ["along", "across"].map(|name| self.dvec3_or(node, name, DVec3::ZERO).as_vec3());
                Plane::spanned(place.point(p), directions.map(|v| place.vector(v)), placed.reverse)
            }
            _ => {
                let n = self.vec3(node, "normal");
                let d = match point {
                    Some(p) => {
                        self.superseded(node, "point", &["distance"]);
                        -n.dot(p)
                    }
                    None => self.float(node, "distance"),
                };
                // n·x + d = 0 in object space: the plane's covector goes by the inverse transpose.
                let covector = place.inv.transpose() * n.extend(d);
                Plane::new(covector.truncate(), covector.w, placed.reverse)
            }
        };
        if point.is_none() && (has("along") || has("across")) {
            self.error(node.span, "'along' and 'across' span a plane through a 'point', which is absent");
        }
        match plane {
            Some(plane) => vec![Shape::Plane(plane)],
            None => {
                let what = "the normal of this plane is zero or not finite, or its two directions are parallel";
                self.error(node.span, what);
                Vec::new()
            }
        }
    }
}
