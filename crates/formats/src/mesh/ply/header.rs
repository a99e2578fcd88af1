//! The header of a PLY file: elements and their properties.

use crate::mesh::{
    MeshError, MeshErrorKind as Kind,
    text::{integer, shown, trim, words},
};

/// Storage format of the data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    Little,
    Big,
}

impl Encoding {
    /// `Err` says which there are.
    fn named(name: &[u8]) -> Result<Self, String> {
        match name {
            b"ascii" => Ok(Self::Ascii),
            b"binary_little_endian" => Ok(Self::Little),
            b"binary_big_endian" => Ok(Self::Big),
            other => Err(format!(
                "unknown format '{}' (known: ascii, binary_little_endian, binary_big_endian)",
                shown(other)
            )),
        }
    }
}

/// Type of a stored number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Type {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Type {
    fn named(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    /// Bytes of a binary value.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// The largest value of an integer type, which stands for one where the number means a fraction.
    pub(super) fn integer_max(self) -> Option<f32> {
        match self {
            Self::I8 => Some(f32::from(i8::MAX)),
            Self::U8 => Some(f32::from(u8::MAX)),
            Self::I16 => Some(f32::from(i16::MAX)),
            Self::U16 => Some(f32::from(u16::MAX)),
            Self::I32 => Some(i32::MAX as f32),
            Self::U32 => Some(u32::MAX as f32),
            Self::F32 | Self::F64 => None,
        }
    }
}

/// A property: one number, or a list that starts with its length.
#[derive(Clone, Debug)]
pub(super) struct Property {
    pub(super) name: String,
    /// Type of the length of a list; `None` for a single number.
    pub(super) length: Option<Type>,
    /// Type of the number, or of the items.
    pub(super) item: Type,
}

/// An element: a table with one record per row.
#[derive(Clone, Debug)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: usize,
    pub(super) properties: Vec<Property>,
    /// Offset of its declaration in the header.
    pub(super) offset: usize,
}

impl Element {
    /// The fewest bytes a record can take: lists may be empty; a number in text takes a digit and a separator.
    fn least_record(&self, encoding: Encoding) -> usize {
        match encoding {
            Encoding::Ascii => 2 * self.properties.len(),
            _ => self.properties.iter().map(|p| p.length.unwrap_or(p.item).size()).sum(),
        }
    }

    /// Size in bytes of every record, where all are of one size.
    pub(super) fn fixed_record(&self, encoding: Encoding) -> Option<usize> {
        let fixed = encoding != Encoding::Ascii && self.properties.iter().all(|p| p.length.is_none());
        fixed.then(|| self.least_record(encoding))
    }
}

/// More properties than any real element has; a hostile header must not cost more than it is long.
const MOST_PROPERTIES: usize = 1000;

/// Header of a PLY file, before the data.
#[derive(Clone, Debug)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// Offset of the first byte of data.
    pub(super) data: usize,
    /// Pictures that comments `TextureFile NAME` name, as MeshLab and photogrammetry write them.
    pub(super) pictures: Vec<String>,
}

impl Header {
    /// Refuses an element that declares more records than the bytes left can hold.
    pub(super) fn check_count(&self, bytes: &[u8], element: &Element, bytes_left: usize) -> Result<(), MeshError> {
        let least = element.least_record(self.encoding);
        // The last number of a text may lack its separator.
        let room = bytes_left + usize::from(self.encoding == Encoding::Ascii);
        if least > 0 && element.count.checked_mul(least).is_none_or(|need| need > room) {
            return Err(MeshError::in_text(
                Kind::Truncated,
                bytes,
                element.offset,
                format!(
                    "element '{}' declares {} records of at least {least} bytes, but only {bytes_left} bytes are left",
                    element.name, element.count
                ),
            ));
        }
        Ok(())
    }
}

/// The next line and where the one after it starts. Lines end in LF or CR LF, or in CR alone where `cr_only`.
fn line(bytes: &[u8], at: usize, cr_only: bool) -> Option<(&[u8], usize)> {
    let terminator = if cr_only { b'\r' } else { b'\n' };
    let length = bytes.get(at..)?.iter().position(|&b| b == terminator)?;
    Some((&bytes[at..at + length], at + length + 1))
}

