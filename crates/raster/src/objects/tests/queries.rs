//! Queries against direct counts (M188).

use super::{assert_refused, context};
use crate::{
    AttributeFormat, Components, Counters, Format, Fragment, Pipeline, Program, Result, State, Vertex, VertexInput,
    fragment,
    glam::Vec4,
    objects::{
        BufferFlags, BufferTarget, ConditionalMode, Contents, Context, FeedbackPrimitive, Inputs, Output, QueryTarget,
        Usage, VertexBuffer,
    },
    state::DepthState,
};

const OP: &str = "INVALID_OPERATION";

/// Two triangles that overlap, the first nearer, and one outside of the view: x, y, depth.
const CORNERS: [[f32; 3]; 9] = [
    [-0.9, -0.9, 0.25],
    [0.6, -0.7, 0.25],
    [-0.4, 0.8, 0.25],
    [-0.7, -0.2, 0.75],
    [0.9, -0.5, 0.75],
    [0.3, 0.9, 0.75],
    [2.0, 2.0, 0.5],
    [3.0, 2.0, 0.5],
    [2.0, 3.0, 0.5],
];

/// Context with the triangles in a vertex array, and the name of their buffer.
fn prepared() -> (Context, u32) {
    let mut c = context();
    let (buffer, array) = (c.create_buffers(1).unwrap()[0], c.create_vertex_arrays(1).unwrap()[0]);
    let bytes: Vec<u8> = CORNERS.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
    c.buffer_data(buffer, Contents::Bytes(&bytes), Usage::StaticDraw).unwrap();
    c.vertex_array_vertex_buffer(array, 0, VertexBuffer { buffer, offset: 0, stride: 12 }).unwrap();
    c.vertex_array_attrib_format(array, 0, AttributeFormat::floats(Components::Three), 0).unwrap();
    c.enable_vertex_array_attrib(array, 0).unwrap();
    c.bind_vertex_array(array).unwrap();
    c.clear(Vec4::ZERO, 1.0, 0).unwrap();
    (c, buffer)
}

/// Draws triangles in white with a depth test.
fn white(inputs: &Inputs, output: &mut Output) -> Result<()> {
    let vertex = |v: VertexInput| Vertex::new(inputs.attribute(0, v), ());
    let shader = fragment(|_: &Fragment<()>| Vec4::ONE);
    let state = State { depth: Some(DepthState::LESS), ..State::default() };
    output.draw(&Pipeline::new(Program::new(vertex, shader), state, output.layout())?).map(drop)
}

/// Pixels that have been drawn.
fn drawn(c: &Context) -> u64 {
    let target = c.default_framebuffer().color(0);
    (0..64 * 64).filter(|i| target.pixel(i % 64, i / 64) == Some(Vec4::ONE)).count() as u64
}

#[test]
fn counts_of_samples_and_primitives_are_those_of_a_direct_count() {
    let (mut c, _) = prepared();
    let targets = [
        QueryTarget::SamplesPassed,
        QueryTarget::AnySamplesPassed,
        QueryTarget::AnySamplesPassedConservative,
        QueryTarget::PrimitivesGenerated,
        QueryTarget::TransformFeedbackPrimitivesWritten,
        QueryTarget::TimeElapsed,
    ];
    let names = c.gen_queries(targets.len()).unwrap();
    // Triangle by triangle: a sample passes once for each pixel that turns white or is drawn over by what is nearer.
    let mut counts = Vec::new();
    for first in [0, 3, 6] {
        for (target, name) in targets.iter().zip(&names) {
            c.begin_query(*target, *name).unwrap();
        }
        let before = drawn(&c);
        let counters = c.draw_arrays(first..first + 3, 0..1, white).unwrap();
        for target in targets {
            c.end_query(target).unwrap();
        }
        let results: Vec<u64> = names[..5].iter().map(|name| c.get_query_object(*name).unwrap()).collect();
        let passed = drawn(&c) - before;
        assert_eq!(results, [passed, u64::from(passed > 0), u64::from(passed > 0), 1, 0]);
        assert_eq!(counters.samples_passed, passed);
        counts.push(passed);
    }
    assert!(counts[0] > 400 && counts[1] > 100 && counts[2] == 0, "{counts:?}");
    // All at once, over two draws: counts add up until the end, and start anew at the next begin.
    c.clear(Vec4::ZERO, 1.0, 0).unwrap();
    c.begin_query(QueryTarget::SamplesPassed, names[0]).unwrap();
    c.draw_arrays(0..6, 0..1, white).unwrap();
    // Nothing is nearer: no sample passes.
    c.draw_arrays(0..6, 0..3, white).unwrap();
    c.end_query(QueryTarget::SamplesPassed).unwrap();
    assert_eq!(c.get_query_object(names[0]).unwrap(), counts[0] + counts[1]);
    assert_eq!(drawn(&c), counts[0] + counts[1]);
}

