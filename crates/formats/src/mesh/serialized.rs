//! Mitsuba's `.serialized` meshes, versions 3 and 4: a header, one zlib stream per mesh, and at the end a table of
//! where each starts.

use super::{MeshError, MeshErrorKind as Kind};
use crate::limits::{MOST_OF_MESHES, unpacked};
use std::io::Read;
use steradian_scene::{Attribute, Domain, Mesh};

/// The first two bytes of every mesh.
const MAGIC: u16 = 0x041c;
const HAS_NORMALS: u32 = 0x0001;
const HAS_UVS: u32 = 0x0002;
const HAS_COLORS: u32 = 0x0008;
const FACE_NORMALS: u32 = 0x0010;
const DOUBLE: u32 = 0x2000;

/// A mesh of a `.serialized` file.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct SerializedMesh {
    /// Its name; empty in version 3.
    pub name: String,
    /// The arrays. Vertex colours are the attribute `color`.
    pub mesh: Mesh,
    /// The file asks for flat shading; the normals are left out then.
    pub face_normals: bool,
}

/// Reads one of the meshes of a file, counted from 0.
///
/// # Errors
/// [`MeshError`] with the byte in the file, or in the unpacked data for what lies in the zlib stream, for anything
/// malformed, for versions other than 3 and 4, and for an index past the meshes of the file.
pub fn read(bytes: &[u8], shape_index: usize) -> Result<SerializedMesh, MeshError> {
    let (version, _) = version_at(bytes, 0)?;
    let start = if shape_index == 0 { 0 } else { start_of(bytes, shape_index, version)? };

    let (version, packed_at) = version_at(bytes, start)?;
    let mut stream = Stream {
        unzip: flate2::bufread::ZlibDecoder::new(&bytes[packed_at..]),
        at: 0,
        most: unpacked(bytes.len() - packed_at, MOST_OF_MESHES),
        scratch: Vec::new(),
    };
    stream.mesh(version)
}

fn fixed<const N: usize>(bytes: &[u8], at: usize, what: &str) -> Result<[u8; N], MeshError> {
    let found = at.checked_add(N).and_then(|end| bytes.get(at..end)).and_then(|s| s.try_into().ok());
    found.ok_or_else(|| MeshError::at_byte(Kind::Truncated, bytes.len(), format!("the file ends within {what}")))
}

/// The version of the mesh whose header starts at `at`, and where its zlib stream starts.
fn version_at(bytes: &[u8], at: usize) -> Result<(u16, usize), MeshError> {
    let magic = u16::from_le_bytes(fixed(bytes, at, "the header of a mesh")?);
    let version = u16::from_le_bytes(fixed(bytes, at + 2, "the header of a mesh")?);
    if magic != MAGIC {
        let message = format!("no mesh starts here: {magic:#06x} where {MAGIC:#06x} is expected");
        return Err(MeshError::at_byte(Kind::Syntax, at, message));
    }
    if !matches!(version, 3 | 4) {
        let message = format!("version {version} of the format (versions 3 and 4 are read)");
        return Err(MeshError::at_byte(Kind::Unsupported, at + 2, message));
    }
    Ok((version, at + 4))
}

/// Looks a mesh up in the table at the end of the file: offsets of 8 bytes (version 4) or 4 (version 3), then how many
/// there are.
fn start_of(bytes: &[u8], shape_index: usize, version: u16) -> Result<usize, MeshError> {
    let missing = || MeshError::at_byte(Kind::Truncated, bytes.len(), "the file ends before its table of meshes");
    let count_at = bytes.len().checked_sub(4).ok_or_else(missing)?;
    let count = u32::from_le_bytes(fixed(bytes, count_at, "the table of meshes")?) as usize;
    if shape_index >= count {
        let message = format!("mesh {shape_index} is asked for, but the file has {count} (0 is the first)");
        return Err(MeshError::at_byte(Kind::Missing, count_at, message));
    }
    let width = if version == 4 { 8 } else { 4 };
    let entry =
        (count - shape_index).checked_mul(width).and_then(|back| count_at.checked_sub(back)).ok_or_else(missing)?;
    let start = if version == 4 {
        u64::from_le_bytes(fixed(bytes, entry, "the table of meshes")?)
    } else {
        u64::from(u32::from_le_bytes(fixed(bytes, entry, "the table of meshes")?))
    };
    usize::try_from(start).ok().filter(|&s| s < entry).ok_or_else(|| {
        MeshError::at_byte(
            Kind::Syntax,
            entry,
            format!("mesh {shape_index} is said to start at byte {start}, past the data"),
        )
    })
}

