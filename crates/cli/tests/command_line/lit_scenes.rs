//! `steradian bake light` to scenes that show their light without lights.

use crate::Place;
use std::f64::consts::PI;

/// A floor of a reflectance under a light, seen by a camera.
fn scene(reflectance: &str, light: &str) -> String {
    format!(
        "<scene version='3.0.0'><sensor type='perspective'><float name='fov' value='60'/>\
         <transform name='to_world'><lookat origin='0.2,-0.1,1.2' target='0.1,0,0' up='0,1,0'/></transform></sensor>\
         <shape type='rectangle'><bsdf type='diffuse'>{reflectance}</bsdf></shape>{light}</scene>"
    )
}

const LAMP: &str = "<shape type='rectangle'><transform name='to_world'><scale value='0.01'/><rotate x='1' angle='180'/>\
    <translate x='0.4' z='1.5'/></transform><bsdf type='diffuse'><rgb name='reflectance' value='0'/></bsdf>\
    <emitter type='area'><rgb name='radiance' value='1000'/></emitter></shape>";
const BULB: &str = "<emitter type='point'><point name='position' x='0.4' y='0' z='1.5'/>\
    <rgb name='intensity' value='0.2'/></emitter>";

/// The centres of pixels that show the floor: place and radiance.
fn seen(place: &Place, scene: &str, integrator: &str) -> Vec<([f64; 2], [f32; 3])> {
    let line = ["render", scene, "--integrator", integrator, "--spp", "16", "--size", "16x16", "--aov", "position"];
    place.succeed(&[&line[..], &["-o", "seen.exr"]].concat());
    let picture = place.picture("seen.exr");
    let [x, y] = ["P.X", "P.Y"].map(|name| picture.channel(name).unwrap().to_vec());
    let pixels = picture.to_rgb().unwrap().into_iter().enumerate();
    pixels.map(|(k, rgb)| ([f64::from(x[k]), f64::from(y[k])], rgb)).collect()
}

/// L = ρ E/π, with E = L A cos⁴θ/h² of a lamp and I cos³θ/h² of a bulb, which the scene that is read back shows colour
/// by colour and square by square. Texels are 1/12 apart: between them E bends by 1e-3.
#[test]
fn a_lit_scene_shows_its_closed_form() {
    let place = Place::new();
    let squares = "<texture name='reflectance' type='checkerboard'><rgb name='color0' value='0.8 0.4 0.2'/>\
                   <rgb name='color1' value='0.1'/></texture>";
    place.file("plain.xml", &scene("<rgb name='reflectance' value='0.8 0.4 0.2'/>", LAMP));
    place.file("squares.xml", &scene(squares, BULB));
    for (name, lit, integrator) in
        [("plain.xml", "plain.glb", "raster"), ("plain.xml", "plain.gltf", "path"), ("squares.xml", "s.glb", "path")]
    {
        let size = ["--resolution", "32", "--padding", "2", "--spp", "64", "--max-depth", "0"];
        place.succeed(&[&["bake", "light", name, "-o", lit][..], &size].concat());
        let mut count = 0;
        for ([x, y], rgb) in seen(&place, lit, integrator) {
            let is_lamp = name == "plain.xml";
            // Filters mix the colours of texels at the edges of squares.
            if !is_lamp && x.abs().min(y.abs()) < 0.1 {
                continue;
            }
            count += 1;
            let square = (x - 0.4).powi(2) + y * y + 1.5_f64.powi(2);
            let irradiance = if is_lamp { 0.4 * 1.5_f64.powi(2) / square.powi(2) } else { 0.3 / square.powf(1.5) };
            let albedo = if is_lamp || x * y > 0.0 { [0.8, 0.4, 0.2] } else { [0.1; 3] };
            for (shown, albedo) in rgb.into_iter().zip(albedo) {
                let error = f64::from(shown) / (albedo * irradiance / PI) - 1.0;
                assert!(error.abs() < 3e-3, "{lit} at {x} {y}: {error}");
            }
        }
        assert!(count > 128, "{lit}: {count}");
    }
}
