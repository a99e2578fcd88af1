//! Makes the gallery of materials: small pictures in `docs/gallery` and the page `docs/gallery.md` with the command
//! line of each.
//!
//! `cargo run --release -p steradian --example gallery [KIND…]` in the folder of the repository; with kinds, only their
//! pictures are taken anew. Materials of the catalogue without a row here are shown with their defaults, so that none
//! is forgotten.
#![expect(clippy::print_stdout, reason = "tells what it does")]

use std::{collections::HashMap, error::Error, fmt::Write, fs, path::Path};
use steradian::{
    ColorMode, CompileOptions, Quality,
    image::{self, WriteOptions},
    instruments::{Specimen, goniometer},
    schema::{Type, material::MATERIALS},
    specimen,
};

/// Side of a picture, pixels, and samples per pixel.
const SIDE: u32 = 192;
const SPP: u32 = 64;

/// The table of angles that `measured` shows, and what it is measured from.
const TABLE: &str = "docs/gallery/velvet.txt";
const TABLE_OF: (&str, &str) = ("sheen", "reflectance=0.15,0.02,0.05 sheen_color=0.9,0.5,0.6 sheen_roughness=0.4");

/// A row: material, what is shown, parameters of all its pictures, and those that tell them apart.
type Row = (&'static str, &'static str, &'static str, &'static [&'static str]);

/// Spectral colour for a row, as a parameter: dispersion and interference are functions of the wavelength.
const SPECTRAL: &str = "--color=spectral";

const ALPHAS: &[&str] = &["", "alpha_u=0.05", "alpha_u=0.15", "alpha_u=0.3", "alpha_u=0.6", "alpha_u=1"];
const ROUGHNESSES: &[&str] = &["roughness=0", "roughness=0.2", "roughness=0.4", "roughness=0.6", "roughness=1"];

const ROWS: &[Row] = &[
    ("diffuse", "albedo", "", &["reflectance=0.2", "reflectance=0.5", "reflectance=0.8,0.25,0.1"]),
    (
        "oren_nayar",
        "forms and roughness",
        "reflectance=0.6,0.4,0.3",
        &["roughness=0", "roughness=0.5", "roughness=1", "form=fujii roughness=1", "form=full sigma=0.6"],
    ),
    ("minnaert", "limb darkening", "reflectance=0.7", &["k=0.5", "k=1", "k=2", "k=4"]),
    (
        "diffuse_transmission",
        "paper and leaf",
        "",
        &["reflectance=0.4 transmittance=0.4", "reflectance=0.1,0.3,0.05 transmittance=0.2,0.5,0.1"],
    ),
    ("conductor", "gold by roughness", "eta=metal-Au-eta k=metal-Au-k", ALPHAS),
    (
        "conductor",
        "other metals",
        "alpha_u=0.1",
        &[
            "eta=metal-Ag-eta k=metal-Ag-k",
            "eta=metal-Al-eta k=metal-Al-k",
            "eta=metal-Cu-eta k=metal-Cu-k",
            "eta=metal-CuZn-eta k=metal-CuZn-k",
            "reflectance=0.2,0.4,0.7",
            "permittivity=-10 permeability=1",
        ],
    ),
    (
        "conductor",
        "distributions of facets",
        "eta=metal-Cu-eta k=metal-Cu-k alpha_u=0.3",
        &[
            "distribution=ggx",
            "distribution=beckmann",
            "distribution=blinn",
            "distribution=gaussian",
            "distribution=student_t gamma=1.7",
            "distribution=beckmann shadowing=v_groove",
        ],
    ),
    (
        "conductor",
        "brushed",
        "eta=metal-Al-eta k=metal-Al-k",
        &["alpha_u=0.05 alpha_v=0.4", "alpha_u=0.2 alpha_v=0.2", "alpha_u=0.4 alpha_v=0.05"],
    ),
    (
        "conductor",
        "light between facets, at α = 0.8",
        "eta=metal-Cu-eta k=metal-Cu-k alpha_u=0.8",
        &["compensation=none", "compensation=kulla_conty", "compensation=turquin"],
    ),
    (
        "conductor",
        "films on titanium",
        "eta=2.74 k=3.8 alpha_u=0.1 film_eta=2.4 --color=spectral",
        &["film_thickness=30", "film_thickness=60", "film_thickness=110", "film_thickness=160", "film_thickness=400"],
    ),
    ("dielectric", "glass by roughness", "", ALPHAS),
    ("dielectric", "water, sapphire, diamond", "", &["eta=1.33", "eta=1.77", "eta=2.417"]),
    (
        "dielectric",
        "dispersion",
        SPECTRAL,
        &["eta=1.5168 abbe_number=64.17", "eta=1.7 abbe_number=20", "cauchy=1.65,0.02", "eta=glass-SF11"],
    ),
    ("thin_dielectric", "a bubble", "", &["eta=1.33", "eta=1.5", "eta=2.4"]),
    ("polarizer", "unpolarised light passes twice", "", &["", "transmittance=0.9,0.5,0.2"]),
    ("retarder", "clear to unpolarised light", "", &[""]),
    ("coated_diffuse", "varnish by roughness", "reflectance=0.1,0.25,0.6", ALPHAS),
    (
        "coated_diffuse",
        "a scattering coat",
        "reflectance=0.4,0.05,0.05 thickness=0.5 samples=4",
        &["albedo=0.3", "albedo=0.6", "albedo=0.9"],
    ),
    (
        "coated_conductor",
        "lacquered metal",
        "",
        &["", "interface.uroughness=0.2", "conductor.uroughness=0.3", "thickness=0.4 albedo=0.8,0.5,0.2 samples=4"],
    ),
    ("plastic", "plastic by roughness", "diffuse_reflectance=0.6,0.15,0.1", ALPHAS),
    ("plastic", "saturated by inner reflection", "diffuse_reflectance=0.6,0.15,0.1", &["", "nonlinear=true"]),
    (
        "phong",
        "exponents; as first published",
        "diffuse_reflectance=0.1,0.2,0.4",
        &["exponent=5", "exponent=30", "exponent=200", "form=empirical"],
    ),
    (
        "blinn_phong",
        "exponents; as first published",
        "diffuse_reflectance=0.1,0.2,0.4",
        &["exponent=20", "exponent=120", "exponent=800", "form=empirical"],
    ),
    (
        "lafortune",
        "mirror, off-specular, retro-reflecting",
        "diffuse_reflectance=0.2,0.1,0.1 specular_reflectance=0.6",
        &["", "coefficients=-1,-1,0.7", "coefficients=1,1,1"],
    ),
    (
        "ward",
        "normalisations; stretched",
        "diffuse_reflectance=0.3,0.1,0.05",
        &["form=bounded", "form=ward", "form=duer", "alpha_u=0.05 alpha_v=0.3"],
    ),
    (
        "cook_torrance",
        "by roughness",
        "diffuse_reflectance=0.1,0.3,0.2",
        &["alpha_u=0.05", "alpha_u=0.15", "alpha_u=0.3", "alpha_u=0.6", "alpha_u=1"],
    ),
    (
        "cook_torrance",
        "what facets reflect",
        "diffuse_reflectance=0.1,0.3,0.2 alpha_u=0.2",
        &["fresnel=schlick f0=0.5", "fresnel=conductor eta=0.2 k=3.9", "film_thickness=300", "coupling=fresnel"],
    ),
    ("measured", "velvet from a table of angles", "", &["file=docs/gallery/velvet.txt"]),
    (
        "hair",
        "pigment, on a ball of fibres along the bitangent",
        "round=true",
        &["eumelanin=0.3", "eumelanin=1.3", "eumelanin=8", "pheomelanin=1", "beta_m=0.15 beta_n=0.15"],
    ),
    ("principled", "by roughness", "base_color=0.7,0.15,0.1", ROUGHNESSES),
    (
        "principled",
        "lobes",
        "base_color=0.7,0.4,0.1 roughness=0.4",
        &[
            "metallic=1",
            "metallic=1 anisotropic=0.9",
            "spec_trans=1",
            "sheen=1 roughness=1",
            "clearcoat=1 clearcoat_gloss=1",
        ],
    ),
    (
        "principledthin",
        "paper, pane, leaf",
        "base_color=0.5,0.7,0.3",
        &["", "spec_trans=1 roughness=0.3", "diff_trans=1", "spec_trans=0.4 diff_trans=1 flatness=1"],
    ),
    ("metallic_roughness", "metal by roughness", "base_color=1,0.77,0.34", ROUGHNESSES),
    ("metallic_roughness", "dielectric by roughness", "base_color=0.1,0.4,0.5 metallic=0", ROUGHNESSES),
    (
        "metallic_roughness",
        "extensions: coat, sheen, stretch, transmission, volume, leaf",
        "metallic=0",
        &[
            "base_color=0.5,0.02,0.02 clearcoat=1",
            "base_color=0.1,0.1,0.3 sheen_color=0.7,0.8,1 sheen_roughness=0.4",
            "metallic=1 roughness=0.4 anisotropy=0.8",
            "base_color=0.9,0.6,0.5 transmission=1 roughness=0.2",
            "base_color=0.95 transmission=1 roughness=0 thin=false",
            "base_color=0.2,0.5,0.1 roughness=0.6 diffuse_transmission=0.6 diffuse_transmission_color=0.5,0.8,0.1",
        ],
    ),
    (
        "metallic_roughness",
        "iridescence by thickness",
        "metallic=1 base_color=0.6 roughness=0.2 iridescence=1 --color=spectral",
        &[
            "iridescence_thickness=100",
            "iridescence_thickness=250",
            "iridescence_thickness=400",
            "iridescence_thickness=700",
        ],
    ),
    (
        "metallic_roughness",
        "dispersion",
        "metallic=0 transmission=1 roughness=0 thin=false --color=spectral",
        &["eta=1.5 dispersion=0.3", "eta=2 dispersion=1"],
    ),
    (
        "openpbr",
        "by roughness",
        "base_color=0.3,0.1,0.5",
        &["specular_roughness=0", "specular_roughness=0.3", "specular_roughness=0.7", "specular_roughness=1"],
    ),
    (
        "openpbr",
        "metal, glass, coat, fuzz",
        "",
        &[
            "base_metalness=1 base_color=0.9,0.5,0.3 specular_color=0.6,0.9,1",
            "transmission_weight=1 specular_roughness=0",
            "base_color=0.6,0.3,0.1 coat_weight=1 coat_color=0.9,0.6,0.3",
            "base_color=0.1,0.05,0.2 fuzz_weight=1 fuzz_color=0.8,0.6,0.9",
        ],
    ),
    (
        "sheen",
        "cloth by roughness",
        "reflectance=0.1,0.02,0.05 sheen_color=0.9,0.6,0.7",
        &["sheen_roughness=0.2", "sheen_roughness=0.5", "sheen_roughness=1"],
    ),
    (
        "grating",
        "compact disc, DVD, blazed, transmitting",
        "alpha_u=0.02 --color=spectral",
        &["", "period=740", "profile=blazed depth=275", "transmission=true depth=500"],
    ),
    ("two_sided", "a mirror outside", "", &["front=conductor(alpha_u=0.05) back=diffuse(reflectance=0.8,0.2,0.1)"]),
    ("mix", "half matt, half mirror", "", &["materials=diffuse(reflectance=0.1,0.4,0.2)|conductor"]),
    (
        "mask",
        "half there",
        "",
        &[
            "material=diffuse(reflectance=0.7,0.5,0.1) opacity=0.5",
            "material=diffuse(reflectance=0.7,0.5,0.1) opacity=0.2",
        ],
    ),
];

fn pairs(words: &str) -> Vec<(String, String)> {
    words.split_whitespace().filter_map(|w| w.split_once('=')).map(|(a, b)| (a.to_owned(), b.to_owned())).collect()
}

/// The command line's parameters.
fn quoted(params: &[(String, String)]) -> String {
    params.iter().map(|(a, b)| format!(" -p '{a}={b}'")).collect()
}

fn main() -> Result<(), Box<dyn Error>> {
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    let folder = Path::new("docs/gallery");
    fs::create_dir_all(folder)?;
    let velvet = specimen::describe(TABLE_OF.0, &pairs(TABLE_OF.1))?;
    let velvet = steradian::compile(&velvet, &CompileOptions::default()).scene.ok_or("velvet does not compile")?;
    let velvet = Specimen::new(&velvet, velvet.geometries()[0].material);
    fs::write(TABLE, goniometer::table(&velvet, [5.0, 10.0], &[0.0]))?;
    let mut page = format!(
        "# Gallery of materials\n\nA ball on tiles in a studio of three lamps, as `steradian material … --picture` renders it; run the commands in the\n\
         folder of the repository. [materials.md](materials.md) lists all parameters. Written by `cargo run --release -p steradian --example gallery`.\n\
         `interface`, which scatters nothing, has no picture. The table of `measured` was made by\n\n    \
         steradian material {}{} --table {TABLE}\n",
        TABLE_OF.0,
        quoted(&pairs(TABLE_OF.1))
    );
    let mut rows: Vec<Row> = ROWS.to_vec();
    for m in MATERIALS {
        let needs_more = m.parameters.iter().any(|p| matches!(p.kind, Type::Material | Type::Materials | Type::File));
        if m.kind != "interface" && !needs_more && !ROWS.iter().any(|r| r.0 == m.kind) {
            rows.push((m.kind, "defaults", "", &[""]));
        }
    }
    let mut seen = HashMap::new();
    for (kind, title, common, tiles) in rows {
        let row = *seen.entry(kind).and_modify(|n| *n += 1).or_insert(1);
        let _ = write!(page, "\n## {kind}: {title}\n\n");
        let mut commands = String::new();
        for (i, tile) in tiles.iter().enumerate() {
            let words = format!("{common} {tile}");
            let is_spectral = words.contains(SPECTRAL);
            // Noise has colour there.
            let spp = if is_spectral { 4 * SPP } else { SPP };
            // What a tile says counts more than what is common.
            let mut params = pairs(&words.replace(SPECTRAL, ""));
            for (name, _) in pairs(tile) {
                let first = params.iter().position(|p| p.0 == name);
                let last = params.iter().rposition(|p| p.0 == name);
                if let (Some(first), true) = (first, first != last) {
                    params.remove(first);
                }
            }
            let path = format!("{}/{kind}-{row}{}.jpg", folder.display(), char::from(b'a' + i as u8));
            if wanted.is_empty() || wanted.iter().any(|w| w == kind) {
                let desc = specimen::describe(kind, &params)?;
                let mode = if is_spectral { ColorMode::Spectral } else { ColorMode::Rgb };
                let options = CompileOptions { size: Some((SIDE, SIDE)), mode: Some(mode), ..Default::default() };
                let compiled = steradian::compile(&desc, &options);
                let scene = compiled.scene.ok_or_else(|| format!("{kind} {words}: {:?}", compiled.diagnostics))?;
                let picture =
                    steradian::render(&std::sync::Arc::new(scene), &Quality { spp: Some(spp), ..Quality::default() })?;
                image::write(Path::new(&path), &picture, &WriteOptions::default())?;
                println!("{path}");
            }
            let shown = if tile.is_empty() { "defaults" } else { tile };
            let gap = if i == 0 { "" } else { " " };
            let _ = write!(page, "{gap}![{shown}]({})", path.trim_start_matches("docs/"));
            let color = if is_spectral { " --color spectral" } else { "" };
            let _ = writeln!(
                commands,
                "    steradian material {kind}{}{color} --size {SIDE}x{SIDE} --spp {spp} --picture {path}",
                quoted(&params)
            );
        }
        let _ = write!(page, "\n\n{commands}");
    }
    fs::write("docs/gallery.md", page)?;
    Ok(())
}
