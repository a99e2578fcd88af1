//! Decoding filters, which turn unpacked attributes into the values of accessors (appendix B). Inputs outside of the
//! valid ranges give some number of their type.

/// Four components, of one byte or two, as numbers and back; `step` gets and gives signed ones.
fn each_four(bytes: &mut [u8], stride: usize, step: impl Fn([i32; 4], f32) -> [i32; 4]) {
    if stride == 4 {
        for b in bytes.as_chunks_mut::<4>().0 {
            *b = step(b.map(|b| i32::from(b as i8)), 127.0).map(|v| v as u8);
        }
    } else {
        for b in bytes.as_chunks_mut::<8>().0 {
            let word = |k: usize| i32::from(i16::from_le_bytes([b[2 * k], b[2 * k + 1]]));
            let words = step(std::array::from_fn(word), 32767.0);
            *b = std::array::from_fn(|k| words[k / 2].to_le_bytes()[k % 2]);
        }
    }
}

/// Filter 1: unit vectors in octahedral encoding; the third component is what 1 is encoded as.
pub(super) fn octahedral(bytes: &mut [u8], stride: usize) {
    each_four(bytes, stride, |[x, y, one, last], most| {
        let (x, y) = (x as f32 / one as f32, y as f32 / one as f32);
        let z = 1.0 - x.abs() - y.abs();
        let fold = z.min(0.0);
        let v = [x - fold.copysign(x), y - fold.copysign(y), z];
        let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
        let [x, y, z] = v.map(|c| (c / length * most).round().clamp(-most, most) as i32);
        [x, y, z, last]
    });
}

/// Filter 2: unit quaternions without their largest component.
pub(super) fn quaternion(bytes: &mut [u8]) {
    each_four(bytes, 8, |[x, y, z, last], most| {
        let scale = std::f32::consts::FRAC_1_SQRT_2 / (last | 3) as f32;
        let small = [x, y, z].map(|v| v as f32 * scale);
        let w = (1.0 - small.iter().map(|v| v * v).sum::<f32>()).max(0.0).sqrt();
        let mut out = [0; 4];
        for (k, v) in [w, small[0], small[1], small[2]].into_iter().enumerate() {
            out[((last & 3) as usize + k) % 4] = (v * most).round().clamp(-most, most) as i32;
        }
        out
    });
}

/// Filter 3: floats as an exponent of 8 bits over a mantissa of 24.
pub(super) fn exponential(bytes: &mut [u8]) {
    for b in bytes.as_chunks_mut::<4>().0 {
        let word = i32::from_le_bytes(*b);
        let (exponent, mantissa) = (word >> 24, word << 8 >> 8);
        *b = ((f64::from(exponent).exp2() * f64::from(mantissa)) as f32).to_le_bytes();
    }
}

/// Filter 4: colours as luma, two differences, and alpha, whose highest bit tells how many bits there are.
pub(super) fn color(bytes: &mut [u8], stride: usize) {
    let sign = if stride == 4 { 0xff } else { 0xffff };
    each_four(bytes, stride, |[y, co, cg, alpha], _| {
        let (y, alpha) = (y & sign, alpha & sign);
        let all = (2 << alpha.checked_ilog2().unwrap_or(0)) - 1;
        let a = alpha & all >> 1;
        let scale = sign as f32 / all as f32;
        [y + co - cg, y + cg, y - co - cg, a << 1 | a & 1].map(|v| (v as f32 * scale).round() as i32 & sign)
    });
}
