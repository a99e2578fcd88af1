//! Materials with impossible parameters, in both languages. The poison here is milder than elsewhere: values of the
//! right type.

use crate::case::{Case, Expect};
use steradian_bsdf::measured::synthetic::METAL;

/// Values that materials are given.
const VALUES: [&str; 10] = ["nan", "inf", "-inf", "1e39", "1e30", "-1", "0", "1e-45", "7", "0.9999999"];

/// pbrt materials with a number left open.
const PBRT: [&str; 31] = [
    "\"diffuse\" \"rgb reflectance\" [@ 0.5 0.5]",
    "\"diffuse\" \"float reflectance\" @",
    "\"diffuse\" \"spectrum reflectance\" [400 @ 700 1]",
    "\"diffusetransmission\" \"rgb transmittance\" [@ 1 1] \"float scale\" @",
    "\"conductor\" \"float roughness\" @",
    "\"conductor\" \"float uroughness\" @ \"float vroughness\" 0.1 \"bool remaproughness\" false",
    "\"conductor\" \"rgb reflectance\" [@ 1 1]",
    "\"conductor\" \"spectrum eta\" [400 @ 700 1] \"spectrum k\" [400 1 700 @]",
    "\"dielectric\" \"float eta\" @",
    "\"dielectric\" \"float roughness\" @",
    "\"dielectric\" \"spectrum eta\" [400 1.5 700 @]",
    "\"thindielectric\" \"float eta\" @",
    "\"coateddiffuse\" \"float eta\" @",
    "\"coateddiffuse\" \"float roughness\" @",
    "\"coateddiffuse\" \"float thickness\" @",
    "\"coateddiffuse\" \"rgb reflectance\" [@ @ @] \"float g\" @ \"rgb albedo\" [@ 1 1]",
    "\"coateddiffuse\" \"integer maxdepth\" @ \"integer nsamples\" @",
    "\"coatedconductor\" \"float conductor.roughness\" @ \"float interface.roughness\" @",
    "\"subsurface\" \"float scale\" @ \"float eta\" @",
    "\"hair\" \"float beta_m\" @ \"float eta\" @",
    "\"hair\" \"float beta_n\" @ \"float alpha\" @",
    "\"hair\" \"float eumelanin\" @ \"float pheomelanin\" @",
    "\"hair\" \"rgb sigma_a\" [@ 1 1]",
    "\"hair\" \"rgb reflectance\" [@ 1 1]",
    "\"coatedconductor\" \"spectrum conductor.eta\" [400 @ 700 1] \"spectrum conductor.k\" [400 1 700 @]",
    "\"coatedconductor\" \"float interface.eta\" @ \"rgb reflectance\" [@ 1 1]",
    "\"coatedconductor\" \"float thickness\" @ \"rgb albedo\" [@ 1 1]",
    "\"subsurface\" \"float roughness\" @",
    "\"subsurface\" \"rgb reflectance\" [@ 1 1] \"float g\" @",
    "\"interface\" \"float displacement\" @",
    "\"diffuse\" \"float displacement\" @",
];

