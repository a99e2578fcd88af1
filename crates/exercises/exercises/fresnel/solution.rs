//! Reflectance of glass; the task is in README.md.

/// The part of unpolarised light that is reflected; `eta` is n_t/n_i.
#[allow(unused_variables)]
pub fn reflectance(cos_i: f64, eta: f64) -> f64 {
    // gap
    let sin2_t = (1.0 - cos_i * cos_i) / (eta * eta);
    if sin2_t >= 1.0 {
        return 1.0;
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    let r_s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    let r_p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    (r_s * r_s + r_p * r_p) / 2.0
    // end
}
