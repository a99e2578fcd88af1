//! Russian roulette; the task is in README.md.
#![allow(unused_variables)]

/// The throughput with which a path goes on, or 0 if it ends.
pub fn survive(beta: f64, u: f64) -> f64 {
    // gap
    let s = beta.min(1.0);
    if u < s { beta / s } else { 0.0 }
    // end
}

/// The radiance in a closed room, estimated by one path.
pub fn radiance(emission: f64, albedo: f64, u: [f64; 20]) -> f64 {
    // gap
    // β is multiplied by albedo/s = 1.
    let bounces = u.iter().take_while(|u| **u < albedo).count();
    emission * (1 + bounces) as f64
    // end
}
