//! Regression check of pictures: small pictures of every integrator on scenes of the project, with layers, and gone on
//! with after a stop, as hashes of their pixels; and the instructions that one picture of each integrator takes,
//! counted by valgrind. Hashes depend on the machine's mathematics, so they are kept for the machine, not in the
//! repository: `--keep` before the change, nothing after it.

use std::{
    collections::BTreeMap,
    error::Error,
    path::{Path, PathBuf},
    process::Command,
};

/// Arguments of `same`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The program that renders; `cargo build --profile quick -p steradian-cli` makes this one
    #[arg(long, default_value = "target/quick/steradian")]
    program: PathBuf,
    /// File of hashes and counts
    #[arg(long, default_value = "target/same.json")]
    file: PathBuf,
    /// Keep what this program gives, instead of comparing with what is kept
    #[arg(long)]
    keep: bool,
    /// Count instructions, too, of which those of a release build are comparable
    #[arg(long)]
    instructions: bool,
}

/// Scenes of `scenes/verify`, and what else is asked for beside the integrator's name.
const SCENES: [&str; 12] = [
    "bumps.pbrt",
    "caustic.pbrt",
    "collimated.xml",
    "diffuse.pbrt",
    "dispersive.pbrt",
    "fog.pbrt",
    "instanced.pbrt",
    "lens.pbrt",
    "masked.pbrt",
    "moving.pbrt",
    "sky-and-lamp.pbrt",
    "textured.pbrt",
];
/// Integrators and their options, in forms that take little time.
const INTEGRATORS: [&str; 30] = [
    "path",
    "path:reuse=4",
    "path:caustics=true,reuse=1",
    "volpath",
    "direct",
    "whitted",
    "ao:distance=1",
    "gather",
    "irradiance-cache:rays=32",
    "raycast",
    "structure",
    "structure:structure=kdtree,show=cells",
    "structure:structure=octree,show=boxes",
    "radiosity:patches=200",
    "radiosity:patches=200,gather=2",
    "light",
    "bdpt",
    "vcm",
    "sppm",
    "photon:photons=2000",
    "photon:photons=2000,nearest=20",
    "pssmlt",
    "mmlt",
    "stokes",
    "stokes-s1",
    "raster",
    "raster:shadows=map",
    "raster:shadows=volume",
    "raster:visibility=bsp",
    "raster:show=normal",
];
/// The scene whose pictures' instructions are counted.
const COUNTED: &str = "diffuse.pbrt";
/// Growth of a count that is an answer of its own.
const ALLOWED: f64 = 0.01;

/// Renders, and keeps or compares.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let folder = std::env::temp_dir().join(format!("steradian-same-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let found = all(arguments, &folder);
    std::fs::remove_dir_all(&folder)?;
    let (pictures, counts) = found?;
    let text = || serde_json::to_string_pretty(&(&pictures, &counts));
    if arguments.keep {
        std::fs::write(&arguments.file, text()? + "\n")?;
        println!("kept {} pictures and {} counts in {}", pictures.len(), counts.len(), arguments.file.display());
        return Ok(());
    }
    let kept = std::fs::read(&arguments.file)
        .map_err(|e| format!("{}: {e}; make it with --keep", arguments.file.display()))?;
    let (before, counted): (BTreeMap<String, String>, BTreeMap<String, u64>) = serde_json::from_slice(&kept)?;
    let mut differ = 0;
    for name in before.keys().chain(pictures.keys().filter(|name| !before.contains_key(*name))) {
        let (then, now) = (before.get(name), pictures.get(name));
        if then != now {
            differ += 1;
            println!("differs: {name}: {} before, {} now", shown(then), shown(now));
        }
    }
    for (name, now) in &counts {
        let Some(then) = counted.get(name) else { continue };
        let growth = *now as f64 / *then as f64 - 1.0;
        println!("{name}: {now} instructions, {:+.2} %", 100.0 * growth);
        differ += usize::from(growth > ALLOWED);
    }
    match differ {
        0 => {
            println!("the same: {} pictures, {} counts", pictures.len(), counts.len());
            Ok(())
        }
        n => Err(format!("{n} are not the same").into()),
    }
}

fn shown(hash: Option<&String>) -> &str {
    hash.map_or("none", |hash| &hash[..hash.len().min(60)])
}

type Found = (BTreeMap<String, String>, BTreeMap<String, u64>);