/// The unpacked data of one mesh.
struct Stream<'a> {
    unzip: flate2::bufread::ZlibDecoder<&'a [u8]>,
    /// Unpacked bytes read so far.
    at: usize,
    /// Most unpacked bytes.
    most: u64,
    scratch: Vec<u8>,
}

impl Stream<'_> {
    fn fill(&mut self, n: usize, what: &str) -> Result<&[u8], MeshError> {
        self.scratch.resize(n, 0);
        self.unzip.read_exact(&mut self.scratch).map_err(|cause| {
            let (kind, why) = match cause.kind() {
                std::io::ErrorKind::UnexpectedEof => (Kind::Truncated, "the packed data ends".to_owned()),
                _ => (Kind::Syntax, format!("the packed data is damaged ({cause})")),
            };
            MeshError::at_byte(kind, self.at, format!("{why} within {what}"))
        })?;
        self.at += n;
        Ok(&self.scratch)
    }

    fn number<const N: usize>(&mut self, what: &str) -> Result<[u8; N], MeshError> {
        let at = self.at;
        fixed(self.fill(N, what)?, 0, what).map_err(|e| MeshError { offset: at, ..e })
    }

    /// A null-terminated string.
    fn name(&mut self) -> Result<String, MeshError> {
        const LONGEST: usize = 1 << 16;
        let mut name = Vec::new();
        loop {
            match self.number::<1>("the name")? {
                [0] => return Ok(String::from_utf8_lossy(&name).into_owned()),
                _ if name.len() == LONGEST => {
                    return Err(MeshError::at_byte(
                        Kind::TooLarge,
                        self.at,
                        format!("the name is longer than {LONGEST} bytes"),
                    ));
                }
                [b] => name.push(b),
            }
        }
    }

    fn count(&mut self, what: &str) -> Result<usize, MeshError> {
        let at = self.at;
        let n = u64::from_le_bytes(self.number(what)?);
        u32::try_from(n).map(|n| n as usize).map_err(|_| {
            MeshError::at_byte(Kind::TooLarge, at, format!("{what} is {n}, more than 32-bit indices can name"))
        })
    }

    /// `count` groups of `N` numbers, read in pieces so that memory grows only with data that is really there.
    fn groups<T: Copy, const W: usize, const N: usize>(
        &mut self,
        count: usize,
        what: &str,
        convert: impl Fn([u8; W]) -> T,
    ) -> Result<Vec<[T; N]>, MeshError> {
        const PIECE: usize = 1 << 14;
        let mut out: Vec<[T; N]> = Vec::new();
        while out.len() < count {
            let n = (count - out.len()).min(PIECE);
            let raw = self.fill(n * N * W, what)?;
            let (words, _) = raw.as_chunks::<W>();
            let (groups, _) = words.as_chunks::<N>();
            out.extend(groups.iter().map(|g| g.map(&convert)));
        }
        Ok(out)
    }

    fn floats<const N: usize>(&mut self, count: usize, double: bool, what: &str) -> Result<Vec<[f32; N]>, MeshError> {
        let start = self.at;
        let values: Vec<[f32; N]> = if double {
            self.groups(count, what, |raw| f64::from_le_bytes(raw) as f32)?
        } else {
            self.groups(count, what, f32::from_le_bytes)?
        };
        if let Some(vertex) = values.iter().position(|v| v.iter().any(|x| !x.is_finite())) {
            let offset = start + vertex * N * if double { 8 } else { 4 };
            return Err(MeshError::at_byte(
                Kind::NotFinite,
                offset,
                format!("the {what} of vertex {vertex} is not a finite number"),
            ));
        }
        Ok(values)
    }

    fn mesh(&mut self, version: u16) -> Result<SerializedMesh, MeshError> {
        let flags = u32::from_le_bytes(self.number("the flags")?);
        let name = if version == 4 { self.name()? } else { String::new() };
        let vertices = self.count("the number of vertices")?;
        let triangles = self.count("the number of triangles")?;
        let (double, has) = (flags & DOUBLE != 0, |flag: u32| flags & flag != 0);
        let lanes =
            3 + 3 * usize::from(has(HAS_NORMALS)) + 2 * usize::from(has(HAS_UVS)) + 3 * usize::from(has(HAS_COLORS));
        let need = (vertices as u64) * (lanes as u64) * if double { 8 } else { 4 } + (triangles as u64) * 12;
        if need > self.most {
            let message = format!(
                "{vertices} vertices and {triangles} triangles take {need} bytes, more than {MOST_OF_MESHES} times the file's own"
            );
            return Err(MeshError::at_byte(Kind::TooLarge, self.at, message));
        }

        let mut mesh = Mesh { positions: self.floats(vertices, double, "position")?, ..Mesh::default() };
        if has(HAS_NORMALS) {
            mesh.normals = self.floats(vertices, double, "normal")?;
        }
        if has(HAS_UVS) {
            mesh.uvs = self.floats(vertices, double, "texture coordinate")?;
        }
        if has(HAS_COLORS) {
            let data = self.floats::<3>(vertices, double, "colour")?.into_flattened();
            mesh.attributes.push(Attribute { name: "color".into(), domain: Domain::Vertex, channels: 3, data });
        }
        let start = self.at;
        mesh.triangles = self.groups(triangles, "the triangles", u32::from_le_bytes)?.into();
        if let Some(face) = mesh.triangles.iter().position(|t| t.iter().any(|&i| i as usize >= vertices)) {
            let index = mesh.triangles[face].iter().max().copied().unwrap_or(0);
            let message =
                format!("triangle {face} refers to vertex {index}, but there are {vertices} (0 is the first)");
            return Err(MeshError::at_byte(Kind::IndexOutOfRange, start + face * 12, message));
        }
        let face_normals = has(FACE_NORMALS);
        if face_normals {
            mesh.normals = Vec::new();
        }
        Ok(SerializedMesh { name, mesh, face_normals })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::test_files::{assets, mutants};
    use flate2::{Compression, write::ZlibEncoder};
    use std::io::Write;

    /// One mesh: a triangle with everything.
    fn packed(version: u16, flags: u32, name: &str, counts: [u64; 2], indices: [u32; 3]) -> Vec<u8> {
        let mut data = flags.to_le_bytes().to_vec();
        if version == 4 {
            data.extend(name.bytes().chain([0]));
        }
        counts.iter().for_each(|c| data.extend(c.to_le_bytes()));
        let lanes = [(true, 9), (flags & HAS_NORMALS != 0, 9), (flags & HAS_UVS != 0, 6), (flags & HAS_COLORS != 0, 9)];
        for i in 0..lanes.iter().filter(|l| l.0).map(|l| l.1).sum::<usize>() {
            if flags & DOUBLE != 0 {
                data.extend((i as f64).to_le_bytes());
            } else {
                data.extend((i as f32).to_le_bytes());
            }
        }
        indices.iter().for_each(|i| data.extend(i.to_le_bytes()));
        let mut zip = ZlibEncoder::new([MAGIC.to_le_bytes(), version.to_le_bytes()].concat(), Compression::default());
        zip.write_all(&data).unwrap();
        zip.finish().unwrap()
    }

    fn file(version: u16, meshes: &[Vec<u8>]) -> Vec<u8> {
        let mut out = Vec::new();
        let mut starts = Vec::new();
        for m in meshes {
            starts.push(out.len() as u64);
            out.extend(m);
        }
        for s in starts {
            let raw = s.to_le_bytes();
            out.extend(&raw[..if version == 4 { 8 } else { 4 }]);
        }
        out.extend((meshes.len() as u32).to_le_bytes());
        out
    }

    #[test]
    fn real_files_read() {
        let Some(root) = assets() else { return };
        for (name, normals, uvs) in
            [("rectangle_normals", 4, 0), ("rectangle_normals_uv", 4, 4), ("rectangle_uv", 0, 4)]
        {
            let bytes = std::fs::read(root.join(format!("mitsuba/tests/serialized/{name}.serialized"))).unwrap();
            let m = read(&bytes, 0).unwrap().mesh;
            m.validate().unwrap();
            assert_eq!(
                (m.positions.len(), m.triangles.len(), m.normals.len(), m.uvs.len()),
                (4, 2, normals, uvs),
                "{name}"
            );
        }
    }

    #[test]
    fn all_versions_precisions_and_shapes_agree() {
        let all = HAS_NORMALS | HAS_UVS | HAS_COLORS;
        for (version, flags) in [(3, all), (4, all), (4, all | DOUBLE), (3, all | DOUBLE)] {
            let meshes = [
                packed(version, flags, "first", [3, 1], [0, 1, 2]),
                packed(version, 0, "", [3, 1], [1, 1, 1]),
                packed(version, flags | FACE_NORMALS, "third", [3, 1], [2, 1, 0]),
            ];
            let bytes = file(version, &meshes);
            let first = read(&bytes, 0).unwrap();
            first.mesh.validate().unwrap();
            assert_eq!(first.name, if version == 4 { "first" } else { "" });
            assert_eq!(first.mesh.positions[1], [3., 4., 5.]);
            assert_eq!(first.mesh.normals[0], [9., 10., 11.]);
            assert_eq!(first.mesh.uvs[2], [22., 23.]);
            assert_eq!(first.mesh.attributes[0].data[..3], [24., 25., 26.]);
            assert_eq!(read(&bytes, 1).unwrap().mesh.triangles, [[1, 1, 1]]);
            let third = read(&bytes, 2).unwrap();
            assert!(third.face_normals && third.mesh.normals.is_empty() && third.mesh.triangles == [[2, 1, 0]]);
            let error = read(&bytes, 3).unwrap_err();
            assert!(error.kind == Kind::Missing && error.message.contains("the file has 3"), "{error}");
        }
    }

    #[test]
    fn faults_are_named() {
        let good = file(4, &[packed(4, 0, "x", [3, 1], [0, 1, 2])]);
        assert!(read(&good, 0).is_ok());
        let mut version = good.clone();
        version[2] = 5;
        assert!(read(&version, 0).unwrap_err().to_string().contains("version 5"));
        assert_eq!(read(b"\x1c\x05\x04\x00", 0).unwrap_err().kind, Kind::Syntax);
        assert_eq!(read(&packed(4, 0, "x", [3, 1], [0, 1, 3]), 0).unwrap_err().kind, Kind::IndexOutOfRange);
        assert_eq!(read(&packed(4, 0, "x", [4, 1], [0, 1, 2]), 0).unwrap_err().kind, Kind::Truncated);
        for counts in [[4_000_000_000, 1], [3, 4_000_000_000], [u64::MAX, 1], [1 << 40, 1 << 40]] {
            let error = read(&packed(4, 0, "x", counts, [0, 1, 2]), 0).unwrap_err();
            assert!(matches!(error.kind, Kind::Truncated | Kind::TooLarge), "{error}");
        }
    }

    /// A small file that holds a huge mesh of nothing: what it may unpack to is bounded, and found out before it is
    /// unpacked.
    #[test]
    fn bombs_are_refused() {
        let bomb = |triangles: u64| {
            let mut zip = ZlibEncoder::new([MAGIC.to_le_bytes(), 4_u16.to_le_bytes()].concat(), Compression::fast());
            zip.write_all(&[0; 5]).unwrap();
            zip.write_all(&[3_u64.to_le_bytes(), triangles.to_le_bytes()].concat()).unwrap();
            std::io::copy(&mut std::io::repeat(0).take(36 + 12 * triangles), &mut zip).unwrap();
            zip.finish().unwrap()
        };
        let (small, large) = (bomb(1_000_000), bomb(8_000_000));
        assert!(large.len() < 500_000);
        assert_eq!(read(&small, 0).unwrap().mesh.triangles.len(), 1_000_000);
        assert_eq!(read(&large, 0).unwrap_err().kind, Kind::TooLarge);
    }

    #[test]
    fn truncations_and_mutants_neither_panic_nor_swell() {
        let seed = file(4, &[packed(4, HAS_UVS, "a", [3, 1], [0, 1, 2]), packed(4, DOUBLE, "b", [3, 1], [0, 1, 2])]);
        let check = |bytes: &[u8]| {
            for index in [0, 1, 5] {
                if let Ok(m) = read(bytes, index) {
                    m.mesh.validate().unwrap();
                    assert!(m.mesh.bytes() as u64 <= unpacked(bytes.len(), MOST_OF_MESHES));
                }
            }
        };
        (0..seed.len()).for_each(|end| check(&seed[..end]));
        mutants(&seed, 10_000, check);
    }
}
