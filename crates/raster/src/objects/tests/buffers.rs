//! Buffers: storage, mappings, copies, clears (M186).

use super::{assert_refused, context};
use crate::{
    Format, Result,
    objects::{BufferFlags as F, BufferTarget, Contents, Context, MAX_BUFFER_BYTES, Mapping, Usage},
};

/// State that a rule is tried in: names 1 to 4 are a mutable buffer of 16 bytes, an immutable one without flags, one
/// with all flags of storage, and one without storage; 1 is mapped as `map` says.
fn prepared(map: Option<F>) -> (Context, Option<Mapping>) {
    let mut c = context();
    assert_eq!(c.create_buffers(4).unwrap(), [1, 2, 3, 4]);
    c.buffer_data(1, Contents::Size(16), Usage::default()).unwrap();
    c.buffer_storage(2, Contents::Size(16), F::NONE).unwrap();
    let all = F::MAP_READ | F::MAP_WRITE | F::MAP_PERSISTENT | F::MAP_COHERENT | F::DYNAMIC_STORAGE | F::CLIENT_STORAGE;
    c.buffer_storage(3, Contents::Size(16), all).unwrap();
    let mapping = map.map(|access| c.map_buffer_range(1, 4, 8, access).unwrap());
    (c, mapping)
}

type Case = (&'static str, Option<F>, fn(&Context) -> Result<()>, [&'static str; 2]);

const OP: &str = "INVALID_OPERATION";
const VALUE: &str = "INVALID_VALUE";
const READ: Option<F> = Some(F::MAP_READ);
const WRITE: Option<F> = Some(F::MAP_WRITE);

