//! Bands of wavelengths of a film: against closed forms, against the colours of the picture, as a file, after a stop.

use std::sync::Arc;
use steradian::{
    CompileOptions, Control, Quality, Render, Scene, compile, develop,
    film::Film,
    image::{FileKind, Image, Limits, Value, WriteOptions, encode, read_bytes},
    integrators::Plan,
    load_bytes,
    math::spectra::{Curve, Spd},
    resume::Recipe,
};

/// The scene of a file by its name, all of which is understood.
fn scene(name: &str, text: &str) -> Arc<Scene> {
    let loaded = load_bytes(name, text.as_bytes().to_vec(), None, &Default::default());
    let compiled = compile(&loaded.desc, &CompileOptions::default());
    let said: Vec<_> = loaded.diagnostics.iter().chain(compiled.diagnostics.iter()).map(|d| &d.message).collect();
    assert!(!loaded.diagnostics.is_lossy() && !compiled.diagnostics.is_lossy(), "{said:?}");
    Arc::new(compiled.scene.unwrap_or_else(|| panic!("{said:?}")))
}

/// A ball of a colour under a light whose radiance rises evenly from 360 to 830 nm.
fn ball(film: &str) -> Arc<Scene> {
    let text = format!(
        r#"LookAt 0 0 -5 0 0 0 0 1 0
        Camera "perspective" "float fov" 30
        Film "spectral" "integer xresolution" 4 "integer yresolution" 4 {film}
        WorldBegin
        LightSource "infinite" "spectrum L" [360 1 830 2]
        Material "diffuse" "rgb reflectance" [.8 .3 .1]
        Shape "sphere" "float radius" .6"#
    );
    scene("ball.pbrt", &text)
}

fn finished(render: &Render, scene: &Arc<Scene>) -> Film {
    let mut session = render.session(scene).unwrap();
    session.step(u32::MAX, &Control::default());
    session.film()
}

fn picture(scene: &Arc<Scene>, quality: &Quality) -> Image {
    develop(scene, &finished(&quality.render(scene).unwrap(), scene), &[])
}

fn mean(plane: &[f32]) -> f64 {
    plane.iter().map(|v| f64::from(*v)).sum::<f64>() / plane.len() as f64
}

/// Wavelength by the name of a channel.
fn wavelength(name: &str) -> Option<f32> {
    name.strip_prefix("S0.")?.strip_suffix("nm")?.replace(',', ".").parse().ok()
}

/// Means over bands of a radiance that is seen directly are those of its curve, but for the noise of wavelengths: they
/// are stratified over a pixel's samples, so that a band of w nm has an error of at most two strata, 2/(4·1024 p w).
#[test]
fn a_background_has_the_means_of_its_curve() {
    let scene = ball("\"integer nbuckets\" 8\nPixelFilter \"box\"");
    let picture = picture(&scene, &Quality::of("path").spp(1024));
    let bands: Vec<(f32, f64)> =
        picture.channels().iter().filter_map(|c| Some((wavelength(&c.name)?, f64::from(c.data[0])))).collect();
    assert_eq!(bands.len(), 8);
    let curve = |lambda: f32| 1.0 + f64::from(lambda - 360.0) / 470.0;
    // pbrt's lights have the luminance one whatever their spectrum.
    let one = Spd::Curve(Arc::new(Curve::new([360.0, 830.0], [1.0, 2.0]).unwrap())).to_xyz().y;
    for (lambda, value) in bands {
        let p = 0.0072 / 1.8275 / (0.0072 * (f64::from(lambda) - 538.0)).cosh().powi(2);
        let bound = 2.0 / (4.0 * 1024.0 * p * 58.75);
        let exact = curve(lambda) / one;
        assert!((value / exact - 1.0).abs() < bound, "{lambda} nm: {value} for {exact}, within {bound}");
    }
}