/// Mitsuba BSDFs with a number left open.
const MITSUBA: [&str; 31] = [
    "<bsdf type='diffuse'><rgb name='reflectance' value='@, 0.5, 0.5'/></bsdf>",
    "<bsdf type='diffuse'><spectrum name='reflectance' value='@'/></bsdf>",
    "<bsdf type='diffuse'><spectrum name='reflectance' value='400:@, 700:1'/></bsdf>",
    "<bsdf type='conductor'><spectrum name='eta' value='@'/><spectrum name='k' value='@'/></bsdf>",
    "<bsdf type='roughconductor'><float name='alpha' value='@'/></bsdf>",
    "<bsdf type='roughconductor'><float name='alpha_u' value='@'/><float name='alpha_v' value='0.1'/></bsdf>",
    "<bsdf type='roughconductor'><rgb name='specular_reflectance' value='@, 1, 1'/></bsdf>",
    "<bsdf type='dielectric'><float name='int_ior' value='@'/></bsdf>",
    "<bsdf type='dielectric'><float name='ext_ior' value='@'/></bsdf>",
    "<bsdf type='roughdielectric'><float name='alpha' value='@'/></bsdf>",
    "<bsdf type='roughdielectric'><string name='distribution' value='beckmann'/><float name='alpha' value='@'/></bsdf>",
    "<bsdf type='thindielectric'><float name='int_ior' value='@'/></bsdf>",
    "<bsdf type='plastic'><float name='int_ior' value='@'/><rgb name='diffuse_reflectance' value='@, 1, 0'/></bsdf>",
    "<bsdf type='plastic'><boolean name='nonlinear' value='true'/><rgb name='diffuse_reflectance' value='@, 1, 0'/></bsdf>",
    "<bsdf type='roughplastic'><float name='alpha' value='@'/></bsdf>",
    "<bsdf type='mask'><float name='opacity' value='@'/><bsdf type='diffuse'/></bsdf>",
    "<bsdf type='blendbsdf'><float name='weight' value='@'/><bsdf type='diffuse'/><bsdf type='conductor'/></bsdf>",
    "<bsdf type='twosided'><bsdf type='roughconductor'><float name='alpha' value='@'/></bsdf></bsdf>",
    "<bsdf type='principled'><float name='roughness' value='@'/><float name='metallic' value='@'/></bsdf>",
    "<bsdf type='principled'><float name='spec_trans' value='@'/><float name='eta' value='@'/></bsdf>",
    "<bsdf type='principled'><float name='specular' value='@'/><float name='clearcoat' value='@'/></bsdf>",
    "<bsdf type='principled'><float name='sheen' value='@'/><float name='anisotropic' value='@'/></bsdf>",
    "<bsdf type='principledthin'><float name='diff_trans' value='@'/><float name='eta' value='@'/></bsdf>",
    "<bsdf type='roughplastic'><float name='int_ior' value='@'/></bsdf>",
    "<bsdf type='phong'><float name='exponent' value='@'/></bsdf>",
    "<bsdf type='ward'><float name='alpha_u' value='@'/><float name='alpha_v' value='@'/></bsdf>",
    "<bsdf type='roughdiffuse'><float name='alpha' value='@'/></bsdf>",
    "<bsdf type='hair'><float name='longitudinal_roughness' value='@'/><float name='int_ior' value='@'/></bsdf>",
    "<bsdf type='hair'><float name='azimuthal_roughness' value='@'/><float name='eumelanin' value='@'/></bsdf>",
    "<bsdf type='pplastic'><float name='alpha' value='@'/><float name='int_ior' value='@'/></bsdf>",
    "<bsdf type='diffuse'><texture type='checkerboard' name='reflectance'><rgb name='color0' value='@,1,0'/>\
     <transform name='to_uv'><scale value='@'/></transform></texture></bsdf>",
];

/// Expectation for a material with this number: impossible values are told of, and no renderer has use for these.
fn of_material(material: &str, number: &str) -> Expect {
    // Heights and coordinates may be any number.
    let is_free = material.contains("displacement") || material.contains("to_uv");
    match number {
        "1e30" | "-1" if !is_free => Expect::Told,
        _ => Expect::of_number(number),
    }
}

/// pbrt materials on a sphere, and inside a mix.
pub fn pbrt() -> Vec<Case> {
    let alone = PBRT.iter().flat_map(|t| VALUES.iter().map(move |v| (t.replace('@', v), of_material(t, v))));
    let alone = alone.map(|(m, expect)| Case::pbrt(m.clone(), format!("Material {m}\nShape \"sphere\""), expect));
    let mixed = VALUES.iter().map(|v| {
        let text = format!(
            "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" \"float reflectance\" {v}\nMakeNamedMaterial \"b\" \"string type\" \"conductor\"\n\
             Material \"mix\" \"string materials\" [\"a\" \"b\"] \"float amount\" {v}\nShape \"sphere\""
        );
        Case::pbrt(format!("mix of amount {v}"), text, of_material("mix", v))
    });
    let media = VALUES.iter().map(|v| {
        let text = format!(
            "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"rgb sigma_s\" [{v} 1 1] \"rgb sigma_a\" [0 {v} 1] \"float g\" {v}\n\
             MediumInterface \"m\" \"\"\nMaterial \"dielectric\"\nShape \"sphere\""
        );
        Case::pbrt(format!("medium of {v}"), text, Expect::of_number(v))
    });
    let spectra = SPECTRA.iter().map(|(name, content, expect)| {
        let world = "Material \"conductor\" \"spectrum eta\" \"eta.spd\"\nShape \"sphere\"";
        Case::pbrt(format!("spectrum file, {name}"), world, *expect).with("eta.spd", *content)
    });
    let measured = measurements().into_iter().map(|(name, content, expect)| {
        let surface = "Material \"measured\" \"string filename\" \"m.dat\" Shape \"sphere\"";
        Case::pbrt(format!("measured, {name}"), surface, expect).with("m.dat", content)
    });
    alone.chain(mixed).chain(media).chain(spectra).chain(measured).collect()
}

