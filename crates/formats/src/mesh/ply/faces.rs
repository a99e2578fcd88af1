//! The elements `face` and `tristrips`.

use super::{
    PlyOptions,
    cursor::{Cursor, Lists, Stored},
    header::{Element, Encoding, Type},
    layout::attributes,
    vertices::is_finite,
    wedges,
};
use crate::mesh::{MeshError, MeshErrorKind as Kind, polygon::Triangulator};
use steradian_scene::{Attribute, Domain, Mesh};

/// The property that lists the corners.
fn corner_list(element: &Element, cursor: &Cursor<'_>) -> Result<usize, MeshError> {
    let is_corners = |name: &str| matches!(name, "vertex_indices" | "vertex_index");
    element.properties.iter().position(|p| p.length.is_some() && is_corners(&p.name)).ok_or_else(|| {
        let message = format!("element '{}' has no list 'vertex_indices' or 'vertex_index'", element.name);
        cursor.fault(Kind::Missing, element.offset, message)
    })
}

#[cold]
fn out_of_range(cursor: &Cursor<'_>, at: usize, name: &str, face: usize, index: i64, count: usize) -> MeshError {
    let message = format!("{name} {face} refers to vertex {index}, but there are {count} vertices (0 is the first)");
    cursor.fault(Kind::IndexOutOfRange, at, message)
}

/// Reads the faces of a mesh whose vertices are known. Lists of less than three corners are no surface and are passed
/// over. Faces at vertices that are not finite are left out; gives how many.
pub(super) fn read(
    cursor: &mut Cursor<'_>,
    element: &Element,
    mesh: &mut Mesh,
    options: &PlyOptions,
    has_bad_vertices: bool,
) -> Result<usize, MeshError> {
    let list = corner_list(element, cursor)?;
    let p = &element.properties[list];
    let layouts = attributes(element, &[]);
    let triangle_bytes = match (cursor.encoding, p.length) {
        (Encoding::Ascii, _) => 8,
        (_, length) => length.map_or(0, Type::size) + 3 * p.item.size(),
    };
    mesh.triangles.reserve(element.count.min(cursor.left() / triangle_bytes));

    let is_32_bit = |t: Type| matches!(t, Type::I32 | Type::U32);
    let mut index = 0;
    if element.properties.len() == 1 && is_32_bit(p.item) {
        index = match (p.length, cursor.encoding) {
            (Some(Type::U8 | Type::I8), Encoding::Little) => packed::<1, false>(cursor, element, mesh),
            (Some(Type::U8 | Type::I8), Encoding::Big) => packed::<1, true>(cursor, element, mesh),
            (Some(t), Encoding::Little) if is_32_bit(t) => packed::<4, false>(cursor, element, mesh),
            (Some(t), Encoding::Big) if is_32_bit(t) => packed::<4, true>(cursor, element, mesh),
            _ => 0,
        };
    }
    let mut left_out = if has_bad_vertices { leave_out_bad(mesh) } else { 0 };
    if index < element.count {
        left_out += general(cursor, element, list, index, &layouts, mesh, options)?;
    }
    Ok(left_out)
}

/// Leaves out the triangles at vertices that are not finite, of a mesh without data for each face; gives how many.
pub(super) fn leave_out_bad(mesh: &mut Mesh) -> usize {
    let before = mesh.triangles.len();
    let positions = &mesh.positions;
    mesh.triangles.retain(|t| t.iter().all(|&i| is_finite(&positions[i as usize])));
    before - mesh.triangles.len()
}

/// The usual layout: records of a length (`L` bytes) and 32-bit indices. Reads triangles up to the first face that is
/// something else, or faulty, and returns its number.
fn packed<const L: usize, const BIG: bool>(cursor: &mut Cursor<'_>, element: &Element, mesh: &mut Mesh) -> usize {
    let count = u32::try_from(mesh.positions.len()).unwrap_or(u32::MAX);
    let size = L + 12;
    let mut done = 0;
    let triangles = &mut *mesh.triangles;
    for record in cursor.bytes[cursor.at..].chunks_exact(size).take(element.count) {
        let word = |at: usize| u32::get(record, at, BIG);
        let corners = if L == 1 { u32::from(record[0]) } else { word(0) };
        let triangle = [word(L), word(L + 4), word(L + 8)];
        if corners != 3 || triangle.iter().any(|&i| i >= count) {
            break;
        }
        triangles.push(triangle);
        done += 1;
    }
    cursor.at += done * size;
    done
}