fn all(arguments: &Arguments, folder: &Path) -> Result<Found, Box<dyn Error>> {
    let (mut pictures, mut counts) = (BTreeMap::new(), BTreeMap::new());
    let out = folder.join("picture.exr");
    for integrator in INTEGRATORS {
        // With layers in one of two renders.
        for (number, scene) in SCENES.into_iter().enumerate() {
            let (path, out) = (Path::new("scenes/verify").join(scene), &out);
            let basic = ["--size", "20x12", "--spp", "4"];
            let layers = ["--aov", "all,cryptomatte"];
            let mut extra: Vec<&str> = basic.to_vec();
            if number % 2 == 0 {
                extra.extend(layers);
            }
            pictures
                .insert(format!("{scene} {integrator}"), picture(&arguments.program, &path, integrator, &extra, out)?);
        }
        let path = Path::new("scenes/verify").join(COUNTED);
        // Stopped after a part of the samples, and gone on with.
        let state = folder.join("render.state");
        let _ = std::fs::remove_file(&state);
        let state_text = state.to_string_lossy();
        for spp in ["4", "10"] {
            let extra = ["--size", "20x12", "--spp", spp, "--crop", "3,2,17,11", "--resume", &state_text];
            let hash = picture(&arguments.program, &path, integrator, &extra, &out)?;
            pictures.insert(format!("{COUNTED} {integrator}, resumed, {spp}"), hash);
        }
        if arguments.instructions {
            counts.insert(integrator.to_owned(), instructions(&arguments.program, &path, integrator, &out)?);
        }
    }
    // Enough samples for trials of all kinds.
    for scene in [COUNTED, "caustic.pbrt"] {
        let path = Path::new("scenes/verify").join(scene);
        let extra = ["--size", "256x256", "--spp", "16", "--aov", "albedo"];
        pictures.insert(format!("{scene} path, large"), picture(&arguments.program, &path, "path", &extra, &out)?);
        pictures.insert(
            format!("{scene} path, large, adaptive"),
            picture(&arguments.program, &path, "path", &["--adaptive", "--size", "96x96", "--spp", "64"], &out)?,
        );
    }
    Ok((pictures, counts))
}

/// The hash of a picture's pixels, or what was said where there is none.
fn picture(
    program: &Path,
    scene: &Path,
    integrator: &str,
    extra: &[&str],
    out: &Path,
) -> Result<String, Box<dyn Error>> {
    let _ = std::fs::remove_file(out);
    let run = Command::new(program)
        .arg("render")
        .arg(scene)
        .args(["--quiet", "--threads", "2", "--integrator", integrator])
        .args(extra)
        .arg("-o")
        .arg(out)
        .output()?;
    if !run.status.success() {
        return Ok(String::from_utf8_lossy(&run.stderr)
            .lines()
            .find(|l| l.contains("error"))
            .unwrap_or_default()
            .into());
    }
    Ok(blake3::hash(pixels(&std::fs::read(out)?).ok_or("not an OpenEXR file")?).to_hex()[..16].to_owned())
}

/// Pixels of an OpenEXR file, after the table of offsets: without metadata, which tell of time.
fn pixels(file: &[u8]) -> Option<&[u8]> {
    // Magic number, version; attributes with name, kind, size and value; an empty name.
    let mut at = 8;
    loop {
        let name = file.get(at..)?.iter().position(|b| *b == 0)?;
        at += name + 1;
        if name == 0 {
            break;
        }
        at += file.get(at..)?.iter().position(|b| *b == 0)? + 1;
        at += 4 + u32::from_le_bytes(file.get(at..at + 4)?.try_into().ok()?) as usize;
    }
    // The first block begins where the table ends.
    let first = u64::from_le_bytes(file.get(at..at + 8)?.try_into().ok()?);
    file.get(usize::try_from(first).ok()?..)
}

/// Instructions of a picture, loading included.
fn instructions(program: &Path, scene: &Path, integrator: &str, out: &Path) -> Result<u64, Box<dyn Error>> {
    let run = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(program)
        .arg("render")
        .arg(scene)
        .args(["--quiet", "--threads", "1", "--integrator", integrator, "--size", "32x32", "--spp", "8", "-o"])
        .arg(out)
        .output()?;
    let said = String::from_utf8_lossy(&run.stderr);
    let collected =
        said.lines().find_map(|line| line.split_once("Collected : ")).and_then(|(_, n)| n.trim().parse().ok());
    collected
        .filter(|_| run.status.success())
        .ok_or_else(|| format!("valgrind did not count '{integrator}': {said}").into())
}

#[cfg(test)]
mod tests {
    use super::pixels;

    #[test]
    fn pixels_are_without_metadata() {
        let file = |seconds: &[u8]| {
            let mut file = b"v/1\x01\x02\0\0\0seconds\0string\0".to_vec();
            file.extend((seconds.len() as u32).to_le_bytes());
            file.extend(seconds);
            file.push(0);
            let first = file.len() as u64 + 8;
            file.extend(first.to_le_bytes());
            file.extend(b"block");
            file
        };
        for seconds in [&b"1.25"[..], b"100.0"] {
            assert_eq!(pixels(&file(seconds)), Some(&b"block"[..]));
        }
    }
}
