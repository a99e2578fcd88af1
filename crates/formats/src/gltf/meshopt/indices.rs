//! Triangles (appendix A, mode 1) and other indices (mode 2).

use super::{Stream, unzigzag};

/// The last 16 values, the newest first.
struct Recent<T> {
    values: [T; 16],
    pushed: usize,
}

impl<T: Copy + Default> Recent<T> {
    fn new() -> Self {
        Self { values: [T::default(); 16], pushed: 0 }
    }

    fn push(&mut self, value: T) {
        self.values[self.pushed % 16] = value;
        self.pushed += 1;
    }

    fn get(&self, back: u8) -> Result<T, String> {
        let at = self.pushed.checked_sub(1 + usize::from(back));
        at.map(|at| self.values[at % 16])
            .ok_or_else(|| "the packed triangles refer to what was not there before".into())
    }
}

/// The state of the decoder of triangles.
struct Triangles<'a> {
    data: Stream<'a>,
    next: u32,
    last: u32,
    edges: Recent<[u32; 2]>,
    vertices: Recent<u32>,
}

impl Triangles<'_> {
    fn fresh(&mut self) -> u32 {
        let fresh = self.next;
        self.next = fresh.wrapping_add(1);
        fresh
    }

    /// An index by its difference from the last such one.
    fn free(&mut self) -> Result<u32, String> {
        self.last = self.last.wrapping_add(unzigzag(self.data.number()?));
        Ok(self.last)
    }

    /// A new vertex, or one of the last.
    fn fresh_or_recent(&mut self, which: u8) -> Result<u32, String> {
        if which == 0 { Ok(self.fresh()) } else { self.vertices.get(which - 1) }
    }

    fn triangle(&mut self, code: u8, table: &[u8]) -> Result<[u32; 3], String> {
        let (high, low) = (code >> 4, code & 15);
        if high < 15 {
            let [a, b] = self.edges.get(high)?;
            let c = match low {
                0 => self.fresh(),
                1..=12 => self.vertices.get(low)?,
                13 | 14 => {
                    self.last = if low == 13 { self.last.wrapping_sub(1) } else { self.last.wrapping_add(1) };
                    self.last
                }
                _ => self.free()?,
            };
            self.edges.push([c, b]);
            self.edges.push([a, c]);
            if !(1..=12).contains(&low) {
                self.vertices.push(c);
            }
            return Ok([a, b, c]);
        }
        let is_explicit = low >= 14;
        let pair = if is_explicit { self.data.byte()? } else { table[usize::from(low)] };
        if is_explicit && pair == 0 {
            self.next = 0;
        }
        let (second, third) = (pair >> 4, pair & 15);
        // Nibbles of 15 stand for free indices, which the table does not hold.
        let a = if low == 15 { None } else { Some(self.fresh()) };
        let b = if second == 15 { None } else { Some(self.fresh_or_recent(second)?) };
        let c = if third == 15 { None } else { Some(self.fresh_or_recent(third)?) };
        let a = a.map_or_else(|| self.free(), Ok)?;
        let b = b.map_or_else(|| self.free(), Ok)?;
        let c = c.map_or_else(|| self.free(), Ok)?;
        for edge in [[b, a], [c, b], [a, c]] {
            self.edges.push(edge);
        }
        self.vertices.push(a);
        for (index, kind) in [(b, second), (c, third)] {
            if matches!(kind, 0 | 15) {
                self.vertices.push(index);
            }
        }
        Ok([a, b, c])
    }
}

/// `count` indices of triangles, of two or four bytes each.
pub(super) fn unpack_triangles(packed: &[u8], count: usize, stride: usize) -> Result<Vec<u8>, String> {
    let mut stream = Stream { left: packed };
    head(&mut stream, 0xe1)?;
    let codes = stream.take(count / 3)?;
    let data = stream.left.len().checked_sub(16).ok_or("the packed data ends early")?;
    let (data, table) = stream.left.split_at(data);
    if table.iter().any(|b| b >> 4 == 15 || b & 15 == 15) || table[14..] != [0; 2] {
        return Err("the table at the end of the packed triangles is not one".into());
    }
    let data = Stream { left: data };
    let mut state = Triangles { data, next: 0, last: 0, edges: Recent::new(), vertices: Recent::new() };
    let mut out = Vec::with_capacity(codes.len() * 3 * stride);
    for code in codes {
        for index in state.triangle(*code, table)? {
            out.extend_from_slice(&index.to_le_bytes()[..stride]);
        }
    }
    state.data.finish()?;
    Ok(out)
}

/// `count` indices of any use, of two or four bytes each.
pub(super) fn unpack_sequence(packed: &[u8], count: usize, stride: usize) -> Result<Vec<u8>, String> {
    let mut stream = Stream { left: packed };
    head(&mut stream, 0xd1)?;
    let data = stream.left.len().checked_sub(4).filter(|data| *data >= count).ok_or("the packed data ends early")?;
    let mut stream = Stream { left: &stream.left[..data] };
    let mut last = [0u32; 2];
    let mut out = Vec::with_capacity(count * stride);
    for _ in 0..count {
        let number = stream.number()?;
        let base = &mut last[(number & 1) as usize];
        *base = base.wrapping_add(unzigzag(number >> 1));
        out.extend_from_slice(&base.to_le_bytes()[..stride]);
    }
    stream.finish()?;
    Ok(out)
}

fn head(stream: &mut Stream<'_>, wanted: u8) -> Result<(), String> {
    let found = stream.byte()?;
    if found == wanted {
        Ok(())
    } else {
        Err(format!("the packed data begin with the byte 0x{wanted:02x}, not 0x{found:02x}"))
    }
}
