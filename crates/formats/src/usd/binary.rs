//! Layers in binary form (.usdc), versions 0.4 to 0.13: Pixar's "crate" files.
//!
//! Sections hold tokens, strings, fields, sets of fields, paths, and specs; the value of a field is eight bytes, of
//! which 48 bits are the value itself or its place. Nothing is allocated that the bytes present do not account for, up
//! to a factor for compression.

use super::{
    layer::{Layer, MOST_NESTED, Spec, Specifier, join, property},
    lz4,
    value::{Item, ListOp, Retime, Value},
};
use std::{
    collections::{BTreeMap, HashMap},
    sync::Arc,
};

/// First bytes of such files.
pub(super) const MAGIC: &[u8] = b"PXR-USDC";
/// Specs of prims, the layer, properties and variants by number.
const ATTRIBUTE: u32 = 1;
const PRIM: u32 = 6;
const LAYER: u32 = 7;
const RELATIONSHIP: u32 = 8;
const VARIANT: u32 = 10;

type Result<T> = std::result::Result<T, String>;

/// Reads a layer, whose values may take `memory` bytes.
pub(super) fn read(bytes: &[u8], memory: u64) -> Result<Layer> {
    let mut file = File::open(bytes, memory)?;
    let mut layer = Layer::default();
    let specs = file.specs()?;
    for (path, fields, kind) in specs {
        let Some(path) = file.paths.get(path as usize).cloned() else {
            return Err("a spec has no path".into());
        };
        let mut spec = Spec::default();
        if kind == LAYER {
            spec.specifier = Specifier::Def;
        }
        if !matches!(kind, ATTRIBUTE | PRIM | LAYER | RELATIONSHIP | VARIANT) {
            continue;
        }
        for (name, value) in file.fields_of(fields as usize, &mut layer)? {
            match (name.as_str(), value) {
                ("specifier", Value::Number(n)) => {
                    spec.specifier = [Specifier::Def, Specifier::Over, Specifier::Class]
                        .get(n as usize)
                        .copied()
                        .unwrap_or_default();
                }
                ("primChildren", value) => spec.children = value.texts().to_vec(),
                ("properties" | "propertyChildren", value) => spec.properties = value.texts().to_vec(),
                (name, value) => {
                    let name = match name {
                        "inheritPaths" => "inherits",
                        "variantSelection" => "variants",
                        "variantSetNames" => "variantSets",
                        "timeSamples" => "samples",
                        "connectionPaths" => "connect",
                        "targetPaths" => "targets",
                        other => other,
                    };
                    spec.fields.insert(name.into(), value);
                }
            }
        }
        layer.specs.insert(path, spec);
    }
    offsets_of_sublayers(&mut layer);
    Ok(layer)
}

/// Puts the offsets of sublayers, which have a field of their own, to the layers that they are of.
fn offsets_of_sublayers(layer: &mut Layer) {
    let Some(head) = layer.specs.get_mut("/") else { return };
    let Some(Value::Texts(files)) = head.fields.get("subLayers") else { return };
    let offsets = head.fields.get("subLayerOffsets").and_then(Value::numbers).unwrap_or_default();
    let items = files.iter().enumerate().map(|(k, file)| Item {
        asset: file.clone(),
        path: String::new(),
        retime: match (offsets.get(2 * k), offsets.get(2 * k + 1)) {
            (Some(&offset), Some(&scale)) => Retime { offset, scale },
            _ => Retime::default(),
        },
    });
    let list = ListOp { explicit: Some(items.collect()), ..ListOp::default() };
    head.fields.insert("subLayers".into(), Value::List(Arc::new(list)));
}

struct File<'b> {
    bytes: &'b [u8],
    version: [u8; 3],
    tokens: Vec<Arc<str>>,
    strings: Vec<u32>,
    /// Name (a token) and value of each field.
    fields: Vec<(u32, u64)>,
    sets: Vec<u32>,
    paths: Vec<String>,
    sections: HashMap<Vec<u8>, usize>,
    /// Values that were read already: many specs share theirs.
    values: HashMap<u64, Option<Value>>,
    /// Bytes of memory left.
    memory: u64,
}

/// A place in the file.
#[derive(Clone, Copy)]
struct Cursor<'b> {
    bytes: &'b [u8],
    at: usize,
}

