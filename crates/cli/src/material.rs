//! `steradian material`: a material under the instruments.

use crate::{
    args::{Color, MaterialArgs, PlotScale},
    diagnostics,
    failure::{self, Failure, Outcome},
    material_summary::{self, Setting},
    open, output, relief,
    terminal::{self, Terminal},
    values::known_name,
};
use serde::{Deserialize, Serialize};
use std::{
    fmt::Write,
    path::{Path, PathBuf},
    sync::Arc,
};
use steradian::{
    ColorMode, CompileOptions, Inputs, Quality, Scene,
    instruments::{
        Specimen,
        albedo::{Albedo, albedo},
        fit::{self, Fit},
        gloss::{GEOMETRIES, Gloss, gloss},
        goniometer,
        laws::{self, Laws},
        plot,
        summary::{Summary, summary},
    },
    math::Vec3,
    scene::{Family, Node, SceneDesc},
    specimen,
};

/// Angles of the table of albedos, degrees from the normal.
const ANGLES: [f64; 9] = [0.0, 15.0, 30.0, 45.0, 60.0, 70.0, 80.0, 85.0, 89.0];

/// Size of the picture of a ball.
const PICTURE: (u32, u32) = (150, 150);

/// Readings of a material.
#[derive(Debug, Default, Serialize)]
struct Report {
    schema: u32,
    material: String,
    /// Its kind, its parameters as they are and what it does, where no reading was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    kind: Option<String>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    parameters: Vec<Setting>,
    #[serde(skip_serializing_if = "Option::is_none")]
    summary: Option<Summary>,
    /// Lanes of values: `rgb`, or four wavelengths in nm.
    #[serde(skip_serializing_if = "Option::is_none")]
    wavelengths: Option<[f32; 4]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    albedo: Option<Vec<Albedo>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    gloss: Option<Vec<Gloss>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    fit: Option<Vec<Fit>>,
    /// The model that fits best.
    #[serde(skip_serializing_if = "Option::is_none")]
    best_fit: Option<fit::Model>,
    #[serde(skip_serializing_if = "Option::is_none")]
    laws: Option<Laws>,
    #[serde(skip_serializing_if = "Option::is_none")]
    eval: Option<Vec<Evaluated>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    relief: Option<Vec<relief::Reading>>,
}

/// A pair of directions: towards the viewer and the light, in the shading frame.
#[derive(Debug, Deserialize)]
struct Pair {
    wo: [f32; 3],
    wi: [f32; 3],
}

/// Evaluation of a material for a pair of directions.
#[derive(Debug, Serialize)]
struct Evaluated {
    /// `f·|cosθ_i|` per lane, sr⁻¹.
    value: Vec<f32>,
    /// The density of sampling `wi`, sr⁻¹.
    pdf: f32,
}

