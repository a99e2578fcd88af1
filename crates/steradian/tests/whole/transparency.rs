//! Transparent surfaces by the methods of `raster:transparency=`, against closed forms and path tracing.

use steradian::{
    ColorMode, CompileOptions, Control, Quality, Scene, compile, load,
    math::{Ray, Vec2, Vec3},
};

/// A parallelogram that emits, and its opacity.
struct Pane {
    corner: Vec3,
    edges: [Vec3; 2],
    opacity: f32,
    radiance: f32,
}

impl Pane {
    /// Distance along a ray; `None` where it is missed, and `Some(None)` within a hair of the border.
    fn meet(&self, ray: &Ray) -> Option<Option<f32>> {
        let [a, b] = self.edges;
        let n = a.cross(b);
        let t = n.dot(self.corner - ray.origin) / n.dot(ray.direction);
        let p = ray.origin + ray.direction * t - self.corner;
        let (u, v) = (p.cross(b).dot(n) / n.length_squared(), a.cross(p).dot(n) / n.length_squared());
        let within = |x: f32, by: f32| x > -by && x < 1.0 + by;
        let is = |by| t > 0.0 && within(u, by) && within(v, by);
        is(0.02).then(|| is(-0.02).then_some(t))
    }
}

/// Panes in all directions that cross each other, some of them opaque.
fn panes(count: usize) -> Vec<Pane> {
    let mut state = 7u32;
    let mut random = move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / 16_777_216.0
    };
    let pane = |i: usize| {
        let mut vector = |size: f32| Vec3::new(random() - 0.5, random() - 0.5, random() - 0.5) * size;
        let (middle, edges) = (vector(2.4), [vector(5.0), vector(5.0)]);
        let opacity = if i % 6 == 5 { 1.0 } else { 0.15 + 0.7 * (i as f32 * 0.37).fract() };
        let radiance = 0.2 + (i as f32 * 0.618).fract();
        Pane { corner: middle - (edges[0] + edges[1]) * 0.5, edges, opacity, radiance }
    };
    (0..count).map(pane).collect()
}

fn scene_of(body: &str) -> Scene {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.pbrt");
    let head = "LookAt 0 -6 0.4  0 0 0  0 0 1\nCamera \"perspective\" \"float fov\" 40\n\
                Film \"rgb\" \"integer xresolution\" 96 \"integer yresolution\" 72\nWorldBegin\n";
    std::fs::write(&path, format!("{head}{body}")).unwrap();
    let loaded = load(path.to_str().unwrap(), &Default::default());
    assert!(!loaded.diagnostics.has_errors(), "{:?}", loaded.diagnostics);
    let options = CompileOptions { mode: Some(ColorMode::Rgb), ..CompileOptions::default() };
    compile(&loaded.desc, &options).scene.unwrap()
}

fn of_panes(panes: &[Pane]) -> Scene {
    let text = |pane: &Pane| {
        let Pane { corner: a, edges: [e, f], opacity, radiance } = pane;
        let corners = [*a, *a + *e, *a + *e + *f, *a + *f].map(|p| format!("{} {} {}", p.x, p.y, p.z)).join(" ");
        format!(
            "AttributeBegin\nAreaLightSource \"diffuse\" \"rgb L\" [{radiance} {radiance} {radiance}] \
             \"bool twosided\" true\nMaterial \"diffuse\" \"rgb reflectance\" [0 0 0]\nShape \"trianglemesh\" \
             \"float alpha\" {opacity} \"point3 P\" [{corners}] \"integer indices\" [0 1 2 0 2 3]\nAttributeEnd\n"
        )
    };
    scene_of(&panes.iter().map(text).collect::<String>())
}

/// Pixels of one sample at their centres.
fn pixels(scene: &Scene, integrator: &str, spp: u32) -> Vec<f64> {
    let scene = std::sync::Arc::new(scene.clone());
    let quality = Quality { integrator: Some(integrator.into()), spp: Some(spp), threads: 2, ..Quality::default() };
    let mut session = quality.render(&scene).unwrap().session(&scene).unwrap();
    session.step(u32::MAX, &Control::default());
    assert_eq!(session.failure(), None);
    session.film().pixels.iter().map(|p| p.mean()[0]).collect()
}

/// Radiance that panes send along a ray, by distance: Σ αₖ Lₖ Πⱼ﹤ₖ (1 − αⱼ); `None` near a border of one, or where two
/// meet.
fn blended(panes: &[Pane], ray: &Ray) -> Option<f64> {
    let mut layers = Vec::new();
    for pane in panes {
        match pane.meet(ray) {
            None => {}
            Some(None) => return None,
            Some(Some(t)) => layers.push((t, pane)),
        }
    }
    layers.sort_by(|a, b| a.0.total_cmp(&b.0));
    if layers.windows(2).any(|pair| pair[1].0 - pair[0].0 < 0.01) {
        return None;
    }
    let (mut sum, mut rest) = (0.0, 1.0);
    for (_, Pane { opacity, radiance, .. }) in layers {
        sum += rest * f64::from(*opacity) * f64::from(*radiance);
        rest *= 1.0 - f64::from(*opacity);
    }
    Some(sum)
}

