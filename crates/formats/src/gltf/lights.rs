//! KHR_lights_punctual.

use super::{Reader, json::At};
use steradian_math::{DMat4, DVec3, Transform};
use steradian_scene::{ColorSpace, Family, Node, SpectrumValue};

impl Reader<'_> {
    /// The light that a node's extension names.
    pub(super) fn light(&mut self, root: &At<'_>, at: &At<'_>, place: DMat4) {
        let Some(lights) = root.extension("KHR_lights_punctual") else {
            self.error(at, "the document has no lights");
            return;
        };
        let Some((_, light)) = self.index(&lights, at, "light", "lights") else { return };
        let span = self.span(&light);
        let color = self.numbers(&light, "color", [1.0; 3]);
        let strength = self.number(&light, "intensity", 1.0, (0.0, 1e12));
        let emitted = SpectrumValue::Rgb(color.map(|c| c.max(0.0) * strength), ColorSpace::Srgb);
        let forward = place.transform_vector3(DVec3::NEG_Z).normalize_or(DVec3::NEG_Z);
        let position = place.w_axis.truncate();
        if light.get("range").is_some() {
            self.approximated(&light, "'range' is ignored: light falls with the square of the distance");
        }
        let node = match light.text("type") {
            Some("point") => {
                Node::new(Family::Light, "point", span).with("intensity", emitted).with("position", position.to_array())
            }
            Some("directional") => Node::new(Family::Light, "distant", span)
                .with("radiance", emitted)
                .with("direction", forward.to_array()),
            Some("spot") => {
                let cone = light.get("spot").unwrap_or_else(|| light.clone());
                let outer = self.number(&cone, "outerConeAngle", std::f64::consts::FRAC_PI_4, (1e-3, 1.5707964));
                let inner = self.number(&cone, "innerConeAngle", 0.0, (0.0, 1.5707964)).min(outer);
                let up = if forward.y.abs() < 0.99 { DVec3::Y } else { DVec3::X };
                let right = forward.cross(up).normalize();
                let up = right.cross(forward);
                let matrix =
                    DMat4::from_cols(right.extend(0.0), up.extend(0.0), forward.extend(0.0), position.extend(1.0));
                Node::new(Family::Light, "spot", span)
                    .with("intensity", emitted)
                    .with("cone_angle", outer.to_degrees())
                    .with("falloff_start", inner.to_degrees())
                    .with("falloff", "quadratic")
                    .with("to_world", Transform { matrix })
            }
            other => {
                let message =
                    format!("'{}' is not a type of light; there are point, spot and directional", other.unwrap_or(""));
                self.error(&light, message);
                return;
            }
        };
        self.uses_lights = true;
        let desc = &mut self.import.desc;
        let id = desc.add(Node { name: light.label(), ..node });
        desc.lights.push(id);
    }
}
