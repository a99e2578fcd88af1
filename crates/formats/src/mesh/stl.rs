//! STL ("StereoLithography Interface Specification", 3D Systems 1989), binary and in text: triangles without vertices
//! in common, which are joined here where their coordinates are equal.
//!
//! A binary file has 80 bytes of any text, the number of triangles, and 50 bytes for each: normal, three points, and a
//! number that some programs use for a colour. Normals are those of the triangles, whatever the file says.

use super::{
    MeshError, MeshErrorKind as Kind,
    text::{float, is_space, shown},
};
use std::collections::HashMap;
use steradian_scene::Mesh;

/// Bytes before the triangles.
const HEADER: usize = 84;
/// Bytes of a triangle.
const FACET: usize = 50;

/// A mesh, and what the file says beside it.
#[derive(Debug)]
pub struct StlFile {
    /// The triangles.
    pub mesh: Mesh,
    /// Number of triangles that have a colour of their own, which is not read.
    pub colored: usize,
}

/// Number of triangles that a binary file declares; `None` for text.
fn declared(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(80..HEADER)?;
    let count = u32::from_le_bytes([count[0], count[1], count[2], count[3]]) as usize;
    let is_binary = bytes.len() == HEADER + count * FACET || !is_text(bytes);
    is_binary.then_some(count)
}

fn is_text(bytes: &[u8]) -> bool {
    bytes.trim_ascii_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
}

/// True if bytes look like a file of this kind.
pub fn looks_like(bytes: &[u8]) -> bool {
    is_text(bytes) || declared(bytes).is_some_and(|count| count > 0 && bytes.len() == HEADER + count * FACET)
}

/// Reads a file.
///
/// # Errors
/// Where it is not as said, has no triangle, or coordinates that are not finite.
pub fn read(bytes: &[u8]) -> Result<StlFile, MeshError> {
    let file = match declared(bytes) {
        Some(count) => binary(bytes, count)?,
        None => text(bytes)?,
    };
    match file.mesh.triangles.is_empty() {
        true => Err(MeshError::at_byte(Kind::Missing, 0, "there are no triangles")),
        false => Ok(file),
    }
}

/// Triangles under construction, with the number of each point by its bits.
#[derive(Default)]
struct Joined {
    mesh: Mesh,
    known: HashMap<[u32; 3], u32>,
}

impl Joined {
    fn add(&mut self, triangle: [[f32; 3]; 3]) -> Option<()> {
        let mut corners = [0; 3];
        for (corner, p) in corners.iter_mut().zip(triangle) {
            // Both zeros are one.
            let key = p.map(|v| (v + 0.0).to_bits());
            let next = u32::try_from(self.mesh.positions.len()).ok()?;
            *corner = *self.known.entry(key).or_insert(next);
            if *corner == next {
                self.mesh.positions.push(p);
            }
        }
        self.mesh.triangles.push(corners);
        Some(())
    }
}

fn too_many(offset: usize) -> MeshError {
    MeshError::at_byte(Kind::TooLarge, offset, "there are too many points for a mesh")
}

fn binary(bytes: &[u8], count: usize) -> Result<StlFile, MeshError> {
    let there = (bytes.len() - HEADER) / FACET;
    if there < count {
        let message = format!("{count} triangles are declared, and there are bytes for {there}");
        return Err(MeshError::at_byte(Kind::Truncated, bytes.len(), message));
    }
    let (mut joined, mut colored) = (Joined::default(), 0);
    let has_palette = bytes[..80].windows(6).any(|w| w == b"COLOR=");
    for (k, facet) in bytes[HEADER..].chunks_exact(FACET).take(count).enumerate() {
        let offset = HEADER + k * FACET;
        let number = |at: usize| f32::from_le_bytes([facet[at], facet[at + 1], facet[at + 2], facet[at + 3]]);
        let triangle: [[f32; 3]; 3] = std::array::from_fn(|c| std::array::from_fn(|a| number(12 + 12 * c + 4 * a)));
        if !triangle.as_flattened().iter().all(|v| v.is_finite()) {
            let message = format!("a coordinate of triangle {} is not a finite number", k + 1);
            return Err(MeshError::at_byte(Kind::NotFinite, offset + 12, message));
        }
        joined.add(triangle).ok_or_else(|| too_many(offset))?;
        // By its highest bit: set for a colour (VisCAM), or clear beside a palette in the header (Magics).
        let attribute = u16::from_le_bytes([facet[48], facet[49]]);
        colored += usize::from((attribute & 0x8000 != 0) != has_palette);
    }
    Ok(StlFile { mesh: joined.mesh, colored })
}

fn text(bytes: &[u8]) -> Result<StlFile, MeshError> {
    let mut joined = Joined::default();
    let mut corners: Vec<[f32; 3]> = Vec::new();
    let mut at = 0;
    // The name of a solid, which may be any text, ends with its line.
    skip_line(bytes, &mut at);
    while let Some((word, start)) = next(bytes, &mut at) {
        let is = |name: &[u8]| word.eq_ignore_ascii_case(name);
        if is(b"vertex") {
            let mut p = [0.0; 3];
            for v in &mut p {
                *v = coordinate(bytes, &mut at)?;
            }
            corners.push(p);
        } else if is(b"endloop") {
            let Ok(triangle) = <[[f32; 3]; 3]>::try_from(corners.as_slice()) else {
                let message = format!("a facet has three vertices, not {}", corners.len());
                return Err(MeshError::in_text(Kind::Syntax, bytes, start, message));
            };
            joined.add(triangle).ok_or_else(|| too_many(start))?;
            corners.clear();
        } else if is(b"normal") {
            // Some programs write 'nan' for triangles without area.
            for _ in 0..3 {
                next(bytes, &mut at);
            }
        } else if is(b"solid") || is(b"endsolid") {
            skip_line(bytes, &mut at);
        } else if !(is(b"facet") || is(b"outer") || is(b"loop") || is(b"endfacet")) {
            let message = format!("expected 'facet', 'vertex' or 'endsolid', found '{}'", shown(word));
            return Err(MeshError::in_text(Kind::Syntax, bytes, start, message));
        }
    }
    match corners.is_empty() {
        true => Ok(StlFile { mesh: joined.mesh, colored: 0 }),
        false => Err(MeshError::in_text(Kind::Truncated, bytes, bytes.len(), "the file ends within a facet")),
    }
}

