use glam::Vec3;

use super::shapes::{grid, torus};
use crate::mesh_shading::{BytesRead, MeshletLimits, Meshlets, Overdraw, VertexReuse};

/// Vertices shaded as `meshopt_analyzeVertexCache` (warp size 0) of meshoptimizer 0.2.30a0 counts them.
#[test]
fn mesh_vertex_reuse_is_that_of_meshoptimizer() {
    for (mesh, cache, shaded) in [
        (grid(64), 16, 8320),
        (grid(64), 32, 8320),
        (torus(96, 48), 16, 9313),
        (torus(96, 48), 32, 9313),
        (grid(12), 16, 312),
        (grid(12), 32, 169),
    ] {
        let reuse = VertexReuse::of_indices(&mesh.indices, cache);
        assert_eq!(reuse.shaded, shaded);
        assert_eq!(reuse.acmr(), shaded as f64 / mesh.triangles().len() as f64);
        assert_eq!(reuse.atvr(), shaded as f64 / mesh.positions.len() as f64);
    }
    assert_eq!(VertexReuse::of_indices(&[0, 1, 2, 1, 2, 3], 0).shaded, 6);
    assert_eq!(VertexReuse::of_indices(&[0, 1, 2, 7, 8], 16), VertexReuse { shaded: 3, distinct: 3, triangles: 1 });
    assert_eq!(VertexReuse::of_indices(&[], 16).acmr(), 0.0);
}

#[test]
fn meshlets_share_vertices_better_than_a_cache_of_16() {
    let mesh = torus(96, 48);
    let meshlets = Meshlets::build(&mesh.positions, &mesh.indices, MeshletLimits::default()).unwrap();
    let reuse = VertexReuse::of_meshlets(&meshlets);
    assert_eq!((reuse.distinct, reuse.triangles), (96 * 48, 2 * 96 * 48));
    assert!(reuse.acmr() < 0.72 && reuse.atvr() < 1.44, "{} {}", reuse.acmr(), reuse.atvr());
}

#[test]
fn mesh_overdraw_of_sheets_is_their_number() {
    // Squares one behind the other that face +z.
    let sheet =
        |z: u16| [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(x, y)| Vec3::new(x as f32, y as f32, f32::from(z) / 8.0));
    let positions: Vec<Vec3> = (0..5).flat_map(sheet).collect();
    let square = |i: u32| [0, 1, 2, 0, 2, 3].map(|corner| 4 * i + corner);
    let near_last: Vec<u32> = (0..5).flat_map(square).collect();
    let near_first: Vec<u32> = (0..5).rev().flat_map(square).collect();
    let measure = |indices: &[u32]| Overdraw::of_indices(&positions, indices).unwrap();
    assert_eq!(measure(&near_last), Overdraw { covered: 65536, shaded: 5 * 65536 });
    assert_eq!(measure(&near_first), Overdraw { covered: 65536, shaded: 65536 });
    assert!(Overdraw::of_indices(&[], &[0]).unwrap_err().rule.contains("index 0"));
    assert_eq!(Overdraw::of_indices(&[], &[]).unwrap().ratio(), 0.0);
}

/// `meshopt_analyzeOverdraw` of meshoptimizer 0.2.30a0, which has a rasteriser of its own, finds 1.1197.
#[test]
fn mesh_overdraw_is_close_to_that_of_meshoptimizer() {
    let mesh = torus(96, 48);
    let overdraw = Overdraw::of_indices(&mesh.positions, &mesh.indices).unwrap();
    assert!((overdraw.ratio() / 1.1197 - 1.0).abs() < 0.01, "{overdraw:?} {}", overdraw.ratio());
}

#[test]
fn meshlets_are_read_with_fewer_bytes_than_indices() {
    let mesh = torus(96, 48);
    let meshlets = Meshlets::build(&mesh.positions, &mesh.indices, MeshletLimits::default()).unwrap();
    let indexed = BytesRead::of_indices(&mesh.indices, 16, 4, 24);
    assert_eq!(indexed, BytesRead { topology: 3 * 4 * 9216, vertices: 9313 * 24 });
    let read = BytesRead::of_meshlets(&meshlets, |_| true, 24);
    let [count, table] = [meshlets.meshlets().len(), meshlets.vertices().len()].map(|n| n as u64);
    assert_eq!(read, BytesRead { topology: 60 * count + 3 * 9216 + 4 * table, vertices: 24 * table });
    assert!(read.topology * 10 < indexed.topology * 6 && read.total() * 10 < indexed.total() * 7, "{read:?}");
    // What is culled costs its bounds alone.
    let none = BytesRead::of_meshlets(&meshlets, |_| false, 24);
    assert_eq!((none.topology, none.vertices), (60 * count, 0));
    let halves = [0, 1].map(|odd| BytesRead::of_meshlets(&meshlets, |i| i % 2 == odd, 24).total());
    assert_eq!(halves[0] + halves[1], read.total() + none.total());
}
