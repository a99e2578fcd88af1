//! The sky over a model without light of its own: a picture with a sun, made when the model is read.

/// Columns of the picture; it has half as many rows.
const COLUMNS: usize = 512;
/// Direction to the sun, not of unit length: over the left shoulder of the camera.
pub(super) const SUN: [f64; 3] = [-0.45, 0.85, 0.65];
/// Angles from the centre of the sun, in degrees, within which it has full radiance and beyond which it has none. It is
/// wider than the real one, so that shadows are soft.
const SUN_RADII: [f32; 2] = [3.0, 6.0];
/// Irradiance of the sun on a surface that faces it, and radiance of the sky at the zenith, at the horizon and below
/// it.
const SUN_IRRADIANCE: [f32; 3] = [2.7, 2.5, 2.2];
const ZENITH: [f32; 3] = [0.3, 0.37, 0.5];
const HORIZON: [f32; 3] = [0.58, 0.61, 0.64];
const BELOW: [f32; 3] = [0.32, 0.32, 0.32];

/// The sky as a PFM file (latitude and longitude, +y up, radiance in linear Rec.709).
pub(super) fn pfm() -> Vec<u8> {
    let rows = COLUMNS / 2;
    let sun = SUN.map(|x| x as f32);
    let length = sun.map(|x| x * x).iter().sum::<f32>().sqrt();
    let [inner, outer] = SUN_RADII.map(f32::to_radians);
    let mut texels = vec![[0.0_f32; 3]; COLUMNS * rows];
    let mut share_of_sun = vec![0.0_f32; texels.len()];
    let mut total = 0.0_f64;
    for row in 0..rows {
        let (sin, cos) = (std::f32::consts::PI * (row as f32 + 0.5) / rows as f32).sin_cos();
        let radiance: [f32; 3] = if cos < 0.0 {
            BELOW
        } else {
            // Most of the change is near the horizon.
            let height = cos.sqrt();
            std::array::from_fn(|c| HORIZON[c] + (ZENITH[c] - HORIZON[c]) * height)
        };
        for column in 0..COLUMNS {
            let (sin_phi, cos_phi) = (std::f32::consts::TAU * (column as f32 + 0.5) / COLUMNS as f32).sin_cos();
            let direction = [sin * sin_phi, cos, -sin * cos_phi];
            let cos_sun = direction.iter().zip(sun).map(|(d, s)| d * s / length).sum::<f32>();
            let x = ((outer - cos_sun.clamp(-1.0, 1.0).acos()) / (outer - inner)).clamp(0.0, 1.0);
            let i = row * COLUMNS + column;
            share_of_sun[i] = x * x * (3.0 - 2.0 * x);
            total += f64::from(share_of_sun[i] * sin);
            texels[i] = radiance;
        }
    }
    // A texel of the row at θ has the solid angle 2π² sinθ / (columns · rows).
    let solid_angle = total * 2.0 * std::f64::consts::PI.powi(2) / texels.len() as f64;
    let mut bytes = format!("PF\n{COLUMNS} {rows}\n-1.0\n").into_bytes();
    // PFM begins with the last row.
    for row in (0..rows).rev() {
        for i in row * COLUMNS..(row + 1) * COLUMNS {
            for c in 0..3 {
                let sun = share_of_sun[i] * (f64::from(SUN_IRRADIANCE[c]) / solid_angle) as f32;
                bytes.extend((texels[i][c] + sun).to_le_bytes());
            }
        }
    }
    bytes
}

/// Irradiance on a surface that faces up: of the sun, and of a sky whose radiance goes with the root of the height.
pub(super) fn irradiance() -> [f64; 3] {
    let [x, y, z] = SUN;
    let cos_sun = y / (x * x + y * y + z * z).sqrt();
    std::array::from_fn(|c| {
        // The mean of the root of the cosine, weighted by the cosine, is 4/5.
        let [zenith, horizon] = [ZENITH[c], HORIZON[c]].map(f64::from);
        f64::from(SUN_IRRADIANCE[c]) * cos_sun + std::f64::consts::PI * (horizon + (zenith - horizon) * 0.8)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The irradiance of a plane that faces the sun is that of the sun and of half a sky.
    #[test]
    fn the_sun_has_its_irradiance() {
        let bytes = pfm();
        let rows = COLUMNS / 2;
        let data = &bytes[bytes.len() - COLUMNS * rows * 12..];
        let red = |row: usize, column: usize| {
            let at = ((rows - 1 - row) * COLUMNS + column) * 12;
            f64::from(f32::from_le_bytes([data[at], data[at + 1], data[at + 2], data[at + 3]]))
        };
        let mut sun = 0.0;
        for row in 0..rows / 2 {
            let sin = (std::f64::consts::PI * (row as f64 + 0.5) / rows as f64).sin();
            let sky = f64::from(HORIZON[0].max(ZENITH[0]));
            for column in 0..COLUMNS {
                sun += (red(row, column) - sky).max(0.0) * sin;
            }
        }
        sun *= 2.0 * std::f64::consts::PI.powi(2) / (COLUMNS * rows) as f64;
        assert!((sun / f64::from(SUN_IRRADIANCE[0]) - 1.0).abs() < 0.01, "{sun}");
        assert_eq!(red(rows - 1, 0), f64::from(BELOW[0]));
    }
}
