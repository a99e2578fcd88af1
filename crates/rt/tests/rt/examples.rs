//! The examples have the same bits everywhere.

use steradian_image::Image;

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
    ];
    let found: Vec<_> = pictures.iter().map(|(name, image, _)| (*name, fingerprint(image.as_ref().unwrap()))).collect();
    let expected: Vec<_> = pictures.iter().map(|(name, _, hash)| (*name, *hash)).collect();
    assert_eq!(found, expected);
}
