//! Draw calls against their expansion into single draws (M187).

use super::{assert_refused, context};
use crate::{
    AttributeFormat, ComponentType, Components, Conversion, Counters, Fragment, Pipeline, Program, Result, State,
    Vertex, VertexInput, fragment,
    glam::{Vec2, Vec4},
    objects::{
        BufferFlags, BufferTarget, Contents, Context, Elements, IndexType, Indirect, Inputs, Output, Usage,
        VertexBuffer,
    },
    varyings,
};

varyings! { struct Colored { color: Vec4, } }

const OP: &str = "INVALID_OPERATION";
const VALUE: &str = "INVALID_VALUE";

/// Parameters of three draws of arrays, 20 bytes apart from byte 8 on: 6 vertices from 3 on, 3 instances from 1 on; no
/// vertices; 9 from 0 on, 2 instances from 4 on. Then the number 2.
const ARRAYS: [u32; 18] = [99, 99, 6, 3, 3, 1, 99, 0, 7, 0, 0, 99, 9, 2, 0, 4, 2, 5];
/// Parameters of two draws of elements without a gap, from byte 4 on: 6 indices from the fourth on, 2 instances from 3
/// on, 5 added to each; 3 from 0 on, 1 instance, 1 taken away.
const ELEMENTS: [u32; 11] = [99, 6, 2, 4, 5, 3, 3, 1, 0, u32::MAX, 0];
const INDICES: [u16; 12] = [2, 5, 1, 9, 0, 3, 8, 7, 4, 10, 11, 6];

/// Triangles that overlap, moved by instance: positions and colours of vertices, and offsets that two instances share.
/// Buffers: 1 vertices, 2 offsets, 3 indices, 4 parameters.
fn prepared(parameters: &[u32]) -> Context {
    let mut c = context();
    let (array, names) = (c.create_vertex_arrays(1).unwrap()[0], c.create_buffers(4).unwrap());
    let mut seed = 1u32;
    let mut random = || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 8) as f32 / (1 << 24) as f32
    };
    let mut bytes = Vec::new();
    for _ in 0..18 {
        bytes.extend([1.6 * random() - 1.0, 1.6 * random() - 1.0].map(f32::to_le_bytes).concat());
        bytes.extend([random(), random(), random(), 1.0].map(|x| (255.0 * x) as u8));
    }
    let offsets: Vec<u8> = (0..8).flat_map(|i| [0.1 * i as f32, 0.05 * i as f32]).flat_map(f32::to_le_bytes).collect();
    let indices = INDICES.map(u16::to_le_bytes).concat();
    let parameters: Vec<u8> = parameters.iter().flat_map(|word| word.to_le_bytes()).collect();
    for (name, bytes) in names.iter().zip([&bytes, &offsets, &indices, &parameters]) {
        c.buffer_data(*name, Contents::Bytes(bytes), Usage::StaticDraw).unwrap();
    }
    let floats = AttributeFormat::floats(Components::Two);
    let (component, components) = (ComponentType::U8, Components::Four);
    let colors = AttributeFormat { component, components, conversion: Conversion::Normalized };
    for (number, format, relative, binding) in [(0, floats, 0, 0), (1, colors, 8, 0), (2, floats, 0, 1)] {
        c.vertex_array_attrib_format(array, number, format, relative).unwrap();
        c.vertex_array_attrib_binding(array, number, binding).unwrap();
        c.enable_vertex_array_attrib(array, number).unwrap();
    }
    c.vertex_array_vertex_buffer(array, 0, VertexBuffer { buffer: names[0], offset: 0, stride: 12 }).unwrap();
    c.vertex_array_vertex_buffer(array, 1, VertexBuffer { buffer: names[1], offset: 0, stride: 8 }).unwrap();
    c.vertex_array_binding_divisor(array, 1, 2).unwrap();
    c.vertex_array_element_buffer(array, names[2]).unwrap();
    c.bind_vertex_array(array).unwrap();
    c.bind_buffer(BufferTarget::DrawIndirect, names[3]).unwrap();
    c.bind_buffer(BufferTarget::Parameter, names[3]).unwrap();
    c
}

/// Draws what is bound, the last on top.
fn shade(inputs: &Inputs, output: &mut Output) -> Result<()> {
    let vertex = |v: VertexInput| {
        let [position, color, offset] = [0, 1, 2].map(|number| inputs.attribute(number, v));
        let at: Vec2 = position.truncate().truncate() + offset.truncate().truncate();
        Vertex::new(at.extend(0.5).extend(1.0), Colored { color })
    };
    let shader = fragment(|f: &Fragment<Colored>| f.varyings().color);
    output.draw(&Pipeline::new(Program::new(vertex, shader), State::default(), output.layout())?).map(drop)
}

