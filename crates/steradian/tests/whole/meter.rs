//! Light meters against closed forms.

use std::{
    f64::consts::{PI, SQRT_2},
    sync::Arc,
};
use steradian::{
    ColorMode, CompileOptions, Quality, Scene, compile,
    formats::Options,
    integrators::Depth,
    load,
    math::Vec3,
    meter::{self, Estimate, Reading, Receiver, Settings},
    render,
};

const UNLIMITED: Depth = Depth { max: u32::MAX, roulette_after: 2, hide_emitters: false };
const SETTINGS: Settings = Settings { samples: 1 << 16, error: None, seed: 1, media: false, depth: UNLIMITED };

fn scene(what: &str, mode: ColorMode) -> Scene {
    let xml = format!("<scene version='3.0.0'><sensor type='perspective'/>{what}</scene>");
    let loaded = load::load_bytes("meter.xml", xml.into_bytes(), Some("xml"), &Options::default());
    assert!(loaded.diagnostics.is_empty(), "{:?}", loaded.diagnostics);
    let options = CompileOptions { mode: Some(mode), ..CompileOptions::default() };
    compile(&loaded.desc, &options).scene.expect("a scene")
}

fn read(what: &str, receiver: Receiver) -> Reading {
    meter::read(&scene(what, ColorMode::Rgb), &receiver, &SETTINGS)
}

/// Within twice the confidence interval (one reading in four thousand is not), and that is narrow.
fn assert_is(found: Estimate, expected: f64, width: f64) {
    let Estimate { value, plus_minus } = found;
    assert!((value - expected).abs() <= 2.0 * plus_minus + 2e-6 * expected, "{value} ± {plus_minus}, not {expected}");
    assert!(plus_minus <= width * expected, "{value} ± {plus_minus}");
}

/// A disc of radius 1 and radiance 1 at the height 1, which shines downwards.
const DISC: &str =
    "<shape type='disk'><transform name='to_world'><rotate x='1' angle='180'/><translate z='1'/></transform>
    <emitter type='area'><rgb name='radiance' value='1'/></emitter></shape>";
const UP: Receiver = Receiver::Plane(Vec3::ZERO, Vec3::Z);

/// M66: E = π L sin²θ = π/2 below a disc as wide as it is high; from all sides L times its solid angle; nothing from
/// below; and its radiance from its direction.
#[test]
fn a_disc_gives_its_closed_forms() {
    let lit = read(DISC, UP);
    assert_is(lit.rgb[1], PI / 2.0, 1e-3);
    assert_is(lit.luminous, 683.0 * 106.857 * PI / 2.0, 1e-3);
    assert!(lit.radiant.is_none());
    assert_is(read(DISC, Receiver::Sphere(Vec3::ZERO)).rgb[0], 2.0 * PI * (1.0 - 1.0 / SQRT_2), 1e-3);
    assert_eq!(read(DISC, Receiver::Plane(Vec3::ZERO, -Vec3::Z)).luminous.value, 0.0);
    let seen = |d: Vec3| read(DISC, Receiver::Radiance(Vec3::ZERO, d.normalize())).rgb[2].value;
    assert_eq!((seen(Vec3::new(0.5, 0.0, 1.0)), seen(Vec3::new(1.5, 0.0, 1.0))), (1.0, 0.0));
}

/// A scene in Steradian's own language, with a black material `k`.
fn own(what: &str) -> Scene {
    let text = format!(
        "steradian: 1\ncamera: {{camera: perspective}}\nmaterials: {{k: {{material: diffuse, reflectance: \
          0}}}}\n{what}\n"
    );
    let loaded = load::load_bytes("l.steradian", text.into_bytes(), Some("steradian"), &Options::default());
    assert!(!loaded.diagnostics.has_errors(), "{:?}", loaded.diagnostics);
    let options = CompileOptions { mode: Some(ColorMode::Rgb), ..CompileOptions::default() };
    compile(&loaded.desc, &options).scene.expect("a scene")
}

