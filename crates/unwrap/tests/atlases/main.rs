//! Atlases of closed forms, of real files and of broken meshes: nothing overlaps, whatever comes in.

mod check;
mod shapes;

use check::{checked, checked_with};
use shapes::{Shape, grid, soup};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use steradian_testkit::asset;
use steradian_unwrap::{Error, MOST_TRIANGLES, Mesh, NO_CHART, Options, unwrap};

#[test]
fn a_cube_has_a_chart_for_each_face() {
    let metrics = checked(&shapes::cube()).metrics;
    assert_eq!((metrics.charts, metrics.degenerate), (6, 0));
    assert!((metrics.stretch_l2 - 1.0).abs() < 1e-4 && (metrics.stretch_max - 1.0).abs() < 1e-4, "{metrics:?}");
    assert!((metrics.conformal - 1.0).abs() < 1e-4 && (metrics.area - 6.0).abs() < 1e-9, "{metrics:?}");
    assert!((metrics.seam_length - 12.0).abs() < 1e-9 && metrics.utilisation > 0.6, "{metrics:?}");
}

/// The wall of a cylinder is developable: the map is an isometry of each facet.
#[test]
fn an_open_cylinder_unrolls_without_stretch() {
    let wall = grid(48, 10, true, false, |u, v| [(TAU * u).cos(), (TAU * u).sin(), 2.0 * v]);
    let metrics = checked(&wall).metrics;
    assert!(metrics.charts <= 4, "{metrics:?}");
    assert!((metrics.stretch_l2 - 1.0).abs() < 1e-3 && metrics.stretch_max < 1.01, "{metrics:?}");
    assert!(metrics.conformal < 1.001, "{metrics:?}");
}

#[test]
fn a_sphere_and_a_torus_stretch_little() {
    let sphere = grid(64, 32, true, false, |u, v| {
        let (theta, phi) = (PI * v, TAU * u);
        [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()]
    });
    let torus = grid(64, 32, true, true, |u, v| {
        let (a, b) = (TAU * u, TAU * v);
        let r = 1.0 + 0.4 * b.cos();
        [r * a.cos(), r * a.sin(), 0.4 * b.sin()]
    });
    for (shape, charts) in [(sphere, 20), (torus, 40)] {
        let metrics = checked(&shape).metrics;
        assert!(metrics.charts <= charts && metrics.stretch_l2 < 1.1 && metrics.conformal < 1.05, "{metrics:?}");
        assert!(metrics.utilisation > 0.5, "{metrics:?}");
    }
}

/// A wavy height field is a disk, but not flat.
#[test]
fn a_height_field_is_a_single_chart() {
    let waves = grid(40, 40, false, false, |u, v| [u, v, 0.05 * (9.0 * u).sin() * (7.0 * v).cos()]);
    let metrics = checked(&waves).metrics;
    assert!(metrics.charts <= 4 && metrics.stretch_l2 < 1.05 && metrics.conformal < 1.1, "{metrics:?}");
}

#[test]
fn given_seams_are_cut() {
    let plane = grid(4, 4, false, false, |u, v| [u, v, 0.0]);
    assert_eq!(checked(&plane).metrics.charts, 1);
    let seams: Vec<[u32; 2]> = (0..4).map(|i| [5 * i + 2, 5 * i + 7]).collect();
    let mesh = Mesh { seams: &seams, ..plane.mesh() };
    let atlas = unwrap(&mesh, &Options::default()).unwrap();
    assert_eq!(atlas.metrics.charts, 2);
    assert!((atlas.metrics.seam_length - 1.0).abs() < 1e-9);
}

