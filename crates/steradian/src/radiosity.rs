//! Radiosity for users: its options in text, and solutions that are kept in files and seen again from any camera.

use crate::{Error, Scene, resume};
use std::{
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
};
use steradian_integrators::{
    Depth,
    radiosity::{FormFactors, LoadError, METHODS, Refusal, Settings, Solution, View, check},
};
use steradian_scene::{Family, SceneDesc};

pub use steradian_integrators::radiosity::{Report, Watcher, solve};

const MAGIC: &[u8; 16] = b"Steradian light\n";
const HASH: usize = blake3::OUT_LEN;
/// Largest file that is read.
const LARGEST: u64 = 8 << 30;

/// What is asked of radiosity.
#[derive(Clone, Debug)]
pub struct Asked {
    /// How it is solved and seen.
    pub view: View,
    /// The file that keeps the solution.
    pub file: Option<PathBuf>,
}

/// Why a kept solution is of no use.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum KeptError {
    /// The system's answer.
    #[error("cannot be read: {0}")]
    Io(#[from] io::Error),
    /// Something else is in the file.
    #[error("is no kept solution of radiosity")]
    NotASolution,
    /// What is in the file is not what was written.
    #[error("is damaged: its contents do not match their checksum")]
    Damaged,
    /// The scene has changed, or it is another one.
    #[error("belongs to another scene, or surfaces, materials, lights, or the colour mode have changed since")]
    OtherScene,
    /// It was solved otherwise.
    #[error("was solved with {0}, which is not what is asked for; without that file the scene is solved anew")]
    OtherSettings(String),
}

/// Reads the options `key=value,…` of radiosity.
///
/// # Errors
/// [`Error::RadiosityOption`] for what is not understood.
pub fn options(text: &str, mut depth: Depth) -> Result<Asked, Error> {
    let mut settings = Settings::default();
    let (mut gather, mut smooth, mut file) = (0, true, None);
    let (mut factors, mut resolution) = ("analytic", None);
    for option in text.split(',').filter(|o| !o.is_empty()) {
        let fault = || Error::RadiosityOption(option.into());
        let (key, value) = option.split_once('=').ok_or_else(fault)?;
        let whole = |range: std::ops::RangeInclusive<u32>| -> Result<u32, Error> {
            value.parse().ok().filter(|v| range.contains(v)).ok_or_else(fault)
        };
        match key.trim() {
            "max_depth" if value == "-1" => depth.max = u32::MAX,
            "max_depth" => depth.max = whole(0..=u32::MAX)?,
            "hide_emitters" => depth.hide_emitters = value.parse().map_err(|_| fault())?,
            "method" => settings.method = METHODS.iter().find(|m| m.0 == value).ok_or_else(fault)?.1,
            "factors" if ["analytic", "montecarlo", "hemicube"].contains(&value) => factors = value,
            "resolution" => resolution = Some(whole(2..=4096)?),
            "patches" => settings.patches = whole(1..=2_000_000)? as usize,
            "adaptive" => settings.adaptive = whole(0..=8)?,
            "tolerance" => {
                let v: f64 = value.parse().map_err(|_| fault())?;
                settings.tolerance = Some(v).filter(|v| *v > 0.0 && *v < 1.0).ok_or_else(fault)?;
            }
            "rays" => settings.rays = whole(1..=1_000_000)?,
            "wavelengths" => settings.bands = whole(4..=256)?.div_ceil(4) as usize,
            "ambient" => settings.ambient = value.parse().map_err(|_| fault())?,
            "gather" => gather = whole(0..=4096)?,
            "smooth" => smooth = value.parse().map_err(|_| fault())?,
            "solution" if !value.is_empty() => file = Some(PathBuf::from(value)),
            _ => return Err(fault()),
        }
    }
    settings.factors = match factors {
        "montecarlo" => FormFactors::MonteCarlo(resolution.unwrap_or(1000)),
        "hemicube" => FormFactors::Hemicube(resolution.unwrap_or(64)),
        _ => FormFactors::Analytic,
    };
    // The last bounce is that at the surface that is seen; with a final gather the last two are followed.
    let carried = depth.max.saturating_sub(u32::from(gather > 0));
    settings.bounces = (depth.max != u32::MAX).then_some(carried);
    Ok(Asked { view: View { settings, depth, gather, smooth }, file })
}

/// Whether a scene can be solved.
///
/// # Errors
/// Why it cannot.
pub fn can_solve(scene: &Scene, view: &View) -> Result<(), Refusal> {
    check(scene, &view.settings)
}

/// The fingerprint of all that light depends on: a description without its cameras and what is done with pictures.
///
/// # Errors
/// Those of reading files; files that are not there count as empty.
pub fn fingerprint(desc: &SceneDesc) -> io::Result<[u8; HASH]> {
    let seen = [Family::Camera, Family::Film, Family::Filter, Family::Sampler, Family::Integrator];
    resume::fingerprint_of(desc, (), |node| !seen.contains(&node.family))
}

/// Settings as they are kept: those that decide about the light.
fn kept(scene: &Scene, settings: &Settings) -> String {
    format!("{settings:?}, {:?}", scene.mode())
}