/// Lamps with holes: a sphere of radius 1 and opacity α at distance 3 gives a plane π L/9 times the part of each
/// direction that shines, in the mean: α of its near side, and through the holes (1 − α) α of its far side.
#[test]
fn far_sides_shine_through_holes() {
    let lit = |what: &str| {
        let scene = own(&format!("shapes: [{{shape: sphere, radius: 1, alpha: 0.4, material: k, {what}}}]"));
        meter::read(&scene, &Receiver::Plane(Vec3::new(0.0, 0.0, -3.0), Vec3::Z), &SETTINGS).rgb[0]
    };
    let [near, far] = [0.4, 0.24].map(|part| part * PI / 9.0);
    assert_is(lit("emission: {light: area, radiance: 1, two_sided: true}"), near + far, 0.01);
    assert_is(lit("emission: {light: area, radiance: 1}"), near, 0.01);
    assert_is(lit("reversed: true, emission: {light: area, radiance: 1}"), far, 0.01);
}

/// A mask is seen in its mean by a meter of one direction, and by a sensor of one ray.
#[test]
fn masks_are_met_by_chance() {
    let mask = "<emitter type='constant'/><shape type='disk'><bsdf type='mask'><float name='opacity' value='.4'/>
        <bsdf type='diffuse'><rgb name='reflectance' value='0'/></bsdf></bsdf></shape>";
    let disk = "lights: [{light: environment, radiance: 1}]\nshapes: [{shape: disk, alpha: 0.4, material: k}]";
    let along = Receiver::Radiance(Vec3::new(0.1, 0.2, 2.0), -Vec3::Z);
    assert_is(meter::read(&own(disk), &along, &SETTINGS).rgb[1], 0.6, 0.01);
    let xml = format!(
        "<scene version='3.0.0'><sensor type='radiancemeter'><point name='origin' x='.1' y='.2' z='2'/>
        <vector name='direction' x='0' y='0' z='-1'/><film type='hdrfilm'><integer name='width' value='1'/>
        <integer name='height' value='1'/></film></sensor>{mask}</scene>"
    );
    let loaded = load::load_bytes("meter.xml", xml.into_bytes(), Some("xml"), &Options::default());
    let options = CompileOptions { mode: Some(ColorMode::Rgb), ..CompileOptions::default() };
    let scene = Arc::new(compile(&loaded.desc, &options).scene.expect("a scene"));
    let picture = render(&scene, &Quality::of("path").spp(4096)).expect("a picture");
    let green = picture.channel("G").expect("green")[0];
    // Four standard errors of 4096 draws.
    assert!((green - 0.6).abs() < 4.0 * (0.24f32 / 4096.0).sqrt(), "{green}");
}

/// An even sky gives a plane π L and a sphere 4π L; a point light I cosθ/d² and I/d².
#[test]
fn skies_and_points_give_their_closed_forms() {
    let sky = "<emitter type='constant'><rgb name='radiance' value='2, 1, 0.5'/></emitter>";
    assert_is(read(sky, UP).rgb[0], 2.0 * PI, 1e-3);
    assert_is(read(sky, Receiver::Sphere(Vec3::ONE)).rgb[2], 2.0 * PI, 1e-3);
    let point =
        "<emitter type='point'><point name='position' x='0' y='1' z='2'/><rgb name='intensity' value='3'/></emitter>";
    assert_is(read(point, UP).rgb[0], 3.0 * 2.0 / 5f64.powf(1.5), 1e-6);
    assert_is(read(point, Receiver::Sphere(Vec3::ZERO)).rgb[0], 3.0 / 5.0, 1e-6);
}

/// Within a furnace of emission 1 and albedo ½ radiance is 2 everywhere, also on the wall; direct light alone is that
/// of one bounce fewer for each.
#[test]
fn a_furnace_is_filled_with_light() {
    let furnace = "<shape type='sphere'><boolean name='flip_normals' value='true'/>
        <bsdf type='diffuse'><rgb name='reflectance' value='0.5'/></bsdf>
        <emitter type='area'><rgb name='radiance' value='1'/></emitter></shape>";
    for p in [Vec3::new(0.0, 0.3, 0.0), Vec3::new(0.0, 0.0, -1.0)] {
        assert_is(read(furnace, Receiver::Plane(p, Vec3::Z)).rgb[1], 2.0 * PI, 2e-3);
    }
    let scene = scene(furnace, ColorMode::Rgb);
    for (max, radiance) in [(0, 1.0), (1, 1.5), (2, 1.75)] {
        let settings = Settings { depth: Depth { max, ..UNLIMITED }, ..SETTINGS };
        let at = Receiver::Plane(Vec3::new(0.2, 0.1, 0.0), Vec3::Y);
        assert_is(meter::read(&scene, &at, &settings).rgb[1], radiance * PI, 2e-3);
    }
}

