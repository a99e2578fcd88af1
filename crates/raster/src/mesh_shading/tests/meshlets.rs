use glam::Vec3;

use super::shapes::{Mesh, Random, grid, icosphere, soup, torus};
use crate::mesh_shading::{MeshletLimits, Meshlets};

const LIMITS: [MeshletLimits; 4] = [
    MeshletLimits { vertices: 64, triangles: 126 },
    MeshletLimits::LARGEST,
    MeshletLimits { vertices: 3, triangles: 1 },
    MeshletLimits { vertices: 17, triangles: 256 },
];

/// Each triangle is there once, with its corners in order; tables are dense and within the limits.
fn check(mesh: &Mesh, limits: MeshletLimits) -> Meshlets {
    let meshlets = Meshlets::build(&mesh.positions, &mesh.indices, limits).unwrap();
    let mut seen = vec![false; mesh.triangles().len()];
    let indices = meshlets.to_indices();
    for (corners, &source) in indices.as_chunks::<3>().0.iter().zip(meshlets.sources()) {
        assert_eq!(*corners, mesh.triangles()[source as usize]);
        assert!(!std::mem::replace(&mut seen[source as usize], true), "triangle {source} is there twice");
    }
    assert!(seen.iter().all(|&s| s));
    assert_eq!((meshlets.triangles().len() * 3, meshlets.sources().len() * 3), (indices.len(), indices.len()));
    let (mut vertex, mut triangle) = (0, 0);
    for meshlet in meshlets.meshlets() {
        let (vertices, triangles) = (meshlet.vertices(), meshlet.triangles());
        assert_eq!((vertices.start, triangles.start), (vertex, triangle));
        (vertex, triangle) = (vertices.end, triangles.end);
        assert!((1..=limits.vertices).contains(&vertices.len()) && (1..=limits.triangles).contains(&triangles.len()));
        let mut table = meshlets.vertices()[vertices.clone()].to_vec();
        table.sort_unstable();
        assert!(table.windows(2).all(|w| w[0] != w[1]), "a vertex is in a table twice");
        let mut used = vec![false; vertices.len()];
        meshlets.triangles()[triangles].iter().flatten().for_each(|&corner| used[usize::from(corner)] = true);
        assert!(used.iter().all(|&u| u), "a vertex of a table has no triangle");
    }
    assert_eq!((vertex, triangle), (meshlets.vertices().len(), meshlets.triangles().len()));
    meshlets
}

#[test]
fn meshlets_are_the_mesh_triangle_by_triangle() {
    let mut random = Random(1);
    let mut meshes = vec![grid(33), torus(40, 24), icosphere(4)];
    meshes.extend([(3, 40), (300, 2000), (100_000, 3000)].map(|(v, t)| soup(v, t, &mut random)));
    for mesh in &meshes {
        for limits in LIMITS {
            let meshlets = check(mesh, limits);
            assert_eq!(meshlets, Meshlets::build(&mesh.positions, &mesh.indices, limits).unwrap());
        }
    }
}

#[test]
fn meshlets_of_odd_meshes() {
    let build = |positions: &[Vec3], indices: &[u32]| Meshlets::build(positions, indices, MeshletLimits::default());
    assert_eq!(build(&[], &[]).unwrap(), Meshlets::default());
    assert_eq!(build(&[Vec3::NAN; 9], &[]).unwrap().meshlets().len(), 0);
    // Degenerate triangles stay, and vertices without triangles may be anything.
    let mut positions = vec![Vec3::NAN; 5];
    positions[..3].copy_from_slice(&[Vec3::ZERO, Vec3::X, Vec3::Y]);
    let odd = Mesh { positions, indices: vec![0, 0, 0, 1, 2, 1, 2, 1, 0, 2, 1, 0, 0, 2, 2] };
    assert_eq!(check(&odd, MeshletLimits::default()).meshlets().len(), 1);
    // Coordinates at the ends of the range.
    let mut random = Random(5);
    let huge = Mesh { positions: (0..300).map(|_| random.point(f32::MAX)).collect(), indices: (0..300).collect() };
    check(&huge, MeshletLimits::default());
    let same = Mesh { positions: vec![Vec3::splat(f32::MIN_POSITIVE); 300], indices: (0..300).collect() };
    assert_eq!(check(&same, MeshletLimits { vertices: 64, triangles: 126 }).meshlets().len(), 5);
    // All triangles about one vertex.
    let fan = |i: u32| [0, i + 1, i + 2];
    let positions = (0..100_002).map(|i| Vec3::new(i as f32, (i % 7) as f32, 0.0)).collect();
    let fan = check(&Mesh { positions, indices: (0..100_000).flat_map(fan).collect() }, MeshletLimits::default());
    assert!(fan.meshlets().len() < 1700, "{}", fan.meshlets().len());
}

#[test]
fn meshlets_refuse_by_name() {
    let positions = [Vec3::ZERO, Vec3::X, Vec3::new(0.0, f32::INFINITY, 0.0)];
    let rule = |indices: &[u32], vertices, triangles| {
        Meshlets::build(&positions, indices, MeshletLimits { vertices, triangles }).unwrap_err().rule
    };
    assert_eq!(rule(&[0, 1, 3], 64, 126), "index 3 at place 2; there are 3 positions");
    assert_eq!(rule(&[0, 1, 1, u32::MAX, 0, 0], 64, 126), "index 4294967295 at place 3; there are 3 positions");
    assert_eq!(rule(&[0, 1], 64, 126), "2 indices; three for each triangle");
    assert!(rule(&[0, 1, 2], 64, 126).contains("position 2 is"));
    assert!(rule(&[], 2, 126).contains("from 3 to 256") && rule(&[], 257, 126).contains("257 vertices"));
    assert!(rule(&[], 64, 0).contains("from 1 to 256") && rule(&[], 64, 257).contains("257 triangles"));
}

/// Numbers of meshlets and of entries of their tables that `meshopt_buildMeshlets` (cone weight 0.25) of meshoptimizer
/// 0.2.30a0 (its package for Python) gives for these meshes.
#[test]
fn meshlets_are_as_few_as_those_of_meshoptimizer() {
    let small = MeshletLimits { vertices: 64, triangles: 126 };
    let large = MeshletLimits { vertices: 128, triangles: 256 };
    let cases = [
        (grid(64), small, 89, 5673),
        (grid(64), large, 40, 5109),
        (torus(96, 48), small, 98, 6231),
        (torus(96, 48), large, 45, 5706),
    ];
    for (mesh, limits, count, vertices) in cases {
        let found = check(&mesh, limits);
        let (n, v) = (found.meshlets().len(), found.vertices().len());
        assert!(
            n * 20 <= count * 21 && v * 20 <= vertices * 21,
            "{n} meshlets for {count}, {v} vertices for {vertices}"
        );
    }
}
