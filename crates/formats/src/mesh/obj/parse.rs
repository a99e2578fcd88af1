//! The statements of an OBJ file.

use super::{Library, ObjOptions, Skipped, lines::Lines};
use crate::mesh::{
    MeshError, MeshErrorKind as Kind, recentre,
    text::{double, float, is_blank, shown, words},
};
use std::collections::{HashMap, HashSet};

/// No texture coordinate, or no normal.
pub(super) const NONE: u32 = u32::MAX;

/// Indices of a corner: position, texture coordinate, normal.
pub(super) type Corner = [u32; 3];

/// Faces of one mesh, with corners that are not yet shared.
#[derive(Default)]
pub(super) struct Part {
    pub(super) object: String,
    pub(super) group: String,
    pub(super) material: Option<String>,
    pub(super) material_offset: usize,
    /// Corners of all faces.
    pub(super) corners: Vec<Corner>,
    /// Per face: end of its range in `corners`, and its offset in the file.
    pub(super) faces: Vec<(usize, usize)>,
}

/// Contents of a file, before corners are shared.
#[derive(Default)]
pub(super) struct Parsed {
    pub(super) positions: Vec<[f32; 3]>,
    /// None, or one for each position up to the last that has one.
    pub(super) colors: Vec<[f32; 3]>,
    pub(super) uvs: Vec<[f32; 2]>,
    pub(super) normals: Vec<[f32; 3]>,
    pub(super) parts: Vec<Part>,
    pub(super) libraries: Vec<Library>,
    pub(super) skipped: Skipped,
    pub(super) origin: [f64; 3],
}

/// Object, group and material of the faces that follow.
#[derive(Clone, Default, PartialEq, Eq, Hash)]
struct Names {
    object: String,
    group: String,
    material: Option<String>,
}

struct Parser<'a> {
    bytes: &'a [u8],
    options: &'a ObjOptions,
    out: Parsed,
    names: Names,
    material_offset: usize,
    /// The part that the next face joins; `None` after a change of names.
    current: Option<usize>,
    known: HashMap<Names, usize>,
    /// Libraries met so far.
    named: HashSet<String>,
}

/// Reads all statements. Indices are made absolute, but not yet compared with what there is: a face may stand before
/// its vertices.
pub(super) fn parse(bytes: &[u8], options: &ObjOptions) -> Result<Parsed, MeshError> {
    let mut p = Parser {
        bytes,
        options,
        out: Parsed::default(),
        names: Names::default(),
        material_offset: 0,
        current: None,
        known: HashMap::new(),
        named: HashSet::new(),
    };
    for (at, line) in Lines::new(bytes) {
        p.statement(at, &line)?;
    }
    Ok(p.out)
}