/// An absorbing medium around the meter dims a point light by exp(−σ d).
#[test]
fn media_dim_light() {
    let fog =
        "<medium type='homogeneous' id='fog'><rgb name='sigma_t' value='0.4'/><rgb name='albedo' value='0'/></medium>";
    let xml = format!(
        "<scene version='3.0.0'>{fog}<sensor type='perspective'><ref id='fog'/></sensor>
         <emitter type='point'><point name='position' x='0' y='0' z='2'/><rgb name='intensity' value='3'/>
          </emitter></scene>"
    );
    let loaded = load::load_bytes("meter.xml", xml.into_bytes(), Some("xml"), &Options::default());
    let scene = compile(&loaded.desc, &CompileOptions::default()).scene.expect("a scene");
    let lit = |media| meter::read(&scene, &UP, &Settings { media, ..SETTINGS });
    assert_is(lit(true).rgb[0], 0.75 * (-0.8f64).exp(), 1e-5);
    assert_is(lit(false).rgb[0], 0.75, 1e-5);
}

/// Lines, bells and boxes between whole nanometres have their integrals over the wavelength.
#[test]
fn narrow_spectra_keep_their_power() {
    let bell = (0..61).map(|k| {
        let l = 541.0 + 0.1 * f64::from(k);
        format!("{l}:{}, ", 100.0 * (-0.5 * ((l - 544.0) / 0.3).powi(2)).exp())
    });
    let bell = bell.collect::<String>();
    for (curve, watts) in [
        ("589.2:0, 589.4:100, 589.6:0", 20.0),
        (bell.trim_end_matches(", "), 30.0 * (2.0 * PI).sqrt()),
        ("499.9:0, 500:1, 600:1, 600.1:0", 100.1),
        ("548.9:0, 549:1, 551:1, 551.1:0", 2.1),
    ] {
        let sun = format!(
            "<emitter type='directional'><vector name='direction' x='0' y='0' z='-1'/><spectrum name='irradiance' \
              value='{curve}'/></emitter>"
        );
        let found = meter::read(&scene(&sun, ColorMode::Spectral), &UP, &SETTINGS).radiant.expect("W");
        assert!((found.value / watts - 1.0).abs() < 0.03, "{curve}: {found:?}, not {watts}");
    }
}

/// M68: one W/m² within the nanometre about 555 nm is 683 lx; D65 of Y = 1 is 72 983 cd/m² at 184.4 lm/W (Mitsuba's
/// table of D65 over its table of ȳ, both from 360 to 830 nm).
#[test]
fn light_of_known_spectra_has_its_lumens() {
    let constant =
        |radiance: &str| scene(&format!("<emitter type='constant'>{radiance}</emitter>"), ColorMode::Spectral);
    let line = constant("<spectrum name='radiance' value='554:0, 555:0.31830989, 556:0'/>");
    let found = meter::read(&line, &UP, &Settings { samples: 1 << 20, ..SETTINGS });
    assert_is(found.luminous, 683.0, 3e-3);
    assert_is(found.radiant.expect("spectral mode"), 1.0, 3e-3);
    let daylight = constant("<spectrum name='radiance' type='d65'/>");
    let found = meter::read(&daylight, &Receiver::Radiance(Vec3::ZERO, Vec3::Y), &SETTINGS);
    assert!((found.luminous.value / 72_983.3 - 1.0).abs() < 1e-4, "{:?}", found.luminous);
    let efficacy = found.luminous.value / found.radiant.expect("spectral mode").value;
    assert!((efficacy - 184.4).abs() < 0.2, "{efficacy}");
}

