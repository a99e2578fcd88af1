//! Compiling height fields.

use super::Compiler;
use steradian_core::{relief::HeightField, shape::Field};
use steradian_math::{Vec2, transform::Affine};
use steradian_scene::Node;
use steradian_texture::{FloatTexture, TextureContext};

/// Most samples of a height field: 256 MiB of them.
pub(super) const MOST: i64 = 1 << 26;

/// Most samples of a height field that emits, which becomes triangles that are lights.
pub(super) const MOST_EMITTING: i64 = 1 << 20;

/// Samples along a side where a texture gives the heights and nothing says how many.
const SIDE: i64 = 256;

/// Heights of this magnitude and above are taken for faults: squares of their slopes would leave the range of numbers.
const TOO_HIGH: f32 = 1e15;

impl Compiler<'_> {
    /// The height field of a shape: heights that are listed, those of a texture over the unit square, or the first
    /// channel of a picture, whose texels are the samples, with v = 0 in its last row. `most` samples at most.
    pub(super) fn height_field(
        &mut self,
        node: &Node,
        place: &Affine,
        swaps: bool,
        reverse: bool,
        most: i64,
    ) -> Option<Field> {
        let span = |name: &str| node.param(name).and_then(|p| p.span).or(node.span);
        let (nu, nv) = (self.given_int(node, "nu"), self.given_int(node, "nv"));
        let scale = self.float(node, "scale");
        let smooth = self.bool(node, "smooth");
        let (width, height, data) = if node.get("file").is_some() {
            let texels = self.image(node)?;
            let (w, h, n) = (texels.width, texels.height, texels.channels);
            let rows = (0..h).rev().flat_map(|y| (0..w).map(move |x| (y * w + x) * n));
            if (w as i64).saturating_mul(h as i64) > most {
                self.error(span("file"), format!("a height field of {w} × {h} samples is too large"));
                return None;
            }
            (w as i64, h as i64, rows.map(|i| texels.data.stored(i)).collect())
        } else if node.floats("heights").is_some() {
            let Some((nu, nv)) = nu.zip(nv) else {
                self.error(node.span, "a height field needs 'nu' and 'nv', the numbers of its samples along u and v");
                return None;
            };
            (nu, nv, self.list(node, "heights")?)
        } else if node.get("heights").is_some() {
            let texture = self.float_texture_or(node, "heights", 0.0);
            let side = if matches!(texture, FloatTexture::Constant(_)) { 2 } else { SIDE };
            let (nu, nv) = (nu.unwrap_or(side), nv.unwrap_or(side));
            if nu < 2 || nv < 2 || nu.saturating_mul(nv) > most {
                self.error(node.span, format!("a height field cannot have {nu} × {nv} samples"));
                return None;
            }
            let height = |i: i64, j: i64| {
                let uv = Vec2::new(i as f32 / (nu - 1) as f32, j as f32 / (nv - 1) as f32);
                texture.eval(&self.textures, &TextureContext::new(place.point(uv.extend(0.0)), uv))
            };
            (
                nu,
                nv,
                (0..nv).flat_map(|j| (0..nu).map(move |i| (i, j))).map(|(i, j)| height(i, j)).collect::<Vec<f32>>(),
            )
        } else {
            self.error(node.span, "a height field needs 'heights' or a 'file'");
            return None;
        };
        let count = data.len();
        let mut faults = 0;
        let sound = |h: f32| {
            let h = h * scale;
            let is_sound = h.abs() < TOO_HIGH;
            faults += usize::from(!is_sound);
            if is_sound { h } else { 0.0 }
        };
        let data: Vec<f32> = data.into_iter().map(sound).collect();
        if faults > 0 {
            let what = format!("{faults} heights are NaN or too large; they count as zero");
            self.diagnostics.warn(&self.desc.sources, span("heights"), what);
        }
        let sizes = usize::try_from(width).ok().zip(usize::try_from(height).ok());
        let Some(relief) = sizes.and_then(|(w, h)| HeightField::new(w, h, data)) else {
            let what = format!("{count} heights are no field of {width} × {height} samples, at least two each way");
            self.error(span("heights"), what);
            return None;
        };
        // As of a mesh, normals that are given keep to their side.
        Some(Field { relief, place: *place, flip: reverse ^ (swaps && !smooth), smooth })
    }
}

#[cfg(test)]
mod tests {
    use crate::{Options, compile};
    use steradian_core::Scene;
    use steradian_math::{DVec3, Ray, Transform, Vec3};
    use steradian_scene::{Family, Group, Instance, Node, SceneDesc, Shape};