/// Asserts that a call draws the bytes, and counts, that its expansion into single draws does.
#[track_caller]
fn assert_expands(
    parameters: &[u32],
    call: impl Fn(&mut Context) -> Result<Counters>,
    expansion: impl Fn(&mut Context) -> Result<Counters>,
) {
    let run = |draw: &dyn Fn(&mut Context) -> Result<Counters>| {
        let mut c = prepared(parameters);
        let counters = draw(&mut c).unwrap();
        (counters, c.default_framebuffer().color(0).to_bytes(0))
    };
    let (of_call, bytes) = run(&call);
    let (of_expansion, expected) = run(&expansion);
    assert!(expected.iter().filter(|byte| **byte != 0).count() > 300);
    assert!(bytes == expected);
    assert_eq!(of_call, of_expansion);
}

/// Counters of several calls together.
fn sum(counters: impl IntoIterator<Item = Result<Counters>>) -> Result<Counters> {
    counters.into_iter().try_fold(Counters::default(), |mut sum, counters| {
        sum += counters?;
        Ok(sum)
    })
}

fn short(first: usize, count: usize, base_vertex: i32) -> Elements {
    Elements { count, index: IndexType::U16, offset: 2 * first, base_vertex }
}

/// One after the other, the vertices of indices by number: three for each draw, so that arrays draw them.
fn one_by_one(c: &mut Context, indices: &[u16], base: i32, instance: u32) -> Result<Counters> {
    let bytes: Vec<u8> = indices.iter().flat_map(|i| (i32::from(*i) + base).to_le_bytes()).collect();
    let buffer = c.create_buffers(1)?[0];
    c.buffer_data(buffer, Contents::Bytes(&bytes), Usage::StreamDraw)?;
    c.bind_buffer(BufferTarget::ElementArray, buffer)?;
    let of = |draw: usize| Elements { count: 3, index: IndexType::U32, offset: 12 * draw, base_vertex: 0 };
    let draws = (0..indices.len() / 3).map(|draw| c.draw_elements(of(draw), instance..instance + 1, shade));
    let all = sum(draws.collect::<Vec<_>>());
    c.vertex_array_element_buffer(1, 3)?;
    all
}

/// The element of an instance is ⌊(instance − base) / divisor⌋ + base, so that a draw of that one instance, its own
/// base, has it.
#[test]
fn instances_are_draws_of_one_instance_each() {
    assert_expands(
        &ARRAYS,
        |c| c.draw_arrays(3..12, 2..7, shade),
        |c| sum([2, 2, 3, 3, 4].map(|element| c.draw_arrays(3..12, element..element + 1, shade))),
    );
    assert_expands(
        &ARRAYS,
        |c| c.draw_elements(short(3, 9, 2), 1..4, shade),
        |c| sum([1, 1, 2].map(|element| c.draw_elements(short(3, 9, 2), element..element + 1, shade))),
    );
}

#[test]
fn elements_are_the_vertices_that_they_name() {
    for (base, instance) in [(0, 0), (5, 3), (-1, 1)] {
        let indices = if base < 0 { &INDICES[5..11] } else { &INDICES[..] };
        let first = if base < 0 { 5 } else { 0 };
        assert_expands(
            &ARRAYS,
            |c| c.draw_elements(short(first, indices.len(), base), instance..instance + 1, shade),
            |c| one_by_one(c, indices, base, instance),
        );
    }
    assert_expands(
        &ARRAYS,
        |c| c.draw_range_elements(0..=11, short(0, 12, 5), shade),
        |c| c.draw_elements(short(0, 12, 5), 0..1, shade),
    );
}

#[test]
fn several_draws_are_those_one_after_the_other() {
    assert_expands(
        &ARRAYS,
        |c| c.multi_draw_arrays(&[6..15, 0..0, 0..9, 3..6], shade),
        |c| sum([6..15, 0..0, 0..9, 3..6].map(|vertices| c.draw_arrays(vertices, 0..1, shade))),
    );
    let draws = [short(0, 6, 0), short(3, 9, 6), short(4, 6, -3)];
    assert_expands(
        &ARRAYS,
        |c| c.multi_draw_elements(&draws[..2], shade),
        |c| sum([draws[0], draws[1]].map(|draw| c.draw_elements(draw, 0..1, shade))),
    );
}