/// Opens the material and takes what readings were asked for.
pub fn run(args: &MaterialArgs, terminal: Terminal) -> Outcome {
    open::limit_threads(args.scene.threads);
    let outputs = || [&args.plot, &args.table, &args.picture].into_iter().flatten().map(PathBuf::as_path);
    output::claim(
        outputs(),
        &Inputs::of(args.eval.as_deref().into_iter().chain(args.geometry.as_deref().map(Path::new))),
    )?;
    let write = |path: &Path, text: String| {
        steradian::image::write_whole(path, text.as_bytes()).map_err(|e| Failure::failed(e.to_string()))?;
        terminal.say(&format!("wrote {}", path.display()));
        Ok::<(), Failure>(())
    };
    if let Some((name, _)) = args.scene.define.first().filter(|_| scene_and_name(&args.material).is_none()) {
        let message =
            format!("-D is for materials of scenes (SCENE:NAME), so '{name}' has no effect; -p sets parameters");
        if args.scene.strict {
            return Err(Failure::bad_input(format!("{message} (unused, which --strict refuses)")));
        }
        terminal.warn(&message);
    }
    if let Some(relief) = relief::Relief::asked_for(args, terminal)? {
        output::claim(outputs(), &relief.inputs)?;
        if let Some(path) = &args.table {
            write(path, relief.table(args.samples))?;
        }
        let report = Report {
            schema: 1,
            material: args.material.clone(),
            relief: args.albedo.then(|| ANGLES.iter().map(|t| relief.read(*t, args.samples)).collect()),
            ..Report::default()
        };
        return tell(&report, args.json);
    }
    let is_summary = is_summary(args);
    // Of what needs more to be measured, the parameters are told all the same.
    if is_summary && args.params.is_empty() && material_summary::needed(&args.material).next().is_some() {
        let kind = &args.material;
        terminal.say(&format!("before it is measured, it needs more: {}", material_summary::example(kind)));
        let parameters = material_summary::settings(&Node::new(Family::Material, kind, None), &SceneDesc::default());
        let (material, kind) = (kind.clone(), Some(kind.clone()));
        return tell(&Report { schema: 1, material, kind, parameters, ..Report::default() }, args.json);
    }
    let Glass { scene, index, inputs, kind, parameters } = under_glass(args, terminal)?;
    output::claim(outputs(), &inputs)?;
    let mut specimen = Specimen::new(&scene, index).at(args.uv.into());
    if let Some(lambda) = args.wavelengths {
        specimen = specimen.with_wavelengths(lambda);
    }
    let pairs = args.eval.as_deref().map(read_pairs).transpose()?;
    if let Some(path) = &args.plot {
        let radius = match args.plot_scale {
            PlotScale::Linear => plot::Radius::Linear,
            PlotScale::Log => plot::Radius::Log,
        };
        write(path, plot::svg(&specimen, &titled(args), radius))?;
    }
    if let Some(path) = &args.table {
        write(path, goniometer::table(&specimen, [5.0, 10.0], &[0.0]))?;
    }
    let fits = args.fit.then(|| {
        let readings = fit::readings(&specimen);
        fit::MODELS.map(|m| m.fit(&readings)).to_vec()
    });
    let is_interface = kind == "interface";
    let report = Report {
        schema: 1,
        material: args.material.clone(),
        kind: is_summary.then_some(kind),
        parameters: if is_summary { parameters } else { Vec::new() },
        // An interface scatters nothing.
        summary: (is_summary && !is_interface).then(|| summary(&specimen, args.samples)),
        wavelengths: (scene.mode() == ColorMode::Spectral).then(|| specimen.wavelengths()),
        albedo: args.albedo.then(|| ANGLES.iter().map(|t| albedo(&specimen, *t, args.samples)).collect()),
        gloss: args.gloss.then(|| GEOMETRIES.iter().map(|g| gloss(&specimen, *g, args.samples)).collect()),
        best_fit: fits.as_deref().and_then(fit::best),
        fit: fits,
        laws: args.laws.then(|| laws::laws(&specimen, args.samples)),
        eval: pairs.map(|p| evaluate(&specimen, &p, args.importance)),
        relief: None,
    };
    tell(&report, args.json)?;
    // Last, so that a picture that cannot be made or written takes no reading along.
    if let Some(path) = &args.picture {
        let quality = Quality { spp: Some(args.spp), ..Quality::default() };
        let picture = steradian::render(&scene, &quality).map_err(|e| Failure::failed(e.to_string()))?;
        let written = steradian::image::write(path, &picture, &args.files.write_options().map_err(Failure::bad_input)?);
        written.map_err(|e| Failure::failed(e.to_string()))?;
        terminal.say(&format!("wrote {}", path.display()));
    }
    Ok(failure::DONE)
}

/// True if nothing in particular was asked for: then the parameters and a summary are told.
fn is_summary(args: &MaterialArgs) -> bool {
    let readings = args.albedo || args.gloss || args.fit || args.laws || args.eval.is_some();
    !readings && args.plot.is_none() && args.table.is_none() && args.picture.is_none()
}

/// Title of a plot: the material and its parameters that were set.
fn titled(args: &MaterialArgs) -> String {
    let set = args.params.iter().map(|(name, value)| format!(" {name}={value}"));
    format!("{}{}", args.material, set.collect::<String>())
}

