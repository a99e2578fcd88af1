//! Cameras: UsdGeomCamera.

use super::{Reader, stage::Prim};
use glam::DQuat;
use steradian_math::{DMat4, Transform};
use steradian_scene::{Family, Node};

/// USD looks along −z, cameras here along +z.
const TURN: DMat4 = DMat4::from_cols_array_2d(&[
    [1.0, 0.0, 0.0, 0.0],
    [0.0, 1.0, 0.0, 0.0],
    [0.0, 0.0, -1.0, 0.0],
    [0.0, 0.0, 0.0, 1.0],
]);
/// Apertures and focal lengths are in tenths of the stage's units.
const TENTH: f64 = 0.1;

impl Reader<'_> {
    pub(super) fn camera(&mut self, prim: &Prim, place: DMat4) {
        let positive = (1e-6, 1e12);
        let width = self.number(prim, "horizontalAperture", 20.955, positive);
        let height = self.number(prim, "verticalAperture", 15.2908, positive);
        let focal = self.number(prim, "focalLength", 50.0, positive);
        let aspect = (width / height).clamp(0.05, 20.0);
        let span = self.stage.span(prim, None);
        let mut camera = match self.word(prim, "projection").as_deref() {
            Some("orthographic") => {
                let (x, y) = (0.5 * TENTH * width, 0.5 * TENTH * height);
                Node::new(Family::Camera, "orthographic", span).with("screen_window", vec![-x, x, -y, y])
            }
            _ => {
                let fov = 2.0 * (0.5 * width / focal).atan();
                Node::new(Family::Camera, "perspective", span).with("fov", fov.to_degrees()).with("fov_axis", "x")
            }
        };
        let shift = ["horizontalApertureOffset", "verticalApertureOffset"]
            .map(|name| self.number(prim, name, 0.0, (-1e9, 1e9)));
        if shift != [0.0; 2] {
            camera.set("principal_x", -shift[0] / width, None).set("principal_y", shift[1] / height, None);
        }
        let [near, far] = self.tuple(prim, "clippingRange", [1.0, 1e6]);
        if near < far && near >= 0.0 {
            camera.set("near", near, None).set("far", far, None);
        }
        let stop = self.number(prim, "fStop", 0.0, (0.0, 1e12));
        let focus = self.number(prim, "focusDistance", 0.0, (0.0, 1e30));
        if stop > 0.0 && focus > 0.0 {
            camera.set("lens_radius", 0.5 * TENTH * focal / stop, None).set("focal_distance", focus, None);
        }
        // A camera keeps its shape whatever the scale of its parents is.
        let (_, rotation, translation) = place.to_scale_rotation_translation();
        let rotation = if rotation.is_finite() { rotation.normalize() } else { DQuat::IDENTITY };
        let matrix = DMat4::from_rotation_translation(rotation, translation) * TURN;
        camera.set("to_world", Transform { matrix }, None);
        camera.name = Some(prim.name().to_owned());
        let desc = &mut self.stage.import.desc;
        let id = desc.add(camera);
        desc.cameras.push(id);
        if desc.film.is_none() {
            let width = (768.0 * aspect).round().max(1.0) as i64;
            let film = Node::new(Family::Film, "rgb", None).with("width", width).with("height", 768);
            desc.film = Some(desc.add(film));
        }
    }
}