/// Files split vertices where normals jump; the triangles are neighbours all the same.
#[test]
fn vertices_at_one_position_are_one() {
    let plane = grid(8, 8, false, false, |u, v| [u, v, 0.0]);
    let apart = Shape {
        positions: plane.triangles.iter().flatten().map(|i| plane.positions[*i as usize]).collect(),
        triangles: (0..plane.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
    };
    assert_eq!(checked(&apart).metrics.charts, 1);
}

#[test]
fn what_is_no_manifold_is_cut_where_it_is_none() {
    // Three sheets at one edge.
    let book = Shape {
        positions: vec![[0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [-0.5, 0.8, 0.0], [-0.5, -0.8, 0.0]],
        triangles: vec![[0, 1, 2], [0, 1, 3], [0, 1, 4]],
    };
    assert_eq!(checked(&book).metrics.charts, 3);
    let strip = grid(40, 4, false, false, |u, v| {
        let (a, w) = (TAU * u, v - 0.5);
        let r = 1.0 + w * (0.5 * a).cos();
        [r * a.cos(), r * a.sin(), w * (0.5 * a).sin()]
    });
    checked(&strip.rounded(1e3));
    // The same triangle twice, and with its back.
    let doubled = Shape { positions: book.positions.clone(), triangles: vec![[0, 1, 2], [0, 1, 2], [2, 1, 0]] };
    assert_eq!(checked(&doubled).metrics.charts, 3);
    // Two cones that touch at their tips.
    let cones = grid(12, 6, true, false, |u, v| {
        let z = 2.0 * v - 1.0;
        [z * (TAU * u).cos(), z * (TAU * u).sin(), z]
    });
    checked(&cones);
}

#[test]
fn triangles_without_area_are_in_no_chart() {
    let mut plane = grid(4, 4, false, false, |u, v| [u, v, 0.0]);
    plane.triangles.extend([[0, 0, 0], [0, 1, 1], [0, 1, 2]]);
    let atlas = checked(&plane);
    assert_eq!((atlas.metrics.charts, atlas.metrics.degenerate), (1, 3));
    assert!(atlas.charts[32..].iter().all(|c| *c == NO_CHART));
    let needle = Shape {
        positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.5, 1e-6, 0.0], [0.5, 1.0, 0.0]],
        triangles: vec![[0, 1, 2], [0, 2, 3], [2, 1, 3]],
    };
    checked(&needle);
}

#[test]
fn random_triangles_do_not_overlap() {
    for seed in 0..4 {
        checked_with(&soup(300, 900, seed), &Options { resolution: 2048, padding: 2, ..Options::default() });
        // Few vertices, so that edges have many triangles.
        checked_with(&soup(40, 400, seed), &Options { resolution: 2048, padding: 2, ..Options::default() });
    }
}

#[test]
fn options_are_obeyed() {
    let rounded = grid(32, 16, true, false, |u, v| {
        let (theta, phi) = (PI * v, TAU * u);
        [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()]
    });
    for (resolution, padding) in [(64, 0), (100, 3), (4096, 16)] {
        checked_with(&rounded, &Options { resolution, padding, ..Options::default() });
    }
    let charts = |cone: f64| checked_with(&rounded, &Options { cone, ..Options::default() }).metrics.charts;
    assert!(charts(0.5) > charts(1.2));
    let bevel = Options { seam_angle: FRAC_PI_2 + 0.1, ..Options::default() };
    assert!(checked_with(&shapes::cube(), &bevel).metrics.charts < 6);
}

#[test]
fn faults_are_told() {
    let of = |positions: &[[f32; 3]], triangles: &[[u32; 3]]| {
        unwrap(&Mesh { positions, triangles, seams: &[] }, &Options::default()).map(|_| ())
    };
    assert_eq!(of(&[], &[]), Err(Error::Empty));
    assert_eq!(of(&[[0.0; 3]], &[[0, 0, 0]]), Err(Error::Empty));
    assert_eq!(of(&[[f32::NAN; 3]], &[[0, 0, 0]]), Err(Error::NotFinite(0)));
    assert_eq!(of(&[[0.0; 3]], &[[0, 1, 0]]), Err(Error::IndexOutOfRange { triangle: 0, vertex: 1, count: 1 }));
    let many = vec![[0; 3]; MOST_TRIANGLES + 1];
    assert_eq!(of(&[[0.0; 3]], &many), Err(Error::TooLarge(MOST_TRIANGLES + 1)));
    let tight = Options { resolution: 64, padding: 16, ..Options::default() };
    let refused = unwrap(&soup(300, 100, 1).mesh(), &tight);
    assert_eq!(refused.unwrap_err(), Error::DoesNotFit { charts: 99, padding: 16, resolution: 64 });
}

/// A model of a cow.
#[test]
fn a_model_is_unwrapped_with_little_stretch() {
    let Some(path) = asset("obj/spot/spot_triangulated.obj") else { return };
    let cow = Shape::read(&std::fs::read_to_string(path).unwrap());
    let metrics = checked(&cow).metrics;
    assert!(metrics.charts < 60 && metrics.stretch_l2 < 1.1 && metrics.conformal < 1.1, "{metrics:?}");
    assert!(metrics.utilisation > 0.5 && metrics.degenerate == 0, "{metrics:?}");
}