/// More samples are taken until the error is reached, and the interval holds what it says: of 200 seeds about ten are
/// off.
#[test]
fn intervals_are_those_of_95_percent() {
    let scene = scene(DISC, ColorMode::Rgb);
    let few = Settings { samples: 256, ..SETTINGS };
    let good = meter::read(&scene, &UP, &Settings { error: Some(2e-4), ..few });
    assert!(good.samples > 1024 && good.luminous.plus_minus <= 2e-4 * good.luminous.value);
    let is_off = |seed| {
        let Estimate { value, plus_minus } = meter::read(&scene, &UP, &Settings { seed, ..few }).rgb[0];
        (value - PI / 2.0).abs() > plus_minus
    };
    let off = (0..200).filter(|seed| is_off(*seed)).count();
    assert!((2..=22).contains(&off), "{off} of 200");
}

/// The picture of a scene with its own sensor, of one pixel.
fn pixel(what: &str) -> [f64; 3] {
    let xml = format!("<scene version='3.0.0'>{what}</scene>").replace(
        "FILM",
        "<film type='hdrfilm'><integer name='width' value='1'/><integer name='height' value='1'/>
         <rfilter type='box'/></film>",
    );
    let loaded = load::load_bytes("meter.xml", xml.into_bytes(), Some("xml"), &Options::default());
    assert!(loaded.diagnostics.is_empty(), "{:?}", loaded.diagnostics);
    let scene = compile(&loaded.desc, &CompileOptions::default()).scene.expect("a scene");
    let quality = Quality { spp: Some(1 << 15), ..Quality::default() };
    let picture = render(&Arc::new(scene), &quality).expect("a picture");
    ["R", "G", "B"].map(|name| f64::from(picture.channel(name).expect("a colour")[0]))
}

/// Two parallel squares whose distance is their side exchange 0.1998 of what they emit (Hottel; Howell, A Catalog of
/// Radiation Heat Transfer Configuration Factors, C-11). A sphere of
/// radius 1 about a lamp of radius ½ receives π/4 from it; of what its albedo of ½ sends back ¾ arrives at itself.
#[test]
fn irradiance_meters_give_form_factors() {
    let lamp = "<emitter type='area'><rgb name='radiance' value='1'/></emitter>";
    let meter = "<sensor type='irradiancemeter'>FILM</sensor>";
    let above = "<transform name='to_world'><rotate x='1' angle='180'/><translate z='2'/></transform>";
    let square = |flip: &str| {
        pixel(&format!(
            "<shape type='rectangle'>{above}{lamp}</shape>
             <shape type='rectangle'><boolean name='flip_normals' value='{flip}'/>{meter}</shape>"
        ))[1]
    };
    let (found, expected) = (square("false"), 0.199_825 * PI);
    assert!((found / expected - 1.0).abs() < 5e-3, "{found} for {expected}");
    assert_eq!(square("true"), 0.0);
    let sphere = |flip: &str| {
        pixel(&format!(
            "<shape type='sphere'><float name='radius' value='0.5'/>
             <point name='center' x='3' y='1' z='2'/>{lamp}</shape>
             <shape type='sphere'><point name='center' x='3' y='1' z='2'/>
              <boolean name='flip_normals' value='{flip}'/>{meter}</shape>"
        ))[2]
    };
    let (found, expected) = (sphere("true"), PI / 4.0 / (1.0 - 0.5 * 0.75));
    assert!((found / expected - 1.0).abs() < 1e-2, "{found} for {expected}");
    assert_eq!(sphere("false"), 0.0);
}

/// All rays of a radiance meter are the one.
#[test]
fn radiance_meters_look_along_a_line() {
    let through = |x: f64| {
        pixel(&format!(
            "{DISC}<sensor type='radiancemeter'><point name='origin' x='0' y='0' z='0'/>
             <vector name='direction' x='{x}' y='0' z='2'/>FILM</sensor>"
        ))
    };
    assert_eq!((through(1.99), through(2.01)), ([1.0; 3], [0.0; 3]));
}