impl Parser<'_> {
    #[cold]
    fn fault(&self, kind: Kind, at: usize, message: String) -> MeshError {
        MeshError::in_text(kind, self.bytes, at, message)
    }

    fn statement(&mut self, at: usize, line: &[u8]) -> Result<(), MeshError> {
        let word_end = line.iter().position(|&b| is_blank(b)).unwrap_or(line.len());
        let (word, rest) = line.split_at(word_end);
        let name = || super::name(rest);
        match word {
            b"v" => self.vertex(at, rest)?,
            b"vt" => {
                let (mut uv, found) = self.numbers::<2>(at, rest, "texture coordinate")?;
                self.at_least(at, found, 1, "texture coordinate")?;
                if !uv.iter().all(|v| v.is_finite()) {
                    uv = [0.0; 2];
                    self.out.skipped.not_finite += 1;
                }
                uv[1] = if self.options.flip_v { 1.0 - uv[1] } else { uv[1] };
                self.out.uvs.push(uv);
            }
            b"vn" => {
                let (mut normal, found) = self.numbers::<3>(at, rest, "normal")?;
                self.at_least(at, found, 3, "normal")?;
                if !normal.iter().all(|v| v.is_finite()) {
                    normal = [0.0; 3];
                    self.out.skipped.not_finite += 1;
                }
                self.out.normals.push(normal);
            }
            b"f" | b"fo" => self.face(at, rest)?,
            b"o" => {
                self.names.object = name();
                self.current = None;
            }
            b"g" => {
                self.names.group = name();
                self.current = None;
            }
            b"usemtl" => {
                self.names.material = Some(name()).filter(|n| !n.is_empty());
                self.material_offset = at;
                self.current = None;
            }
            b"mtllib" => self.library(at, rest),
            b"p" => self.out.skipped.points += 1,
            b"l" => self.out.skipped.lines += 1,
            b"vp" | b"cstype" | b"deg" | b"bmat" | b"step" | b"curv" | b"curv2" | b"surf" | b"parm" | b"trim"
            | b"hole" | b"scrv" | b"sp" | b"end" | b"con" => self.out.skipped.free_form += 1,
            // Smoothing without normals, and attributes of display: nothing for us.
            b"s" | b"mg" | b"bevel" | b"c_interp" | b"d_interp" | b"lod" | b"shadow_obj" | b"trace_obj" | b"ctech"
            | b"stech" | b"usemap" | b"maplib" | b"call" | b"csh" => {}
            _ => {
                if self.out.skipped.unknown == 0 {
                    self.out.skipped.unknown_offset = at;
                }
                self.out.skipped.unknown += 1;
            }
        }
        Ok(())
    }

    /// Up to `N` numbers, finite or not, and how many there were; what follows them is passed over.
    #[inline]
    fn numbers<const N: usize>(&self, at: usize, rest: &[u8], what: &str) -> Result<([f32; N], usize), MeshError> {
        let mut values = [0.0; N];
        let (mut i, mut found) = (0, 0);
        while found < N {
            while i < rest.len() && is_blank(rest[i]) {
                i += 1;
            }
            let start = i;
            while i < rest.len() && !is_blank(rest[i]) {
                i += 1;
            }
            let word = &rest[start..i];
            if word.is_empty() || word[0] == b'#' {
                break;
            }
            match float(word) {
                Some(v) => values[found] = v,
                None => return Err(self.fault(Kind::Syntax, at, format!("{what}: '{}' is not a number", shown(word)))),
            }
            found += 1;
        }
        Ok((values, found))
    }

    fn at_least(&self, at: usize, found: usize, needed: usize, what: &str) -> Result<(), MeshError> {
        if found < needed {
            return Err(self.fault(Kind::Syntax, at, format!("{what}: {found} numbers where {needed} are needed")));
        }
        Ok(())
    }

    /// `v x y z`, `v x y z w` (the weight is for curves only) or `v x y z r g b`.
    fn vertex(&mut self, at: usize, rest: &[u8]) -> Result<(), MeshError> {
        let ([x, y, z, r, g, b], found) = self.numbers::<6>(at, rest, "vertex")?;
        self.at_least(at, found, 3, "vertex")?;
        if found == 6 {
            let is_sound = r.is_finite() && g.is_finite() && b.is_finite();
            self.out.skipped.colors += usize::from(!is_sound);
            self.out.colors.resize(self.out.positions.len(), [1.0; 3]);
            self.out.colors.push(if is_sound { [r, g, b] } else { [1.0; 3] });
        }
        let mut p = [x, y, z];
        if self.options.recentre {
            if self.out.positions.is_empty() {
                self.out.origin = recentre::origin(p.map(f64::from));
            }
            if self.out.origin != [0.0; 3] {
                let words = rest.split(|b| is_blank(*b)).filter(|word| !word.is_empty());
                for ((p, origin), word) in p.iter_mut().zip(self.out.origin).zip(words) {
                    *p = double(word).map_or(*p, |v| (v - origin) as f32);
                }
            }
        }
        self.out.positions.push(p);
        Ok(())
    }

    /// The part that faces join now.
    fn part(&mut self) -> usize {
        if let Some(i) = self.current {
            return i;
        }
        let names = if self.options.merge { Names::default() } else { self.names.clone() };
        let next = self.out.parts.len();
        let index = *self.known.entry(names).or_insert_with_key(|n| {
            let (object, group, material) = (n.object.clone(), n.group.clone(), n.material.clone());
            self.out.parts.push(Part {
                object,
                group,
                material,
                material_offset: self.material_offset,
                ..Part::default()
            });
            next
        });
        self.current = Some(index);
        index
    }

    /// `f v v v…`, `f v/vt…`, `f v//vn…`, `f v/vt/vn…`
    fn face(&mut self, at: usize, rest: &[u8]) -> Result<(), MeshError> {
        let part = self.part();
        let counts = [self.out.positions.len(), self.out.uvs.len(), self.out.normals.len()];
        let start = self.out.parts[part].corners.len();
        let mut i = 0;
        loop {
            while i < rest.len() && is_blank(rest[i]) {
                i += 1;
            }
            if i == rest.len() || rest[i] == b'#' {
                break;
            }
            let word_start = i;
            let mut corner = [NONE; 3];
            let mut ok = true;
            for (k, index) in corner.iter_mut().enumerate() {
                let (value, digits) = signed(rest, &mut i);
                if digits {
                    *index = match absolute(value, counts[k]) {
                        Some(index) => index,
                        None if k > 0 => {
                            self.out.skipped.references += 1;
                            NONE
                        }
                        None => {
                            let message =
                                format!("the face refers to vertex {value}, but {} stand before it", counts[k]);
                            return Err(MeshError::in_text(Kind::IndexOutOfRange, self.bytes, at, message));
                        }
                    };
                } else if k == 0 {
                    ok = false;
                }
                match rest.get(i) {
                    Some(b'/') if k < 2 => i += 1,
                    _ => break,
                }
            }
            if !ok || rest.get(i).is_some_and(|&b| !is_blank(b)) {
                let word = rest[word_start..].split(|&b| is_blank(b)).next().unwrap_or_default();
                return Err(self.fault(
                    Kind::Syntax,
                    at,
                    format!("face: '{}' is not a corner (v, v/vt, v//vn or v/vt/vn)", shown(word)),
                ));
            }
            self.out.parts[part].corners.push(corner);
        }
        let p = &mut self.out.parts[part];
        if p.corners.len() - start < 3 {
            p.corners.truncate(start);
            self.out.skipped.degenerate += 1;
        } else {
            p.faces.push((p.corners.len(), at));
        }
        Ok(())
    }

    /// One or several file names; blanks within a name are told by what ends in `.mtl`.
    fn library(&mut self, at: usize, rest: &[u8]) {
        let mut name = String::new();
        let words: Vec<_> = words(rest).map(String::from_utf8_lossy).collect();
        for (i, word) in words.iter().enumerate() {
            if !name.is_empty() {
                name.push(' ');
            }
            name.push_str(word);
            let ends = word.len() >= 4
                && word.is_char_boundary(word.len() - 4)
                && word[word.len() - 4..].eq_ignore_ascii_case(".mtl");
            if ends || i + 1 == words.len() {
                let name = std::mem::take(&mut name);
                if self.named.insert(name.clone()) {
                    self.out.libraries.push(Library { name, offset: at });
                }
            }
        }
    }
}

/// Reads an integer at `i` and moves past it; large ones stop at a bound that no index reaches.
#[inline]
fn signed(text: &[u8], i: &mut usize) -> (i64, bool) {
    let negative = text.get(*i) == Some(&b'-');
    *i += usize::from(negative || text.get(*i) == Some(&b'+'));
    let start = *i;
    let mut value = 0i64;
    while let Some(digit) = text.get(*i).map(|b| b.wrapping_sub(b'0')).filter(|&d| d <= 9) {
        value = (value * 10 + i64::from(digit)).min(1 << 50);
        *i += 1;
    }
    (if negative { -value } else { value }, *i > start)
}

/// An index from 0: positive ones count from 1 at the start of the file, negative ones back from the last.
#[inline]
fn absolute(index: i64, count: usize) -> Option<u32> {
    let zero_based = if index > 0 {
        index - 1
    } else if index < 0 {
        index + count as i64
    } else {
        return None;
    };
    u32::try_from(zero_based).ok().filter(|&i| i != NONE)
}
