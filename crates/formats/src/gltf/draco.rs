//! Primitives packed by `KHR_draco_mesh_compression` (Khronos registry, ratified): a Draco mesh whose attributes stand
//! in for the data of the primitive's accessors.

use super::{
    Reader,
    accessor::{Component, Decoded, View},
    container::Bytes,
    json::At,
};
use crate::limits::unpacked;
use draco_core::{DataType, DecodeLimits, DecoderBuffer, Mesh, MeshDecoder, PointIndex};

pub(super) const NAME: &str = "KHR_draco_mesh_compression";

/// Most bytes of attributes for a packed one. Meshes of few bits reach 50; a flat grid packs better.
const MOST: u64 = 512;
/// Bytes of attributes that all primitives of any file may have together.
const ALWAYS: u64 = 1 << 30;
/// The mode of triangle strips.
const STRIP: u64 = 5;

impl Reader<'_> {
    /// Unpacks a primitive's data into `self.decoded`, for its accessors. `None`, reported, where that cannot be had.
    pub(super) fn unpack_draco(&mut self, root: &At<'_>, primitive: &At<'_>) -> Option<()> {
        self.decoded.clear();
        let Some(at) = primitive.extension(NAME) else { return Some(()) };
        let (packed, _) = self.buffer_view(root, &at, "bufferView")?;
        if primitive.get("indices").is_none() {
            self.error(&at, "packed triangles need an accessor of 'indices' in their primitive");
            return None;
        }
        let (order, accessor) = self.index(root, primitive, "indices", "accessors")?;
        let mesh = match decode(packed.as_slice()) {
            Ok(mesh) => mesh,
            Err(why) => {
                self.error(&at, format!("the Draco data cannot be unpacked: {why}"));
                return None;
            }
        };
        // Strips are packed as triangles too.
        if primitive.value["mode"] != STRIP {
            self.check_count(&accessor, 3 * mesh.num_faces())?;
        }
        let bytes: Vec<u8> = mesh.faces().iter().flatten().flat_map(|corner| corner.0.to_le_bytes()).collect();
        let view = View { bytes: Bytes::whole(bytes), stride: 4 };
        self.decoded.insert(order, Decoded { component: Component::U32, count: 3 * mesh.num_faces(), view });
        let there: usize = self.buffers.iter().flatten().map(|b| b.as_slice().len()).sum();
        let most = ALWAYS.max(there as u64 * MOST);
        if self.decoded_bytes > most {
            self.error(&at, format!("the Draco data of all primitives together are more than {most} bytes"));
            return None;
        }
        let (ids, attributes) = (at.get("attributes"), primitive.get("attributes"));
        let (Some(ids), Some(attributes)) = (ids.filter(|i| i.value.is_object()), attributes) else {
            self.error(&at, "packed data need 'attributes'");
            return None;
        };
        for (name, id) in ids.value.as_object().into_iter().flatten() {
            if attributes.get(name).is_none() {
                continue;
            }
            let (number, accessor) = self.index(root, &attributes, name, "accessors")?;
            let id = id.as_u64().and_then(|id| u32::try_from(id).ok());
            match id.ok_or_else(|| "is no number".to_owned()).and_then(|id| values(&mesh, id)) {
                Ok((component, channels, bytes)) => {
                    self.check_count(&accessor, mesh.num_points())?;
                    let stride = channels * component.size();
                    if component.channels_of(&accessor) != Some(channels) {
                        self.error(
                            &accessor,
                            format!("'{name}' has {channels} numbers a vertex in the Draco data, of another type"),
                        );
                        return None;
                    }
                    self.decoded_bytes += bytes.len() as u64;
                    let view = View { bytes: Bytes::whole(bytes), stride };
                    self.decoded.insert(number, Decoded { component, count: mesh.num_points(), view });
                }
                Err(why) => {
                    self.error(&at, format!("the Draco attribute of '{name}' {why}"));
                    return None;
                }
            }
        }
        Some(())
    }

    fn check_count(&mut self, accessor: &At<'_>, found: usize) -> Option<()> {
        if accessor.value["count"].as_u64() == Some(found as u64) {
            return Some(());
        }
        self.error(accessor, format!("its 'count' is not that of the Draco data, which is {found}"));
        None
    }
}

fn decode(packed: &[u8]) -> Result<Mesh, String> {
    let most = unpacked(packed.len(), MOST);
    let limits =
        DecodeLimits::default().with_max_decoded_bytes(most).with_max_points(most / 4).with_max_faces(most / 12);
    let mut mesh = Mesh::new();
    MeshDecoder::new()
        .decode(&mut DecoderBuffer::new(packed).with_limits(limits), &mut mesh)
        .map_err(|e| e.to_string())?;
    Ok(mesh)
}

/// The type, the number of channels and the bytes of an attribute, vertex by vertex.
fn values(mesh: &Mesh, id: u32) -> Result<(Component, usize, Vec<u8>), String> {
    let attribute = mesh.attribute_by_unique_id(id).ok_or_else(|| format!("({id}) is not in the data"))?;
    let component = match attribute.data_type() {
        DataType::Int8 => Component::I8,
        DataType::Uint8 => Component::U8,
        DataType::Int16 => Component::I16,
        DataType::Uint16 => Component::U16,
        DataType::Uint32 => Component::U32,
        DataType::Float32 => Component::F32,
        other => return Err(format!("has values of type {other:?}, which accessors do not have")),
    };
    let channels = usize::from(attribute.num_components());
    let element = channels * component.size();
    let stride = usize::try_from(attribute.byte_stride()).unwrap_or(0);
    let data = attribute.buffer().data();
    let mut bytes = Vec::with_capacity(mesh.num_points() * element);
    for point in 0..mesh.num_points() {
        let index = attribute.mapped_index(PointIndex(point as u32)).0 as usize;
        let start = index.checked_mul(stride);
        let value = start.and_then(|start| data.get(start..start.checked_add(element)?));
        bytes.extend_from_slice(value.ok_or("is cut off")?);
    }
    Ok((component, channels, bytes))
}