fn skip_line(bytes: &[u8], at: &mut usize) {
    *at += bytes[*at..].iter().take_while(|b| **b != b'\n').count();
}

/// The next word and its place; `None` at the end.
fn next<'a>(bytes: &'a [u8], at: &mut usize) -> Option<(&'a [u8], usize)> {
    let start = *at + bytes[*at..].iter().take_while(|b| is_space(**b)).count();
    let length = bytes[start..].iter().take_while(|b| !is_space(**b)).count();
    *at = start + length;
    (length > 0).then(|| (&bytes[start..*at], start))
}

fn coordinate(bytes: &[u8], at: &mut usize) -> Result<f32, MeshError> {
    let Some((word, start)) = next(bytes, at) else {
        return Err(MeshError::in_text(Kind::Truncated, bytes, bytes.len(), "the file ends within a vertex"));
    };
    match float(word) {
        Some(v) if v.is_finite() => Ok(v),
        Some(_) => {
            let message = format!("the coordinate '{}' is not a finite number", shown(word));
            Err(MeshError::in_text(Kind::NotFinite, bytes, start, message))
        }
        None => {
            let message = format!("expected a coordinate, found '{}'", shown(word));
            Err(MeshError::in_text(Kind::Syntax, bytes, start, message))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "solid a square of two\n\
        facet normal 0 0 1\n outer loop\n vertex 0 0 0\n vertex 1 0 0\n vertex 1 1 -0\n endloop\nendfacet\n\
        FACET NORMAL nan nan nan OUTER LOOP VERTEX 0 0 0 VERTEX 1 1 0 VERTEX 0 1e0 0 ENDLOOP ENDFACET\n\
        endsolid a square of two\n";

    fn bytes_of(triangles: &[[[f32; 3]; 3]], header: &[u8], attribute: u16) -> Vec<u8> {
        let mut bytes = header.to_vec();
        bytes.resize(80, b' ');
        bytes.extend((triangles.len() as u32).to_le_bytes());
        for t in triangles {
            bytes.extend([0.0_f32; 3].iter().chain(t.as_flattened()).flat_map(|v| v.to_le_bytes()));
            bytes.extend(attribute.to_le_bytes());
        }
        bytes
    }

    const SQUARE: [[[f32; 3]; 3]; 2] =
        [[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, -0.0]], [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]];

    #[test]
    fn text_and_bytes_are_the_same_mesh() {
        let of_text = read(TEXT.as_bytes()).unwrap();
        // A header may begin as text does.
        let of_bytes = read(&bytes_of(&SQUARE, b"solid of CAD", 0)).unwrap();
        for file in [&of_text, &of_bytes] {
            assert_eq!((file.mesh.positions.len(), file.colored), (4, 0), "points are joined");
            assert_eq!(file.mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
            file.mesh.validate().unwrap();
        }
        assert!(looks_like(TEXT.as_bytes()) && looks_like(&bytes_of(&SQUARE, b"", 0)));
        assert!(!looks_like(b"v 0 0 0\nf 1 1 1\n") && !looks_like(&[0; 84]));
    }

    #[test]
    fn colours_are_counted() {
        for (header, attribute, colored) in [(&b"x"[..], 0x8001, 2), (b"x", 1, 0), (b"COLOR=abcd", 1, 2)] {
            assert_eq!(read(&bytes_of(&SQUARE, header, attribute)).unwrap().colored, colored);
        }
    }

    #[test]
    fn faults_have_their_place() {
        let whole = bytes_of(&SQUARE, b"", 0);
        let infinite = bytes_of(&[[[f32::INFINITY; 3]; 3]], b"", 0);
        for (bytes, kind, said) in [
            (whole[..whole.len() - 1].to_vec(), Kind::Truncated, "2 triangles are declared, and there are bytes for 1"),
            (infinite, Kind::NotFinite, "triangle 1"),
            (bytes_of(&[], b"", 0), Kind::Missing, "no triangles"),
            (b"solid a\nendsolid a".to_vec(), Kind::Missing, "no triangles"),
            (TEXT.replace("1 1 -0\n", "1 1 x\n").into(), Kind::Syntax, "line 6: expected a coordinate, found 'x'"),
            (TEXT.replace("1 1 -0\n", "1 1 1e99\n").into(), Kind::NotFinite, "'1e99'"),
            (TEXT.replace(" vertex 1 0 0\n", "").into(), Kind::Syntax, "three vertices, not 2"),
            (TEXT.replace("outer", "inner").into(), Kind::Syntax, "line 3: expected 'facet'"),
            (b"solid a\nfacet outer loop vertex 1 2".to_vec(), Kind::Truncated, "within a vertex"),
            (b"solid a\nfacet outer loop vertex 1 2 3".to_vec(), Kind::Truncated, "within a facet"),
        ] {
            let e = read(&bytes).unwrap_err();
            assert!(e.kind == kind && e.to_string().contains(said), "{e}");
        }
        assert!(read(b"").is_err() && read(&[b' '; 83]).is_err());
    }
}