/// Any layout, from face `first` on.
fn general(
    cursor: &mut Cursor<'_>,
    element: &Element,
    list: usize,
    first: usize,
    layouts: &[super::layout::AttributeLayout],
    mesh: &mut Mesh,
    options: &PlyOptions,
) -> Result<usize, MeshError> {
    let count = mesh.positions.len();
    let mut row = vec![0.0_f32; element.properties.len()];
    let uv_slot = options.corner_uvs.then(|| wedges::slot(element)).flatten();
    let mut lists = Lists { corner_slot: Some(list), uv_slot, ..Lists::default() };
    let (mut corners, mut left_out) = (Vec::new(), 0);
    let mut wedges = uv_slot.map(|_| wedges::Wedges::new(mesh));
    let mut cutter = Triangulator::default();
    // Values of triangles and of patches apart, for they are numbered one after the other.
    let mut data: Vec<[Vec<f32>; 2]> = vec![[Vec::new(), Vec::new()]; layouts.len()];
    for face in first..element.count {
        let at = cursor.at;
        cursor.record(element, face, &mut row, &mut lists)?;
        corners.clear();
        for &i in &lists.corners {
            match u32::try_from(i) {
                Ok(v) if (v as usize) < count => corners.push(v),
                _ => return Err(out_of_range(cursor, at, &element.name, face, i, count)),
            }
        }
        if !corners.iter().all(|&v| is_finite(&mesh.positions[v as usize])) {
            left_out += 1;
            continue;
        }
        if let Some(wedges) = &mut wedges {
            wedges.split(mesh, &mut corners, &lists.uvs);
        }
        let (triangles, patches) = (mesh.triangles.len(), mesh.patches.len());
        match *corners.as_slice() {
            [a, b, c] => mesh.triangles.push([a, b, c]),
            [a, b, c, d] if options.keep_quads => mesh.patches.push([a, b, d, c]),
            _ => {
                let position = |k: usize| mesh.positions[corners[k] as usize];
                let emit = |t: [usize; 3]| mesh.triangles.push(t.map(|k| corners[k]));
                cutter.cut(corners.len(), position, emit).map_err(|_| {
                    let message = format!("face {face}: a concave polygon of {} corners is too complex", corners.len());
                    cursor.fault(Kind::TooLarge, at, message)
                })?;
            }
        }
        let made = [mesh.triangles.len() - triangles, mesh.patches.len() - patches];
        for (values, layout) in data.iter_mut().zip(layouts) {
            for (values, made) in values.iter_mut().zip(made) {
                for _ in 0..made {
                    values.extend(layout.slots.iter().map(|&(s, scale)| scale.apply(row[s])));
                }
            }
        }
    }
    for (layout, [mut values, patches]) in layouts.iter().zip(data) {
        values.extend(patches);
        let (name, channels) = (layout.name.clone(), layout.slots.len());
        mesh.attributes.push(Attribute { name, domain: Domain::Face, channels, data: values });
    }
    Ok(left_out)
}

/// Reads triangle strips: each corner after the second makes a triangle with the two before it, every other one turned;
/// −1 starts anew. Only for files that have no faces.
pub(super) fn read_strips(cursor: &mut Cursor<'_>, element: &Element, mesh: &mut Mesh) -> Result<(), MeshError> {
    let list = corner_list(element, cursor)?;
    let count = mesh.positions.len();
    let mut row = vec![0.0_f32; element.properties.len()];
    let mut lists = Lists { corner_slot: Some(list), ..Lists::default() };
    for strip in 0..element.count {
        let at = cursor.at;
        cursor.record(element, strip, &mut row, &mut lists)?;
        let (mut last, mut length) = ([0u32; 2], 0usize);
        for &i in &lists.corners {
            if i == -1 {
                length = 0;
                continue;
            }
            let v = match u32::try_from(i) {
                Ok(v) if (v as usize) < count => v,
                _ => return Err(out_of_range(cursor, at, &element.name, strip, i, count)),
            };
            if length >= 2 {
                let [a, b] = last;
                let triangle = if length % 2 == 0 { [a, b, v] } else { [b, a, v] };
                // Strips turn corners with triangles of no area.
                if a != b && b != v && a != v {
                    mesh.triangles.push(triangle);
                }
            }
            last = [last[1], v];
            length += 1;
        }
    }
    Ok(())
}
