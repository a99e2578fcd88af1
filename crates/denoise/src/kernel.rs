//! Kernels, and walks over the pixels beneath them.

/// The B₃ spline at −2, …, 2: the low-pass of the à-trous wavelet transform (Dammertz and others, "Edge-Avoiding
/// À-Trous Wavelet Transform for fast Global Illumination Filtering", HPG 2010, section 2).
pub(crate) const B3_SPLINE: [f32; 5] = [1.0 / 16.0, 1.0 / 4.0, 3.0 / 8.0, 1.0 / 4.0, 1.0 / 16.0];

/// The Gaussian [1 2 1]/4.
pub(crate) const GAUSSIAN: [f32; 3] = [0.25, 0.5, 0.25];

/// A pixel beneath a kernel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tap {
    pub x: u32,
    pub y: u32,
    /// From the middle of the kernel, in taps.
    pub offset: [i32; 2],
}

/// The pixels of a frame of `size` beneath a square kernel of 2 `radius` + 1 taps a side, `step` pixels apart, row by
/// row. The middle is among them.
pub(crate) fn taps([x, y]: [u32; 2], [width, height]: [u32; 2], radius: i32, step: i64) -> impl Iterator<Item = Tap> {
    let place = move |middle: u32, count: u32, offset: i32| {
        u32::try_from(i64::from(middle) + i64::from(offset) * step).ok().filter(|&at| at < count)
    };
    let column = move |i| place(x, width, i).map(|x| (i, x));
    let row = move |j| place(y, height, j).map(|y| (j, y));
    (-radius..=radius)
        .filter_map(row)
        .flat_map(move |(j, y)| (-radius..=radius).filter_map(column).map(move |(i, x)| Tap { x, y, offset: [i, j] }))
}
