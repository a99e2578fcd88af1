//! Kernels, and walks over the pixels beneath them.

/// The B₃ spline at −2, …, 2: the low-pass of the à-trous wavelet transform (Dammertz and others, "Edge-Avoiding
/// À-Trous Wavelet Transform for fast Global Illumination Filtering", HPG 2010, section 2).
pub(crate) const B3_SPLINE: [f32; 5] = [1.0 / 16.0, 1.0 / 4.0, 3.0 / 8.0, 1.0 / 4.0, 1.0 / 16.0];

/// The Gaussian [1 2 1]/4.
pub(crate) const GAUSSIAN: [f32; 3] = [0.25, 0.5, 0.25];

/// A pixel beneath a kernel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tap {
    /// Its place among the values of an image.
    pub place: usize,
    /// Pixels from the middle of the kernel.
    pub offset: [i64; 2],
    /// The kernel's weight.
    pub weight: f32,
}

/// Visits the pixels of a frame of `size` beneath a kernel that is the same along both axes, its taps `step` pixels
/// apart, row by row. The middle is among them.
#[inline(always)]
pub(crate) fn visit<const N: usize>(
    kernel: &[f32; N],
    [x, y]: [u32; 2],
    [width, height]: [u32; 2],
    step: i64,
    mut visit: impl FnMut(Tap),
) {
    let offset = |tap: usize| (tap as i64 - N as i64 / 2) * step;
    let place = |middle: u32, count: u32, tap: usize| {
        usize::try_from(i64::from(middle) + offset(tap)).ok().filter(|&place| place < count as usize)
    };
    let columns: [Option<usize>; N] = std::array::from_fn(|tap| place(x, width, tap));
    for j in 0..N {
        let Some(row) = place(y, height, j) else { continue };
        for i in 0..N {
            let Some(column) = columns[i] else { continue };
            let (place, offset) = (row * width as usize + column, [offset(i), offset(j)]);
            visit(Tap { place, offset, weight: kernel[i] * kernel[j] });
        }
    }
}