fn tell(report: &Report, json: bool) -> Outcome {
    if json {
        terminal::json(report)?;
    } else {
        terminal::data(report.text().as_bytes())?;
    }
    Ok(failure::DONE)
}

/// Largest file of pairs, bytes.
const MOST_PAIRS: u64 = 1 << 30;

fn read_pairs(path: &Path) -> Result<Vec<Pair>, Failure> {
    let fault = |e: &dyn std::fmt::Display| {
        Failure::bad_input(format!(
            "cannot read pairs from '{}': {e} (wanted is [{{\"wo\": [x, y, z], \"wi\": [x, y, z]}}, …])",
            path.display()
        ))
    };
    let text = steradian::image::read_regular(path, MOST_PAIRS).map_err(|e| fault(&e))?;
    let pairs: Vec<Pair> = serde_json::from_slice(&text).map_err(|e| fault(&e))?;
    let bad = |w: &[f32; 3]| !Vec3::from(*w).is_normalized();
    match pairs.iter().position(|p| bad(&p.wo) || bad(&p.wi)) {
        Some(i) => Err(fault(&format!("a direction of pair {i} is not of length one"))),
        None => Ok(pairs),
    }
}

fn evaluate(specimen: &Specimen<'_>, pairs: &[Pair], importance: bool) -> Vec<Evaluated> {
    use steradian::instruments::TransportMode::{Importance, Radiance};
    let mode = if importance { Importance } else { Radiance };
    pairs
        .iter()
        .map(|p| {
            let e = specimen.eval(p.wo.into(), p.wi.into(), mode);
            Evaluated { value: specimen.lanes(e.value), pdf: e.pdf }
        })
        .collect()
}

/// The scene that holds a material.
struct Glass {
    scene: Arc<Scene>,
    /// Which of its materials.
    index: u32,
    /// The files that it was made of.
    inputs: Inputs,
    /// Its kind, and its parameters.
    kind: String,
    parameters: Vec<Setting>,
}

/// The scene file and the name in it, where a material is one of a scene.
fn scene_and_name(material: &str) -> Option<(&str, &str)> {
    // What has an extension is a file, whether it is there or not.
    let is_scene = |file: &str| file.starts_with("builtin:") || Path::new(file).extension().is_some();
    material.rsplit_once(':').filter(|(file, _)| is_scene(file))
}

/// Why a scene alone is not enough, with the materials that it has.
fn of_which(args: &MaterialArgs, terminal: Terminal) -> Failure {
    let scene = &args.material;
    let opened = open::open(Path::new(scene), &args.scene, None);
    match open::ready(opened, Path::new(scene), false, terminal) {
        Err(failure) => failure,
        Ok(ready) => {
            let mut names: Vec<&str> = Vec::new();
            for name in ready.scene.material_names().iter().filter(|n| !n.is_empty()) {
                if !names.contains(&name.as_str()) {
                    names.push(name);
                }
            }
            // What shapes without a material have comes last.
            names.sort_by_key(|n| *n == "default");
            let Some(first) = names.first() else {
                return Failure::bad_input(format!("'{scene}' is a scene, and none of its materials has a name"));
            };
            let (example, names) = (format!("steradian material {scene}:{first}"), names.join(", "));
            Failure::bad_input(format!("'{scene}' is a scene; name one of its materials ({names}), as in {example}"))
        }
    }
}