/// Mitsuba BSDFs on a sphere.
pub fn mitsuba() -> Vec<Case> {
    let alone = MITSUBA.iter().flat_map(|t| VALUES.iter().map(move |v| (t.replace('@', v), of_material(t, v))));
    let alone = alone.map(|(b, expect)| Case::mitsuba(b.clone(), format!("<shape type='sphere'>{b}</shape>"), expect));
    let spectra = SPECTRA.iter().map(|(name, content, expect)| {
        let light =
            "<emitter type='point'><spectrum name='intensity' filename='eta.spd'/></emitter><shape type='sphere'/>";
        Case::mitsuba(format!("spectrum file, {name}"), light, *expect).with("eta.spd", *content)
    });
    let measured = measurements().into_iter().flat_map(|(name, content, expect)| {
        ["measured", "measured_polarized"].map(|plugin| {
            let surface = format!(
                "<shape type='sphere'><bsdf type='{plugin}'><string name='filename' value='m.dat'/></bsdf></shape>"
            );
            Case::mitsuba(format!("{plugin}, {name}"), surface, expect).with("m.dat", content.clone())
        })
    });
    alone.chain(spectra).chain(measured).collect()
}

/// Files of measured reflection: sound, cut, of the wrong size, with sizes beyond all bounds, and with numbers that are
/// none.
fn measurements() -> Vec<(&'static str, Vec<u8>, Expect)> {
    let merl = METAL.merl([3, 3, 4]);
    let rgl = METAL.rgl(4, 2).expect("sound");
    let table = METAL.angles([45.0, 90.0], &[0.0]).into_bytes();
    let cut = |bytes: &[u8]| bytes[..bytes.len() / 2].to_vec();
    let with = |bytes: &[u8], at: usize, new: &[u8]| {
        let mut bytes = bytes.to_vec();
        bytes[at..at + new.len()].copy_from_slice(new);
        bytes
    };
    let huge = 1_000_000_000u32.to_le_bytes();
    vec![
        ("a cut MERL file", cut(&merl), Expect::Refused("m.dat")),
        ("a MERL file of 10⁹ angles", with(&merl, 0, &huge), Expect::Refused("m.dat")),
        ("a MERL file with NaN", with(&merl, 12, &f64::NAN.to_le_bytes()), Expect::Refused("m.dat")),
        ("a cut tensor file", cut(&rgl), Expect::Refused("m.dat")),
        ("a tensor file of 10⁹ fields", with(&rgl, 14, &huge), Expect::Refused("m.dat")),
        ("a tensor file with NaN", with(&rgl, rgl.len() - 4, &f32::NAN.to_le_bytes()), Expect::Refused("m.dat")),
        ("an incomplete table", cut(&table), Expect::Refused("m.dat")),
        ("a list of pictures that are not there", b"0 0 0 0 no.png\n".to_vec(), Expect::Refused("no.png")),
        ("an empty file", Vec::new(), Expect::Refused("m.dat")),
        ("noise", vec![0xa5; 1000], Expect::Refused("m.dat")),
        ("a MERL file", merl, Expect::Picture),
        ("a tensor file", rgl, Expect::Picture),
        ("a table of angles", table, Expect::Picture),
    ]
}

/// Files of measured spectra.
const SPECTRA: [(&str, &[u8], Expect); 12] = [
    ("sound", b"400 1.5\n700 1.4\n", Expect::Picture),
    ("empty", b"", Expect::Refused("eta.spd")),
    ("one number", b"400", Expect::Refused("eta.spd")),
    ("words", b"four five\nsix seven\n", Expect::Refused("eta.spd")),
    ("zeros", &[0; 1000], Expect::Refused("eta.spd")),
    ("not text", &[0xff; 1000], Expect::Refused("eta.spd")),
    ("backwards", b"700 1\n400 1\n", Expect::Refused("")),
    ("one wavelength twice", b"500 1\n500 2\n", Expect::Refused("")),
    ("nan", b"400 nan\n700 1\n", Expect::Refused("")),
    ("infinite", b"400 1\n700 inf\n", Expect::Refused("")),
    ("too large", b"400 1e39\n700 1\n", Expect::Either),
    ("negative", b"400 -1\n700 -2\n", Expect::Either),
];