impl<'b> Cursor<'b> {
    fn take(&mut self, count: usize) -> Result<&'b [u8]> {
        let end = self.at.checked_add(count).ok_or("a length is out of range")?;
        let part = self.bytes.get(self.at..end).ok_or_else(|| {
            format!("{count} bytes are expected at {}, but the file has {}", self.at, self.bytes.len())
        })?;
        self.at = end;
        Ok(part)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N]> {
        self.take(N)?.try_into().map_err(|_| "a value is cut off".to_owned())
    }

    fn u8(&mut self) -> Result<u8> {
        Ok(u8::from_le_bytes(self.array()?))
    }

    fn u32(&mut self) -> Result<u32> {
        Ok(u32::from_le_bytes(self.array()?))
    }

    fn u64(&mut self) -> Result<u64> {
        Ok(u64::from_le_bytes(self.array()?))
    }

    fn f64(&mut self) -> Result<f64> {
        Ok(f64::from_le_bytes(self.array()?))
    }

    /// A number of elements of so many bytes that follow.
    fn count(&mut self, each: usize) -> Result<usize> {
        let count = self.u64()?;
        self.checked(count, each)
    }

    fn checked(&self, count: u64, each: usize) -> Result<usize> {
        let left = self.bytes.len().saturating_sub(self.at) as u64;
        match count.checked_mul(each.max(1) as u64) {
            Some(needed) if needed <= left => Ok(count as usize),
            _ => Err(format!("{count} values are said to be at {}, where {left} bytes are left", self.at)),
        }
    }

    fn u32s(&mut self, count: usize) -> Result<Vec<u32>> {
        let bytes = self.take(count.checked_mul(4).ok_or("a length is out of range")?)?;
        Ok(bytes.chunks_exact(4).map(|c| u32::from_le_bytes([c[0], c[1], c[2], c[3]])).collect())
    }

    /// Destination of a relative offset at this place.
    fn jump(&mut self) -> Result<Self> {
        let from = self.at as i64;
        let offset = i64::from_le_bytes(self.array()?);
        let at = from.checked_add(offset).and_then(|at| usize::try_from(at).ok());
        Ok(Self { at: at.filter(|at| *at <= self.bytes.len()).ok_or("an offset leads out of the file")?, ..*self })
    }
}

/// A value's eight bytes.
#[derive(Clone, Copy)]
struct Rep(u64);

impl Rep {
    fn kind(self) -> u8 {
        (self.0 >> 48) as u8
    }
    fn is_array(self) -> bool {
        self.0 >> 63 != 0
    }
    fn is_inlined(self) -> bool {
        self.0 >> 62 & 1 != 0
    }
    fn is_compressed(self) -> bool {
        self.0 >> 61 & 1 != 0
    }
    fn payload(self) -> u64 {
        self.0 & ((1 << 48) - 1)
    }
}

/// Numbers as they are stored.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Bool,
    U8,
    I32,
    U32,
    I64,
    U64,
    Half,
    Float,
    Double,
}

impl Kind {
    fn size(self) -> usize {
        match self {
            Self::Bool | Self::U8 => 1,
            Self::Half => 2,
            Self::I32 | Self::U32 | Self::Float => 4,
            Self::I64 | Self::U64 | Self::Double => 8,
        }
    }

    fn is_single(self) -> bool {
        matches!(self, Self::Half | Self::Float)
    }

    fn number(self, b: &[u8]) -> f64 {
        let b8: [u8; 8] = std::array::from_fn(|k| b.get(k).copied().unwrap_or(0));
        let b4 = [b8[0], b8[1], b8[2], b8[3]];
        match self {
            Self::Bool | Self::U8 => f64::from(b8[0]),
            Self::I32 => f64::from(i32::from_le_bytes(b4)),
            Self::U32 => f64::from(u32::from_le_bytes(b4)),
            Self::I64 => i64::from_le_bytes(b8) as f64,
            Self::U64 => u64::from_le_bytes(b8) as f64,
            Self::Half => half(u16::from_le_bytes([b8[0], b8[1]])),
            Self::Float => f64::from(f32::from_le_bytes(b4)),
            Self::Double => f64::from_le_bytes(b8),
        }
    }
}

