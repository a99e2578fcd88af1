//! Radiosity for users: solutions that are kept in files and seen again from any camera.

use crate::{Render, Scene, resume};
use std::{
    any::Any,
    io::{self, BufWriter, Write},
    path::Path,
};
use steradian_integrators::radiosity::{LoadError, Settings, Solution, View};
use steradian_scene::{Family, SceneDesc};

pub use steradian_integrators::radiosity::{Report, Watcher, solve};

const MAGIC: &[u8; 16] = b"Steradian light\n";
const HASH: usize = blake3::OUT_LEN;
/// Largest file that is read.
const LARGEST: u64 = 8 << 30;

/// Reason why a kept solution cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum KeptError {
    /// The system's answer.
    #[error("cannot be read: {0}")]
    Io(#[from] io::Error),
    /// Something else is in the file.
    #[error("is no kept solution of radiosity")]
    NotASolution,
    /// The file's contents are not those that were written.
    #[error("is damaged: its contents do not match their checksum")]
    Damaged,
    /// The scene has changed, or it is another one.
    #[error("belongs to another scene, or surfaces, materials, lights, or the colour mode have changed since")]
    OtherScene,
    /// The solution was computed with other settings.
    #[error("was solved with {0}, which is not what is asked for; without that file the scene is solved anew")]
    OtherSettings(String),
}

/// Views of radiosity, where that is the method of a render.
pub fn view_of(render: &Render) -> Option<&View> {
    (&*render.method as &dyn Any).downcast_ref()
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
    use crate::{CompileOptions, Quality, compile, cornell};
    use steradian_integrators::radiosity::FormFactors;

    fn scene(desc: &SceneDesc, camera: f64) -> Scene {
        let mut desc = desc.clone();
        let view = desc.cameras[0];
        let at = steradian_scene::Transform::translate(steradian_math::DVec3::new(camera, 0.0, -3.5));
        desc.nodes[view.0 as usize].set("to_world", steradian_scene::Value::from(at), None);
        compile(&desc, &CompileOptions { size: Some((16, 16)), ..CompileOptions::default() }).scene.unwrap()
    }

    /// Kept for one camera, seen from another; not for other lights, materials, or settings.
    #[test]
    fn solutions_are_kept_for_all_cameras() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("light");
        let desc = cornell::luminous_ceiling();
        let here = scene(&desc, 0.0);
        let render = Quality::of("radiosity:patches=100,adaptive=0").render(&here).unwrap();
        let settings = view_of(&render).expect("radiosity").settings;
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
    fn options_follow_requests() {
        let scene = scene(&cornell::luminous_ceiling(), 0.0);
        let view = |text: &str| {
            let render = Quality::of(&format!("radiosity:{text}")).render(&scene)?;
            Ok::<_, crate::Error>(*view_of(&render).expect("radiosity"))
        };
        let asked = view("factors=hemicube,resolution=32,patches=500,gather=4,wavelengths=9,max_depth=7").unwrap();
        assert_eq!(asked.settings.factors, FormFactors::Hemicube(32));
        assert_eq!((asked.settings.patches, asked.gather, asked.settings.bands), (500, 4, 3));
        // With a final gather the last two bounces are followed.
        assert_eq!((asked.depth.max, asked.settings.bounces), (7, Some(6)));
        let defaults = view("").unwrap();
        let bounces = defaults.settings.bounces;
        assert_eq!(defaults.settings, Settings { bounces, ..Settings::default() });
        assert_eq!(view("factors=hemicube").unwrap().settings.factors, FormFactors::Hemicube(64));
        for wrong in ["method=magic", "patches=0", "tolerance=0", "factors=", "spp=3", "gather", "rays=-1"] {
            assert!(view(wrong).is_err(), "{wrong}");
        }
    }
}
