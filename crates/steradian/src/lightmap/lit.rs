//! A scene that shows its lightmap without lights.
//!
//! Surfaces are black and emit, by a picture over the atlas, the radiance that a diffuse surface of their albedo sends
//! back: L = ρ E/π. The picture holds L over its largest value, and the emission scales it by that value, so that
//! files whose pictures end at one keep the scale.

use super::{Lightmap, Part};
use crate::{Error, unwrap};
use std::{f32::consts::PI, path::PathBuf};
use steradian_image::{FileKind, Image, WriteOptions, encode};
use steradian_scene::{ColorSpace, Family, Mesh, Node, SceneDesc, SpectrumValue};

impl Lightmap {
    /// Radiance that surfaces send back of one of the parts, which is `kind`; [`Part::Ao`] is taken as that of a sky of
    /// radiance 1. Neither negative nor NaN.
    pub fn reflected(&self, part: usize, kind: Part) -> Vec<[f32; 3]> {
        let scale = if kind == Part::Ao { 1.0 } else { PI.recip() };
        let texels = self.parts[part].iter().zip(&self.albedo);
        texels.map(|(light, albedo)| [0, 1, 2].map(|k| (light[k] * albedo[k] * scale).max(0.0))).collect()
    }
}

/// A scene that was [laid out](super::laid_out), lit by `radiance`, a picture of `side` rows over its atlas: lights are
/// gone, and meshes that emit keep their emission in place of the picture's. Values are held by 16 bits, encoded as
/// sRGB: to 1.2·10⁻⁶ of the largest near black, and to 2·10⁻⁴ of themselves above a hundredth of it.
///
/// # Errors
/// [`Error::Failed`] where the picture cannot be encoded.
pub fn lit(desc: &SceneDesc, radiance: &[[f32; 3]], side: usize) -> Result<SceneDesc, Error> {
    let largest = radiance.iter().flatten().copied().filter(|v| v.is_finite()).fold(0.0, f32::max);
    let strength = if largest > 0.0 { largest } else { 1.0 };
    let shown: Vec<[f32; 3]> = radiance.iter().map(|texel| texel.map(|v| v / strength)).collect();
    let options = WriteOptions { sixteen_bit: true, ..WriteOptions::default() };
    let encoded = Image::from_rgb(side, side, &shown).and_then(|image| encode(FileKind::Png, &image, &options));
    let mut desc = desc.clone();
    let name = desc.path.as_ref().map(|path| path.display().to_string()).unwrap_or_default();
    let file = PathBuf::from(format!("{name}#lightmap.png"));
    desc.embedded.insert(file.clone(), encoded.map_err(|e| Error::Failed(e.to_string()))?.into());
    let picture = Node::new(Family::Texture, "image", None)
        .with("file", file)
        .with("origin", "top")
        .with("encoding", "srgb")
        .with("wrap_u", "clamp")
        .with("wrap_v", "clamp")
        .with("uv_set", unwrap::SECOND);
    let picture = desc.add(picture);
    let scaled = Node::new(Family::Texture, "scale", None).with("texture", picture).with("scale", f64::from(strength));
    let scaled = desc.add(scaled);
    let light = desc.add(Node::new(Family::Light, "area", None).with("radiance", scaled));
    let black = SpectrumValue::Rgb([0.0; 3], ColorSpace::Srgb);
    let black = desc.add(Node::new(Family::Material, "diffuse", None).with("reflectance", black));
    for k in 0..desc.shapes.len() {
        let shape = &desc.shapes[k];
        let separates = shape.material.is_some_and(|material| desc.node(material).kind == "interface");
        let Some(mesh) = shape.mesh.filter(|_| !separates) else { continue };
        if desc.meshes[mesh].uvs.is_empty() {
            let with_first = with_first_set(&desc.meshes[mesh]);
            desc.meshes[mesh] = with_first.into();
        }
        let shape = &mut desc.shapes[k];
        shape.material = Some(black);
        shape.emission = shape.emission.or(Some(light));
        (shape.interior, shape.exterior) = (None, None);
    }
    desc.lights.clear();
    // Emission is to be seen; nothing is to be scattered.
    desc.integrator = None;
    Ok(desc)
}

/// A mesh with the coordinates of the atlas as its first set too, which glTF asks for where there is a second.
fn with_first_set(mesh: &Mesh) -> Mesh {
    let mut mesh = mesh.clone();
    if let Some(second) = mesh.attributes.iter().find(|a| a.name == unwrap::SECOND) {
        mesh.uvs = second.data.as_chunks::<2>().0.to_vec();
    }
    mesh
}
