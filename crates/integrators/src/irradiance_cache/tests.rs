use super::{
    hemisphere::{Hemisphere, Irradiance},
    records::{Record, Records},
};
use std::f32::consts::PI;
use steradian_math::{Frame, Spectrum, Vec2, Vec3};

/// A ball of radiance 1 and radius ρ at c over a plane has the irradiance `π ρ² c·n/|c|³`; the gradients are its
/// derivatives by the normal and by the place.
#[test]
fn gradients_are_those_of_a_ball() {
    let (center, radius) = (Vec3::new(0.8, -0.5, 1.5), 0.4_f32);
    let hemisphere = Hemisphere::new(200_000);
    let (light, distances): (Vec<_>, Vec<_>) = (0..hemisphere.cells())
        .map(|cell| {
            let w = hemisphere.direction(cell, Vec2::splat(0.5));
            let along = w.dot(center);
            let half = along * along - center.length_squared() + radius * radius;
            match along > 0.0 && half > 0.0 {
                true => (Spectrum::ONE, along - half.sqrt()),
                false => (Spectrum::ZERO, f32::INFINITY),
            }
        })
        .unzip();
    let found = hemisphere.irradiance(&Frame::from_z(Vec3::Z), &light, &distances);
    let d = center.length();
    let scale = PI * radius * radius / d.powi(3);
    assert!((found.value[0] / (scale * center.z) - 1.0).abs() < 0.005, "{}", found.value[0]);
    for axis in 0..2 {
        let by_normal = scale * center[axis];
        assert!((found.by_normal[axis][0] / by_normal - 1.0).abs() < 0.01, "{axis}: {:?}", found.by_normal);
        // The border that moves is nearer than the middle of the ball: √(d² − ρ²), and a little less.
        let by_place = 3.0 * scale * center.z * center[axis] / (d * d);
        assert!((found.by_place[axis][0] / by_place - 1.0).abs() < 0.1, "{axis}: {:?}, {by_place}", found.by_place);
    }
    assert!(found.by_place[2][0].abs() < 1e-6 && found.by_normal[2][0].abs() < 1e-6);
}

/// Between records of a field that is linear in place and normal the interpolation is exact; without gradients it is
/// not. Records do not count far off, behind an edge, or after other numbers of events.
#[test]
fn linear_fields_are_exact() {
    let slope = Vec3::new(0.5, -0.25, 0.125);
    let field = |p: Vec3| 3.0 + slope.dot(p);
    let filled = |gradients: bool| {
        let mut records = Records::new(0.5, 1);
        for k in 0..25 {
            let p = Vec3::new((k % 5) as f32 * 0.3, (k / 5) as f32 * 0.3, 0.0);
            let by_place = if gradients { slope.to_array() } else { [0.0; 3] }.map(Spectrum::splat);
            let irradiance = Irradiance { value: Spectrum::splat(field(p)), by_place, ..Irradiance::default() };
            records.insert(Record { p, n: Vec3::Z, radius: 1.0, least: 0.1, events: 2 }, &[irradiance]);
        }
        records
    };
    let at = |records: &Records, p: Vec3, events: u32| {
        records.at(p, Vec3::Z, events, |bands, place, normal| bands[0].at(place, normal))
    };
    let (exact, flat) = (filled(true), filled(false));
    assert_eq!(exact.len(), 25);
    let p = Vec3::new(0.37, 0.52, 0.0);
    let found = |records: &Records| at(records, p, 2).expect("covered")[0];
    assert!((found(&exact) - field(p)).abs() < 1e-5 && (found(&flat) - field(p)).abs() > 1e-4);
    assert!(at(&exact, p, 1).is_none() && at(&exact, Vec3::new(5.0, 0.0, 0.0), 2).is_none());
    // A step of the floor: records above it see what the point below does not.
    assert!(at(&exact, p + Vec3::Z * 0.2, 2).is_some() && at(&exact, p - Vec3::Z * 0.2, 2).is_none());
}