/// Rules of storage, sub-data, clear, copy and invalidation (sections 6.2, 6.5 and 6.6).
const RULES: &[Case] = &[
    ("buffer_storage", None, |c| c.buffer_storage(9, Contents::Size(1), F::NONE), ["9 is not a name", OP]),
    (
        "buffer_storage",
        None,
        |c| c.buffer_storage(BufferTarget::Array, Contents::Size(1), F::NONE),
        ["no buffer is bound to Array", OP],
    ),
    ("buffer_storage", None, |c| c.buffer_storage(4, Contents::Size(0), F::NONE), ["must be positive", VALUE]),
    ("buffer_storage", None, |c| c.buffer_storage(4, Contents::Bytes(&[]), F::NONE), ["must be positive", VALUE]),
    ("buffer_storage", None, |c| c.buffer_storage(4, Contents::Size(1), F::from_bits(0x1000)), ["bits", VALUE]),
    ("buffer_storage", None, |c| c.buffer_storage(4, Contents::Size(1), F::MAP_FLUSH_EXPLICIT), ["bits", VALUE]),
    ("buffer_storage", None, |c| c.buffer_storage(4, Contents::Size(1), F::MAP_PERSISTENT), ["needs MAP_READ", VALUE]),
    (
        "buffer_storage",
        None,
        |c| c.buffer_storage(4, Contents::Size(1), F::MAP_READ | F::MAP_COHERENT),
        ["needs MAP_PERSISTENT", VALUE],
    ),
    ("buffer_storage", None, |c| c.buffer_storage(2, Contents::Size(1), F::NONE), ["immutable", OP]),
    (
        "buffer_storage",
        None,
        |c| c.buffer_storage(4, Contents::Size(MAX_BUFFER_BYTES + 1), F::NONE),
        ["at most", "OUT_OF_MEMORY"],
    ),
    ("buffer_data", None, |c| c.buffer_data(3, Contents::Size(4), Usage::DynamicCopy), ["immutable", OP]),
    (
        "buffer_data",
        None,
        |c| c.buffer_data(1, Contents::Size(usize::MAX), Usage::StreamRead),
        ["at most", "OUT_OF_MEMORY"],
    ),
    ("buffer_sub_data", None, |c| c.buffer_sub_data(1, 13, &[0; 4]), ["the buffer has 16", VALUE]),
    ("buffer_sub_data", None, |c| c.buffer_sub_data(1, usize::MAX, &[0; 4]), ["the buffer has 16", VALUE]),
    ("buffer_sub_data", None, |c| c.buffer_sub_data(4, 0, &[0; 1]), ["the buffer has 0", VALUE]),
    ("buffer_sub_data", None, |c| c.buffer_sub_data(2, 0, &[0; 1]), ["DYNAMIC_STORAGE", OP]),
    ("buffer_sub_data", WRITE, |c| c.buffer_sub_data(1, 0, &[0; 1]), ["mapped", OP]),
    ("get_buffer_sub_data", None, |c| c.get_buffer_sub_data(1, 8, 9).map(drop), ["the buffer has 16", VALUE]),
    ("get_buffer_sub_data", READ, |c| c.get_buffer_sub_data(1, 0, 1).map(drop), ["mapped", OP]),
    (
        "clear_buffer_sub_data",
        None,
        |c| c.clear_buffer_sub_data(1, Format::R16Uint, (1, 2), &[1, 2]),
        ["not both multiples of 2", VALUE],
    ),
    (
        "clear_buffer_sub_data",
        None,
        |c| c.clear_buffer_sub_data(1, Format::R16Uint, (2, 3), &[1, 2]),
        ["not both multiples of 2", VALUE],
    ),
    (
        "clear_buffer_sub_data",
        None,
        |c| c.clear_buffer_sub_data(1, Format::R16Uint, (2, 16), &[1, 2]),
        ["the buffer has 16", VALUE],
    ),
    (
        "clear_buffer_sub_data",
        None,
        |c| c.clear_buffer_sub_data(1, Format::R16Uint, (0, 2), &[1]),
        ["a texel of 1 bytes", VALUE],
    ),
    (
        "clear_buffer_sub_data",
        None,
        |c| c.clear_buffer_sub_data(1, Format::Rgb8Unorm, (0, 3), &[1; 3]),
        ["no format of buffers", "INVALID_ENUM"],
    ),
    ("clear_buffer_sub_data", READ, |c| c.clear_buffer_sub_data(1, Format::R8Uint, (0, 1), &[1]), ["mapped", OP]),
    ("copy_buffer_sub_data", None, |c| c.copy_buffer_sub_data((1, 0), (1, 7), 8), ["overlap", VALUE]),
    ("copy_buffer_sub_data", None, |c| c.copy_buffer_sub_data((1, 7), (1, 0), 8), ["overlap", VALUE]),
    ("copy_buffer_sub_data", None, |c| c.copy_buffer_sub_data((1, 0), (2, 9), 8), ["the buffer has 16", VALUE]),
    ("copy_buffer_sub_data", None, |c| c.copy_buffer_sub_data((1, 9), (2, 0), 8), ["the buffer has 16", VALUE]),
    ("copy_buffer_sub_data", READ, |c| c.copy_buffer_sub_data((1, 0), (2, 0), 8), ["mapped", OP]),
    ("copy_buffer_sub_data", READ, |c| c.copy_buffer_sub_data((2, 0), (1, 0), 8), ["mapped", OP]),
    ("copy_buffer_sub_data", READ, |c| c.copy_buffer_sub_data((1, 0), (1, 8), 8), ["mapped", OP]),
    ("invalidate_buffer_sub_data", None, |c| c.invalidate_buffer_sub_data(1, 16, 1), ["the buffer has 16", VALUE]),
    ("invalidate_buffer_sub_data", READ, |c| c.invalidate_buffer_sub_data(1, 0, 1), ["mapped", OP]),
];

