//! The examples have the same bits everywhere.

use steradian_image::Image;

#[path = "../../examples/builds/main.rs"]
mod builds;
#[path = "../../examples/closest_hit.rs"]
mod closest_hit;
#[path = "../../examples/leaves.rs"]
mod leaves;
#[path = "../../examples/spheres.rs"]
mod spheres;
#[path = "../../examples/triangle.rs"]
mod triangle;

fn fingerprint(image: &Image) -> u64 {
    let bytes = image.channels().iter().flat_map(|channel| &channel.data).flat_map(|value| value.to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3))
}

/// Fingerprints of pictures that were looked at. They use no function whose bits differ from machine to machine.
#[test]
fn examples_are_what_they_were() {
    let pictures = [
        ("triangle", triangle::picture().map(|(image, _)| image), 0x9b24c4440e51d0c3),
        ("closest_hit", closest_hit::picture(), 0x93fef1aa221946a1),
        ("spheres", spheres::picture(), 0xc2abf0d9b772a54b),
        ("leaves", leaves::picture(), 0x3fd98a0481311fd2),
        ("builds", builds::picture().map(|(image, _)| image), 0xa7824770d6199dc6),
    ];
    let found: Vec<_> = pictures.iter().map(|(name, image, _)| (*name, fingerprint(image.as_ref().unwrap()))).collect();
    let expected: Vec<_> = pictures.iter().map(|(name, _, hash)| (*name, *hash)).collect();
    assert_eq!(found, expected);
}

/// Sizes printed by the example but for scratch memory. Compacted: 36 bytes of each of 3200 triangles, 256 of each node
/// and 320 of each block.
#[test]
fn what_builds_take_is_what_it_was() {
    let (_, said) = builds::picture().expect("valid");
    let expected = ["  built 308808, compacted 276384", "  built 70988, compacted 54748"];
    let built: Vec<_> = said.lines().filter(|line| line.starts_with("  built")).collect();
    assert_eq!(built, expected);
    assert!(said.contains("serialized 163, 136057\ncapture 136516, handle [86, d2, 6f, 9c, 2c, 5f, 1b, 4f]"), "{said}");
}
