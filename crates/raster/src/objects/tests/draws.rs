//! Attributes and indices as draws find them bound.

use super::{assert_refused, context};
use crate::{
    AttributeFormat, ComponentType, Components, Conversion, VertexInput,
    glam::Vec4,
    objects::{Contents, Context, Elements, IndexType, Usage, VertexBuffer},
};

/// A vertex array of a byte by vertex (0), one by two instances (1), and one that is not enabled (2), of bytes that are
/// their numbers; indices 2, 1, 0 of 16 bits from byte 1 on.
fn prepared() -> Context {
    let mut c = context();
    let (array, names) = (c.create_vertex_arrays(1).unwrap()[0], c.create_buffers(2).unwrap());
    c.buffer_data(names[0], Contents::Bytes(&(0..32).collect::<Vec<u8>>()), Usage::StaticDraw).unwrap();
    c.buffer_data(names[1], Contents::Bytes(&[9, 2, 0, 1, 0, 0, 0]), Usage::StaticDraw).unwrap();
    let format =
        AttributeFormat { component: ComponentType::U8, components: Components::One, conversion: Conversion::Float };
    for (binding, offset) in [(0, 0), (1, 10)] {
        c.vertex_array_vertex_buffer(array, binding, VertexBuffer { buffer: names[0], offset, stride: 3 }).unwrap();
        c.vertex_array_attrib_format(array, binding, format, 1).unwrap();
        c.enable_vertex_array_attrib(array, binding).unwrap();
    }
    c.vertex_array_binding_divisor(array, 1, 2).unwrap();
    c.vertex_array_element_buffer(array, names[1]).unwrap();
    c.vertex_attrib(2, Vec4::splat(7.0)).unwrap();
    c.bind_vertex_array(array).unwrap();
    c
}

#[test]
fn attributes_follow_vertices_instances_and_constants() {
    let mut c = prepared();
    // The element of an instance is ⌊(instance − first) / divisor⌋ + first (section 10.3.4).
    c.draw_arrays(0..3, 4..9, |inputs, _| {
        let at = |number: usize, vertex: u32, instance: u32| {
            inputs.attribute(number, VertexInput { vertex, instance, draw: 0 }).x
        };
        assert_eq!([0, 1, 2].map(|vertex| at(0, vertex, 4)), [1.0, 4.0, 7.0]);
        assert_eq!([4, 5, 6, 7, 8].map(|instance| at(1, 2, instance)), [23.0, 23.0, 26.0, 26.0, 29.0]);
        assert_eq!((at(2, 0, 4), at(3, 0, 4)), (7.0, 0.0));
        Ok(())
    })
    .unwrap();
}

/// The formats that each call does not take (table 10.3, section 10.3.2), with their codes; the array stays as it is.
#[test]
fn attributes_refuse_what_their_call_does_not_take() {
    use ComponentType::*;
    use Components::*;
    use Conversion::{Float, Integer, Long, Normalized};
    const CALL: &str = "vertex_array_attrib_format";
    let mut c = prepared();
    let mut set = |component, components, conversion, offset| {
        c.vertex_array_attrib_format(1, 0, AttributeFormat { component, components, conversion }, offset)
    };
    for (component, components, conversion, words) in [
        (F32, Two, Integer, ["F32 components are no integers", "INVALID_ENUM"]),
        (Fixed, One, Integer, ["Fixed components are no integers", "INVALID_ENUM"]),
        (Uint2_10_10_10, Four, Integer, ["are no integers", "INVALID_ENUM"]),
        (F32, Four, Long, ["F32 components are no doubles", "INVALID_ENUM"]),
        (I32, Four, Long, ["I32 components are no doubles", "INVALID_ENUM"]),
        (Int2_10_10_10, Three, Float, ["has four components", "INVALID_OPERATION"]),
        (Float10_11_11, Four, Float, ["has three components", "INVALID_OPERATION"]),
        (I8, Bgra, Normalized, ["is not for Bgra", "INVALID_OPERATION"]),
        (U8, Bgra, Float, ["is normalised in Bgra", "INVALID_OPERATION"]),
    ] {
        assert_refused(set(component, components, conversion, 0), CALL, words);
    }
    assert_refused(set(F64, Four, Long, 2048), CALL, ["2048; at most 2047", "INVALID_VALUE"]);
    c.draw_arrays(0..1, 0..1, |inputs, _| {
        assert_eq!(inputs.attribute(0, VertexInput { vertex: 1, instance: 0, draw: 0 }).x, 4.0);
        Ok(())
    })
    .unwrap();
    // Bytes 1 to 8 as a double.
    let double = AttributeFormat { component: F64, components: One, conversion: Long };
    c.vertex_array_attrib_format(1, 0, double, 1).unwrap();
    c.draw_arrays(0..1, 0..1, |inputs, _| {
        let value = inputs.attribute_double(0, VertexInput { vertex: 0, instance: 0, draw: 0 }).x;
        assert_eq!(value.to_le_bytes(), [1, 2, 3, 4, 5, 6, 7, 8]);
        Ok(())
    })
    .unwrap();
}

#[test]
fn indices_are_read_from_the_byte_of_their_offset() {
    use crate::{Fragment, Pipeline, Program, State, Vertex, fragment, state::Topology};
    use std::sync::Mutex;
    let mut c = prepared();
    let mut shaded = |elements: Elements| {
        let vertices = Mutex::new(Vec::new());
        c.draw_elements(elements, 0..1, |_, output| {
            let vertex = |v: VertexInput| {
                vertices.lock().unwrap().push(v.vertex);
                Vertex::new(Vec4::W, ())
            };
            let program = Program::new(vertex, fragment(|_: &Fragment<()>| Vec4::ONE));
            let state = State { topology: Topology::Points, ..State::default() };
            output.draw(&Pipeline::new(program, state, output.layout())?).map(drop)
        })?;
        crate::Result::Ok(vertices.into_inner().unwrap())
    };
    let elements = Elements { count: 3, index: IndexType::U16, offset: 1, base_vertex: 0 };
    assert_eq!(shaded(elements).unwrap(), [2, 1, 0]);
    assert_eq!(shaded(Elements { base_vertex: 5, ..elements }).unwrap(), [7, 6, 5]);
    assert_eq!(shaded(Elements { count: 2, index: IndexType::U8, offset: 0, ..elements }).unwrap(), [9, 2]);
    let long = Elements { count: 1, index: IndexType::U32, offset: 3, ..elements };
    assert_eq!(shaded(long).unwrap(), [1]);
    let beyond = shaded(Elements { count: 4, ..elements });
    assert_refused(beyond, "draw_elements", ["the buffer has 7", "INVALID_VALUE"]);
    let beyond = shaded(Elements { count: usize::MAX, ..elements });
    assert_refused(beyond, "draw_elements", ["indices", "INVALID_VALUE"]);
}
