//! Sample positions in a pixel: the standard patterns of Vulkan and Direct3D, in sixteenths of a pixel.

/// The samples of a pixel, in 1/16 pixel from its top left corner.
const ONE: [[u8; 2]; 1] = [[8, 8]];
const TWO: [[u8; 2]; 2] = [[12, 12], [4, 4]];
const FOUR: [[u8; 2]; 4] = [[6, 2], [14, 6], [2, 10], [10, 14]];
const EIGHT: [[u8; 2]; 8] = [[9, 5], [7, 11], [13, 9], [5, 3], [3, 13], [1, 7], [11, 15], [15, 1]];
const SIXTEEN: [[u8; 2]; 16] = [
    [9, 9],
    [7, 5],
    [5, 10],
    [12, 7],
    [3, 6],
    [10, 13],
    [13, 11],
    [11, 3],
    [6, 14],
    [8, 1],
    [4, 2],
    [2, 12],
    [0, 8],
    [15, 4],
    [14, 15],
    [1, 0],
];

/// Sub-pixel units of a pixel: positions are rounded to 1/256 pixel.
pub(crate) const SUBPIXELS: i32 = 256;

/// The sample counts that there are.
pub const SAMPLE_COUNTS: [u32; 5] = [1, 2, 4, 8, 16];

/// The positions of the samples in 1/16 pixel; the centre for counts that there are not.
fn pattern(count: u32) -> &'static [[u8; 2]] {
    match count {
        2 => &TWO,
        4 => &FOUR,
        8 => &EIGHT,
        16 => &SIXTEEN,
        _ => &ONE,
    }
}

/// The position of one sample within its pixel, each coordinate in [0, 1), from the top left.
pub fn sample_position(count: u32, sample: u32) -> [f32; 2] {
    pattern(count).get(sample as usize).map_or([0.5; 2], |p| [f32::from(p[0]) / 16.0, f32::from(p[1]) / 16.0])
}

/// The samples of a pixel in sub-pixel units, and the box that holds them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pattern {
    pub offsets: [[i32; 2]; 16],
    pub count: usize,
    pub min: [i32; 2],
    pub max: [i32; 2],
}

impl Pattern {
    pub fn new(count: u32) -> Self {
        let places = pattern(count);
        let mut offsets = [[SUBPIXELS / 2; 2]; 16];
        let (mut min, mut max) = ([SUBPIXELS; 2], [0; 2]);
        for (offset, place) in offsets.iter_mut().zip(places) {
            for axis in 0..2 {
                offset[axis] = i32::from(place[axis]) * (SUBPIXELS / 16);
                min[axis] = min[axis].min(offset[axis]);
                max[axis] = max[axis].max(offset[axis]);
            }
        }
        Self { offsets, count: places.len(), min, max }
    }

    /// The centre of a pixel.
    pub const fn centre() -> [i32; 2] {
        [SUBPIXELS / 2; 2]
    }
}
