//! From the output of a mesh group to assembled primitives.

use super::{
    output::{MeshOutput, MeshPrimitive},
    stages::MeshShader,
};
use crate::{front::Sink, stages::Vertex, state::Provoking, varyings::Varyings};

/// Hands the primitives of a checked output on in order, and gives how many the shader dropped.
pub(super) fn feed<M: MeshShader>(
    out: &MeshOutput<M::Vertex, M::Primitive, M::Corners>,
    provoking: Provoking,
    sink: &mut impl Sink<M::Varyings>,
) -> u64 {
    let mut culled = 0;
    for primitive in out.primitives.iter().flatten() {
        if primitive.culled {
            culled += 1;
            continue;
        }
        // Corners are joined with the primitive's attributes one by one: vertices are shared, varyings are not.
        let corner = |number: &u8| corner::<M>(out, primitive, *number);
        let last = |count: usize| if provoking == Provoking::First { 0 } else { count - 1 };
        match primitive.corners.as_ref() {
            [a] => {
                let Some(a) = corner(a) else { continue };
                sink.point(&a, primitive.id);
            }
            [a, b] => {
                let (Some(a), Some(b)) = (corner(a), corner(b)) else { continue };
                sink.line([&a, &b], last(2), primitive.id);
            }
            [a, b, c] => {
                let (Some(a), Some(b), Some(c)) = (corner(a), corner(b), corner(c)) else { continue };
                sink.triangle([&a, &b, &c], last(3), primitive.id);
            }
            _ => {}
        }
    }
    culled
}

#[inline]
fn corner<M: MeshShader>(
    out: &MeshOutput<M::Vertex, M::Primitive, M::Corners>,
    primitive: &MeshPrimitive<M::Primitive, M::Corners>,
    number: u8,
) -> Option<Vertex<M::Varyings>> {
    // Varyings join what the vertex has with what the primitive has.
    let vertex = out.vertices.get(usize::from(number))?.as_ref()?;
    Some(Vertex {
        position: vertex.position,
        varyings: M::varyings(&vertex.attributes, &primitive.attributes),
        point_size: vertex.point_size,
        layer: primitive.layer,
        viewport: primitive.viewport,
    })
}

/// Takes primitives and keeps nothing.
pub(super) struct Count;

impl<V: Varyings> Sink<V> for Count {
    fn point(&mut self, _: &Vertex<V>, _: u32) {}
    fn line(&mut self, _: [&Vertex<V>; 2], _: usize, _: u32) {}
    fn triangle(&mut self, _: [&Vertex<V>; 3], _: usize, _: u32) {}
}
