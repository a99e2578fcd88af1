//! `steradian bench`.

use crate::Place;

/// Two triangles that make a square in the plane z = 0, seen from (0, 0, 1).
const SQUARE: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
    element face 2\nproperty list uchar int vertex_indices\nend_header\n\
    -1 -1 0\n1 -1 0\n1 1 0\n-1 1 0\n3 0 1 2\n3 0 2 3\n";

/// A file of rays.
fn rays(rays: &[[f32; 7]]) -> Vec<u8> {
    let numbers = rays.iter().flatten().flat_map(|x| x.to_le_bytes());
    (rays.len() as u64).to_le_bytes().into_iter().chain(numbers).collect()
}

#[test]
fn rays_of_a_file_are_traced_alike_in_every_mode() {
    let place = Place::new();
    place.file("square.ply", SQUARE);
    // Straight at it, past it, too short, and not a ray at all.
    let mut all: Vec<[f32; 7]> =
        (0..40).map(|i| [i as f32 / 50.0 - 0.4, 0.1, 2.0, 0.0, 0.0, -1.0, f32::INFINITY]).collect();
    all.push([5.0, 0.0, 2.0, 0.0, 0.0, -1.0, f32::INFINITY]);
    all.push([0.0, 0.0, 2.0, 0.0, 0.0, -1.0, 1.5]);
    all.push([f32::NAN; 7]);
    std::fs::write(place.path("rays.bin"), rays(&all)).unwrap();
    for mode in ["single", "packet", "stream"] {
        for query in ["closest", "occluded"] {
            let line = ["bench", "rays", "square.ply", "rays.bin", "--query", query, "--mode", mode, "--robust"];
            let more = ["--threads", "2", "--repeat", "1", "--json"];
            let json = place.succeed(&[&line[..], &more].concat()).json();
            assert_eq!((json["rays"].as_u64(), json["hits"].as_u64()), (Some(43), Some(40)), "{mode} {query}");
            let sum = if query == "closest" { 80.0 } else { 0.0 };
            assert_eq!(json["sum_t"].as_f64(), Some(sum));
            for positive in ["mrays_per_cpu_second", "mrays_per_second", "build_seconds", "bytes"] {
                assert!(json[positive].as_f64().is_some_and(|x| x > 0.0), "{positive}: {json}");
            }
        }
    }
    // One instance stands at the origin, turned: the square is seen by some ray or not, but always the same way.
    let line = ["bench", "rays", "square.ply", "rays.bin", "--instances", "1", "--repeat", "1", "--json"];
    let hits = |mode| place.succeed(&[&line[..], &["--mode", mode]].concat()).json()["hits"].as_u64();
    assert_eq!(hits("single"), hits("packet"));
    assert!(place.succeed(&line[..4]).stdout.contains("40 of 43 rays hit"));
}

#[test]
fn files_of_rays_that_are_not_sound_are_located() {
    let place = Place::new();
    place.file("square.ply", SQUARE);
    let whole = rays(&[[0.0; 7]; 3]);
    std::fs::write(place.path("short.bin"), &whole[..whole.len() - 1]).unwrap();
    std::fs::write(place.path("count.bin"), [&[255; 8], &whole[8..]].concat()).unwrap();
    place.refuse(2, &["bench", "rays", "square.ply", "short.bin"], &["short.bin", "byte 91", "2 rays and 27 of 28"]);
    place.refuse(2, &["bench", "rays", "square.ply", "count.bin"], &["count.bin", "byte 92", "18446744073709551615"]);
    place.refuse(2, &["bench", "rays", "square.ply", "none.bin"], &["none.bin"]);
    place.refuse(2, &["bench", "rays", "short.bin", "short.bin"], &["short.bin"]);
    place.refuse(2, &["bench", "rays", "square.ply", "short.bin", "--threads", "0"], &["--threads"]);
}
