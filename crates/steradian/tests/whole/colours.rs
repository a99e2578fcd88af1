//! Colours of Mitsuba files in spectral mode, seen in pictures of scenes written here.

use steradian::{ColorMode, CompileOptions, Quality, compile, load, render};

/// The mean colour of a scene that is seen from the origin, in spectral mode.
fn color(inside: &str) -> [f64; 3] {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.xml");
    let sensor = "<sensor type=\"perspective\"><film type=\"hdrfilm\"><integer name=\"width\" value=\"8\"/>\
                  <integer name=\"height\" value=\"8\"/></film></sensor>";
    let text = format!("<scene version=\"3.0.0\"><integrator type=\"volpath\"/>{sensor}{inside}</scene>");
    std::fs::write(&path, text).expect("a file");
    let loaded = load(path, &Default::default());
    assert!(!loaded.diagnostics.has_errors(), "{:#?}", loaded.diagnostics);
    let options = CompileOptions { mode: Some(ColorMode::Spectral), ..CompileOptions::default() };
    let compiled = compile(&loaded.desc, &options);
    let scene = compiled.scene.unwrap_or_else(|| panic!("{:#?}", compiled.diagnostics));
    let picture = render(&std::sync::Arc::new(scene), &Quality { spp: Some(256), ..Quality::default() })
        .expect("the integrator exists");
    let rgb = picture.to_rgb().expect("pictures have colour");
    let mut sum = [0.0; 3];
    rgb.iter().for_each(|p| (0..3).for_each(|c| sum[c] += f64::from(p[c])));
    sum.map(|s| s / rgb.len() as f64)
}

fn glowing_sphere(radiance: &str) -> [f64; 3] {
    color(&format!(
        "<shape type=\"sphere\"><boolean name=\"flip_normals\" value=\"true\"/><emitter type=\"area\">{radiance}</emitter></shape>"
    ))
}

/// White means D65 as a plain colour; as the colour of a texture it is the reflectance one, and emission of that is the
/// white E. Linear Rec.709 of E: (1.205, 0.948, 0.909).
#[test]
fn emitted_textures_are_spectra_of_reflectances() {
    let plain = glowing_sphere("<rgb name=\"radiance\" value=\"1\"/>");
    let board = "<texture type=\"checkerboard\" name=\"radiance\"><rgb name=\"color0\" value=\"1\"/><rgb name=\"color1\" value=\"1\"/></texture>";
    let textured = glowing_sphere(board);
    for (c, e) in [1.2048, 0.9483, 0.9087].into_iter().enumerate() {
        assert!((plain[c] - 1.0).abs() < 0.01, "{plain:?}");
        assert!((textured[c] - e).abs() < 0.01, "{textured:?}");
    }
}

/// Coefficients of media up to one have the spectrum of a reflectance, in which a saturated green absorbs less of the
/// red than in the smoother spectrum of twice the range.
#[test]
fn coefficients_of_media_are_spectra_of_reflectances() {
    let absorbed = |sigma: &str| {
        let medium = format!(
            "<medium type=\"homogeneous\" name=\"interior\"><rgb name=\"sigma_t\" value=\"{sigma}\"/><rgb name=\"albedo\" value=\"0\"/></medium>"
        );
        let ball = format!(
            "<shape type=\"sphere\"><float name=\"radius\" value=\"0.5\"/><point name=\"center\" x=\"0\" y=\"0\" z=\"4\"/><bsdf type=\"null\"/>{medium}</shape>"
        );
        color(&format!("{ball}<emitter type=\"constant\"/>"))
    };
    // The same colour, but beyond one it is scaled.
    let (unit, scaled) = (absorbed("0.05, 0.99, 0.05"), absorbed("0.0505, 1.001, 0.0505"));
    assert!(unit[0] > scaled[0] + 0.001 && unit[1] < 1.0, "{unit:?} {scaled:?}");
}