/// Means of Mitsuba 3.9.1 with 131 072 samples, and their standard errors.
#[test]
fn meters_agree_with_mitsuba() {
    const ROOM: &str = "<bsdf type='diffuse' id='matt'><rgb name='reflectance' value='0.7,0.5,0.3'/></bsdf>
        <shape type='cube'><boolean name='flip_normals' value='true'/><ref id='matt'/></shape>
        <shape type='rectangle'><transform name='to_world'><scale value='0.4'/><rotate x='1' angle='90'/>
         <translate y='0.99'/>
        </transform><emitter type='area'><rgb name='radiance' value='5,4,3'/></emitter></shape>";
    let tilted =
        "<shape type='rectangle'><transform name='to_world'><scale x='0.5' y='0.3'/><rotate x='1' angle='-90'/>
        <rotate z='1' angle='20'/><translate y='-0.5' x='0.2'/></transform><ref id='matt'/>
        <sensor type='irradiancemeter'>FILM</sensor></shape>";
    let ball = "<emitter type='constant'><rgb name='radiance' value='0.2,0.3,0.5'/></emitter>
        <bsdf type='diffuse' id='matt'><rgb name='reflectance' value='0.7,0.5,0.3'/></bsdf>
        <shape type='rectangle'><transform name='to_world'><scale value='4'/><rotate x='1' angle='-90'/></transform>
        <ref id='matt'/></shape>
        <shape type='rectangle'><transform name='to_world'><rotate x='1' angle='90'/><translate y='2.5'/></transform>
        <emitter type='area'><rgb name='radiance' value='5,4,3'/></emitter></shape>
        <shape type='sphere'><point name='center' x='0.5' y='0.8' z='0.2'/><float name='radius' value='0.6'/>
         <ref id='matt'/>
        <sensor type='irradiancemeter'>FILM</sensor></shape>";
    let line = "<sensor type='radiancemeter'><point name='origin' x='0' y='0.2' z='0.3'/>
        <vector name='direction' x='0.2' y='-1' z='0.4'/>FILM</sensor>";
    for (what, means, errors) in [
        (format!("{ROOM}{tilted}"), [2.007_95, 1.240_55, 0.798_02], [0.008_45, 0.006_55, 0.004_92]),
        (ball.to_owned(), [1.948_86, 1.751_21, 1.743_86], [0.005_39, 0.004_38, 0.003_63]),
        (format!("{ROOM}{line}"), [0.319_804, 0.121_638, 0.042_168], [2.4e-4, 6.2e-5, 1.9e-5]),
    ] {
        let found =
            pixel(&format!("<integrator type='path'><integer name='max_depth' value='12'/></integrator>{what}"));
        for c in 0..3 {
            // A quarter of the samples: twice the error at most, and that of the mean.
            let allowed = 4.0 * 5f64.sqrt() * errors[c];
            assert!((found[c] - means[c]).abs() < allowed, "{found:?} for {means:?} ± {errors:?}");
        }
    }
}

/// Flux onto a disc: of a point light above its middle `2π I (1 − cos α)`, of an even sky `π L` for each area; and out
/// of a ball: `4π I` of a point light anywhere within, `π L A` of a disc that shines to one side, and of what crosses
/// it from outside `π L` for each area.
#[test]
fn flux_has_its_closed_forms() {
    let point =
        "<emitter type='point'><point name='position' x='0' y='0' z='2'/><rgb name='intensity' value='3'/></emitter>";
    let onto = |r: f32| Receiver::Disc(Vec3::ZERO, Vec3::Z, r);
    for r in [0.5f32, 3.0] {
        let cos = 2.0 / 2f64.hypot(f64::from(r));
        assert_is(read(point, onto(r)).rgb[0], 2.0 * PI * 3.0 * (1.0 - cos), 1e-3);
    }
    let sky = "<emitter type='constant'><rgb name='radiance' value='2, 1, 0.5'/></emitter>";
    assert_is(read(sky, onto(0.5)).rgb[0], 2.0 * PI * PI * 0.25, 1e-3);
    let lamp = read(point, Receiver::Ball(Vec3::new(0.5, 0.2, 1.5), 1.0));
    assert_is(lamp.rgb[0], 4.0 * PI * 3.0, 2e-3);
    assert_is(lamp.luminous, 683.0 * 106.857 * 12.0 * PI, 2e-3);
    assert_is(read(DISC, Receiver::Ball(Vec3::Z, 1.5)).rgb[0], PI * PI, 1e-2);
    assert_is(read(sky, Receiver::Ball(Vec3::ZERO, 0.5)).rgb[1], PI * PI, 1e-3);
}

