//! The element `vertex`.

use super::{
    PlyFile,
    cursor::{Cursor, Lists, Real, Stored, stored},
    header::{Element, Encoding, Type},
    layout::{AttributeLayout, Scale, VertexLayout},
};
use crate::mesh::{MeshError, MeshErrorKind as Kind, recentre};
use steradian_scene::{Attribute, Domain, Mesh};

/// Reads all vertices into a mesh without faces; with `recentre` moved near the origin where the first is far from it.
/// The count has been checked against the bytes left.
pub(super) fn read(cursor: &mut Cursor<'_>, element: &Element, recentre: bool) -> Result<PlyFile, MeshError> {
    let layout = VertexLayout::new(element).map_err(|name| {
        cursor.fault(Kind::Missing, element.offset, format!("element 'vertex' has no property '{name}'"))
    })?;
    let start = cursor.at;
    let origin = if recentre { origin(cursor.clone(), element, &layout) } else { [0.0; 3] };
    let mut mesh = match element.fixed_record(cursor.encoding) {
        Some(size) => {
            // The product cannot overflow: it was held against the length of the file.
            let block = &cursor.bytes[start..start + size * element.count];
            cursor.at += block.len();
            columns(block, size, element, &layout, (cursor.encoding == Encoding::Big, origin))
        }
        None if origin == [0.0; 3] => rows(cursor, element, &layout, |v: f32, _| v, |v| v)?,
        None => rows(cursor, element, &layout, |v: f64, axis| (v - origin[axis]) as f32, |v| v as f32)?,
    };
    let bad_normals = leave_out_bad(&mut mesh.normals);
    let bad_uvs = leave_out_bad(&mut mesh.uvs);
    Ok(PlyFile { mesh, bad_normals, bad_uvs, origin, ..PlyFile::default() })
}

/// Offset subtracted from all positions, found from the first vertex, where the file has more digits than single
/// precision. Faults of its record are left to the next reader of it.
fn origin(mut cursor: Cursor<'_>, element: &Element, layout: &VertexLayout) -> [f64; 3] {
    let is_wide = |slot: &usize| matches!(element.properties[*slot].item, Type::F64 | Type::I32 | Type::U32);
    if element.count == 0 || cursor.encoding != Encoding::Ascii && !layout.position.iter().any(is_wide) {
        return [0.0; 3];
    }
    let mut row = vec![0.0_f64; element.properties.len()];
    match cursor.record(element, 0, &mut row, &mut Lists::default()) {
        Ok(()) => recentre::origin(layout.position.map(|slot| row[slot])),
        Err(_) => [0.0; 3],
    }
}

/// Replaces values that are not finite by zero, and counts them.
fn leave_out_bad<const N: usize>(values: &mut [[f32; N]]) -> usize {
    let bad = values.iter_mut().filter(|v| !is_finite(&v[..]));
    bad.map(|v| *v = [0.0; N]).count()
}

/// True if all numbers are finite.
pub(super) fn is_finite(values: &[f32]) -> bool {
    values.iter().fold(true, |ok, v| ok & v.is_finite())
}

/// Binary records of one size: each quantity is gathered in a loop of its own, made for its type.
fn columns(
    block: &[u8],
    size: usize,
    element: &Element,
    layout: &VertexLayout,
    (big, origin): (bool, [f64; 3]),
) -> Mesh {
    let mut offsets = Vec::with_capacity(element.properties.len());
    let mut at = 0;
    for p in &element.properties {
        offsets.push((at, p.item));
        at += p.item.size();
    }
    let table = Table { block, size, big, offsets };
    let mut uvs = layout.uv.map_or_else(Vec::new, |slots| table.gather(slots));
    for channel in 0..2 {
        if layout.uv_scale[channel] != Scale::Plain {
            uvs.iter_mut().for_each(|uv: &mut [f32; 2]| uv[channel] = layout.uv_scale[channel].apply(uv[channel]));
        }
    }
    Mesh {
        positions: match origin {
            [0.0, 0.0, 0.0] => table.gather(layout.position),
            _ => table.moved(layout.position, origin),
        },
        normals: layout.normal.map_or_else(Vec::new, |slots| table.gather(slots)),
        uvs,
        attributes: layout.attributes.iter().map(|a| table.attribute(a)).collect(),
        ..Mesh::default()
    }
}

/// Binary records of one size.
struct Table<'a> {
    block: &'a [u8],
    size: usize,
    big: bool,
    /// Offset in the record and type of each property.
    offsets: Vec<(usize, Type)>,
}

