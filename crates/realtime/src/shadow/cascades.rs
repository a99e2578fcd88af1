//! Several maps of parallel light, one behind the other along the view (Zhang, Sun, Xu, Lun 2006, "Parallel-Split
//! Shadow Maps").
//!
//! Each is a square around the sphere of its part of the view, so that its size does not change when the eye turns, and
//! moves by whole texels (Valient 2008, "Stable Rendering of Cascaded Shadow Maps"): shadows do not swim.

use steradian_core::Scene;
use steradian_math::{Vec2, Vec3};

use super::{Eye, map::Map, parallel_axes};
use crate::{Error, draw_list::DrawList, options::Options, projection::Projected};

/// Weight of logarithmic splits against even ones.
const LOGARITHMIC: f32 = 0.7;
/// The last split over the nearest.
const RANGE: f32 = 200.0;

/// Distances along the view where parts begin and end.
fn splits(far: f32, count: u32) -> Vec<f32> {
    let near = far / RANGE;
    let split = |i: u32| {
        let share = i as f32 / count as f32;
        if i == 0 {
            return 0.0;
        }
        // The practical split scheme (Zhang et al. 2006): logarithmic splits give all parts the same aliasing,
        // even ones keep the nearest part from being too short.
        LOGARITHMIC * near * RANGE.powf(share) + (1.0 - LOGARITHMIC) * (near + (far - near) * share)
    };
    (0..=count).map(split).collect()
}

/// Centre along the axis and radius of the sphere around the part of a view between two distances, whose corners are
/// `spread` from the axis: for each unit of distance, for perspective.
fn sphere([a, b]: [f32; 2], spread: f32, perspective: bool) -> (f32, f32) {
    if !perspective {
        return ((a + b) / 2.0, Vec2::new((b - a) / 2.0, spread).length());
    }
    // The centre has the same distance from near and far corners: (a − c)² + s²a² = (b − c)² + s²b².
    let center = ((a + b) * (1.0 + spread * spread) / 2.0).min(b);
    (center, Vec2::new(b - center, spread * b).length())
}

/// The views of parallel light from `wi`, from the nearest part on.
pub fn views(scene: &Scene, options: &Options, projected: &Projected, wi: Vec3) -> Vec<Projected> {
    let (center, radius) = crate::extent(scene);
    let axes = parallel_axes(wi);
    let [right, up, forward] = axes;
    let (size, unit) = (options.size as f32, projected.eye().1.length());
    let far = projected.local(center).z + radius / unit;
    // In steps, so that small movements leave the splits where they are.
    let far = 2f32.powf((2.0 * far.max(1e-6 * radius / unit).log2()).ceil() / 2.0);
    let window = projected.window();
    let spread = Vec2::new(window[0].abs().max(window[1].abs()), window[2].abs().max(window[3].abs())).length();
    let view = |part: &[f32]| {
        let (along, of_part) = sphere([part[0], part[1]], spread, projected.is_perspective());
        // Filters at the border stay inside.
        let whole = 1.01 * radius;
        let half = (of_part * unit * size / (size - 2.0 * (options.pcf as f32 + 2.0)).max(size / 2.0)).min(whole);
        let middle = if half < whole { projected.world(Vec3::new(0.0, 0.0, along)) } else { center };
        // Across the light, the view moves in steps of a texel; along the light, the range of depths is that of the
        // whole scene, so that casters outside the part are drawn too.
        let texel = 2.0 * half / size;
        let snap = |axis: Vec3| (middle.dot(axis) / texel).round() * texel;
        let place = right * snap(right) + up * snap(up) + forward * (center.dot(forward) - whole);
        Projected::of_light(place, axes, half, false, [0.0, 2.0 * whole], options.size)
    };
    splits(far, options.cascades).windows(2).map(view).collect()
}

/// The maps.
pub fn maps(scene: &Scene, list: &DrawList, options: &Options, eye: &Eye, wi: Vec3) -> Result<Vec<Map>, Error> {
    let views = views(scene, options, eye.projected, wi);
    views.into_iter().map(|view| Map::new(scene, list, view, options.size)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_scene::{Family, Node, SceneDesc};

    /// The sphere of a part holds its corners, and parts follow one another without a gap (M233).
    #[test]
    fn spheres_hold_their_parts() {
        let splits = splits(10.0, 4);
        assert!(splits[0] == 0.0 && (splits[4] - 10.0).abs() < 1e-5 && splits.is_sorted());
        for part in splits.windows(2) {
            for (perspective, spread) in [(true, 0.3), (true, 2.0), (false, 5.0)] {
                let (center, radius) = sphere([part[0], part[1]], spread, perspective);
                for z in part {
                    let corner = if perspective { spread * z } else { spread };
                    assert!(Vec2::new(z - center, corner).length() <= radius * 1.00001, "{part:?} {spread}");
                }
            }
        }
    }

    /// When the eye moves and turns, maps keep their size and move by whole texels.
    #[test]
    fn maps_move_by_whole_texels() {
        let mut description = SceneDesc::default();
        let camera = description.add(Node::new(Family::Camera, "perspective", None));
        description.cameras.push(camera);
        let scene = steradian_compile::compile(&description, &Default::default()).scene.unwrap();
        let options = Options { size: 256, ..Options::default() };
        let wi = Vec3::new(0.3, -0.5, 0.8).normalize();
        let eye = |place: Vec3, turn: f32| {
            let forward = Vec3::new(turn.cos(), turn.sin(), 0.0);
            let axes = [forward.cross(Vec3::Z), Vec3::Z, forward];
            views(&scene, &options, &Projected::of_light(place, axes, 0.4, true, [0.01, 5.0], 64), wi)
        };
        let first = eye(Vec3::ZERO, 0.0);
        let other = eye(Vec3::new(0.013, -0.021, 0.007), 0.1);
        let mut moved = 0;
        for (a, b) in first.iter().zip(&other) {
            assert_eq!(a.half(), b.half());
            for p in [Vec3::new(0.1, 0.2, 0.3), Vec3::new(-0.4, 0.1, 0.0)] {
                let shift = (a.clip(p) - b.clip(p)).truncate().truncate() * 128.0;
                assert!((shift - shift.round()).abs().max_element() < 0.02, "{shift}");
                moved += u32::from(shift.round() != Vec2::ZERO);
            }
        }
        assert!(moved > 0);
    }
}