/// The material of a scene file, or of a kind with the parameters given.
fn under_glass(args: &MaterialArgs, terminal: Terminal) -> Result<Glass, Failure> {
    if let Some((file, name)) = scene_and_name(&args.material) {
        if !args.params.is_empty() {
            return Err(Failure::bad_input("--params sets parameters of a material by kind, not of one in a scene"));
        }
        let opened = open::open(Path::new(file), &args.scene, None);
        let is_named = |n: &&Node| n.family == Family::Material && n.name.as_deref() == Some(name);
        let node = opened.desc.nodes.iter().rfind(is_named);
        let parameters = node.map(|n| material_summary::settings(n, &opened.desc)).unwrap_or_default();
        let kind = node.map(|n| n.kind.clone()).unwrap_or_default();
        let ready = open::ready(opened, Path::new(file), args.scene.strict, terminal)?;
        let names = || ready.scene.material_names().iter().map(String::as_str);
        known_name(name, "material", names()).map_err(Failure::bad_input)?;
        let index = names().collect::<Vec<_>>().iter().rposition(|n| *n == name).unwrap_or(0);
        return Ok(Glass { scene: ready.scene, index: index as u32, inputs: ready.inputs, kind, parameters });
    }
    if args.material.starts_with("builtin:") || Path::new(&args.material).is_file() {
        return Err(of_which(args, terminal));
    }
    material_summary::known(&args.material)?;
    let desc = specimen::describe(&args.material, &args.params).map_err(Failure::bad_input)?;
    let mode = if args.scene.color == Color::Spectral { ColorMode::Spectral } else { ColorMode::Rgb };
    let compiling = CompileOptions {
        mode: Some(mode),
        size: Some(args.scene.size.map_or(PICTURE, |s| (s.0, s.1))),
        ..CompileOptions::default()
    };
    let compiled = steradian::compile(&desc, &compiling);
    diagnostics::tell(&compiled.diagnostics, terminal);
    // The specimen is the first shape.
    match compiled.scene {
        Some(scene) => {
            let inputs = Inputs::of(desc.files().chain(compiled.files.iter().map(PathBuf::as_path)));
            let is_it = |n: &&Node| n.family == Family::Material && n.name.as_deref() == Some(&*args.material);
            let node = desc.nodes.iter().rfind(is_it);
            let parameters = node.map(|n| material_summary::settings(n, &desc)).unwrap_or_default();
            let (index, kind) = (scene.geometries()[0].material, args.material.clone());
            Ok(Glass { index, scene: Arc::new(scene), inputs, kind, parameters })
        }
        None => Err(Failure::bad_input(format!("material '{}' has errors", args.material))),
    }
}

impl Report {
    fn text(&self) -> String {
        let mut out = String::new();
        let lanes = |v: &[f32]| v.iter().map(|v| format!("{v:9.5}")).collect::<Vec<_>>().join(" ");
        let what = match self.wavelengths {
            Some(l) => format!("at {} nm", l.map(|l| l.to_string()).join(", ")),
            None => "red, green, blue".into(),
        };
        if let Some(kind) = &self.kind {
            material_summary::text(&mut out, kind, &self.parameters, self.summary.as_ref());
        }
        if let Some(rows) = &self.albedo {
            let _ = writeln!(out, "albedo ({what})\n angle  reflectance                     transmittance");
            for a in rows {
                let _ = writeln!(
                    out,
                    "{:5}°  {}   {}  ± {:.5}",
                    a.theta,
                    lanes(&a.reflectance),
                    lanes(&a.transmittance),
                    a.error
                );
            }
        }
        for g in self.gloss.iter().flatten() {
            let _ = writeln!(out, "gloss {}°  {:.2} GU ± {:.2}", g.theta, g.units, g.error);
        }
        for f in self.fit.iter().flatten() {
            let _ = writeln!(
                out,
                "fit {:14} diffuse {:.4}  specular {:.4}  alpha {:.4}  residual {:.2e}",
                format!("{:?}", f.model),
                f.diffuse,
                f.specular,
                f.alpha,
                f.residual
            );
        }
        if let Some(best) = self.best_fit {
            let _ = writeln!(out, "best fit {best:?}");
        }
        if let Some(laws) = &self.laws {
            let _ = writeln!(out, "{laws}");
        }
        if let Some(rows) = &self.relief {
            let _ = writeln!(out, "geometry\n angle  reflected  met once");
            for r in rows {
                let _ = writeln!(out, "{:5}°  {:9.5}  {:8.5}", r.theta, r.albedo, r.single);
            }
        }
        for (i, e) in self.eval.iter().flatten().enumerate() {
            let _ = writeln!(out, "{i:6}  f cos {}  pdf {:.6}", lanes(&e.value), e.pdf);
        }
        out
    }
}
