//! Parts before the tree of a grid: flags of packing, metadata, and the map from indices to the world.

use crate::{Error, bytes::Stream};

/// Head of a grid.
pub(super) struct Head {
    /// Flags of how values are packed.
    pub packing: u32,
    /// Class of the grid: `fog volume`, `level set`, `unknown`, or empty.
    pub class: String,
    /// Rows of the map.
    pub world_from_index: [[f64; 4]; 3],
}

impl Head {
    pub fn read(stream: &mut Stream) -> Result<Self, Error> {
        Ok(Self { packing: stream.u32()?, class: metadata(stream)?, world_from_index: map(stream)? })
    }
}

/// Passes over a list of metadata: names, types and lengths before what they are. Returns the class among them.
pub(super) fn metadata(stream: &mut Stream) -> Result<String, Error> {
    let mut class = String::new();
    for _ in 0..stream.u32()? {
        let (name, kind) = (stream.text()?, stream.text()?);
        if (name.as_str(), kind.as_str()) == ("class", "string") {
            class = stream.text()?;
        } else {
            let length = stream.u32()?;
            stream.take(length.into())?;
        }
    }
    Ok(class)
}

/// Rows of the affine map. Maps that scale have four more vectors, which follow from the scale.
fn map(stream: &mut Stream) -> Result<[[f64; 4]; 3], Error> {
    const FOLLOWING: u64 = 4 * 24;
    let kind = stream.text()?;
    let vector = |stream: &mut Stream| Ok::<_, Error>([stream.f64()?, stream.f64()?, stream.f64()?]);
    let diagonal = |scale: [f64; 3], offset: [f64; 3]| {
        std::array::from_fn(|i| std::array::from_fn(|j| [scale[i] * f64::from(u8::from(i == j)), offset[i]][j / 3]))
    };
    match kind.as_str() {
        "UniformScaleMap" | "ScaleMap" => {
            let scale = vector(stream)?;
            stream.take(FOLLOWING)?;
            Ok(diagonal(scale, [0.0; 3]))
        }
        "UniformScaleTranslateMap" | "ScaleTranslateMap" => {
            let (offset, scale) = (vector(stream)?, vector(stream)?);
            stream.take(FOLLOWING)?;
            Ok(diagonal(scale, offset))
        }
        "TranslationMap" => Ok(diagonal([1.0; 3], vector(stream)?)),
        // A matrix of four rows that stands right of row vectors.
        "AffineMap" | "UnitaryMap" => {
            let mut column = || vector(stream).and_then(|v| stream.f64().map(|_| v));
            let columns = [column()?, column()?, column()?, column()?];
            Ok(std::array::from_fn(|i| columns.map(|column| column[i])))
        }
        other => Err(Error::Unsupported(format!("it has a grid with a map '{other}'; affine maps are read"))),
    }
}
