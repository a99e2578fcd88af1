//! Names: generation, binding, attachment, deletion, sharing (M184).

use super::{assert_refused, context, context_of};
use crate::{
    Format,
    glam::Vec4,
    objects::{
        AttachmentPoint, BufferTarget, Contents, Context, Elements, FramebufferTarget, IndexType, Pixels, QueryTarget,
        Region, ShareGroup, Usage, VertexBuffer,
    },
    texture::{TextureKind, TextureSize},
};

/// Runs a trace: lines of a context (`a` or `b`, of one group), a call and its arguments, and after `=` what it
/// returns.
fn run(trace: &str) {
    let group = ShareGroup::new();
    let mut contexts = [context_of(&group), context_of(&group)];
    for line in trace.lines().map(str::trim).filter(|line| !line.is_empty()) {
        let (call, expected) = line.split_once('=').map_or((line, ""), |(call, expected)| (call, expected.trim()));
        let words: Vec<&str> = call.split_whitespace().collect();
        let context = &mut contexts[usize::from(words[0] == "b")];
        assert_eq!(step(context, &words[1..]), expected, "{line}");
    }
}

fn step(c: &mut Context, words: &[&str]) -> String {
    let number = |i: usize| words[i].parse::<u32>().unwrap();
    let target = |word: &str| match word {
        "array" => BufferTarget::Array,
        "elements" => BufferTarget::ElementArray,
        "read" => BufferTarget::CopyRead,
        _ => panic!("{word}"),
    };
    let done = |result: crate::Result<()>| result.map_or_else(|error| error.rule, |()| String::new());
    let names = |names: crate::Result<Vec<u32>>| format!("{:?}", names.unwrap());
    match words[0] {
        "gen" => names(c.gen_buffers(number(1) as usize)),
        "create" => names(c.create_buffers(number(1) as usize)),
        "delete" => {
            c.delete_buffers(&[number(1)]);
            String::new()
        }
        "is" => c.is_buffer(number(1)).to_string(),
        "bind" => done(c.bind_buffer(target(words[1]), number(2))),
        "bound" => c.buffer_binding(target(words[1])).to_string(),
        "data" => done(c.buffer_data(target(words[1]), Contents::Bytes(words[2].as_bytes()), Usage::default())),
        "read" => c
            .get_buffer_sub_data(target(words[1]), 0, number(2) as usize)
            .map_or_else(|error| error.rule, |bytes| String::from_utf8(bytes).unwrap()),
        "genarray" => names(c.gen_vertex_arrays(1)),
        "bindarray" => done(c.bind_vertex_array(number(1))),
        "isarray" => c.is_vertex_array(number(1)).to_string(),
        "deletearray" => {
            c.delete_vertex_arrays(&[number(1)]);
            String::new()
        }
        word => panic!("{word}"),
    }
}