/// Rules of mappings (section 6.3).
const RULES_OF_MAPPINGS: &[Case] = &[
    ("map_buffer_range", None, |c| map(c, 1, 8, 9, F::MAP_READ), ["the buffer has 16", VALUE]),
    ("map_buffer_range", None, |c| map(c, 1, usize::MAX, 2, F::MAP_READ), ["the buffer has 16", VALUE]),
    ("map_buffer_range", None, |c| map(c, 1, 0, 4, F::MAP_READ | F::DYNAMIC_STORAGE), ["bits", VALUE]),
    ("map_buffer_range", READ, |c| map(c, 1, 0, 1, F::MAP_READ), ["mapped already", OP]),
    ("map_buffer_range", None, |c| map(c, 1, 0, 0, F::MAP_READ), ["empty", OP]),
    ("map_buffer_range", None, |c| map(c, 1, 0, 4, F::MAP_UNSYNCHRONIZED), ["neither", OP]),
    ("map_buffer_range", None, |c| map(c, 1, 0, 4, F::MAP_READ | F::MAP_INVALIDATE_RANGE), ["together", OP]),
    ("map_buffer_range", None, |c| map(c, 1, 0, 4, F::MAP_READ | F::MAP_INVALIDATE_BUFFER), ["together", OP]),
    ("map_buffer_range", None, |c| map(c, 1, 0, 4, F::MAP_READ | F::MAP_UNSYNCHRONIZED), ["together", OP]),
    ("map_buffer_range", None, |c| map(c, 1, 0, 4, F::MAP_READ | F::MAP_FLUSH_EXPLICIT), ["needs MAP_WRITE", OP]),
    ("map_buffer_range", None, |c| map(c, 1, 0, 4, F::MAP_READ | F::MAP_PERSISTENT), ["storage lacks", OP]),
    ("map_buffer_range", None, |c| map(c, 1, 0, 4, F::MAP_READ | F::MAP_COHERENT), ["storage lacks", OP]),
    ("map_buffer_range", None, |c| map(c, 2, 0, 4, F::MAP_READ), ["storage lacks", OP]),
    ("map_buffer_range", None, |c| map(c, 2, 0, 4, F::MAP_WRITE), ["storage lacks", OP]),
    ("unmap_buffer", None, |c| c.unmap_buffer(1), ["not mapped", OP]),
    ("flush_mapped_buffer_range", None, |c| c.flush_mapped_buffer_range(1, 0, 1), ["not mapped", OP]),
    ("flush_mapped_buffer_range", WRITE, |c| c.flush_mapped_buffer_range(1, 0, 1), ["without MAP_FLUSH_EXPLICIT", OP]),
    (
        "flush_mapped_buffer_range",
        Some(F::from_bits(0x12)),
        |c| c.flush_mapped_buffer_range(1, 4, 5),
        ["the mapping has 8", VALUE],
    ),
    ("client_mapped_buffer_barrier", None, |c| c.client_mapped_buffer_barrier(9), ["9 is not a name", OP]),
];

fn map(c: &Context, name: u32, offset: usize, size: usize, access: F) -> Result<()> {
    c.map_buffer_range(name, offset, size, access).map(drop)
}

#[test]
fn each_broken_rule_is_an_error_that_names_it_and_changes_nothing() {
    for (call, access, broken, words) in RULES.iter().chain(RULES_OF_MAPPINGS) {
        let (c, _mapping) = prepared(*access);
        let state = |c: &Context| [1, 2, 3, 4].map(|name| c.get_buffer_parameters(name).unwrap());
        let before = state(&c);
        assert_refused(broken(&c), call, *words);
        assert_eq!(state(&c), before, "{call} {words:?}");
    }
}

#[test]
fn a_mapping_ends_with_unmapping_deletion_and_other_storage() {
    let ends: [fn(&mut Context); 4] = [
        |c| c.unmap_buffer(1).unwrap(),
        |c| c.delete_buffers(&[1]),
        |c| c.buffer_data(1, Contents::Size(16), Usage::default()).unwrap(),
        // A second mapping is not the first.
        |c| {
            c.unmap_buffer(1).unwrap();
            map(c, 1, 0, 8, F::MAP_READ | F::MAP_WRITE).unwrap();
        },
    ];
    for end in ends {
        let (mut c, mapping) = prepared(Some(F::MAP_READ | F::MAP_WRITE));
        let mapping = mapping.unwrap();
        mapping.write(0, &[1]).unwrap();
        assert_eq!(mapping.read(0, 2).unwrap(), [1, 0]);
        end(&mut c);
        assert_refused(mapping.write(0, &[1]), "Mapping::write", ["has ended", OP]);
        assert_refused(mapping.read(0, 1), "Mapping::read", ["has ended", OP]);
    }
    let (_c, mapping) = prepared(WRITE);
    let mapping = mapping.unwrap();
    assert_refused(mapping.read(0, 1), "Mapping::read", ["without MAP_READ", OP]);
    assert_refused(mapping.write(7, &[1, 2]), "Mapping::write", ["the mapping has 8", VALUE]);
    let (_c, mapping) = prepared(READ);
    let mapping = mapping.unwrap();
    assert_refused(mapping.write(0, &[1]), "Mapping::write", ["without MAP_WRITE", OP]);
    assert_refused(mapping.read(8, 1), "Mapping::read", ["the mapping has 8", VALUE]);
}

