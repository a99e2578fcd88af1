//! Pictures of cube maps as six faces below each other.

use steradian_image::{TexelData, Texels};

/// Column and row in a wide cross of the faces +x, −x, +y, −y, +z, −z.
const CROSS: [[usize; 2]; 6] = [[2, 1], [0, 1], [1, 0], [1, 2], [1, 1], [3, 1]];

/// The faces of a picture below each other; pictures that are none are left as they are. In a cross of three by four
/// the lowest face, −z, is turned by half a turn.
pub fn strip(texels: Texels) -> Texels {
    let (w, h) = (texels.width, texels.height);
    // A row of six, or a cross whose faces are square. Crosses have the proportions of photographs: these are so only
    // where all that lies beside the faces is of one colour.
    if w == 6 * h {
        return collect(&texels, h, |face, x, y| [face * h + x, y]);
    }
    let n = if 3 * w == 4 * h && w.is_multiple_of(4) {
        w / 4
    } else if 4 * w == 3 * h && w.is_multiple_of(3) {
        w / 3
    } else {
        return texels;
    };
    if !is_cross(&texels, n) {
        return texels;
    }
    collect(&texels, n, |face, x, y| {
        // Upright, −z hangs below −y, turned by half a turn.
        if w < h && face == 5 {
            return [2 * n - 1 - x, 4 * n - 1 - y];
        }
        let [column, row] = CROSS[face];
        [column * n + x, row * n + y]
    })
}

/// True if all texels beside the faces, which are those of one row and one column, are equal.
fn is_cross(texels: &Texels, n: usize) -> bool {
    let color =
        |x: usize, y: usize| -> Vec<u32> { (0..texels.channels).map(|c| texels.linear(x, y, c).to_bits()).collect() };
    let is_beside = |x: usize, y: usize| {
        let (column, row) = (x / n, y / n);
        row != 1 && column != 1
    };
    let first = color(0, 0);
    (0..texels.height).all(|y| (0..texels.width).all(|x| !is_beside(x, y) || color(x, y) == first))
}

/// Faces of `n` texels below each other, by the place of each texel in the picture.
fn collect(texels: &Texels, n: usize, place: impl Fn(usize, usize, usize) -> [usize; 2]) -> Texels {
    fn gather<T: Copy>(data: &[T], channels: usize, width: usize, places: &[[usize; 2]]) -> Vec<T> {
        let texel = |[x, y]: &[usize; 2]| {
            let at = (y * width + x) * channels;
            &data[at..at + channels]
        };
        places.iter().flat_map(texel).copied().collect()
    }
    let places: Vec<[usize; 2]> = (0..6 * n * n).map(|k| place(k / (n * n), k % n, k / n % n)).collect();
    let (channels, width) = (texels.channels, texels.width);
    let data = match &texels.data {
        TexelData::U8(v) => TexelData::U8(gather(v, channels, width, &places)),
        TexelData::U16(v) => TexelData::U16(gather(v, channels, width, &places)),
        TexelData::F16(v) => TexelData::F16(gather(v, channels, width, &places)),
        TexelData::F32(v) => TexelData::F32(gather(v, channels, width, &places)),
    };
    Texels { width: n, height: 6 * n, channels, data, encoding: texels.encoding, metadata: texels.metadata.clone() }
}