#[test]
fn a_name_has_an_object_from_its_first_binding_or_from_its_creation() {
    run("a gen 2 = [1, 2]
        a is 1 = false
        a bind array 1
        a is 1 = true
        a is 2 = false
        a create 1 = [3]
        a is 3 = true
        a is 0 = false
        a bound array = 1
        a bind array 0
        a bound array = 0
        a read array 1 = no buffer is bound to Array (INVALID_OPERATION)
        a bind array 9 = 9 is not a generated name of a buffer (INVALID_OPERATION)");
}

#[test]
fn a_deleted_buffer_lives_while_another_context_has_it_bound() {
    run("a gen 1 = [1]
        a bind array 1
        a bind read 1
        a data array old
        b bind array 1
        b read array 3 = old
        a delete 1
        a is 1 = false
        b is 1 = false
        a bound array = 0
        a bound read = 0
        a read array 3 = no buffer is bound to Array (INVALID_OPERATION)
        a read read 3 = no buffer is bound to CopyRead (INVALID_OPERATION)
        b read array 3 = old
        b bound array = 0
        a delete 1
        a delete 0
        b gen 1 = [1]
        a bind read 1
        a data read new
        b read array 3 = old
        b bind read 1
        b read read 3 = new
        b bind array 0
        b read array 3 = no buffer is bound to Array (INVALID_OPERATION)");
}

#[test]
fn a_deleted_buffer_leaves_the_bound_vertex_array_and_stays_in_others() {
    run("a genarray = [1]
        a bind elements 0 = indices belong to a vertex array, and none is bound (INVALID_OPERATION)
        a isarray 1 = false
        a bindarray 1
        a isarray 1 = true
        a create 2 = [1, 2]
        a bind elements 1
        a data elements one
        a genarray = [2]
        a bindarray 2
        a bound elements = 0
        a bind elements 2
        a data elements two
        a delete 2
        a bound elements = 0
        a read elements 3 = no buffer is bound to ElementArray (INVALID_OPERATION)
        a delete 1
        a bindarray 1
        a read elements 3 = one
        a bound elements = 0
        a deletearray 1
        a read elements 3 = no buffer is bound to ElementArray (INVALID_OPERATION)
        b bindarray 2 = 2 is not a generated name of a vertex array (INVALID_OPERATION)");
}

#[test]
fn containers_and_queries_are_not_shared() {
    let group = ShareGroup::new();
    let (mut a, mut b) = (context_of(&group), context_of(&group));
    let [array, framebuffer] = [a.create_vertex_arrays(1).unwrap()[0], a.create_framebuffers(1).unwrap()[0]];
    let query = a.create_queries(QueryTarget::SamplesPassed, 1).unwrap()[0];
    let texture = a.create_textures(TextureKind::D2, 1).unwrap()[0];
    assert!(a.is_vertex_array(array) && a.is_framebuffer(framebuffer) && a.is_query(query) && a.is_texture(texture));
    assert!(!b.is_vertex_array(array) && !b.is_framebuffer(framebuffer) && !b.is_query(query));
    assert!(b.is_texture(texture));
    // Another group has other names.
    assert!(!context().is_texture(texture));
    for (result, call) in [
        (b.bind_vertex_array(array), "bind_vertex_array"),
        (b.bind_framebuffer(FramebufferTarget::Both, framebuffer), "bind_framebuffer"),
        (b.begin_query(QueryTarget::SamplesPassed, query), "begin_query"),
    ] {
        assert_refused(result, call, ["is not a generated name", "INVALID_OPERATION"]);
    }
    a.bind_framebuffer(FramebufferTarget::Both, framebuffer).unwrap();
    a.delete_framebuffers(&[framebuffer]);
    // The default framebuffer is bound again, which can be cleared.
    a.clear(Vec4::ONE, 1.0, 0).unwrap();
    assert_eq!(a.default_framebuffer().color(0).pixel(0, 0), Some(Vec4::ONE));
}

#[test]
fn a_deleted_texture_lives_while_it_is_attached_to_a_framebuffer_that_is_not_bound() {
    let mut c = context();
    let framebuffers = c.create_framebuffers(2).unwrap();
    let texture = c.create_textures(TextureKind::D2, 1).unwrap()[0];
    c.texture_storage(texture, 1, Format::Rgba8Unorm, TextureSize::d2(4, 4)).unwrap();
    for framebuffer in &framebuffers {
        c.named_framebuffer_texture(*framebuffer, AttachmentPoint::Color(0), texture, 0).unwrap();
    }
    c.bind_framebuffer(FramebufferTarget::Both, framebuffers[0]).unwrap();
    c.delete_textures(&[texture]);
    assert!(!c.is_texture(texture));
    assert_refused(c.clear(Vec4::ONE, 1.0, 0), "clear", ["MissingAttachment", "INVALID_FRAMEBUFFER_OPERATION"]);
    c.bind_framebuffer(FramebufferTarget::Both, framebuffers[1]).unwrap();
    c.clear(Vec4::ONE, 1.0, 0).unwrap();
}

#[test]
fn each_misuse_of_names_and_attachments_is_refused_by_its_rule() {
    let mut c = context();
    let (array, framebuffer) = (c.create_vertex_arrays(1).unwrap()[0], c.create_framebuffers(1).unwrap()[0]);
    let reserved = c.gen_buffers(1).unwrap()[0];
    let texture = c.create_textures(TextureKind::D2Array, 1).unwrap()[0];
    let (op, value) = ("INVALID_OPERATION", "INVALID_VALUE");
    assert_refused(c.gen_buffers(usize::MAX), "gen_buffers", ["at most", value]);
    assert_refused(c.bind_texture(0, TextureKind::D2, 7), "bind_texture", ["7 is not a generated name", op]);
    assert_refused(c.bind_texture(0, TextureKind::D2, texture), "bind_texture", ["D2Array, not D2", op]);
    assert_refused(c.bind_texture(80, TextureKind::D2Array, texture), "bind_texture", ["unit 80", value]);
    let source = VertexBuffer { buffer: reserved, offset: 0, stride: 4 };
    let call = "vertex_array_vertex_buffer";
    assert_refused(c.vertex_array_vertex_buffer(array, 0, source), call, ["without an object", op]);
    let source = VertexBuffer { buffer: 0, ..source };
    assert_refused(c.vertex_array_vertex_buffer(array, 32, source), call, ["binding 32", value]);
    assert_refused(c.vertex_array_vertex_buffer(9, 0, source), call, ["9 is not a name of a vertex array", op]);
    let source = VertexBuffer { stride: 2049, ..source };
    assert_refused(c.vertex_array_vertex_buffer(array, 0, source), call, ["at most 2048", value]);
    let call = "enable_vertex_array_attrib";
    assert_refused(c.enable_vertex_array_attrib(array, 32), call, ["attribute 32", value]);
    let call = "named_framebuffer_texture_layer";
    c.texture_storage(texture, 2, Format::R8Uint, TextureSize { layers: 3, ..TextureSize::d2(4, 4) }).unwrap();
    assert_refused(
        c.named_framebuffer_texture_layer(framebuffer, AttachmentPoint::Color(8), texture, (0, 0)),
        call,
        ["attachment 8", op],
    );
    assert_refused(
        c.named_framebuffer_texture_layer(framebuffer, AttachmentPoint::Color(0), texture, (2, 0)),
        call,
        ["level 2", value],
    );
    assert_refused(
        c.named_framebuffer_texture_layer(framebuffer, AttachmentPoint::Color(0), texture, (1, 3)),
        call,
        ["layer 3", value],
    );
    c.named_framebuffer_texture_layer(framebuffer, AttachmentPoint::Color(0), texture, (1, 2)).unwrap();
    // Draws without what they need.
    let elements = Elements { count: 1, index: IndexType::U8, offset: 0, base_vertex: 0 };
    assert_refused(c.draw_arrays(0..3, 0..1, |_, _| Ok(())), "draw_arrays", ["no vertex array is bound", op]);
    c.bind_vertex_array(array).unwrap();
    assert_refused(c.draw_elements(elements, 0..1, |_, _| Ok(())), "draw_elements", ["no buffer of indices", op]);
    c.enable_vertex_array_attrib(array, 3).unwrap();
    assert_refused(c.draw_arrays(0..3, 0..1, |_, _| Ok(())), "draw_arrays", ["attribute 3 is enabled without", op]);
    c.disable_vertex_array_attrib(array, 3).unwrap();
    assert_refused(
        c.draw_arrays(0..3, 0..1, |inputs, _| inputs.texture(0, TextureKind::D2).map(drop)),
        "Inputs::texture",
        ["no D2 texture", op],
    );
    let region = Region { level: 0, origin: [0; 3], size: [1; 3] };
    let pixels = Pixels::Bytes(&[0; 4]);
    assert_refused(
        c.texture_sub_image(99, region, Format::R8Uint, pixels),
        "texture_sub_image",
        ["99 is not a name of a texture", op],
    );
}