#[test]
fn mapped_bytes_arrive_when_the_buffer_is_unmapped() {
    let (c, mapping) = prepared(WRITE);
    mapping.unwrap().write(1, b"abc").unwrap();
    c.unmap_buffer(1).unwrap();
    assert_eq!(c.get_buffer_sub_data(1, 3, 6).unwrap(), b"\0\0abc\0");
    // Invalidation gives zeros: of the range, or of all.
    map(&c, 1, 0, 6, F::MAP_WRITE | F::MAP_INVALIDATE_RANGE | F::MAP_UNSYNCHRONIZED).unwrap();
    c.unmap_buffer(1).unwrap();
    assert_eq!(c.get_buffer_sub_data(1, 3, 6).unwrap(), b"\0\0\0bc\0");
    map(&c, 1, 0, 1, F::MAP_WRITE | F::MAP_INVALIDATE_BUFFER).unwrap();
    c.unmap_buffer(1).unwrap();
    assert_eq!(c.get_buffer_sub_data(1, 0, 16).unwrap(), [0; 16]);
}

#[test]
fn explicit_flush_brings_the_flushed_bytes_alone() {
    let (c, mapping) = prepared(Some(F::MAP_WRITE | F::MAP_FLUSH_EXPLICIT));
    mapping.unwrap().write(0, b"abcdefgh").unwrap();
    c.flush_mapped_buffer_range(1, 2, 3).unwrap();
    c.flush_mapped_buffer_range(1, 7, 1).unwrap();
    c.unmap_buffer(1).unwrap();
    assert_eq!(c.get_buffer_sub_data(1, 4, 8).unwrap(), b"\0\0cde\0\0h");
}

#[test]
fn a_persistent_mapping_is_seen_at_once_only_if_it_is_coherent() {
    let access = F::MAP_READ | F::MAP_WRITE | F::MAP_PERSISTENT;
    let (c, _) = prepared(None);
    let coherent = c.map_buffer_range(3, 0, 16, access | F::MAP_COHERENT).unwrap();
    coherent.write(0, b"ab").unwrap();
    assert_eq!(c.get_buffer_sub_data(3, 0, 2).unwrap(), b"ab");
    c.buffer_sub_data(3, 1, b"c").unwrap();
    assert_eq!(coherent.read(0, 2).unwrap(), b"ac");
    c.unmap_buffer(3).unwrap();
    // Without coherence a barrier carries bytes both ways.
    let mapping = c.map_buffer_range(3, 0, 16, access).unwrap();
    mapping.write(0, b"x").unwrap();
    c.buffer_sub_data(3, 1, b"y").unwrap();
    assert_eq!(c.get_buffer_sub_data(3, 0, 2).unwrap(), b"ay");
    assert_eq!(mapping.read(0, 2).unwrap(), b"xc");
    c.client_mapped_buffer_barrier(3).unwrap();
    assert_eq!(c.get_buffer_sub_data(3, 0, 2).unwrap(), b"xy");
    assert_eq!(mapping.read(0, 2).unwrap(), b"xy");
    c.unmap_buffer(3).unwrap();
    // With explicit flush a barrier does not take the place of flushing.
    let mapping = c.map_buffer_range(3, 0, 16, access | F::MAP_FLUSH_EXPLICIT).unwrap();
    mapping.write(0, b"pq").unwrap();
    c.client_mapped_buffer_barrier(3).unwrap();
    assert_eq!(c.get_buffer_sub_data(3, 0, 2).unwrap(), b"xy");
    c.flush_mapped_buffer_range(3, 1, 1).unwrap();
    assert_eq!(c.get_buffer_sub_data(3, 0, 2).unwrap(), b"xq");
}