fn read_text(name: &str, text: &str, receiver: Receiver) -> f64 {
    // The lights of the text alone: glTF files with lamps get dim light from all sides.
    let defines = if name.ends_with("gltf") { vec![("sky", "none")] } else { Vec::new() };
    let defines = defines.into_iter().map(|(name, value)| (name.to_owned(), value.to_owned())).collect();
    let options = Options { defines, ..Options::default() };
    let loaded = load::load_bytes(name, text.as_bytes().to_vec(), None, &options);
    assert!(!loaded.diagnostics.has_errors(), "{:?}", loaded.diagnostics);
    let compiled = compile(&loaded.desc, &CompileOptions::default());
    let scene = compiled.scene.unwrap_or_else(|| panic!("{name}: {:?}", compiled.diagnostics));
    meter::read(&scene, &receiver, &SETTINGS).luminous.value
}

/// Flux and illuminance of our language are lm and lx, of coloured light too; what pbrt calls so is of spectra of Y =
/// 1; numbers of glTF files are candela and lux, and pictures say which luminance a value of one has.
#[test]
fn luminous_units_are_those_of_the_si() {
    let native = |light: &str| {
        let text = format!("steradian: 1\nlights: [{{{light}}}]\ncamera: {{camera: perspective}}\nfilm: {{film: rgb}}");
        read_text("a.steradian", &text, UP)
    };
    let above = "position: [0, 0, 2]";
    for (light, lux) in [
        (format!("light: point, power: 800, {above}"), 800.0 / (16.0 * PI)),
        (format!("light: point, power: 800, intensity: {{rgb: [3, 0.2, 0.1]}}, {above}"), 800.0 / (16.0 * PI)),
        (format!("light: point, power: 800, intensity: 7, {above}"), 800.0 / (16.0 * PI)),
        ("light: distant, illuminance: 1000, direction: [0, 0, -1]".into(), 1000.0),
        ("light: environment, illuminance: 1000".into(), 1000.0),
    ] {
        let found = native(&light);
        assert!((found / lux - 1.0).abs() < 5e-3, "{light}: {found} lx, not {lux}");
    }
    let pbrt = "Camera \"perspective\" WorldBegin LightSource \"point\" \"float power\" 800 \"point3 from\" [0 0 2]";
    let found = read_text("a.pbrt", pbrt, UP);
    assert!((found / (72_983.26 * 800.0 / (16.0 * PI)) - 1.0).abs() < 1e-3, "pbrt: {found} lx");
    let gltf = |light: &str| {
        format!(
            r#"{{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}],
            "nodes": [{{"translation": [0, 2, 0], "rotation": [-0.70710678, 0, 0, 0.70710678],
            "extensions": {{"KHR_lights_punctual": {{"light": 0}}}}}}], "extensionsUsed": ["KHR_lights_punctual"],
            "extensions": {{"KHR_lights_punctual": {{"lights": [{{{light}}}]}}}}}}"#
        )
    };
    let spot = r#""type": "spot", "intensity": 100, "spot": {"innerConeAngle": 0.2, "outerConeAngle": 0.6}"#;
    // Between the cones the square of a line in the cosine.
    let at = Vec3::new(0.8, 0.0, 0.0);
    let (cos, inner, outer) = (2.0 / 4.64f64.sqrt(), 0.2f64.cos(), 0.6f64.cos());
    let share = ((cos - outer) / (inner - outer)).powi(2);
    for (light, receiver, lux) in [
        (r#""type": "point", "intensity": 27176"#, Receiver::Plane(Vec3::ZERO, Vec3::Y), 6794.0),
        (r#""type": "directional", "intensity": 500"#, Receiver::Plane(Vec3::ZERO, Vec3::Y), 500.0),
        (spot, Receiver::Plane(at, Vec3::Y), share * cos * 100.0 / 4.64),
    ] {
        let found = read_text("a.gltf", &gltf(light), receiver);
        assert!((found / lux - 1.0).abs() < 1e-3, "{light}: {found} lx, not {lux}");
    }
}