/// Keeps a solution in a file, which appears whole or not at all.
///
/// # Errors
/// The path and the system's answer.
pub fn keep(
    scene: &Scene,
    fingerprint: &[u8; HASH],
    settings: &Settings,
    solution: &Solution,
    path: &Path,
) -> Result<(), steradian_image::Error> {
    steradian_image::stream_whole(path, |out| {
        let mut bytes = Vec::new();
        bytes.extend(MAGIC);
        bytes.extend(fingerprint);
        let text = kept(scene, settings);
        bytes.extend((text.len() as u32).to_le_bytes());
        bytes.extend(text.as_bytes());
        solution.save(&mut bytes)?;
        let hash = *blake3::hash(&bytes).as_bytes();
        let mut out = BufWriter::new(out);
        out.write_all(&bytes)?;
        out.write_all(&hash)?;
        out.flush()
    })
}

/// A solution from a file.
///
/// # Errors
/// [`KeptError`].
pub fn load(scene: &Scene, fingerprint: &[u8; HASH], settings: &Settings, path: &Path) -> Result<Solution, KeptError> {
    let bytes = steradian_image::read_regular(path, LARGEST)?;
    if !bytes.starts_with(MAGIC) || bytes.len() < MAGIC.len() + 2 * HASH + 4 {
        return Err(KeptError::NotASolution);
    }
    let (body, hash) = bytes.split_at(bytes.len() - HASH);
    if blake3::hash(body).as_bytes() != hash {
        return Err(KeptError::Damaged);
    }
    let (theirs, rest) = body[MAGIC.len()..].split_at(HASH);
    if theirs != fingerprint {
        return Err(KeptError::OtherScene);
    }
    let (length, rest) = rest.split_at(4);
    let length = u32::from_le_bytes([length[0], length[1], length[2], length[3]]) as usize;
    let text = rest.get(..length).ok_or(KeptError::Damaged)?;
    if text != kept(scene, settings).as_bytes() {
        return Err(KeptError::OtherSettings(String::from_utf8_lossy(text).into_owned()));
    }
    let mut rest = &rest[length..];
    let length = rest.len() as u64;
    Solution::load(scene, &mut rest, length).map_err(|e| match e {
        LoadError::Io(_) => KeptError::Damaged,
        _ => KeptError::OtherScene,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{CompileOptions, compile, cornell};

    fn scene(desc: &SceneDesc, camera: f64) -> Scene {
        let mut desc = desc.clone();
        let view = desc.cameras[0];
        let at = steradian_scene::Transform::translate(steradian_math::DVec3::new(camera, 0.0, -3.5));
        desc.nodes[view.0 as usize].set("to_world", steradian_scene::Value::from(at), None);
        compile(&desc, &CompileOptions { size: Some((16, 16)), ..CompileOptions::default() }).scene.unwrap()
    }

    fn depth() -> Depth {
        Depth { max: u32::MAX, roulette_after: 2, hide_emitters: false }
    }

    /// Kept for one camera, seen from another; not for other lights, materials, or settings.
    #[test]
    fn solutions_are_kept_for_all_cameras() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("light");
        let desc = cornell::luminous_ceiling();
        let here = scene(&desc, 0.0);
        let settings = options("patches=100,adaptive=0", depth()).unwrap().view.settings;
        let print = fingerprint(&desc).unwrap();
        let solution = solve(&here, &settings, &()).unwrap().unwrap();
        keep(&here, &print, &settings, &solution, &path).unwrap();
        let there = scene(&desc, 0.3);
        let back = load(&there, &print, &settings, &path).unwrap();
        let light = |s: &Solution| s.patches().map(|p| p.1[0].to_array()).collect::<Vec<_>>();
        assert_eq!(light(&back), light(&solution));
        let other = fingerprint(&cornell::point_light()).unwrap();
        assert!(matches!(load(&there, &other, &settings, &path), Err(KeptError::OtherScene)));
        let more = Settings { patches: 200, ..settings };
        assert!(matches!(load(&there, &print, &more, &path), Err(KeptError::OtherSettings(_))));
        // What has no end, or waits for somebody, is not read.
        #[cfg(unix)]
        {
            let pipe = folder.path().join("pipe");
            assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
            for special in [pipe.as_path(), Path::new("/dev/zero"), folder.path()] {
                let said = load(&there, &print, &settings, special).unwrap_err().to_string();
                assert_eq!(said, "cannot be read: it is not a regular file", "{}", special.display());
            }
        }
        let bytes = std::fs::read(&path).unwrap();
        for at in (0..bytes.len()).step_by(311) {
            let mut changed = bytes.clone();
            changed[at] ^= 0x10;
            std::fs::write(&path, changed).unwrap();
            assert!(load(&there, &print, &settings, &path).is_err(), "byte {at}");
            std::fs::write(&path, &bytes[..at]).unwrap();
            assert!(load(&there, &print, &settings, &path).is_err(), "cut at {at}");
        }
    }

    #[test]
    fn options_are_read_or_refused() {
        let asked = options("method=direct,factors=hemicube,resolution=32,patches=500,gather=4,solution=a b", depth());
        let asked = asked.unwrap();
        assert_eq!(asked.view.settings.factors, FormFactors::Hemicube(32));
        assert_eq!((asked.view.gather, asked.file), (4, Some(PathBuf::from("a b"))));
        for wrong in
            ["method=magic", "patches=0", "tolerance=0", "tolerance=nan", "factors=", "spp=3", "gather", "rays=-1"]
        {
            assert!(options(wrong, depth()).is_err(), "{wrong}");
        }
    }
}