/// In 4 samples for each pixel, the count is that of the samples that hold the colour.
#[test]
fn samples_are_counted_one_by_one() {
    use crate::{Extent, Framebuffer, objects::ShareGroup, state::Multisample};
    let picture = Framebuffer::with_color_and_depth(Extent::new(64, 64).samples(4), Format::Rgba8Unorm).unwrap();
    let mut c = Context::new(&ShareGroup::new(), picture);
    let (array, query) = (c.create_vertex_arrays(1).unwrap()[0], c.gen_queries(1).unwrap()[0]);
    c.bind_vertex_array(array).unwrap();
    c.begin_query(QueryTarget::SamplesPassed, query).unwrap();
    c.draw_arrays(0..3, 0..1, |_, output| {
        let vertex = |v: VertexInput| {
            let [x, y, z] = CORNERS[v.vertex as usize];
            Vertex::new(Vec4::new(x, y, z, 1.0), ())
        };
        let state = State { multisample: Multisample::samples(4), ..State::default() };
        let program = Program::new(vertex, fragment(|_: &Fragment<()>| Vec4::ONE));
        output.draw(&Pipeline::new(program, state, output.layout())?).map(drop)
    })
    .unwrap();
    c.end_query(QueryTarget::SamplesPassed).unwrap();
    let target = c.default_framebuffer().color(0);
    let white = |i: u32| target.sample([i / 4 % 64, i / 256], 0, i % 4) == Some(Vec4::ONE);
    let count = (0..4 * 64 * 64).filter(|i| white(*i)).count() as u64;
    assert_eq!(c.get_query_object(query).unwrap(), count);
    assert!(count > 4 * 400);
}

#[test]
fn transform_feedback_writes_whole_primitives_while_there_is_room() {
    let (mut c, _) = prepared();
    let names = c.gen_queries(2).unwrap();
    let buffer = c.create_buffers(1).unwrap()[0];
    // Room for two triangles of three positions of 16 bytes, and a bit.
    c.buffer_data(buffer, Contents::Size(2 * 48 + 47), Usage::StreamCopy).unwrap();
    c.bind_buffer(BufferTarget::TransformFeedback, buffer).unwrap();
    c.rasterizer_discard(true);
    c.begin_query(QueryTarget::PrimitivesGenerated, names[0]).unwrap();
    c.begin_query(QueryTarget::TransformFeedbackPrimitivesWritten, names[1]).unwrap();
    c.begin_transform_feedback(FeedbackPrimitive::Triangles).unwrap();
    // Draws go on where the one before ended.
    c.draw_arrays(3..6, 0..1, white).unwrap();
    c.draw_arrays(0..9, 0..1, white).unwrap();
    c.end_transform_feedback().unwrap();
    c.end_query(QueryTarget::PrimitivesGenerated).unwrap();
    c.end_query(QueryTarget::TransformFeedbackPrimitivesWritten).unwrap();
    assert_eq!([0, 1].map(|i| c.get_query_object(names[i]).unwrap()), [4, 2]);
    let expected: Vec<u8> = [3, 4, 5, 0, 1, 2]
        .iter()
        .flat_map(|i: &usize| [CORNERS[*i][0], CORNERS[*i][1], CORNERS[*i][2], 1.0])
        .flat_map(f32::to_le_bytes)
        .chain([0; 47])
        .collect();
    assert_eq!(c.get_buffer_sub_data(buffer, 0, 143).unwrap(), expected);
    assert_eq!(drawn(&c), 0);
    // The result goes to a buffer, too.
    c.get_query_buffer_object(names[0], buffer, 8).unwrap();
    assert_eq!(c.get_buffer_sub_data(buffer, 8, 8).unwrap(), 4u64.to_le_bytes());
}

