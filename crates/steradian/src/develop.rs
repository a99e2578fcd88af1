//! Development of a film to a picture that is named after its scene.

use crate::{Film, Layer, Scene};
use std::collections::BTreeMap;
use steradian_core::camera::Projection;
use steradian_film::Names;
use steradian_image::{Image, Value};
use steradian_math::DMat4;
use steradian_schema::material::MATERIALS;

/// The picture: linear Rec.709 in `R G B`, premultiplied by [`Layer::ALPHA`] where the background was left out, and the
/// layers asked for, with those of the scene's film. Layers of first hits need a film on which they were gathered.
/// Where the scene's film has a sensor, the picture has its noise; the layers do not.
pub fn develop(scene: &Scene, film: &Film, layers: &[Layer]) -> Image {
    let names = Names {
        objects: scene.object_names().clone(),
        materials: material_names(scene.material_names()),
        light_groups: scene.light_groups().names.clone(),
        origin: scene.origin().to_array(),
    };
    let mut image = steradian_film::develop(film, &scene.film().with_layers(layers), &names);
    let world_from_camera = scene.camera().world_from_camera;
    let crop = film.crop;
    if let Some(sensor) = scene.film().sensor {
        sensor.expose(&mut image, [crop.x0, crop.y0].map(|v| v as i32));
    }
    // Where a value is not a radiance that arrives at the camera, white has no luminance.
    if !matches!(scene.camera().projection, Projection::Patch(..) | Projection::Realistic(_)) {
        let white = scene.film().unit_luminance / f64::from(scene.film().imaging_ratio);
        image.metadata.set("whiteLuminance", Value::Float(white as f32));
    }
    let camera_from_world = world_from_camera.inv.as_dmat4() * DMat4::from_translation(-scene.origin());
    image.metadata.set("worldToCamera", Value::Matrix(camera_from_world.as_mat4().to_cols_array()));
    image
}

/// The names of materials by their numbers from one. Those that a file gave no name are called after their kind, and
/// numbered.
fn material_names(names: &[String]) -> BTreeMap<u32, String> {
    let mut met: BTreeMap<&str, u32> = BTreeMap::new();
    let mut distinct = BTreeMap::new();
    for (number, name) in (1..).zip(names) {
        let count = met.entry(name.as_str()).or_default();
        *count += 1;
        let is_kind = MATERIALS.iter().any(|m| m.kind == name);
        distinct.insert(number, if is_kind && *count > 1 { format!("{name}_{count}") } else { name.clone() });
    }
    distinct
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unnamed_materials_are_told_apart() {
        let names = ["default", "diffuse", "Paint", "diffuse", "Paint"].map(String::from);
        let found: Vec<String> = material_names(&names).into_values().collect();
        assert_eq!(found, ["default", "diffuse", "Paint", "diffuse_2", "Paint"]);
    }
}
