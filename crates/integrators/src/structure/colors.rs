//! Colours of numbers, linear Rec.709.

use steradian_math::{Vec3, hash::HashRng};

/// Scale of costs: black at 0, blue at ¼, green at ½, yellow at ¾, red from 1 on, linear between them.
pub fn heat(x: f32) -> Vec3 {
    const STOPS: [Vec3; 5] = [Vec3::ZERO, Vec3::Z, Vec3::Y, Vec3::new(1.0, 1.0, 0.0), Vec3::X];
    let x = x.clamp(0.0, 1.0) * 4.0;
    let i = (x as usize).min(3);
    STOPS[i].lerp(STOPS[i + 1], x - i as f32)
}

/// A colour for a number among those of an instance; neighbours differ.
pub fn number(instance: u32, number: u32) -> Vec3 {
    let mut rng = HashRng::new(u64::from(instance) << 32 | u64::from(number));
    // A saturated hue, so that shading does not take one colour for another.
    let hue = rng.next_f32() * 6.0;
    let channel = |shift: f32| ((hue + shift) % 6.0 - 3.0).abs().clamp(1.0, 2.0) - 1.0;
    Vec3::new(channel(0.0), channel(4.0), channel(2.0)).lerp(Vec3::ONE, 0.1 + 0.5 * rng.next_f32())
}