#[test]
fn conditional_rendering_draws_or_not() {
    use ConditionalMode::*;
    let modes = [
        (Wait, false),
        (NoWait, false),
        (ByRegionWait, false),
        (ByRegionNoWait, false),
        (WaitInverted, true),
        (NoWaitInverted, true),
        (ByRegionWaitInverted, true),
        (ByRegionNoWaitInverted, true),
    ];
    for (mode, is_inverted) in modes {
        for target in [QueryTarget::SamplesPassed, QueryTarget::AnySamplesPassed] {
            // The third triangle is outside: no sample passes.
            for (first, passes) in [(0, true), (6, false)] {
                let (mut c, _) = prepared();
                let query = c.gen_queries(1).unwrap()[0];
                c.begin_query(target, query).unwrap();
                c.draw_arrays(first..first + 3, 0..1, white).unwrap();
                c.end_query(target).unwrap();
                let before = drawn(&c);
                c.begin_conditional_render(query, mode).unwrap();
                let counters = c.draw_arrays(3..6, 0..1, white).unwrap();
                c.end_conditional_render().unwrap();
                let draws = passes != is_inverted;
                assert_eq!(drawn(&c) > before, draws, "{mode:?} {target:?} {first}");
                assert_eq!(counters == Counters::default(), !draws);
                // Clears are conditional, too.
                c.begin_conditional_render(query, mode).unwrap();
                c.clear(Vec4::ONE, 1.0, 0).unwrap();
                c.end_conditional_render().unwrap();
                assert_eq!(drawn(&c) == 64 * 64, draws);
            }
        }
    }
}

#[test]
fn times_do_not_decrease() {
    let mut c = context();
    let names = c.gen_queries(3).unwrap();
    c.query_counter(names[0]).unwrap();
    c.begin_query(QueryTarget::TimeElapsed, names[1]).unwrap();
    c.end_query(QueryTarget::TimeElapsed).unwrap();
    c.query_counter(names[2]).unwrap();
    let [first, elapsed, last] = [0, 1, 2].map(|i| c.get_query_object(names[i]).unwrap());
    assert!(first + elapsed <= last);
}

/// A closure of a draw that writes to what the draw reads is refused, and nothing panics.
#[test]
fn a_draw_reads_what_is_bound_until_it_ends() {
    use crate::objects::ShareGroup;
    let group = ShareGroup::new();
    let (mut a, mut b) = (super::context_of(&group), super::context_of(&group));
    let (buffer, array) = (a.create_buffers(1).unwrap()[0], a.create_vertex_arrays(1).unwrap()[0]);
    let access = BufferFlags::MAP_WRITE | BufferFlags::MAP_PERSISTENT;
    a.buffer_storage(buffer, Contents::Size(48), access | BufferFlags::DYNAMIC_STORAGE).unwrap();
    a.vertex_array_vertex_buffer(array, 0, VertexBuffer { buffer, offset: 0, stride: 16 }).unwrap();
    a.enable_vertex_array_attrib(array, 0).unwrap();
    a.bind_vertex_array(array).unwrap();
    let mapping = a.map_buffer_range(buffer, 0, 48, access).unwrap();
    a.draw_arrays(0..3, 0..1, |_, _| {
        let words = ["a draw that has not ended", OP];
        assert_refused(mapping.write(0, &[1]), "Mapping::write", words);
        assert_refused(b.buffer_sub_data(buffer, 0, &[1]), "buffer_sub_data", words);
        assert_refused(b.unmap_buffer(buffer), "unmap_buffer", words);
        assert_refused(b.copy_buffer_sub_data((buffer, 0), (buffer, 4), 4), "copy_buffer_sub_data", words);
        b.delete_buffers(&[buffer]);
        Ok(())
    })
    .unwrap();
    mapping.write(0, &[1]).unwrap();
    // The vertex array keeps the buffer that the other context has deleted.
    a.draw_arrays(0..3, 0..1, white).unwrap();
}

#[test]
fn a_deleted_query_counts_until_it_ends() {
    let (mut c, _) = prepared();
    let target = QueryTarget::SamplesPassed;
    let query = c.gen_queries(1).unwrap()[0];
    assert!(!c.is_query(query));
    c.begin_query(target, query).unwrap();
    assert!(c.is_query(query));
    c.delete_queries(&[query]);
    assert!(!c.is_query(query));
    // The name is free, the target is not.
    assert_eq!(c.gen_queries(1).unwrap(), [query]);
    assert_refused(c.begin_query(target, query), "begin_query", ["a query of SamplesPassed is active", OP]);
    c.end_query(target).unwrap();
    c.begin_query(target, query).unwrap();
    c.end_query(target).unwrap();
    assert_eq!(c.get_query_object(query).unwrap(), 0);
}

