//! Kernels of filters, the same along both axes.

/// The B₃ spline at −2, …, 2: the low-pass of the à-trous wavelet transform (Dammertz and others, "Edge-Avoiding
/// À-Trous Wavelet Transform for fast Global Illumination Filtering", HPG 2010, section 2).
pub(crate) const B3_SPLINE: [f32; 5] = [1.0 / 16.0, 1.0 / 4.0, 3.0 / 8.0, 1.0 / 4.0, 1.0 / 16.0];

/// The Gaussian [1 2 1]/4.
pub(crate) const GAUSSIAN: [f32; 3] = [0.25, 0.5, 0.25];
