//! Makes the gallery of materials: small pictures in `docs/gallery` and the page `docs/materials-gallery.md` with the command line of each.
//!
//! `cargo run --release -p steradian --example gallery` in the folder of the repository. Materials of the catalogue without a row here are shown
//! with their defaults, so that none is forgotten.
#![allow(clippy::print_stdout, reason = "tells what it does")]

use std::{error::Error, fmt::Write, fs, path::Path};
use steradian::{
    CompileOptions, Quality,
    image::{self, WriteOptions},
    materials::{Kind, MATERIALS},
    specimen,
};

/// Side of a picture, pixels, and samples per pixel.
const SIDE: u32 = 112;
const SPP: u32 = 64;

/// A row: material, what is shown, and the pictures' parameters.
type Row = (&'static str, &'static str, &'static [&'static str]);

const ROWS: &[Row] = &[
    ("diffuse", "albedo", &["reflectance=0.2", "reflectance=0.5", "reflectance=0.8,0.25,0.1"]),
    (
        "conductor",
        "gold, GGX, by roughness",
        &[
            "eta=metal-Au-eta k=metal-Au-k",
            "eta=metal-Au-eta k=metal-Au-k alpha_u=0.1",
            "eta=metal-Au-eta k=metal-Au-k alpha_u=0.25",
            "eta=metal-Au-eta k=metal-Au-k alpha_u=0.5",
            "eta=metal-Au-eta k=metal-Au-k alpha_u=1",
        ],
    ),
    (
        "conductor",
        "copper, Beckmann, and brushed",
        &[
            "eta=metal-Cu-eta k=metal-Cu-k alpha_u=0.1 distribution=beckmann",
            "eta=metal-Cu-eta k=metal-Cu-k alpha_u=0.4 distribution=beckmann",
            "eta=metal-Cu-eta k=metal-Cu-k alpha_u=0.05 alpha_v=0.4",
            "eta=metal-Cu-eta k=metal-Cu-k alpha_u=0.4 alpha_v=0.05",
        ],
    ),
    (
        "dielectric",
        "glass, by roughness; diamond",
        &["eta=1.5", "eta=1.5 alpha_u=0.1", "eta=1.5 alpha_u=0.3", "eta=1.5 alpha_u=0.6", "eta=2.417"],
    ),
    ("thin_dielectric", "a bubble", &["eta=1.5"]),
    (
        "coated_diffuse",
        "varnish, by roughness",
        &[
            "reflectance=0.1,0.25,0.6",
            "reflectance=0.1,0.25,0.6 alpha_u=0.1",
            "reflectance=0.1,0.25,0.6 alpha_u=0.3",
            "reflectance=0.1,0.25,0.6 alpha_u=0.6",
        ],
    ),
    (
        "plastic",
        "plastic, by roughness; nonlinear",
        &[
            "diffuse_reflectance=0.6,0.15,0.1",
            "diffuse_reflectance=0.6,0.15,0.1 alpha_u=0.1",
            "diffuse_reflectance=0.6,0.15,0.1 alpha_u=0.3",
            "diffuse_reflectance=0.6,0.15,0.1 nonlinear=true",
        ],
    ),
    (
        "diffuse_transmission",
        "paper and leaf",
        &["reflectance=0.4 transmittance=0.4", "reflectance=0.1,0.3,0.05 transmittance=0.2,0.5,0.1"],
    ),
    ("mix", "half matt, half mirror", &["materials=diffuse(reflectance=0.1,0.4,0.2)|conductor"]),
    ("mask", "half there", &["material=diffuse(reflectance=0.7,0.5,0.1) opacity=0.5"]),
];

fn main() -> Result<(), Box<dyn Error>> {
    let folder = Path::new("docs/gallery");
    fs::create_dir_all(folder)?;
    let mut page = String::from(
        "# Gallery of materials\n\nA ball on tiles under a small lamp and a grey sky, as `steradian material … --picture` renders it. Written by\n\
         `cargo run --release -p steradian --example gallery`.\n",
    );
    let mut rows: Vec<(&str, String, Vec<&str>)> =
        ROWS.iter().map(|(kind, title, tiles)| (*kind, format!("{kind}: {title}"), tiles.to_vec())).collect();
    for m in MATERIALS {
        let needs_more = m.parameters.iter().any(|p| matches!(p.kind, Kind::Material | Kind::Materials | Kind::File));
        if m.name != "interface" && !needs_more && !ROWS.iter().any(|r| r.0 == m.name) {
            rows.push((m.name, format!("{}: defaults", m.name), vec![""]));
        }
    }
    for (kind, title, tiles) in rows {
        let _ = write!(page, "\n## {title}\n\n");
        let mut commands = String::new();
        for words in tiles {
            let params: Vec<(String, String)> =
                words.split_whitespace().filter_map(|w| w.split_once('=')).map(|(a, b)| (a.into(), b.into())).collect();
            let suffix: String =
                words.chars().map(|c| if c.is_ascii_alphanumeric() || c == '.' { c } else { '-' }).collect();
            let name = format!("{kind}{}{suffix}.png", if suffix.is_empty() { "" } else { "-" });
            let desc = specimen::describe(kind, &params)?;
            let compiled =
                steradian::compile(&desc, &CompileOptions { size: Some((SIDE, SIDE)), ..Default::default() });
            let scene = compiled.scene.ok_or_else(|| format!("{kind} {words}: {:?}", compiled.diagnostics))?;
            let picture = steradian::render(&scene, &Quality { spp: Some(SPP), ..Quality::default() })?;
            image::write(&folder.join(&name), &picture, &WriteOptions::default())?;
            println!("{name}");
            let _ = write!(page, "![{kind} {words}](gallery/{name}) ");
            let quoted: String = params.iter().map(|(a, b)| format!(" -p '{a}={b}'")).collect();
            let _ = writeln!(
                commands,
                "    steradian material {kind}{quoted} --size {SIDE}x{SIDE} --spp {SPP} --picture {name}"
            );
        }
        let _ = write!(page, "\n\n{commands}");
    }
    fs::write("docs/materials-gallery.md", page)?;
    Ok(())
}
