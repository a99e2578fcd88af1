//! Geometry that work groups make.

use steradian_raster::{
    glam::{Vec3, Vec4},
    mesh_shading::{BytesRead, MeshletLimits, Meshlets},
};

use crate::{
    examples::{
        forest,
        icosphere_lod::{Ball, draw},
        meshlets,
    },
    stage::framebuffer,
};

#[test]
fn an_icosphere_has_20_times_4_to_the_k_triangles() {
    let mut target = framebuffer(8, 1);
    let counts = [(0, 20), (1, 80), (3, 1280), (5, 20_480), (7, 327_680), (9, 5_242_880)];
    for (level, triangles) in counts {
        let counters = draw(&[Ball { center: Vec3::ZERO, level }], &mut target, true).unwrap();
        assert_eq!((counters.task_groups, counters.primitives), (20, triangles));
        // Groups of 64 triangles about 45 vertices, from the third level on.
        let groups = 20 * 4u64.pow(level.saturating_sub(3));
        let rows = 1 << level.min(3);
        assert_eq!((counters.mesh_groups, counters.vertices), (groups, groups * (rows + 1) * (rows + 2) / 2));
    }
}

/// Faces and patches meet without gaps or overlaps: each pixel of the disc is drawn once.
#[test]
fn an_icosphere_is_closed_at_all_levels() {
    for level in [0, 1, 2, 3, 4, 6] {
        let mut target = framebuffer(256, 1);
        target.clear(Vec4::ZERO, 1.0, 0);
        let ball = Ball { center: Vec3::new(0.0, 0.0, -3.0), level };
        let counters = draw(&[ball], &mut target, false).unwrap();
        assert_eq!(counters.primitives, 20 * 4u64.pow(level));
        let covered =
            (0..256 * 256).filter(|i| target.color(0).pixel(i % 256, i / 256).unwrap().w > 0.0).count() as u64;
        assert_eq!(counters.rasterized.fragments, covered, "level {level}");
        // The disc's radius is 1/√8 of the distance; 128 pixels are half of it.
        let disc = std::f64::consts::PI * (256.0f64 / 8f64.sqrt()).powi(2);
        let least = if level < 2 { 0.7 } else { 1.0 - 0.4 * 0.25f64.powi(level as i32) - 0.005 };
        assert!((least..1.005).contains(&(covered as f64 / disc)), "level {level}: {covered} of {disc} pixels");
        // No pixel within is left out.
        for row in 0..256 {
            let line: Vec<bool> = (0..256).map(|x| target.color(0).pixel(x, row).unwrap().w > 0.0).collect();
            let changes = line.windows(2).filter(|w| w[0] != w[1]).count();
            assert!(changes <= 2, "level {level}, row {row}");
        }
    }
}

#[test]
fn a_forest_expands_from_16_bytes_for_each_tree() {
    let trees = forest::forest();
    let mut target = framebuffer(64, 1);
    let counters = forest::draw(&trees, &mut target).unwrap();
    // Distances from 3 to 28.5: full trees nearer than 8, then a level less for each doubling.
    let branches: u64 = (0..16u64)
        .map(|row| match 3.0 + 1.7 * row as f64 {
            distance if distance < 8.0 => 16 * 255,
            distance if distance < 16.0 => 16 * 127,
            _ => 16 * 63,
        })
        .sum();
    assert_eq!((counters.task_groups, counters.mesh_groups), (256, branches));
    assert_eq!((counters.vertices, counters.primitives), (8 * branches, 8 * branches));
    // The same triangles in buffers: 16-bit indices of each triangle, positions of 12 bytes, a colour of 4 for each
    // triangle.
    let buffers = counters.primitives * (3 * 2 + 4) + counters.vertices * 12;
    let read = (size_of::<forest::Tree>() * trees.len()) as u64;
    assert!(read == 4096 && buffers > 1000 * read, "{buffers} bytes of buffers");
}

#[test]
fn meshlets_that_show_their_backs_are_not_drawn() {
    let (positions, indices) = meshlets::torus(96, 48);
    let all = Meshlets::build(&positions, &indices, MeshletLimits::default()).unwrap();
    let eye = Vec3::new(0.0, 1.68, 2.24);
    let drawn = |i: usize| !all.meshlets()[i].cone.faces_away_from(eye);
    let seen: Vec<_> = (0..all.meshlets().len()).filter(|&i| drawn(i)).collect();
    let (_, counters) = meshlets::draw().unwrap();
    assert_eq!((counters.task_groups, counters.mesh_groups), (4, seen.len() as u64));
    let triangles: usize = seen.iter().map(|&i| all.meshlets()[i].triangles().len()).sum();
    assert_eq!(counters.primitives, triangles as u64);
    // Three quarters of the triangles, and three fifths of the bytes of an indexed draw with vertices of 24 bytes.
    let indexed = BytesRead::of_indices(&indices, 16, 4, 24).total();
    let read = BytesRead::of_meshlets(&all, drawn, 24).total();
    assert!(triangles * 4 < 9216 * 3 && read * 5 < indexed * 3, "{triangles}, {read} of {indexed}");
}
