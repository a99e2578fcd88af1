//! Normal maps through the compiler: the space of the object, a second map, and what is wrong with them.

use super::one_shape;
use steradian_core::Scene;
use steradian_math::{DVec3, Ray, Transform, Vec3, hash::HashRng, spectra::Wavelengths};
use steradian_scene::{Attribute, Domain, Family, Mesh, Node, SceneDesc, SpectrumValue, Value};

/// An octahedron whose vertices carry their positions as normals of a map: along its faces the map has exactly the
/// directions of the sphere around it.
fn octahedron() -> Mesh {
    let positions: Vec<[f32; 3]> =
        [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z].iter().map(|v| v.to_array()).collect();
    let data = positions.iter().flatten().map(|v| (v + 1.0) / 2.0).collect();
    let mut triangles = Vec::new();
    for (x, y, z) in (0..8).map(|i| (i & 1, i >> 1 & 1, i >> 2 & 1)) {
        let [a, b, c] = [3 * x, 1 + 3 * y, 2 + 3 * z];
        triangles.push(if (x + y + z) % 2 == 0 { [a, b, c] } else { [a, c, b] });
    }
    Mesh {
        positions,
        triangles: triangles.into(),
        attributes: vec![Attribute { name: "sphere".into(), domain: Domain::Vertex, channels: 3, data }],
        ..Mesh::default()
    }
}

fn scene(material: Node, world_from_object: Transform) -> Result<Scene, Vec<String>> {
    scene_of(SceneDesc::default(), material, world_from_object)
}

fn scene_of(mut desc: SceneDesc, material: Node, world_from_object: Transform) -> Result<Scene, Vec<String>> {
    let map = desc.add(Node::new(Family::Texture, "mesh_attribute", None).with("name", "sphere"));
    let shape = Node::new(Family::Shape, "mesh", None);
    one_shape::add(&mut desc, shape, Some(octahedron()), Some(material.with("normal_map", map)));
    desc.shapes[0].world_from_object = world_from_object;
    one_shape::compiled(&desc)
}

fn diffuse() -> Node {
    Node::new(Family::Material, "diffuse", None).with("normal_map_space", "object").with("detail_facing", "as_it_is")
}

/// Shading normals where rays from afar meet the shape, with the points.
fn normals(scene: &Scene, count: usize) -> Vec<(Vec3, Vec3)> {
    let mut rng = HashRng::new(3);
    let rays = (0..count).map(|_| {
        let d = Vec3::new(rng.next_f32() - 0.5, rng.next_f32() - 0.5, rng.next_f32() - 0.5).normalize();
        Ray::new(d * 50.0, -d)
    });
    let of = |ray: Ray| {
        let i = scene.interaction(&ray, &scene.intersect(&ray)?);
        let (_, frame) = scene.scattering(&i, 0.5, &mut Wavelengths::RGB.clone())?;
        Some((i.surface.p, frame.z))
    };
    rays.filter_map(of).collect()
}

/// A sphere's map in the space of the object gives the sphere's normals on a coarse mesh: as it is, turned, stretched,
/// and mirrored.
#[test]
fn maps_of_the_object_give_the_normals_of_a_sphere() {
    let stretch = Transform::scale(DVec3::new(2.0, 1.0, -0.5));
    for world in [Transform::IDENTITY, Transform::rotate(DVec3::new(1.0, 2.0, 3.0), 1.1), stretch] {
        let scene = scene(diffuse(), world).unwrap();
        let back = world.inverse().unwrap();
        let seen = normals(&scene, 200);
        assert!(seen.len() == 200);
        for (p, n) in seen {
            let on_sphere = back.point(p.as_dvec3()).as_vec3();
            let wanted = world.affine().unwrap().normal(on_sphere).normalize();
            assert!((n - wanted).length() < 1e-5, "{n} {wanted}");
        }
    }
}

/// A flat second map leaves the normals, one that tilts by an angle turns them by it.
#[test]
fn second_maps_tilt_the_normals_of_the_first() {
    let alone = normals(&scene(diffuse(), Transform::IDENTITY).unwrap(), 50);
    let with = |n: Vec3| {
        let c = (n + 1.0) * 0.5;
        let color = SpectrumValue::Rgb([c.x, c.y, c.z].map(f64::from), steradian_scene::ColorSpace::Srgb);
        let mut desc = SceneDesc::default();
        let constant = Node::new(Family::Texture, "constant", None).with("value", Value::Spectrum(color));
        let map = desc.add(constant);
        let scene = scene_of(desc, diffuse().with("detail_normal_map", map), Transform::IDENTITY);
        scene.map(|scene| normals(&scene, 50))
    };
    for (before, after) in alone.iter().zip(with(Vec3::Z).unwrap()) {
        assert!((before.1 - after.1).length() < 1e-5);
    }
    for (before, after) in alone.iter().zip(with(Vec3::new(0.6, 0.0, 0.8)).unwrap()) {
        assert!((before.1.dot(after.1) - 0.8).abs() < 1e-5);
    }
}

#[test]
fn faults_of_normal_maps() {
    let said = |material: Node| scene(material, Transform::IDENTITY).unwrap_err().concat();
    let two_numbers = said(diffuse().with("normal_map_code", "xy"));
    assert!(two_numbers.contains("'normal_map_code' is xyz or octahedral"), "{two_numbers}");
    let filtered = said(diffuse().with("normal_map_filter", "lean"));
    assert!(filtered.contains("in the tangent frame"), "{filtered}");
}