/// The name after a word of a comment: the rest of the line, for it may hold spaces.
fn picture(text: &[u8], word: &[u8]) -> String {
    let comment = trim(&trim(text)[b"comment".len()..]);
    String::from_utf8_lossy(trim(&comment[word.len()..])).into_owned()
}

/// Reads the header.
pub(super) fn parse(bytes: &[u8]) -> Result<Header, MeshError> {
    let fault = |kind, at, message: String| MeshError::in_text(kind, bytes, at, message);
    let text_fault = |at, message: String| fault(Kind::Syntax, at, message);
    if !bytes.starts_with(b"ply") || !bytes.get(3).is_some_and(u8::is_ascii_whitespace) {
        return Err(text_fault(0, "this is not a PLY file: it does not start with 'ply'".into()));
    }
    let mut ends = bytes.iter().copied().filter(|b| matches!(b, b'\r' | b'\n'));
    let cr_only = ends.next() == Some(b'\r') && ends.next() != Some(b'\n');

    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    let mut pictures = Vec::new();
    let mut at = 0;
    let mut first = true;
    loop {
        let start = at;
        let Some((text, next)) = line(bytes, at, cr_only) else {
            return Err(fault(Kind::Truncated, bytes.len(), "the header has no 'end_header' line".into()));
        };
        at = next;
        if std::mem::take(&mut first) {
            continue;
        }
        let parts: Vec<&[u8]> = words(trim(text)).take(6).collect();
        match parts.as_slice() {
            [b"comment", word, _, ..] if word.eq_ignore_ascii_case(b"TextureFile") => {
                pictures.push(picture(text, word));
            }
            [] | [b"comment" | b"obj_info", ..] => {}
            [b"format", name, b"1.0"] => {
                encoding = Some(Encoding::named(name).map_err(|message| text_fault(start, message))?);
            }
            [b"format", ..] => {
                return Err(fault(
                    Kind::Unsupported,
                    start,
                    format!("'{}': only version 1.0 of PLY is read", shown(trim(text))),
                ));
            }
            [b"element", name, count] => {
                let count = integer(count).and_then(|c| usize::try_from(c).ok()).ok_or_else(|| {
                    text_fault(start, format!("element '{}': '{}' is not a count", shown(name), shown(count)))
                })?;
                let name = String::from_utf8_lossy(name).into_owned();
                elements.push(Element { name, count, properties: Vec::new(), offset: start });
            }
            [b"property", rest @ ..] => {
                let (length, item, name) = match rest {
                    [b"list", length, item, name] => (Some(*length), *item, *name),
                    [item, name] => (None, *item, *name),
                    _ => return Err(text_fault(start, format!("'{}' is not a property", shown(trim(text))))),
                };
                let typed = |word: &[u8]| {
                    Type::named(word).ok_or_else(|| {
                        let message = format!(
                            "property '{}': unknown type '{}' (known: char, uchar, short, ushort, int, uint, float, double and int8 … float64)",
                            shown(name),
                            shown(word)
                        );
                        fault(Kind::Unsupported, start, message)
                    })
                };
                let length = length.map(typed).transpose()?;
                if matches!(length, Some(Type::F32 | Type::F64)) {
                    return Err(text_fault(
                        start,
                        format!("property '{}': the length of a list must be an integer", shown(name)),
                    ));
                }
                let property =
                    Property { name: String::from_utf8_lossy(name).into_owned(), length, item: typed(item)? };
                match elements.last_mut() {
                    Some(e) if e.properties.len() == MOST_PROPERTIES => {
                        let message = format!("element '{}' has more than {MOST_PROPERTIES} properties", e.name);
                        return Err(fault(Kind::TooLarge, start, message));
                    }
                    Some(e) => e.properties.push(property),
                    None => {
                        return Err(text_fault(
                            start,
                            format!("property '{}' stands before any element", property.name),
                        ));
                    }
                }
            }
            [b"end_header"] => break,
            [word, ..] => return Err(text_fault(start, format!("unknown keyword '{}' in the header", shown(word)))),
        }
    }
    let encoding = encoding.ok_or_else(|| fault(Kind::Missing, at, "the header has no 'format' line".into()))?;
    Ok(Header { encoding, elements, data: at, pictures })
}