#[test]
fn each_broken_rule_of_queries_is_refused() {
    let (mut c, buffer) = prepared();
    let (samples, any) = (QueryTarget::SamplesPassed, QueryTarget::AnySamplesPassed);
    let names = c.gen_queries(3).unwrap();
    let [query, reserved, timer] = [names[0], names[1], names[2]];
    assert_refused(c.begin_query(samples, 0), "begin_query", ["0 is not a generated name", OP]);
    assert_refused(c.begin_query(QueryTarget::Timestamp, query), "begin_query", ["query_counter", "INVALID_ENUM"]);
    assert_refused(c.end_query(samples), "end_query", ["no query of SamplesPassed", OP]);
    c.begin_query(samples, query).unwrap();
    assert_refused(c.begin_query(samples, reserved), "begin_query", ["is active", OP]);
    assert_refused(c.begin_query(any, query), "begin_query", ["is active", OP]);
    assert_refused(c.end_query(any), "end_query", ["no query of AnySamplesPassed", OP]);
    assert_refused(c.get_query_object(query), "get_query_object", ["is active", OP]);
    assert_refused(c.query_counter(query), "query_counter", ["is active", OP]);
    let call = "begin_conditional_render";
    assert_refused(c.begin_conditional_render(query, ConditionalMode::Wait), call, ["active", OP]);
    c.end_query(samples).unwrap();
    assert_refused(c.begin_query(any, query), "begin_query", ["is of SamplesPassed", OP]);
    assert_refused(c.get_query_object(reserved), "get_query_object", ["without an object", OP]);
    assert_refused(c.get_query_object(77), "get_query_object", ["77 is not a name", OP]);
    assert_refused(c.begin_conditional_render(77, ConditionalMode::Wait), call, ["77", "INVALID_VALUE"]);
    c.query_counter(timer).unwrap();
    assert_refused(c.begin_conditional_render(timer, ConditionalMode::Wait), call, ["not of samples", OP]);
    assert_refused(c.end_conditional_render(), "end_conditional_render", ["has not begun", OP]);
    c.begin_conditional_render(query, ConditionalMode::Wait).unwrap();
    assert_refused(c.begin_conditional_render(query, ConditionalMode::Wait), call, ["begun already", OP]);
    c.end_conditional_render().unwrap();
    let call = "get_query_buffer_object";
    assert_refused(c.get_query_buffer_object(query, buffer, 4), call, ["no multiple of 8", "INVALID_VALUE"]);
    assert_refused(c.get_query_buffer_object(query, buffer, 104), call, ["the buffer has 108", "INVALID_VALUE"]);
    // Transform feedback.
    let (begin, end) = ("begin_transform_feedback", "end_transform_feedback");
    assert_refused(c.end_transform_feedback(), end, ["not active", OP]);
    assert_refused(c.begin_transform_feedback(FeedbackPrimitive::Points), begin, ["no buffer is bound", OP]);
    c.bind_buffer(BufferTarget::TransformFeedback, buffer).unwrap();
    c.begin_transform_feedback(FeedbackPrimitive::Lines).unwrap();
    assert_refused(c.begin_transform_feedback(FeedbackPrimitive::Points), begin, ["active already", OP]);
    assert_refused(c.bind_buffer(BufferTarget::TransformFeedback, 0), "bind_buffer", ["feedback is active", OP]);
    assert_refused(c.draw_arrays(0..3, 0..1, white), "Output::draw", ["other primitives", OP]);
    c.end_transform_feedback().unwrap();
    // A buffer that is mapped but not persistently cannot be drawn from.
    c.map_buffer_range(buffer, 0, 4, BufferFlags::MAP_READ).unwrap();
    assert_refused(c.draw_arrays(0..3, 0..1, white), "draw_arrays", ["mapped, and not persistently", OP]);
    c.unmap_buffer(buffer).unwrap();
    c.draw_arrays(0..3, 0..1, white).unwrap();
}
