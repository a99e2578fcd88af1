use super::*;
use crate::color::lab::delta_e;
use crate::spectra::cie::to_xyz;
use glam::DVec3;

/// XYZ of a reflectance under the white of its space.
fn seen(s: RgbSigmoid, white: &Dense) -> DVec3 {
    to_xyz(|l| s.eval(l) * white.eval(l))
}

fn error(space: &RgbSpace, rgb: Vec3) -> f64 {
    let white = if *space == ACES2065_1 { aces_d60() } else { d65() };
    delta_e(seen(RgbSigmoid::new(space, rgb), white), space.xyz_from_rgb() * rgb.as_dvec3(), space.white())
}

#[test]
fn colours_come_back_on_a_grid_of_the_whole_cube() {
    let n = 8;
    let mut worst = (0.0, Vec3::ZERO);
    for i in 0..n * n * n {
        let rgb = Vec3::new((i % n) as f32, (i / n % n) as f32, (i / n / n) as f32) / (n - 1) as f32;
        let e = error(&REC709, rgb);
        if e > worst.0 {
            worst = (e, rgb);
        }
    }
    assert!(worst.0 < 1.0, "ΔE {} at {}", worst.0, worst.1);
}