/// The exact methods are the sum over the layers at every pixel, where panes cross as well; sorted triangles are wrong
/// there, and weighted sums nearly everywhere, by less than what is seen.
#[test]
fn layers_are_blended() {
    let panes = panes(24);
    let scene = of_panes(&panes);
    let film = scene.film();
    let ray = |k: usize| {
        let at = Vec2::new((k % film.width as usize) as f32 + 0.5, (k / film.width as usize) as f32 + 0.5);
        scene.camera().ray(film, at, Vec2::splat(0.5))
    };
    let right: Vec<Option<f64>> = (0..(film.width * film.height) as usize).map(|k| blended(&panes, &ray(k))).collect();
    let known = right.iter().flatten().count();
    assert!(known > 1000, "{known}");
    // Mean error and number of pixels that are wrong by more than 1e-3.
    let errors = |transparency: &str| {
        let found = pixels(&scene, &format!("raster:frame=forward,transparency={transparency}"), 1);
        let errors = || found.iter().zip(&right).filter_map(|(found, right)| Some((found - (*right)?).abs()));
        (errors().sum::<f64>() / known as f64, errors().filter(|e| *e > 1e-3).count())
    };
    for exact in ["a-buffer", "peel,layers=24", "bsp"] {
        let (mean, wrong) = errors(exact);
        assert!(wrong == 0 && mean < 1e-5, "{exact}: {mean} in the mean, {wrong} of {known} wrong");
    }
    // Peeling ends with the layers that it was given.
    let (mean, wrong) = errors("peel,layers=2");
    assert!(wrong > known / 20 && mean < 0.1, "peel,layers=2: {mean} in the mean, {wrong} of {known} wrong");
    for (near, range) in [("sorted", 0.001..0.1), ("weighted", 0.001..0.1)] {
        let (mean, wrong) = errors(near);
        assert!(range.contains(&mean) && wrong > 100, "{near}: {mean} in the mean, {wrong} of {known} wrong");
    }
}

/// Curved shapes have two layers, one for each side, and lists of any number of threads are the same.
#[test]
fn both_sides_of_a_ball_are_layers() {
    let body = "AreaLightSource \"diffuse\" \"rgb L\" [1 1 1] \"bool twosided\" true\n\
                Material \"diffuse\" \"rgb reflectance\" [0 0 0]\nShape \"sphere\" \"float alpha\" 0.5 \"float radius\" 1\n";
    let scene = scene_of(body);
    let middle = (36 * 96 + 48) as usize;
    for transparency in ["a-buffer", "peel", "sorted", "weighted"] {
        let found = pixels(&scene, &format!("raster:frame=forward,transparency={transparency}"), 1);
        assert!((found[middle] - 0.75).abs() < 1e-5, "{transparency}: {}", found[middle]);
    }
}

/// Panes let their share of light through onto what is behind them, without noise, in previews as well; the mean of
/// paths agrees.
#[test]
fn shadows_of_panes_are_shares() {
    let body = "LightSource \"distant\" \"rgb L\" [3 3 3] \"point3 from\" [0 -1 0] \"point3 to\" [0 0 0]\n\
                Material \"diffuse\" \"rgb reflectance\" [0.5 0.5 0.5]\n\
                Shape \"trianglemesh\" \"point3 P\" [-9 1 -9 9 1 -9 9 1 9 -9 1 9] \"integer indices\" [0 1 2 0 2 3]\n\
                Material \"diffuse\" \"rgb reflectance\" [0 0 0]\nShape \"trianglemesh\" \"float alpha\" 0.25 \
                \"point3 P\" [-9 0 -9 9 0 -9 9 0 9 -9 0 9] \"integer indices\" [0 1 2 0 2 3]\n";
    let scene = scene_of(body);
    // ρ/π E of the wall, by the pane once to the wall and once to the eye.
    let right = 0.5 / std::f64::consts::PI * 3.0 * 0.75 * 0.75;
    for integrator in ["raster:frame=forward", "raster:frame=preview"] {
        for (pixel, found) in pixels(&scene, integrator, 1).iter().enumerate() {
            assert!((found / right - 1.0).abs() < 2e-3, "{integrator}: {found} at {pixel}, not {right}");
        }
    }
    let paths = pixels(&scene, "path", 64);
    let mean = paths.iter().sum::<f64>() / paths.len() as f64;
    assert!((mean / right - 1.0).abs() < 0.01, "{mean} by paths, not {right}");
}

/// Requests that cannot be met are refused by name.
#[test]
fn refusals_are_named() {
    let scene = of_panes(&panes(6));
    let refused = |options: &str| {
        let quality = Quality { integrator: Some(format!("raster:{options}")), spp: Some(1), ..Quality::default() };
        quality.render(&scene).map(drop).unwrap_err().to_string()
    };
    for options in ["frame=hybrid,transparency=peel", "frame=forward,shading=flat,transparency=a-buffer"] {
        assert!(refused(options).contains("transparency other than dither"), "{options}: {}", refused(options));
    }
    let ball = scene_of("Material \"diffuse\"\nShape \"sphere\" \"float alpha\" 0.5\n");
    let quality = Quality { integrator: Some("raster:frame=forward,transparency=bsp".into()), ..Quality::default() };
    let ball = std::sync::Arc::new(ball);
    let mut session = quality.render(&ball).unwrap().session(&ball).unwrap();
    session.step(1, &Control::default());
    assert!(session.failure().is_some_and(|why| why.contains("triangles of meshes")), "{:?}", session.failure());
}
