//! Infinite planes by their three forms (M54).

use steradian::{
    CompileOptions, Scene, compile, load_bytes,
    math::{Ray, Vec3, hash::HashRng},
};

fn scene(plane: &str) -> Result<Scene, String> {
    let text = format!(
        r#"steradian: 1
        camera: {{camera: perspective}}
        shapes: [{{shape: plane, {plane},
                  to_world: [{{scale: [1, 2, 1]}}, {{rotate: [1, 2, 0], degrees: 30}}, {{translate: [0, 1, 0]}}]}}]"#
    );
    let loaded = load_bytes("plane.steradian", text.into_bytes(), None, &Default::default());
    let compiled = compile(&loaded.desc, &CompileOptions::default());
    compiled.scene.ok_or_else(|| format!("{:?}", compiled.diagnostics))
}

/// The forms n·x + d = 0, point and normal, and point and two directions meet rays at the same points; rays along the
/// plane miss it; the parameters of the last form are those of its directions.
#[test]
fn three_forms_are_one_plane() {
    // (1, 2, −1)·x + 3 = 0 goes through (0, −1, 1) along (2, −1, 0) and (1, 0, 1); their product is (−1, −2, 1).
    let forms = [
        "normal: [1, 2, -1], distance: 3",
        "normal: [1, 2, -1], point: [0, -1, 1]",
        "point: [0, -1, 1], along: [1, 0, 1], across: [2, -1, 0]",
    ];
    let scenes = forms.map(|form| scene(form).expect(form));
    let mut rng = HashRng::new(54);
    let mut vector = || Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) * 2.0 - Vec3::ONE;
    let (mut hits, mut origin) = (0, None);
    for _ in 0..2000 {
        let ray = Ray::new(vector() * 4.0, vector().normalize_or(Vec3::X));
        let found = scenes.each_ref().map(|s| s.intersect(&ray).map(|hit| s.interaction(&ray, &hit)));
        let [Some(a), Some(b), Some(c)] = found else {
            assert!(found.iter().all(Option::is_none), "{ray:?}");
            continue;
        };
        hits += 1;
        for other in [&b, &c] {
            // Rounding of the place of a hit grows as rays graze the plane.
            let close = 2e-5 * (1.0 + a.surface.p.length()) / a.surface.n.dot(ray.direction).abs();
            assert!((a.surface.p - other.surface.p).length() < close, "{ray:?}: {} {}", a.surface.p, other.surface.p);
            assert!(a.surface.n.dot(other.surface.n) > 1.0 - 1e-5, "{ray:?}");
        }
        // All points are the same one plus their parameters times the two directions.
        let steradian_core::scene::Shape::Plane(plane) = &scenes[2].geometries()[0].shape else { panic!("no plane") };
        let uv = c.surface.uv;
        let start = c.surface.p - c.surface.dpdu * uv.x - plane.dpdv() * uv.y;
        let first = *origin.get_or_insert(start);
        assert!((start - first).length() < 1e-3 * (1.0 + c.surface.p.length()), "{start} {first}");
    }
    assert!(hits > 500, "{hits}");
    // Along the plane, beside it.
    let edge = scenes.each_ref().map(|s| {
        let ray = Ray::new(Vec3::new(0.3, 4.0, -2.0), Vec3::Y);
        let i = s.interaction(&ray, &s.intersect(&Ray { direction: -ray.direction, ..ray }).expect("a hit"));
        let along = i.surface.n.any_orthonormal_vector();
        s.intersect(&Ray::new(i.surface.p + i.surface.n, along))
    });
    assert!(edge.iter().all(|hit| hit.is_none_or(|hit| hit.t > 1e4)), "{edge:?}");
}

#[test]
fn forms_that_name_no_plane_are_errors() {
    for (form, what) in [
        ("normal: [0, 0, 0]", "zero"),
        ("point: [0, 0, 0], along: [1, 2, 3], across: [2, 4, 6]", "parallel"),
        ("point: [0, 0, 0], along: [1, 2, 3]", "parallel"),
        ("along: [1, 0, 0], across: [0, 1, 0]", "'point'"),
    ] {
        let said = scene(form).expect_err(form);
        assert!(said.contains(what), "{form}: {said}");
    }
}
