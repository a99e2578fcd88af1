//! Paths that are followed together have the bits of paths that are followed one by one, which they are where light is
//! counted by groups, and take as many rays.

use std::{path::PathBuf, sync::Arc};
use steradian::{ColorMode, CompileOptions, Control, Film, Layer, Quality, Scene, compile, load};

/// The film, and the rays that it took.
fn film(scene: &Arc<Scene>, integrator: &str, layers: Vec<Layer>) -> (Film, u64) {
    let quality = Quality { integrator: Some(integrator.into()), spp: Some(5), layers, ..Quality::default() };
    let mut session = quality.render(scene).expect("a registered integrator").session(scene).expect("a session");
    session.step(u32::MAX, &Control::default());
    (session.film(), session.counters().rays)
}

/// A room in coloured haze without interfaces, so that flights and shadow rays take one medium each.
const HAZE: &str = r#"LookAt 0 0 -3.2  0 0 0  0 1 0
MakeNamedMedium "haze" "string type" "homogeneous" "float g" [ 0.6 ]
  "rgb sigma_a" [ 0.02 0.03 0.3 ] "rgb sigma_s" [ 0.3 0.2 0 ]
MediumInterface "" "haze"
Camera "perspective" "float fov" [ 40 ]
WorldBegin
MediumInterface "" "haze"
LightSource "point" "rgb I" [ 1 0.5 2 ] "point3 from" [ 0.5 0.9 -0.5 ]
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 4 4 4 ]
Shape "trianglemesh" "point3 P" [ -0.6 1.2 -0.6  0.6 1.2 -0.6  0.6 1.2 0.6 ] "integer indices" [ 0 1 2 ]
AttributeEnd
MediumInterface "" ""
Material "diffuse" "rgb reflectance" [ 0.6 0.6 0.6 ]
Shape "trianglemesh" "point3 P" [ -1 -1 -1  -1 -1 1  1 -1 1  1 -1 -1 ] "integer indices" [ 0 1 2  0 2 3 ]
MediumInterface "haze" "haze"
Material "coateddiffuse" "rgb reflectance" [ 0.2 0.3 0.6 ]
Shape "trianglemesh" "point3 P" [ -1 -1 1  -1 1 1  1 1 1  1 -1 1 ] "integer indices" [ 0 1 2  0 2 3 ]
Material "dielectric"
Shape "sphere" "float radius" [ 0.4 ]
"#;

#[test]
fn waves_have_the_bits_of_single_paths() {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../scenes/verify");
    let files = std::fs::read_dir(folder).expect("the folder").map(|e| e.expect("an entry").path());
    let temporary = tempfile::tempdir().expect("a folder");
    let haze = temporary.path().join("haze.pbrt");
    std::fs::write(&haze, HAZE).expect("a file");
    let all = files.chain(["builtin:cornell-box-area".into(), haze]);
    let mut count = 0;
    for path in all {
        let loaded = load(&path, &Default::default());
        for mode in [ColorMode::Rgb, ColorMode::Spectral] {
            let options = CompileOptions { size: Some((37, 21)), mode: Some(mode), ..CompileOptions::default() };
            let scene = compile(&loaded.desc, &options).scene;
            let scene = Arc::new(scene.unwrap_or_else(|| panic!("{}: no scene", path.display())));
            assert!(!scene.light_groups().names.is_empty());
            for integrator in [
                "path:caustics=false,effort=even",
                "volpath:caustics=false",
                "path:caustics=true",
                "volpath:caustics=true,guiding=true",
            ] {
                let ((together, rays), (alone, rays_alone)) =
                    (film(&scene, integrator, vec![]), film(&scene, integrator, vec![Layer::LIGHT_GROUPS]));
                assert!(!alone.layers.by_light.is_empty() && together.layers.by_light.is_empty());
                let bits =
                    |film: &Film| film.pixels.iter().map(|p| (p.sum.map(f64::to_bits), p.samples)).collect::<Vec<_>>();
                assert!(bits(&together) == bits(&alone), "{}, {mode:?}, {integrator}", path.display());
                assert_eq!(rays, rays_alone, "{}, {mode:?}, {integrator}", path.display());
                count += 1;
            }
        }
    }
    assert!(count > 200);
}