/// Bands of ten nanometres make up the colours of the picture: both are of the same samples, so that what is between
/// them is how the observer varies within a band. Methods that share paths, and that do not, have them.
#[test]
fn bands_make_up_the_colours() {
    let scene = ball(r#""integer nbuckets" 47"#);
    for integrator in ["path:reuse=1,effort=even", "path:reuse=16", "volpath", "whitted"] {
        let picture = picture(&scene, &Quality::of(integrator).spp(256));
        let mut bands: Vec<(f32, f32)> =
            picture.channels().iter().filter_map(|c| Some((wavelength(&c.name)?, mean(&c.data) as f32))).collect();
        bands.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (lambda, value): (Vec<_>, Vec<_>) = bands.into_iter().unzip();
        let rgb = Spd::Curve(Arc::new(Curve::new(lambda, value).unwrap())).to_rgb();
        for (c, name) in ["R", "G", "B"].into_iter().enumerate() {
            let colour = mean(picture.channel(name).unwrap());
            assert!((f64::from(rgb[c]) / colour - 1.0).abs() < 0.01, "{integrator}: {name} {} {colour}", rgb[c]);
        }
    }
}

/// A band of Mitsuba's is the integral of radiance times sensitivity, whatever its exposure.
#[test]
fn named_bands_are_integrals() {
    let text = r#"<scene version="3.0.0"><integrator type="path"/><sensor type="perspective"><film type="specfilm">
        <integer name="width" value="2"/><integer name="height" value="2"/>
        <spectrum name="green" value="500:1, 600:1"/><spectrum name="ramp" value="500:0, 600:1"/><rfilter type="box"/>
        </film></sensor><emitter type="constant"><spectrum name="radiance" value="400:1, 700:4"/></emitter></scene>"#;
    let scene = scene("bands.xml", text);
    let picture = picture(&scene, &Quality::of("path").spp(1024));
    // L = 1 + (λ − 400)/100: ∫ L = 250, ∫ L (λ − 500)/100 = 100 (2/2 + 1/3).
    for (name, exact) in [("green", 250.0), ("ramp", 400.0 / 3.0)] {
        let value = mean(picture.channel(name).unwrap());
        // Two of the strata of 4096 wavelengths, at the ends, which have more than 0.003 of the density for each nm.
        assert!((value - exact).abs() < 2.0 * 3.0 / (4096.0 * 0.003), "{name}: {value} for {exact}");
    }
    assert!(picture.metadata.get("spectralLayoutVersion").is_none());
}

/// A file has the channels and attributes of the layout, and can be read again.
#[test]
fn files_have_the_spectral_layout() {
    let scene = ball(r#""integer nbuckets" 3 "float lambdamin" 400 "float lambdamax" 700 "float iso" 200"#);
    let picture = picture(&scene, &Quality::of("path").spp(4));
    let options = WriteOptions::default();
    let bytes = encode(FileKind::Exr, &picture, &options).unwrap();
    let read = read_bytes(&bytes, None, &Limits::default()).unwrap();
    for name in ["S0.450,000nm", "S0.550,000nm", "S0.650,000nm", "R", "G", "B"] {
        assert_eq!(read.channel(name).unwrap(), picture.channel(name).unwrap(), "{name}");
    }
    for (name, text) in [("spectralLayoutVersion", "1.0"), ("emissiveUnits", "W.m^-2.sr^-1")] {
        assert_eq!(read.metadata.get(name), Some(&Value::Text(text.into())));
    }
    // The exposure is of the colours, not of the radiance.
    let plain = ball(r#""integer nbuckets" 3 "float lambdamin" 400 "float lambdamax" 700"#);
    let plain = self::picture(&plain, &Quality::of("path").spp(4));
    let ratio = |name: &str| mean(picture.channel(name).unwrap()) / mean(plain.channel(name).unwrap());
    assert!((ratio("G") - 2.0).abs() < 1e-5 && (ratio("S0.550,000nm") - 1.0).abs() < 1e-5);
}

/// Any number of threads and a stop give the same bits, with and without sharing.
#[test]
fn bands_go_on_after_a_stop() {
    let scene = ball("");
    for integrator in ["path:reuse=1,effort=even", "path:reuse=4", "transient:to=20"] {
        let render = Quality { seed: Some(1), ..Quality::of(integrator) }.spp(6).render(&scene).unwrap();
        let with =
            |threads| Render { plan: Plan { threads, ..render.plan }, ..render.clone() }.session(&scene).unwrap();
        let (mut before, mut after, mut state) = (with(1), with(3), Vec::new());
        before.step(3, &Control::default());
        before.save(&mut state).unwrap();
        after.restore(&mut state.as_slice()).unwrap();
        after.step(u32::MAX, &Control::default());
        let of_bits = |film: Film| -> Vec<u64> { film.layers.by_band.iter().map(|v| v.to_bits()).collect() };
        let whole = of_bits(finished(&render, &scene));
        assert_eq!(whole.len(), 16 * 16);
        assert!(whole == of_bits(after.film()), "{integrator}");
    }
}

/// Curves of any length are among what a saved render must agree with.
#[test]
fn long_curves_are_kept_with_a_render() {
    let film = |last: u32| {
        let curve =
            |end: u32| (360..830).map(|nm| format!("{nm}:0.{nm}1, ")).collect::<String>() + &format!("830:{end}");
        let bands: String =
            (0..20).map(|band| format!(r#"<spectrum name="b{band}" value="{}"/>"#, curve(last + band))).collect();
        let text = format!(
            r#"<scene version="3.0.0"><integrator type="path"/><sensor type="perspective"><film type="specfilm">
            <integer name="width" value="2"/><integer name="height" value="2"/>{bands}</film></sensor>
            <emitter type="constant"/></scene>"#
        );
        scene("curves.xml", &text)
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("state");
    let of = |scene: &Arc<Scene>| {
        let render = Quality::of("path").spp(2).render(scene).unwrap();
        (Recipe::new(scene, [0; 32], &CompileOptions::default(), &render), render.session(scene).unwrap())
    };
    let (recipe, mut session) = of(&film(1));
    recipe.save(&mut *session, &path).unwrap();
    recipe.restore(&mut *session, &path).unwrap();
    let (recipe, mut session) = of(&film(2));
    let refused = recipe.restore(&mut *session, &path).unwrap_err().to_string();
    assert!(refused.contains("another film"), "{refused}");
}

/// Methods without bands say so, and bands change no bit of the picture; rounds of samples cannot have them.
#[test]
fn bands_are_refused_by_name() {
    let scene = ball("");
    let render = Quality::of("photon").spp(1).render(&scene).unwrap();
    assert!(render.left_out(&scene).unwrap().missing().contains("bands of wavelengths"));
    let adaptive = Quality { adaptive: true, ..Quality::of("path") }.spp(64);
    assert!(adaptive.render(&scene).unwrap_err().to_string().contains("bands of wavelengths"));
    let loaded =
        load_bytes("rgb.pbrt", b"Film \"spectral\"\nWorldBegin\nShape \"sphere\"".to_vec(), None, &Default::default());
    let options = CompileOptions { mode: Some(steradian::ColorMode::Rgb), ..CompileOptions::default() };
    let said = compile(&loaded.desc, &options).diagnostics;
    assert!(said.is_lossy() && said.iter().any(|d| d.message.contains("--color spectral")));
}

/// A film that keeps geometry has its layers without being asked for, once each.
#[test]
fn films_of_geometry_have_their_layers() {
    let text = r#"LookAt 0 0 -5 0 0 0 0 1 0
        Camera "perspective" "float fov" 10
        Film "gbuffer" "integer xresolution" 2 "integer yresolution" 2
        WorldBegin
        LightSource "infinite"
        Shape "sphere""#;
    let loaded = load_bytes("g.pbrt", text.as_bytes().to_vec(), None, &Default::default());
    let scene = Arc::new(compile(&loaded.desc, &CompileOptions::default()).scene.unwrap());
    for integrator in ["path", "bdpt"] {
        let quality = Quality { layers: vec![steradian::Layer::POSITION], ..Quality::of(integrator) }.spp(4);
        let film = finished(&quality.render(&scene).unwrap(), &scene);
        let picture = develop(&scene, &film, &quality.layers);
        for name in ["albedo.R", "N.Z", "Ng.Z", "P.Z", "uv.U", "variance.R"] {
            assert_eq!(picture.channels().iter().filter(|c| c.name == name).count(), 1, "{name}");
        }
        assert!((mean(picture.channel("P.Z").unwrap()) + 1.0).abs() < 0.1, "{integrator}");
    }
}
