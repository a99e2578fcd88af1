use glam::{DVec3, Vec3};

use super::shapes::{Mesh, Random, grid, icosphere, soup, torus};
use crate::mesh_shading::{MeshletLimits, Meshlets, NormalCone, Sphere};

/// Meshes, and which part of what could be culled their cones find at least, in percent.
fn meshes() -> [(Mesh, usize); 6] {
    let mut random = Random(3);
    let mut far = torus(48, 24);
    far.positions.iter_mut().for_each(|p| *p = *p * 0.25 + Vec3::new(148_376.0, 1234.0, -223_423.0));
    let mut thin = icosphere(3);
    thin.positions.iter_mut().for_each(|p| *p *= Vec3::new(1e-3, 1.0, 1e3));
    [(grid(40), 0), (torus(96, 48), 70), (icosphere(4), 70), (soup(400, 800, &mut random), 0), (far, 50), (thin, 0)]
}

/// A corner and the normal of a triangle.
type Plane = (DVec3, DVec3);

/// A mesh in small meshlets, and the plane of each triangle.
fn clustered(mesh: &Mesh, triangles: usize) -> (Meshlets, Vec<Plane>) {
    let meshlets = Meshlets::build(&mesh.positions, &mesh.indices, MeshletLimits { vertices: 64, triangles }).unwrap();
    let plane = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|i| mesh.positions[i as usize].as_dvec3());
        (a, (b - a).cross(c - a))
    };
    let planes = meshlets.to_indices().as_chunks::<3>().0.iter().map(plane).collect();
    (meshlets, planes)
}

#[test]
fn mesh_cones_cull_no_visible_triangle_in_a_million_views() {
    let mut random = Random(17);
    for (mesh, percent) in meshes() {
        let (meshlets, planes) = clustered(&mesh, 48);
        let all = Sphere::around(&mesh.positions);
        let (mut culled, mut hidden) = (0, 0);
        const VIEWS: usize = 170_000;
        for view in 0..VIEWS {
            let meshlet = &meshlets.meshlets()[random.below(meshlets.meshlets().len())];
            // From far, near, and within the cluster; one in four by parallel rays.
            let scale = [10.0, 2.0, 1.0, 0.1][random.below(4)];
            let eye = if scale > 0.5 {
                all.center + random.point(scale * all.radius)
            } else {
                meshlet.sphere.center + random.point(2.0 * meshlet.sphere.radius)
            };
            let parallel = view % 4 == 0;
            let (gone, seen): (bool, &dyn Fn(&Plane) -> bool) = if parallel {
                (meshlet.cone.faces_away_in(eye - all.center), &|p| (eye - all.center).as_dvec3().dot(p.1) < 0.0)
            } else {
                (meshlet.cone.faces_away_from(eye), &|p| (eye.as_dvec3() - p.0).dot(p.1) > 0.0)
            };
            let planes = &planes[meshlet.triangles()];
            if gone {
                culled += 1;
                assert!(!planes.iter().any(seen), "a visible triangle is culled from {eye}");
            }
            hidden += usize::from(!planes.iter().any(seen));
        }
        assert!(culled * 100 >= hidden * percent, "{culled} of {hidden} of {VIEWS}");
    }
}

#[test]
fn mesh_spheres_contain_their_triangles() {
    for (mesh, _) in meshes() {
        let (meshlets, _) = clustered(&mesh, 126);
        for meshlet in meshlets.meshlets() {
            let Sphere { center, radius } = meshlet.sphere;
            let points: Vec<Vec3> =
                meshlets.vertices()[meshlet.vertices()].iter().map(|&v| mesh.positions[v as usize]).collect();
            let farthest = points.iter().map(|p| p.as_dvec3().distance(center.as_dvec3())).fold(0.0, f64::max);
            assert!(farthest <= f64::from(radius) && f64::from(radius) <= farthest * 1.000_001 + 1e-30);
            // No sphere is smaller than half the longest distance; Ritter's is within a fifth of the best.
            let pairs = points.iter().flat_map(|a| points.iter().map(move |b| a.distance(*b)));
            assert!(radius <= 0.5 * pairs.fold(0.0, f32::max) * 1.2 * 1.16);
        }
    }
}

#[test]
fn mesh_cones_of_what_cannot_be_culled() {
    let flat = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let cone = NormalCone::of(&flat, &[[0, 1, 2]]);
    assert!(cone.cutoff < 2e-6 && cone.axis.distance(Vec3::Z) < 1e-6);
    assert!(cone.faces_away_from(Vec3::new(0.3, 0.3, -1.0)) && !cone.faces_away_from(Vec3::new(0.3, 0.3, 1.0)));
    assert!(cone.faces_away_in(Vec3::Z) && !cone.faces_away_in(-Vec3::Z) && !cone.faces_away_in(Vec3::X));
    let never = [
        NormalCone::of(&flat, &[[0, 1, 2], [0, 2, 1]]),
        NormalCone::of(&flat, &[[0, 1, 1], [2, 2, 2]]),
        NormalCone::of(&flat, &[[0, 1, 9]]),
        NormalCone::of(&[], &[]),
    ];
    for cone in never {
        assert_eq!(cone, NormalCone::NEVER);
        let mut random = Random(2);
        for _ in 0..100 {
            let p = random.point(3.0);
            assert!(!cone.faces_away_from(p) && !cone.faces_away_in(p));
        }
    }
    assert!(!cone.faces_away_from(Vec3::NAN) && !cone.faces_away_in(Vec3::ZERO));
    assert_eq!(Sphere::around(&[]), Sphere { center: Vec3::ZERO, radius: 0.0 });
    // The diameter of the range does not fit a float, the radius does not either.
    let ends = [Vec3::MIN, Vec3::MAX];
    assert_eq!(Sphere::around(&ends).radius, f32::INFINITY);
}