#[test]
fn draws_of_a_buffer_are_those_of_its_parameters() {
    let arrays = Indirect { offset: 8, count: 3, stride: 20 };
    let single = |c: &mut Context| [c.draw_arrays(3..9, 1..4, shade), c.draw_arrays(0..9, 4..6, shade)];
    assert_expands(&ARRAYS, |c| c.multi_draw_arrays_indirect(arrays, shade), |c| sum(single(c)));
    let one = Indirect { count: 1, ..arrays };
    assert_expands(&ARRAYS, |c| c.multi_draw_arrays_indirect(one, shade), |c| c.draw_arrays(3..9, 1..4, shade));
    // The count of two is at byte 64, that of five at 68.
    assert_expands(
        &ARRAYS,
        |c| c.multi_draw_indirect_count(None, 64, arrays, shade),
        |c| c.draw_arrays(3..9, 1..4, shade),
    );
    assert_expands(&ARRAYS, |c| c.multi_draw_indirect_count(None, 68, arrays, shade), |c| sum(single(c)));
    let elements = Indirect { offset: 4, count: 2, stride: 0 };
    let single =
        |c: &mut Context| [c.draw_elements(short(4, 6, 5), 3..5, shade), c.draw_elements(short(0, 3, -1), 0..1, shade)];
    assert_expands(&ELEMENTS, |c| c.multi_draw_elements_indirect(IndexType::U16, elements, shade), |c| sum(single(c)));
    assert_expands(
        &ELEMENTS,
        |c| c.multi_draw_indirect_count(Some(IndexType::U16), 4, elements, shade),
        |c| sum(single(c)),
    );
}

/// `VertexInput::draw` counts the draws of a call, and instances count from the base of each.
#[test]
fn draws_are_numbered() {
    let mut c = prepared(&ARRAYS);
    c.multi_draw_arrays_indirect(Indirect { offset: 8, count: 3, stride: 20 }, |inputs, _| {
        let at = |draw: u32, instance: u32| inputs.attribute(2, VertexInput { vertex: 0, instance, draw }).x;
        assert_eq!([at(0, 1), at(0, 2), at(0, 3)], [0.1, 0.1, 0.2]);
        assert_eq!([at(2, 4), at(2, 5)], [0.4, 0.4]);
        Ok(())
    })
    .unwrap();
}

#[test]
fn each_broken_rule_of_draws_is_refused() {
    let mut c = prepared(&ARRAYS);
    let range = "draw_range_elements";
    assert_refused(c.draw_range_elements(0..=8, short(0, 12, 0), shade), range, ["index 9 is outside of 0..=8", OP]);
    assert_refused(c.draw_range_elements(1..=11, short(0, 12, 0), shade), range, ["index 0 is outside", OP]);
    #[allow(clippy::reversed_empty_ranges)]
    let empty = 5..=4;
    assert_refused(c.draw_range_elements(empty, short(0, 12, 0), shade), range, ["is empty", VALUE]);
    let several = c.multi_draw_elements(&[short(0, 3, 0), short(10, 3, 0)], shade);
    assert_refused(several, "multi_draw_elements", ["the buffer has 24", VALUE]);
    let (call, good) = ("multi_draw_arrays_indirect", Indirect { offset: 8, count: 3, stride: 20 });
    for (draws, words) in [
        (Indirect { offset: 6, ..good }, ["offset 6 is no multiple of 4", VALUE]),
        (Indirect { stride: 18, ..good }, ["stride 18 is no multiple of 4", VALUE]),
        (Indirect { offset: 20, ..good }, ["the buffer has 72", OP]),
        (Indirect { offset: usize::MAX - 3, ..good }, ["the buffer has 72", OP]),
        (Indirect { count: 4, ..good }, ["the buffer has 72", OP]),
        (Indirect { count: usize::MAX, ..good }, ["20 bytes apart", OP]),
    ] {
        assert_refused(c.multi_draw_arrays_indirect(draws, shade), call, words);
    }
    let (counted, index) = ("multi_draw_indirect_count", Some(IndexType::U8));
    assert_refused(c.multi_draw_indirect_count(index, 66, good, shade), counted, ["count's offset 66", VALUE]);
    assert_refused(c.multi_draw_indirect_count(index, 72, good, shade), counted, ["the buffer has 72", OP]);
    c.bind_buffer(BufferTarget::Parameter, 0).unwrap();
    assert_refused(c.multi_draw_indirect_count(None, 64, good, shade), counted, ["no buffer is bound", OP]);
    c.map_buffer_range(4, 0, 4, BufferFlags::MAP_READ).unwrap();
    assert_refused(c.multi_draw_arrays_indirect(good, shade), call, ["mapped", OP]);
    c.unmap_buffer(4).unwrap();
    c.buffer_sub_data(4, 8, &[0xff; 16]).unwrap();
    assert_refused(c.multi_draw_arrays_indirect(good, shade), call, ["4294967295 instances from 4294967295", VALUE]);
    let elements = Indirect { stride: 0, ..good };
    let call = "multi_draw_elements_indirect";
    assert_refused(c.multi_draw_elements_indirect(IndexType::U32, elements, shade), call, ["instances", VALUE]);
    c.bind_buffer(BufferTarget::DrawIndirect, 0).unwrap();
    assert_refused(c.multi_draw_elements_indirect(IndexType::U32, elements, shade), call, ["no buffer is bound", OP]);
    c.vertex_array_element_buffer(1, 0).unwrap();
    assert_refused(c.draw_range_elements(0..=9, short(0, 3, 0), shade), range, ["no buffer of indices", OP]);
    assert!(c.default_framebuffer().color(0).to_bytes(0).iter().all(|byte| *byte == 0));
}