impl Table<'_> {
    /// `N` properties of every record.
    fn gather<const N: usize>(&self, slots: [usize; N]) -> Vec<[f32; N]> {
        let fields = slots.map(|s| self.offsets[s]);
        let t = fields[0].1;
        if fields.iter().any(|f| f.1 != t) {
            let mut out = vec![[0.0; N]; self.block.len() / self.size];
            for (k, slot) in slots.into_iter().enumerate() {
                let column = self.gather([slot]);
                out.iter_mut().zip(column).for_each(|(o, [v])| o[k] = v);
            }
            return out;
        }
        let at = fields.map(|f| f.0);
        match t {
            Type::I8 => self.typed::<i8, N>(at),
            Type::U8 => self.typed::<u8, N>(at),
            Type::I16 => self.typed::<i16, N>(at),
            Type::U16 => self.typed::<u16, N>(at),
            Type::I32 => self.typed::<i32, N>(at),
            Type::U32 => self.typed::<u32, N>(at),
            Type::F32 => self.typed::<f32, N>(at),
            Type::F64 => self.typed::<f64, N>(at),
        }
    }

    /// Three properties of every record, less an origin in double precision.
    fn moved(&self, slots: [usize; 3], origin: [f64; 3]) -> Vec<[f32; 3]> {
        let fields = slots.map(|s| self.offsets[s]);
        let coordinate = |record: &[u8], axis: usize| {
            let (at, t) = fields[axis];
            (stored::<f64>(t, record, at, self.big) - origin[axis]) as f32
        };
        self.block.chunks_exact(self.size).map(|r| std::array::from_fn(|axis| coordinate(r, axis))).collect()
    }

    fn typed<T: Stored, const N: usize>(&self, at: [usize; N]) -> Vec<[f32; N]> {
        let (width, first) = (size_of::<T>(), at[0]);
        let records = self.block.chunks_exact(self.size);
        if at.iter().enumerate().all(|(k, &a)| a == first + k * width) {
            // Neighbours: one bounds check per record.
            let pick = |r: &[u8], big| {
                let fields = &r[first..first + N * width];
                std::array::from_fn(|k| T::get(fields, k * width, big).f32())
            };
            return if self.big {
                records.map(|r| pick(r, true)).collect()
            } else {
                records.map(|r| pick(r, false)).collect()
            };
        }
        records.map(|r| at.map(|a| T::get(r, a, self.big).f32())).collect()
    }

    fn attribute(&self, layout: &AttributeLayout) -> Attribute {
        let slots: Vec<usize> = layout.slots.iter().map(|s| s.0).collect();
        let mut data = match *slots.as_slice() {
            [a] => self.gather([a]).into_flattened(),
            [a, b] => self.gather([a, b]).into_flattened(),
            [a, b, c] => self.gather([a, b, c]).into_flattened(),
            [a, b, c, d, ..] => self.gather([a, b, c, d]).into_flattened(),
            [] => Vec::new(),
        };
        for values in data.chunks_exact_mut(slots.len().max(1)) {
            values.iter_mut().zip(&layout.slots).for_each(|(v, s)| *v = s.1.apply(*v));
        }
        Attribute { name: layout.name.clone(), domain: Domain::Vertex, channels: slots.len(), data }
    }
}

/// Text, or records that hold lists: value by value, in a precision of which `position` makes the coordinates of the
/// three axes, and `single` all else.
fn rows<R: Real + Default>(
    cursor: &mut Cursor<'_>,
    element: &Element,
    layout: &VertexLayout,
    position: impl Fn(R, usize) -> f32,
    single: impl Fn(R) -> f32,
) -> Result<Mesh, MeshError> {
    let count = element.count;
    let mut mesh = Mesh { positions: Vec::with_capacity(count), ..Mesh::default() };
    mesh.normals.reserve_exact(if layout.normal.is_some() { count } else { 0 });
    mesh.uvs.reserve_exact(if layout.uv.is_some() { count } else { 0 });
    let attribute = |a: &AttributeLayout| Attribute {
        name: a.name.clone(),
        domain: Domain::Vertex,
        channels: a.slots.len(),
        data: Vec::with_capacity(count * a.slots.len()),
    };
    mesh.attributes = layout.attributes.iter().map(attribute).collect();
    let mut row = vec![R::default(); element.properties.len()];
    let mut unused = Lists::default();
    for index in 0..count {
        cursor.record(element, index, &mut row, &mut unused)?;
        mesh.positions.push(std::array::from_fn(|axis| position(row[layout.position[axis]], axis)));
        let value = |slot: usize| single(row[slot]);
        if let Some(slots) = layout.normal {
            mesh.normals.push(slots.map(value));
        }
        if let Some([u, v]) = layout.uv {
            mesh.uvs.push([layout.uv_scale[0].apply(value(u)), layout.uv_scale[1].apply(value(v))]);
        }
        for (a, l) in mesh.attributes.iter_mut().zip(&layout.attributes) {
            a.data.extend(l.slots.iter().map(|&(s, scale)| scale.apply(value(s))));
        }
    }
    Ok(mesh)
}
