//! Sensors that measure: along one ray, or over a shape.

use super::{graph::ObjectId, reader::Reader};
use steradian_math::{DVec3, Transform};
use steradian_scene::Family;

impl Reader<'_> {
    /// A `radiancemeter`: placed by a transform, or by `origin` and `direction`.
    pub(super) fn radiance_meter(&mut self, object: ObjectId) {
        let mut node = self.node(Family::Camera, "radiance_meter", object);
        let span = self.value_span(object, if self.graph.has(object, "origin") { "origin" } else { "to_world" });
        let line = (self.vec3(object, "origin"), self.vec3(object, "direction"));
        let to_world = match line {
            (None, None) => self.transform(object, "to_world"),
            (Some(origin), Some(direction)) => {
                let (origin, direction) = (DVec3::from(origin), DVec3::from(direction));
                let up = if direction.x.abs() > direction.y.abs() { DVec3::Y } else { DVec3::X };
                self.left_out(object, "to_world", &[], "'origin' and 'direction' place the sensor");
                let Some(place) = Transform::look_at(origin, origin + direction, up) else {
                    return self.error(span, "the 'direction' of a 'radiancemeter' must not be zero");
                };
                place
            }
            _ => return self.error(span, "a 'radiancemeter' needs both 'origin' and 'direction', or neither"),
        };
        node.set("to_world", to_world, Some(span));
        self.exposed(node, object);
    }

    /// An `irradiancemeter` on a shape that is placed so.
    pub(super) fn irradiance_meter(&mut self, object: ObjectId, shape: ObjectId) {
        self.graph.objects[object].visited = true;
        let flip = self.bool(shape, "flip_normals").unwrap_or(false);
        let mut place = self.transform(shape, "to_world");
        // A mirrored round shape faces inwards in Mitsuba.
        let turned = flip != place.swaps_handedness();
        let (surface, is_inward) = match self.plugin(shape) {
            "rectangle" => ("square", flip),
            "disk" => ("disk", flip),
            "sphere" => {
                let center = self.vec3(shape, "center").unwrap_or([0.0; 3]);
                let radius = self.float(shape, "radius").unwrap_or(1.0);
                place = place * Transform::translate(center.into()) * Transform::scale(DVec3::splat(radius));
                ("sphere", turned)
            }
            other => {
                let message = format!("there is no 'irradiancemeter' on a '{other}'");
                let help = Some("it measures on a 'rectangle', 'disk' or 'sphere'".to_owned());
                return self.diagnostics.error_help(&self.desc.sources, Some(self.span(object)), message, help);
            }
        };
        let mut node = self.node(Family::Camera, "irradiance_meter", object);
        node.set("to_world", place, Some(self.span(object)))
            .set("surface", surface, None)
            .set("inward", is_inward, None);
        self.exposed(node, object);
    }
}