    /// A scene with a height field of these parameters, and what was said about it.
    fn scene(set: impl Fn(&mut SceneDesc, Node) -> Node, emits: bool, instanced: bool) -> (Option<Scene>, Vec<String>) {
        let mut desc = SceneDesc::default();
        let node = set(&mut desc, Node::new(Family::Shape, "height_field", None));
        let node = desc.add(node);
        let emission = emits.then(|| desc.add(Node::new(Family::Light, "area", None).with("radiance", 1.0)));
        let shape = Shape { emission, ..Shape::new(node) };
        if instanced {
            desc.groups.push(Group { name: "field".into(), shapes: vec![shape] });
            let world_from_group = Transform::translate(DVec3::new(0.0, 0.0, 0.25));
            desc.instances.push(Instance::new(0, world_from_group));
        } else {
            desc.shapes.push(shape);
        }
        let camera = desc.add(Node::new(Family::Camera, "perspective", None));
        let light = desc.add(Node::new(Family::Light, "point", None));
        desc.cameras.push(camera);
        desc.lights.push(light);
        let compiled = compile(&desc, &Options::default());
        let said = compiled.diagnostics.iter().map(|d| d.message.clone()).collect();
        (compiled.scene, said)
    }

    fn height(scene: &Scene, x: f32, y: f32) -> Option<f32> {
        let ray = Ray::new(Vec3::new(x, y, 9.0), -Vec3::Z);
        scene.intersect(&ray).map(|hit| scene.interaction(&ray, &hit).surface.p.z)
    }

    const LIST: [f64; 6] = [0.0, 1.0, 2.0, 0.0, 1.0, 4.0];

    fn listed(_: &mut SceneDesc, node: Node) -> Node {
        node.with("heights", LIST.to_vec()).with("nu", 3i64).with("nv", 2i64).with("scale", 0.5)
    }

    #[test]
    fn heights_are_listed_or_a_texture() {
        let gradient = |desc: &mut SceneDesc, node: Node| {
            let gradient = desc.add(Node::new(Family::Texture, "gradient", None).with("scale_u", 0.5));
            node.with("heights", gradient).with("nu", 5i64).with("nv", 3i64).with("scale", 4.0)
        };
        let check = |set: &dyn Fn(&mut SceneDesc, Node) -> Node, heights: [f32; 3]| {
            for (emits, instanced) in [(false, false), (false, true), (true, false)] {
                let (scene, said) = scene(set, emits, instanced);
                assert!(said.is_empty(), "{said:?}");
                let scene = scene.unwrap();
                let seen = [(0.25, 0.5), (0.75, 0.0), (0.98, 1.0)].map(|(x, y)| height(&scene, x, y).unwrap());
                for (seen, height) in seen.iter().zip(heights) {
                    let height = if instanced { height + 0.25 } else { height };
                    assert!((seen - height).abs() < 1e-5, "{seen} {height}");
                }
                assert_eq!(height(&scene, 1.1, 0.5), None);
                assert_eq!(scene.lights().lights.len() > 1, emits);
            }
        };
        check(&listed, [0.25, 0.75, 1.94]);
        check(&gradient, [0.5, 1.5, 1.96]);
    }

    #[test]
    fn faults_are_told() {
        let said = |set: &dyn Fn(Node) -> Node| scene(|_, node| set(node), false, false).1.join("; ");
        assert!(said(&|n| n).contains("needs 'heights' or a 'file'"));
        assert!(said(&|n| n.with("heights", LIST.to_vec())).contains("needs 'nu' and 'nv'"));
        let of = |nu: i64, nv: i64| said(&|n| n.with("heights", LIST.to_vec()).with("nu", nu).with("nv", nv));
        assert!(of(2, 2).contains("6 heights are no field of 2 × 2 samples"));
        assert!(of(6, 1).contains("at least two each way") && of(-3, -2).contains("no field"));
        let large = LIST.map(|v| v * 5e37).to_vec();
        assert!(
            said(&|n| n.with("heights", large.clone()).with("nu", 3i64).with("nv", 2i64).with("scale", 10.0))
                .contains("4 heights are NaN or too large; they count as zero")
        );
        let many = |desc: &mut SceneDesc, node: Node| {
            let gradient = desc.add(Node::new(Family::Texture, "gradient", None));
            node.with("heights", gradient).with("nu", 1i64 << 40).with("nv", 1i64 << 40)
        };
        assert!(scene(many, false, false).1.join("; ").contains("cannot have"));
    }
}