/// A number of IEEE half precision.
fn half(bits: u16) -> f64 {
    let sign = if bits >> 15 == 0 { 1.0 } else { -1.0 };
    let (exponent, fraction) = (i32::from(bits >> 10 & 31), f64::from(bits & 1023));
    sign * match exponent {
        0 => fraction * 2.0_f64.powi(-24),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        _ => (1.0 + fraction / 1024.0) * 2.0_f64.powi(exponent - 15),
    }
}

/// The numbers that a type is made of, and how many; matrices have diagonals where they are inlined.
fn numeric(kind: u8) -> Option<(Kind, usize)> {
    use Kind::{Bool, Double, Float, Half, I32, I64, U8, U32, U64};
    let vectors = [Double, Float, Half, I32];
    Some(match kind {
        1 => (Bool, 1),
        2 => (U8, 1),
        3 => (I32, 1),
        4 => (U32, 1),
        5 => (I64, 1),
        6 => (U64, 1),
        7 => (Half, 1),
        8 => (Float, 1),
        9 | 56 => (Double, 1),
        13 => (Double, 4),
        14 => (Double, 9),
        15 => (Double, 16),
        16..=18 => (*vectors.get(usize::from(kind - 16))?, 4),
        19..=30 => (*vectors.get(usize::from((kind - 19) % 4))?, 2 + usize::from((kind - 19) / 4)),
        _ => return None,
    })
}

const QUATERNIONS: std::ops::RangeInclusive<u8> = 16..=18;
const MATRICES: std::ops::RangeInclusive<u8> = 13..=15;

impl<'b> File<'b> {
    fn open(bytes: &'b [u8], memory: u64) -> Result<Self> {
        let mut at = Cursor { bytes, at: MAGIC.len() };
        let [major, minor, patch, ..] = at.array::<8>()?;
        if major != 0 || !(4..=13).contains(&minor) {
            return Err(format!("binary layers of version {major}.{minor}.{patch} are not read; 0.4 to 0.13 are"));
        }
        let contents = at.u64()?;
        let mut at = Cursor { bytes, at: usize::try_from(contents).map_err(|_| "the table of contents is missing")? };
        let mut sections = HashMap::new();
        for _ in 0..at.count(32)?.min(64) {
            let name: [u8; 16] = at.array()?;
            let (start, _size) = (at.u64()?, at.u64()?);
            let name = name.split(|b| *b == 0).next().unwrap_or_default().to_vec();
            sections.insert(name, usize::try_from(start).map_err(|_| "a section is out of the file")?);
        }
        let mut file = Self {
            bytes,
            version: [major, minor, patch],
            tokens: Vec::new(),
            strings: Vec::new(),
            fields: Vec::new(),
            sets: Vec::new(),
            paths: Vec::new(),
            sections,
            values: HashMap::new(),
            memory,
        };
        file.read_tokens()?;
        if let Some(mut at) = file.section(b"STRINGS") {
            let count = at.count(4)?;
            file.strings = at.u32s(count)?;
        }
        let mut at = file.needed(b"FIELDS")?;
        let count = at.u64()?;
        let names = file.integers(&mut at, count)?;
        let packed = file.packed(&mut at, count.saturating_mul(8))?;
        let values = packed.chunks_exact(8).map(|c| u64::from_le_bytes(std::array::from_fn(|k| c[k])));
        file.fields = names.iter().map(|n| *n as u32).zip(values).collect();
        let mut at = file.needed(b"FIELDSETS")?;
        let count = at.u64()?;
        file.sets = file.integers(&mut at, count)?.into_iter().map(|v| v as u32).collect();
        file.read_paths()?;
        Ok(file)
    }

