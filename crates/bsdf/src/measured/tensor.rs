//! Tensor files: named arrays of numbers, the container of the RGL material database (`.bsdf`) and of polarimetric data
//! (`.pbsdf`).
//!
//! Layout (little endian): `tensor_file\0`, version 1.0 as two bytes, `u32` number of fields; for each field `u16`
//! length of the name, the name, `u16` number of dimensions, `u8` type, `u64` offset of the data from the start of the
//! file, and a `u64` per dimension. The last dimension varies fastest. (Dupuy and Jakob 2018, as documented with the
//! database.)

use super::MeasuredError;
use std::collections::HashMap;

/// Most fields and dimensions that are believed.
const MAX_FIELDS: u32 = 256;
const MAX_DIMENSIONS: u16 = 16;

/// One array.
#[derive(Clone, Debug)]
pub struct Tensor<'a> {
    /// Sizes, slowest first.
    pub shape: Vec<usize>,
    kind: u8,
    bytes: &'a [u8],
}

/// The arrays of a file by name.
#[derive(Clone, Debug)]
pub struct TensorFile<'a> {
    fields: HashMap<String, Tensor<'a>>,
}

/// Reads numbers off the front of bytes.
struct Cursor<'a>(&'a [u8]);

impl<'a> Cursor<'a> {
    fn take(&mut self, n: usize) -> Result<&'a [u8], MeasuredError> {
        let (head, rest) = self.0.split_at_checked(n).ok_or(MeasuredError::Truncated)?;
        self.0 = rest;
        Ok(head)
    }

    fn number<const N: usize>(&mut self) -> Result<u64, MeasuredError> {
        // Little endian, folded from the highest byte down.
        Ok(self.take(N)?.iter().rev().fold(0, |v, b| v << 8 | u64::from(*b)))
    }
}

/// Bytes of one number of a type; types are numbered as in the files.
fn width(kind: u8) -> Option<usize> {
    // u8 i8, u16 i16, u32 i32, u64 i64, f16 f32 f64.
    [1, 1, 2, 2, 4, 4, 8, 8, 2, 4, 8].get(usize::from(kind).checked_sub(1)?).copied()
}

impl<'a> TensorFile<'a> {
    /// True if bytes begin as a tensor file does.
    pub fn is(bytes: &[u8]) -> bool {
        bytes.starts_with(b"tensor_file\0")
    }

    /// The directory of a file; every array is held against the bytes there are.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn read(bytes: &'a [u8]) -> Result<Self, MeasuredError> {
        if !Self::is(bytes) {
            return Err(MeasuredError::NotThis("a tensor file"));
        }
        // The header: version and number of fields.
        let mut c = Cursor(&bytes[12..]);
        if c.take(2)? != [1, 0] {
            return Err(MeasuredError::Fault("its version is not 1.0".into()));
        }
        let count = c.number::<4>()? as u32;
        if count > MAX_FIELDS {
            return Err(MeasuredError::Fault(format!("it claims {count} fields")));
        }
        let mut fields = HashMap::new();
        for _ in 0..count {
            // A field's name, dimensions, type and place in the file.
            let n = c.number::<2>()? as usize;
            let name = String::from_utf8_lossy(c.take(n)?).into_owned();
            let dimensions = c.number::<2>()? as u16;
            let kind = c.take(1)?[0];
            let offset = c.number::<8>()?;
            if dimensions > MAX_DIMENSIONS {
                return Err(MeasuredError::Fault(format!("field '{name}' claims {dimensions} dimensions")));
            }
            let shape: Result<Vec<u64>, _> = (0..dimensions).map(|_| c.number::<8>()).collect();
            let shape = shape?;
            let width =
                width(kind).ok_or_else(|| MeasuredError::Fault(format!("field '{name}' has an unknown type")))?;
            // Size in bytes, against overflow and the end of the file.
            let size = shape.iter().try_fold(width as u64, |n, s| n.checked_mul(*s));
            let end = size.and_then(|n| n.checked_add(offset)).filter(|e| *e <= bytes.len() as u64);
            let Some(end) = end else {
                return Err(MeasuredError::Fault(format!("field '{name}' reaches beyond the end of the file")));
            };
            let shape = shape.iter().map(|s| *s as usize).collect();
            fields.insert(name, Tensor { shape, kind, bytes: &bytes[offset as usize..end as usize] });
        }
        Ok(Self { fields })
    }

    /// A field that may be missing.
    pub fn get(&self, name: &str) -> Option<&Tensor<'a>> {
        self.fields.get(name)
    }

    /// A field of so many dimensions, none of them empty.
    ///
    /// # Errors
    /// Where it is missing or of another shape.
    pub fn need(&self, name: &str, dimensions: usize) -> Result<&Tensor<'a>, MeasuredError> {
        let t = self.get(name).ok_or_else(|| MeasuredError::Fault(format!("it lacks the field '{name}'")))?;
        if t.shape.len() != dimensions || t.shape.contains(&0) {
            return Err(MeasuredError::Fault(format!("field '{name}' has the shape {:?}", t.shape)));
        }
        Ok(t)
    }
}