#[test]
fn copies_clears_and_invalidations_give_these_bytes() {
    let (mut c, _) = prepared(None);
    c.buffer_sub_data(1, 0, b"0123456789abcdef").unwrap();
    c.copy_buffer_sub_data((1, 2), (2, 4), 3).unwrap();
    assert_eq!(c.get_buffer_sub_data(2, 3, 5).unwrap(), b"\x00234\0");
    c.copy_buffer_sub_data((1, 0), (1, 8), 8).unwrap();
    assert_eq!(c.get_buffer_sub_data(1, 0, 16).unwrap(), b"0123456701234567");
    c.clear_buffer_sub_data(1, Format::Rg16Uint, (4, 8), b"wxyz").unwrap();
    assert_eq!(c.get_buffer_sub_data(1, 0, 16).unwrap(), b"0123wxyzwxyz4567");
    c.invalidate_buffer_sub_data(1, 1, 14).unwrap();
    assert_eq!(c.get_buffer_sub_data(1, 0, 16).unwrap(), b"0\0\0\0\0\0\0\0\0\0\0\0\0\x00\x007");
    // Through targets, and with nothing to do at the end of a buffer.
    c.bind_buffer(BufferTarget::CopyRead, 1).unwrap();
    c.bind_buffer(BufferTarget::CopyWrite, 2).unwrap();
    c.copy_buffer_sub_data((BufferTarget::CopyRead, 15), (BufferTarget::CopyWrite, 15), 1).unwrap();
    c.copy_buffer_sub_data((BufferTarget::CopyRead, 16), (BufferTarget::CopyWrite, 16), 0).unwrap();
    assert_eq!(c.get_buffer_sub_data(2, 15, 1).unwrap(), b"7");
}

#[test]
fn parameters_are_those_of_the_storage_and_the_mapping() {
    let (c, _mapping) = prepared(WRITE);
    let of = |name: u32| c.get_buffer_parameters(name).unwrap();
    assert_eq!((of(1).size, of(1).access, of(1).mapped), (16, WRITE, (4, 8)));
    assert_eq!(of(1).flags, F::MAP_READ | F::MAP_WRITE | F::DYNAMIC_STORAGE);
    assert_eq!((of(2).flags, of(2).is_immutable, of(2).usage), (F::NONE, true, Usage::DynamicDraw));
    assert_eq!((of(4).size, of(4).is_immutable, of(4).usage, of(4).access), (0, false, Usage::StaticDraw, None));
}

/// Sixty formats: cleared are those of table 8.16, no others.
#[test]
fn formats_of_buffers_are_those_of_buffer_textures() {
    let (c, _) = prepared(None);
    let mut taken = Vec::new();
    for format in Format::ALL {
        let texel = vec![0; format.bytes()];
        if c.clear_buffer_sub_data(1, *format, (0, 0), &texel).is_ok() {
            taken.push(format.name());
        }
    }
    let channels = |prefix: &str, kinds: &[&str]| kinds.iter().map(|k| format!("{prefix}{k}")).collect::<Vec<_>>();
    let mut expected = Vec::new();
    for c in ["R", "Rg", "Rgba"] {
        expected.extend(channels(&format!("{c}8"), &["Unorm", "Uint", "Sint"]));
        expected.extend(channels(&format!("{c}16"), &["Unorm", "Uint", "Sint", "Float"]));
        expected.extend(channels(&format!("{c}32"), &["Uint", "Sint", "Float"]));
    }
    expected.extend(channels("Rgb32", &["Uint", "Sint", "Float"]));
    taken.sort_unstable();
    expected.sort_unstable();
    assert_eq!(taken, expected);
}
