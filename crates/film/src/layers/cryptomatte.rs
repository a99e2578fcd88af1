//! Cryptomatte: which named objects and materials cover each pixel, and how much of it (J. Friedman and A. C. Jones,
//! *Fully automatic ID mattes with support for motion blur and transparency*, SIGGRAPH 2015 posters; specification
//! 1.2).
//!
//! A name's id is its MurmurHash3, bent so that it is a normal `f32`. Layers `crypto_object00` … hold two pairs of id
//! and coverage each, those that cover most first. Metadata tell how ids were made, and the manifest which name has
//! which id.

use super::{Layer, Row, Write, push as push_plane};
use crate::{Hits, LayerInputs, MatteSums};
use std::collections::BTreeMap;
use steradian_image::{Image, Value};

/// Named objects and materials, and the part of the pixel that each covers.
pub const CRYPTOMATTE: Layer = Layer(&Row {
    name: "cryptomatte",
    channels: &["crypto_object00.r", "crypto_object00.g", "crypto_object00.b", "crypto_object00.a"],
    doc: "Cryptomatte 1.2, six ranks: crypto_object00..02.rgba crypto_material00..02.rgba, with manifests",
    in_all: true,
    inputs: LayerInputs::MATTES,
    write: Write::Film(|film, names, image| {
        let mattes = &film.layers.mattes;
        if !mattes.is_empty() {
            push(image, "crypto_object", &names.objects, mattes, |m| &m.objects);
            push(image, "crypto_material", &names.materials, mattes, |m| &m.materials);
        }
    }),
});

/// Pairs of id and coverage that are written: two for each layer of four channels.
const RANKS: usize = 6;

/// Adds the mattes of things with these names, by their numbers from one, in layers that are called after `layer`.
fn push(
    image: &mut Image,
    layer: &str,
    names: &BTreeMap<u32, String>,
    mattes: &[MatteSums],
    hits: impl Fn(&MatteSums) -> &Hits,
) {
    let ids: BTreeMap<u32, f32> = names.iter().map(|(number, name)| (*number, id(name))).collect();
    let ranked: Vec<[[f32; 2]; RANKS]> = mattes.iter().map(|m| ranks(hits(m), m.samples, &ids)).collect();
    for rank in 0..RANKS {
        let (number, channels) = (rank / 2, [["r", "g"], ["b", "a"]][rank % 2]);
        for (k, channel) in channels.into_iter().enumerate() {
            let data = ranked.iter().map(|r| r[rank][k]).collect();
            push_plane(image, &format!("{layer}{number:02}.{channel}"), data);
        }
    }
    let key = format!("{:08x}", murmur3(layer.as_bytes()));
    let mut set = |what: &str, text: String| {
        image.metadata.set(format!("cryptomatte/{}/{what}", &key[..7]), Value::Text(text));
    };
    let manifest: BTreeMap<&str, String> =
        names.values().map(|name| (name.as_str(), format!("{:08x}", id(name).to_bits()))).collect();
    set("name", layer.into());
    set("hash", "MurmurHash3_32".into());
    set("conversion", "uint32_to_float32".into());
    // Maps of texts always have a JSON form.
    set("manifest", serde_json::to_string(&manifest).unwrap_or_default());
}

/// Ids and coverages, the largest first, then by id. Things of the same name are one.
fn ranks(hits: &Hits, samples: u32, ids: &BTreeMap<u32, f32>) -> [[f32; 2]; RANKS] {
    let mut counts: BTreeMap<u32, u32> = BTreeMap::new();
    for (number, count) in hits.iter() {
        if let Some(id) = ids.get(&number) {
            *counts.entry(id.to_bits()).or_default() += count;
        }
    }
    let mut sorted: Vec<(u32, u32)> = counts.into_iter().collect();
    sorted.sort_by_key(|(id, count)| (std::cmp::Reverse(*count), *id));
    let mut ranks = [[0.0; 2]; RANKS];
    for (rank, (id, count)) in ranks.iter_mut().zip(sorted) {
        *rank = [f32::from_bits(id), count as f32 / samples.max(1) as f32];
    }
    ranks
}

/// The id of a name: its hash as the bits of an `f32`, with the exponent held at 1 … 254, so that it is neither
/// denormal, infinite nor NaN.
fn id(name: &str) -> f32 {
    let hash = murmur3(name.as_bytes());
    let exponent = (hash >> 23 & 255).clamp(1, 254);
    f32::from_bits(hash & 0x807f_ffff | exponent << 23)
}

/// MurmurHash3, x86 variant of 32 bits, seed 0 (A. Appleby).
fn murmur3(bytes: &[u8]) -> u32 {
    let mixed = |k: u32| k.wrapping_mul(0xcc9e_2d51).rotate_left(15).wrapping_mul(0x1b87_3593);
    let (blocks, rest) = bytes.as_chunks::<4>();
    let mut h = blocks.iter().fold(0u32, |h, block| {
        (h ^ mixed(u32::from_le_bytes(*block))).rotate_left(13).wrapping_mul(5).wrapping_add(0xe654_6b64)
    });
    let mut last = [0; 4];
    last[..rest.len()].copy_from_slice(rest);
    h ^= mixed(u32::from_le_bytes(last)) ^ bytes.len() as u32;
    h = (h ^ h >> 16).wrapping_mul(0x85eb_ca6b);
    h = (h ^ h >> 13).wrapping_mul(0xc2b2_ae35);
    h ^ h >> 16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_those_of_the_specification() {
        // Published vectors of MurmurHash3_x86_32 with seed 0.
        for (text, hash) in [("", 0), ("test", 0xba6b_d213), ("hello", 0x248b_fa47), ("Hello, world!", 0xc036_3e43)] {
            assert_eq!(murmur3(text.as_bytes()), hash, "{text}");
        }
        // Ids of names as other programs write them.
        for (name, expected) in [("hello", 6.070_563e-17_f32), ("cube", -4.084_619e15), ("sphere", 2.790_186e15)] {
            let found = id(name);
            assert!((found / expected - 1.0).abs() < 1e-6, "{name} has the id {found:e}, not {expected:e}");
        }
        for k in 0..10_000 {
            assert!(id(&k.to_string()).is_normal());
        }
    }

    #[test]
    fn what_covers_most_comes_first() {
        let mut hits = Hits::default();
        for number in [1, 2, 2, 3, 2, 3] {
            hits.add(number);
        }
        // The first and the last have the same name.
        let ids = BTreeMap::from([(1, 1.0), (2, 2.0), (3, 1.0)]);
        let found = ranks(&hits, 8, &ids);
        assert_eq!(found[..3], [[1.0, 0.375], [2.0, 0.375], [0.0, 0.0]]);
    }
}