impl Tensor<'_> {
    /// The numbers, whatever they are.
    ///
    /// # Errors
    /// Another type.
    pub fn numbers(&self, name: &str) -> Result<Vec<f32>, MeasuredError> {
        // Convert the types that occur to single precision.
        Ok(match self.kind {
            10 => self.bytes.as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b)).collect(),
            11 => self.bytes.as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b) as f32).collect(),
            3 => self.bytes.as_chunks::<2>().0.iter().map(|b| f32::from(u16::from_le_bytes(*b))).collect(),
            1 => self.bytes.iter().map(|b| f32::from(*b)).collect(),
            _ => return Err(MeasuredError::Fault(format!("field '{name}' is not of a type that is read here"))),
        })
    }

    /// The numbers, which must be finite floats.
    ///
    /// # Errors
    /// Another type, or numbers that are not finite.
    pub fn floats(&self, name: &str) -> Result<Vec<f32>, MeasuredError> {
        let values = self.numbers(name)?;
        if values.iter().any(|v| !v.is_finite()) {
            return Err(MeasuredError::Fault(format!("field '{name}' has values that are not finite")));
        }
        Ok(values)
    }

    /// The numbers, which must increase.
    ///
    /// # Errors
    /// As [`Tensor::floats`], or numbers out of order.
    pub fn axis(&self, name: &str) -> Result<Vec<f32>, MeasuredError> {
        let values = self.floats(name)?;
        if values.windows(2).any(|w| w[0] >= w[1]) {
            return Err(MeasuredError::Fault(format!("the values of '{name}' do not increase")));
        }
        Ok(values)
    }
}

/// Writing tensor files.
pub mod write {
    /// A field of a file: name, sizes, values, and whether they are stored as bytes rather than `f32`.
    pub type Field<'a> = (&'a str, Vec<usize>, Vec<f32>, bool);

    /// A file of some fields.
    pub fn file(fields: &[Field<'_>]) -> Vec<u8> {
        let mut out = b"tensor_file\0\x01\x00".to_vec();
        out.extend((fields.len() as u32).to_le_bytes());
        // Data follow the directory, whose size is known beforehand.
        let head: usize = fields.iter().map(|f| 2 + f.0.len() + 2 + 1 + 8 + 8 * f.1.len()).sum();
        let mut offset = out.len() + head;
        for (name, shape, values, byte) in fields {
            out.extend((name.len() as u16).to_le_bytes());
            out.extend(name.as_bytes());
            out.extend((shape.len() as u16).to_le_bytes());
            out.push(if *byte { 1 } else { 10 });
            out.extend((offset as u64).to_le_bytes());
            shape.iter().for_each(|s| out.extend((*s as u64).to_le_bytes()));
            offset += values.len() * if *byte { 1 } else { 4 };
        }
        for (_, _, values, byte) in fields {
            for v in values {
                if *byte {
                    out.push(*v as u8);
                } else {
                    out.extend(v.to_le_bytes());
                }
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hostile_files_are_refused() {
        let good = write::file(&[("x", vec![2, 3], vec![1.0; 6], false), ("flag", vec![1], vec![1.0], true)]);
        let read = TensorFile::read(&good).expect("sound");
        assert_eq!(read.need("x", 2).and_then(|t| t.floats("x")), Ok(vec![1.0; 6]));
        assert!(read.need("x", 1).is_err() && read.need("y", 2).is_err());
        for n in 0..good.len() {
            assert!(TensorFile::read(&good[..n]).is_err(), "cut to {n}");
        }
        let with = |at: usize, bytes: &[u8]| {
            let mut bad = good.clone();
            bad[at..at + bytes.len()].copy_from_slice(bytes);
            TensorFile::read(&bad).and_then(|f| f.need("x", 2).and_then(|t| t.floats("x"))).err()
        };
        // The head: 12 bytes of name, 2 of version, 4 of count; then the first field's 2 + 1 of name, 2, 1, 8 and
        // sizes.
        assert!(with(14, &1_000_000_000u32.to_le_bytes()).is_some(), "10⁹ fields");
        assert!(with(18, &u16::MAX.to_le_bytes()).is_some(), "a long name");
        assert!(with(21, &u16::MAX.to_le_bytes()).is_some(), "many dimensions");
        assert!(with(23, &[99]).is_some(), "a type that does not exist");
        assert!(with(24, &u64::MAX.to_le_bytes()).is_some(), "data beyond the end");
        for size in [1_000_000_000u64, u64::MAX, 0] {
            assert!(with(32, &size.to_le_bytes()).is_some(), "{size} rows");
        }
        let data = good.len() - 25;
        assert!(with(data, &f32::NAN.to_le_bytes()).is_some_and(|e| e.to_string().contains("not finite")));
    }
}