    fn section(&self, name: &[u8]) -> Option<Cursor<'b>> {
        Some(Cursor { bytes: self.bytes, at: *self.sections.get(name)? })
    }

    fn needed(&self, name: &[u8]) -> Result<Cursor<'b>> {
        self.section(name).ok_or_else(|| format!("the section {} is missing", String::from_utf8_lossy(name)))
    }

    /// Takes memory for what is about to be made.
    fn spend(&mut self, bytes: u64) -> Result<()> {
        match self.memory.checked_sub(bytes) {
            Some(left) => self.memory = left,
            None => return Err("its values unpack to far more than a file of its size holds".into()),
        }
        Ok(())
    }

    /// Compressed bytes after their length.
    fn packed(&mut self, at: &mut Cursor<'b>, size: u64) -> Result<Vec<u8>> {
        self.spend(size)?;
        let length = at.count(1)?;
        let data = at.take(length)?;
        lz4::unpack(data, size as usize).ok_or_else(|| format!("the compressed data before byte {} are damaged", at.at))
    }

    /// Compressed integers of 32 bits.
    fn integers(&mut self, at: &mut Cursor<'b>, count: u64) -> Result<Vec<i64>> {
        self.unpacked_integers(at, count, 4)
    }

    /// Compressed integers of `size` bytes: differences from one to the next, of four lengths.
    fn unpacked_integers(&mut self, at: &mut Cursor<'b>, count: u64, size: usize) -> Result<Vec<i64>> {
        if count == 0 {
            return Ok(Vec::new());
        }
        let codes = count.div_ceil(4);
        let most = count.saturating_mul(size as u64).saturating_add(codes).saturating_add(size as u64);
        self.spend(count.saturating_mul(8))?;
        let data = self.packed(at, most)?;
        let mut at = Cursor { bytes: &data, at: 0 };
        let signed = |at: &mut Cursor<'_>, size: usize| -> Result<i64> {
            let bytes = at.take(size)?;
            let bits = bytes.iter().rev().fold(0_u64, |bits, b| bits << 8 | u64::from(*b));
            let unused = 64 - 8 * size as u32;
            Ok((bits << unused) as i64 >> unused)
        };
        let common = signed(&mut at, size)?;
        let codes = at.take(usize::try_from(codes).map_err(|_| "a length is out of range")?)?;
        let (mut value, mut out) = (0_i64, Vec::with_capacity(count as usize));
        for k in 0..count as usize {
            let code = codes.get(k / 4).copied().unwrap_or(0) >> (2 * (k % 4)) & 3;
            let delta = match code {
                0 => common,
                code => signed(&mut at, (size / 4) << (code - 1))?,
            };
            value = value.wrapping_add(delta);
            out.push(value);
        }
        Ok(out)
    }

    fn read_tokens(&mut self) -> Result<()> {
        let mut at = self.needed(b"TOKENS")?;
        let (count, size) = (at.u64()?, at.u64()?);
        let data = self.packed(&mut at, size)?;
        self.spend(count.min(size).saturating_mul(32))?;
        let text = data.strip_suffix(&[0]).unwrap_or(&data);
        self.tokens = match count {
            0 => Vec::new(),
            _ => text.split(|b| *b == 0).map(|t| String::from_utf8_lossy(t).into()).collect(),
        };
        if self.tokens.len() as u64 != count {
            return Err(format!("{count} tokens are announced, and {} are there", self.tokens.len()));
        }
        Ok(())
    }

    fn token(&self, index: u64) -> Result<&str> {
        let token = usize::try_from(index).ok().and_then(|k| self.tokens.get(k));
        token.map(|t| &**t).ok_or_else(|| format!("there is no token {index}"))
    }

    fn string(&self, index: u32) -> Result<&str> {
        let token = self.strings.get(index as usize).ok_or_else(|| format!("there is no string {index}"))?;
        self.token(u64::from(*token))
    }

    fn path(&self, index: u32) -> Result<&str> {
        self.paths.get(index as usize).map(String::as_str).ok_or_else(|| format!("there is no path {index}"))
    }

    /// Paths, as a tree in which each element names its own and tells where its sibling is.
    fn read_paths(&mut self) -> Result<()> {
        let mut at = self.needed(b"PATHS")?;
        let (total, count) = (at.u64()?, at.u64()?);
        let indices = self.integers(&mut at, count)?;
        let elements = self.integers(&mut at, count)?;
        let jumps = self.integers(&mut at, count)?;
        if total > count {
            return Err(format!("{total} paths are announced, and {count} are there"));
        }
        let mut paths = vec![String::new(); total as usize];
        let mut open = vec![(0_usize, String::new(), 0_usize)];
        let mut steps = 0;
        while let Some((mut index, mut parent, mut depth)) = open.pop() {
            loop {
                steps += 1;
                let (Some(&place), Some(&element), Some(&jump)) =
                    (indices.get(index), elements.get(index), jumps.get(index))
                else {
                    return if count == 0 { Ok(()) } else { Err("the tree of paths is damaged".into()) };
                };
                if steps > count || depth > MOST_NESTED + 2 {
                    return Err(format!("the tree of paths is damaged, or deeper than {MOST_NESTED}"));
                }
                let path = if parent.is_empty() {
                    "/".to_owned()
                } else {
                    let token = self.token(element.unsigned_abs())?;
                    match (element < 0, token.starts_with('{')) {
                        (true, _) => property(&parent, token),
                        (_, true) => format!("{parent}{token}"),
                        _ => join(&parent, token),
                    }
                };
                self.spend(path.len() as u64 + 32)?;
                let Some(slot) = usize::try_from(place).ok().and_then(|k| paths.get_mut(k)) else {
                    return Err(format!("there is no path {place}"));
                };
                slot.clone_from(&path);
                let (has_child, has_sibling) = (jump > 0 || jump == -1, jump >= 0);
                if has_child && has_sibling {
                    open.push((index + jump as usize, parent.clone(), depth));
                }
                if has_child {
                    (parent, depth) = (path, depth + 1);
                } else if !has_sibling {
                    break;
                }
                index += 1;
            }
        }
        self.paths = paths;
        Ok(())
    }

    /// Path, set of fields and kind of each spec.
    fn specs(&mut self) -> Result<Vec<(u32, u32, u32)>> {
        let mut at = self.needed(b"SPECS")?;
        let count = at.u64()?;
        let [paths, sets, kinds] = [0; 3].map(|_| self.integers(&mut at, count));
        let (paths, sets, kinds) = (paths?, sets?, kinds?);
        Ok(paths.into_iter().zip(sets).zip(kinds).map(|((p, s), k)| (p as u32, s as u32, k as u32)).collect())
    }

    /// Names and values of a set of fields.
    fn fields_of(&mut self, start: usize, layer: &mut Layer) -> Result<Vec<(String, Value)>> {
        let mut out = Vec::new();
        for k in start.. {
            let Some(&field) = self.sets.get(k).filter(|f| **f != u32::MAX) else { break };
            let Some(&(name, rep)) = self.fields.get(field as usize) else {
                return Err(format!("there is no field {field}"));
            };
            let name = self.token(u64::from(name))?.to_owned();
            self.spend(64 + name.len() as u64)?;
            match self.value(Rep(rep), 0).map_err(|why| format!("the field '{name}': {why}"))? {
                Some(value) => out.push((name, value)),
                None if !layer.unknown_types.contains(&Rep(rep).kind()) => layer.unknown_types.push(Rep(rep).kind()),
                None => {}
            }
        }
        Ok(out)
    }

    // Values.

    /// A value; `None` of types that are not read.
    fn value(&mut self, rep: Rep, depth: usize) -> Result<Option<Value>> {
        if depth > MOST_NESTED {
            return Err(format!("values are nested deeper than {MOST_NESTED}"));
        }
        let value = match self.values.get(&rep.0) {
            Some(known) => return self.shared(known.clone()),
            None => self.decoded(rep, depth)?,
        };
        let value = self.shared(value)?;
        if !rep.is_inlined() {
            self.spend(64)?;
            self.values.insert(rep.0, value.clone());
        }
        Ok(value)
    }

    /// A value once more: lists share their memory, texts do not.
    fn shared(&mut self, value: Option<Value>) -> Result<Option<Value>> {
        if let Some(Value::Text(text) | Value::Asset(text)) = &value {
            self.spend(text.len() as u64)?;
        }
        Ok(value)
    }

    fn cursor(&self, rep: Rep) -> Result<Cursor<'b>> {
        let at = usize::try_from(rep.payload()).ok().filter(|at| *at < self.bytes.len());
        Ok(Cursor { bytes: self.bytes, at: at.ok_or("a value is out of the file")? })
    }

    fn decoded(&mut self, rep: Rep, depth: usize) -> Result<Option<Value>> {
        if let Some((kind, width)) = numeric(rep.kind()) {
            return if rep.is_array() { self.numbers(rep, kind, width) } else { self.tuple(rep, kind, width) }
                .map(Some);
        }
        let inlined = rep.payload() & 0xffff_ffff;
        Ok(Some(match rep.kind() {
            10..=12 if rep.is_array() => self.texts(rep)?,
            10 | 57 => Value::Text(self.string(self.index(rep)?)?.to_owned()),
            11 => Value::Text(self.token(u64::from(self.index(rep)?))?.to_owned()),
            12 if rep.is_inlined() => Value::Asset(self.token(inlined)?.to_owned()),
            12 => Value::Asset(self.string(self.index(rep)?)?.to_owned()),
            31 if rep.is_inlined() => Value::Dictionary(Arc::default()),
            31 => {
                let mut at = self.cursor(rep)?;
                Value::Dictionary(Arc::new(self.dictionary(&mut at, depth)?))
            }
            32 => self.list(rep, |file, at| named(file.token(u64::from(at.u32()?))?))?,
            33 => self.list(rep, |file, at| named(file.string(at.u32()?)?))?,
            34 => self.list(rep, |file, at| named(file.path(at.u32()?)?))?,
            35 => self.list(rep, |file, at| file.reference(at, true, depth))?,
            47 => {
                let mut at = self.cursor(rep)?;
                let item = self.reference(&mut at, false, depth)?;
                Value::List(Arc::new(ListOp { explicit: Some(vec![item]), ..ListOp::default() }))
            }
            55 => self.list(rep, |file, at| file.reference(at, false, depth))?,
            40 => self.indexed(rep, |file, k| file.path(k))?,
            41 => self.indexed(rep, |file, k| file.token(u64::from(k)))?,
            50 => self.indexed(rep, |file, k| file.string(k))?,
            42..=44 => Value::Number(inlined as f64),
            45 => self.selections(rep)?,
            46 => self.samples(rep, depth)?,
            48 => self.numbers(rep, Kind::Double, 1)?,
            49 => {
                let mut at = self.cursor(rep)?;
                let count = at.count(16)?;
                self.spend(count as u64 * 16)?;
                Value::Numbers((0..2 * count).map(|_| at.f64()).collect::<Result<_>>()?)
            }
            51 | 58 => Value::Block,
            _ => return Ok(None),
        }))
    }

    fn index(&self, rep: Rep) -> Result<u32> {
        if rep.is_inlined() { Ok(rep.payload() as u32) } else { self.cursor(rep)?.u32() }
    }

    fn tuple(&mut self, rep: Rep, kind: Kind, width: usize) -> Result<Value> {
        let matrix = MATRICES.contains(&rep.kind());
        let mut numbers = if !rep.is_inlined() {
            let bytes = self.cursor(rep)?.take(width * kind.size())?;
            bytes.chunks_exact(kind.size()).map(|c| kind.number(c)).collect::<Vec<_>>()
        } else {
            let bytes = rep.payload().to_le_bytes();
            match (width, kind) {
                (1, Kind::Double) => vec![Kind::Float.number(&bytes)],
                (1, Kind::I64) => vec![Kind::I32.number(&bytes)],
                (1, Kind::U64) => vec![Kind::U32.number(&bytes)],
                (1, _) => vec![kind.number(&bytes)],
                (2, Kind::Half) => vec![kind.number(&bytes), kind.number(&bytes[2..])],
                _ if matrix => {
                    let side = if width == 4 { 2 } else { usize::from(rep.kind()) - 11 };
                    let cell = |k: usize| {
                        if k.is_multiple_of(side + 1) { f64::from(bytes[k / (side + 1)] as i8) } else { 0.0 }
                    };
                    (0..width).map(cell).collect()
                }
                _ => bytes.iter().take(width).map(|b| f64::from(*b as i8)).collect(),
            }
        };
        if width == 1 {
            let number = numbers.first().copied().unwrap_or(0.0);
            return Ok(if kind == Kind::Bool { Value::Bool(number != 0.0) } else { Value::Number(number) });
        }
        if QUATERNIONS.contains(&rep.kind()) {
            // In text, and here, the real part is first.
            numbers.rotate_right(1);
        }
        Ok(match kind.is_single() {
            true => Value::Floats(numbers.into_iter().map(|v| v as f32).collect()),
            false => Value::Numbers(numbers.into()),
        })
    }

    /// The start of an array, and the number of its elements.
    fn array(&self, rep: Rep) -> Result<Option<(Cursor<'b>, u64)>> {
        if rep.payload() == 0 {
            return Ok(None);
        }
        let mut at = self.cursor(rep)?;
        if self.version < [0, 5, 0] {
            at.u32()?;
        }
        let count = if self.version < [0, 7, 0] { u64::from(at.u32()?) } else { at.u64()? };
        Ok((count > 0).then_some((at, count)))
    }

    fn numbers(&mut self, rep: Rep, kind: Kind, width: usize) -> Result<Value> {
        let empty = || if kind.is_single() { Value::Floats(Arc::default()) } else { Value::Numbers(Arc::default()) };
        // Vectors of doubles have a plain count.
        let array = match rep.kind() {
            48 => {
                let mut at = self.cursor(rep)?;
                let count = at.u64()?;
                (count > 0).then_some((at, count))
            }
            _ => self.array(rep)?,
        };
        let Some((mut at, count)) = array else { return Ok(empty()) };
        if rep.is_compressed() && count >= 4 && width == 1 {
            return self.compressed(&mut at, count, kind);
        }
        let bytes = kind.size() * width;
        let count = at.checked(count, bytes)?;
        let data = at.take(count * bytes)?;
        self.spend((count * width) as u64 * if kind.is_single() { 4 } else { 8 })?;
        let numbers = data.chunks_exact(kind.size()).map(|c| kind.number(c));
        Ok(match kind.is_single() {
            true => {
                let mut numbers: Vec<f32> = numbers.map(|v| v as f32).collect();
                if QUATERNIONS.contains(&rep.kind()) {
                    numbers.chunks_exact_mut(4).for_each(|q| q.rotate_right(1));
                }
                Value::Floats(numbers.into())
            }
            false => {
                let mut numbers: Vec<f64> = numbers.collect();
                if QUATERNIONS.contains(&rep.kind()) {
                    numbers.chunks_exact_mut(4).for_each(|q| q.rotate_right(1));
                }
                Value::Numbers(numbers.into())
            }
        })
    }

    fn compressed(&mut self, at: &mut Cursor<'b>, count: u64, kind: Kind) -> Result<Value> {
        let size = kind.size();
        let made = |numbers: &mut dyn Iterator<Item = f64>| match kind.is_single() {
            true => Value::Floats(numbers.map(|v| v as f32).collect()),
            false => Value::Numbers(numbers.collect()),
        };
        if !matches!(kind, Kind::Half | Kind::Float | Kind::Double) {
            self.spend(count.saturating_mul(8))?;
            let integers = self.unpacked_integers(at, count, size)?;
            let unsigned = matches!(kind, Kind::U32);
            return Ok(made(&mut integers.into_iter().map(|v| {
                if unsigned {
                    f64::from(v as u32)
                } else if size == 4 {
                    f64::from(v as i32)
                } else {
                    v as f64
                }
            })));
        }
        self.spend(count.saturating_mul(8))?;
        match at.u8()? {
            b'i' => {
                let integers = self.integers(at, count)?;
                Ok(made(&mut integers.into_iter().map(|v| f64::from(v as i32))))
            }
            b't' => {
                let length = u64::from(at.u32()?);
                let length = at.checked(length, size)?;
                let table: Vec<f64> = at.take(length * size)?.chunks_exact(size).map(|c| kind.number(c)).collect();
                let indices = self.integers(at, count)?;
                if indices.iter().any(|k| *k as u32 as usize >= table.len()) {
                    return Err("a compressed list of numbers is damaged".into());
                }
                Ok(made(&mut indices.iter().filter_map(|k| table.get(*k as u32 as usize).copied())))
            }
            code => Err(format!("numbers are compressed in a way ({code}) that is not known")),
        }
    }

    fn texts(&mut self, rep: Rep) -> Result<Value> {
        let Some((mut at, count)) = self.array(rep)? else { return Ok(Value::Texts(Arc::default())) };
        let count = at.checked(count, 4)?;
        let mut out = Vec::with_capacity(count);
        for index in at.u32s(count)? {
            let text = if rep.kind() == 11 { self.token(u64::from(index))? } else { self.string(index)? }.to_owned();
            self.spend(24 + text.len() as u64)?;
            out.push(text);
        }
        Ok(Value::Texts(out.into()))
    }

    fn indexed(&mut self, rep: Rep, text: impl Fn(&Self, u32) -> Result<&str>) -> Result<Value> {
        let mut at = self.cursor(rep)?;
        let count = at.count(4)?;
        let mut out = Vec::with_capacity(count);
        for index in at.u32s(count)? {
            let text = text(self, index)?.to_owned();
            self.spend(24 + text.len() as u64)?;
            out.push(text);
        }
        Ok(Value::Texts(out.into()))
    }

    fn list(&mut self, rep: Rep, item: impl Fn(&mut Self, &mut Cursor<'b>) -> Result<Item>) -> Result<Value> {
        let mut at = self.cursor(rep)?;
        let bits = at.u8()?;
        let mut items = |file: &mut Self, bit: u8| -> Result<Vec<Item>> {
            if bits >> bit & 1 == 0 {
                return Ok(Vec::new());
            }
            let count = at.count(4)?;
            let mut out = Vec::new();
            for _ in 0..count {
                let item = item(file, &mut at)?;
                file.spend((size_of::<Item>() + item.asset.len() + item.path.len()) as u64)?;
                out.push(item);
            }
            Ok(out)
        };
        let explicit = items(self, 1)?;
        let added = items(self, 2)?;
        let prepended = items(self, 5)?;
        let mut appended = items(self, 6)?;
        let deleted = items(self, 3)?;
        appended.extend(added);
        let explicit = (bits & 1 != 0).then_some(explicit);
        Ok(Value::List(Arc::new(ListOp { explicit, prepended, appended, deleted })))
    }

    /// A reference or a payload, which has no dictionary, and had no offset before version 0.8.
    fn reference(&mut self, at: &mut Cursor<'b>, has_data: bool, depth: usize) -> Result<Item> {
        let asset = self.string(at.u32()?)?.to_owned();
        let path = self.path(at.u32()?)?.to_owned();
        let has_offset = has_data || self.version >= [0, 8, 0];
        let retime = if has_offset { Retime { offset: at.f64()?, scale: at.f64()? } } else { Retime::default() };
        if has_data {
            self.dictionary(at, depth)?;
        }
        Ok(Item { asset, path, retime })
    }

    fn dictionary(&mut self, at: &mut Cursor<'b>, depth: usize) -> Result<BTreeMap<String, Value>> {
        let count = at.count(12)?;
        let mut out = BTreeMap::new();
        for _ in 0..count {
            let key = self.string(at.u32()?)?.to_owned();
            let mut there = at.jump()?;
            let rep = Rep(there.u64()?);
            self.spend(64 + key.len() as u64)?;
            if let Some(value) = self.value(rep, depth + 1)? {
                out.insert(key, value);
            }
            // The next entry is behind the value's eight bytes.
            *at = there;
        }
        Ok(out)
    }

    fn selections(&mut self, rep: Rep) -> Result<Value> {
        let mut at = self.cursor(rep)?;
        let mut out = BTreeMap::new();
        for _ in 0..at.count(8)? {
            let (set, variant) = (self.string(at.u32()?)?.to_owned(), self.string(at.u32()?)?.to_owned());
            self.spend(96 + (set.len() + variant.len()) as u64)?;
            out.insert(set, Value::Text(variant));
        }
        Ok(Value::Dictionary(Arc::new(out)))
    }

    fn samples(&mut self, rep: Rep, depth: usize) -> Result<Value> {
        let mut at = self.cursor(rep)?.jump()?;
        let times = Rep(at.u64()?);
        if !(times.kind() == 48 || times.kind() == 9 && times.is_array()) {
            return Err("the times of samples are of another type than numbers".into());
        }
        let times = self.value(times, depth + 1)?.unwrap_or(Value::Block);
        let times = times.numbers().unwrap_or_default().into_owned();
        let mut at = at.jump()?;
        let count = at.count(8)?;
        if count != times.len() {
            return Err(format!("there are {} times of {count} samples", times.len()));
        }
        let mut out = Vec::with_capacity(count);
        for time in times {
            let rep = Rep(at.u64()?);
            self.spend(64)?;
            if let Some(value) = self.value(rep, depth + 1)? {
                out.push((time, value));
            }
        }
        out.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(Value::Samples(out.into()))
    }
}

fn named(path: &str) -> Result<Item> {
    Ok(Item { path: path.to_owned(), ..Item::default() })
}
