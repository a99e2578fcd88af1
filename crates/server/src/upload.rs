//! Scenes and pictures that are dropped onto the page. Scenes lie in a folder of their own, and read nothing outside
//! it; a picture without a scene becomes the environment map of the one that is shown.

use crate::{
    app::{App, Refused},
    document::Source,
    save::{LONGEST_NAME, is_printable},
    uploaded::Upload,
    viewer::Task,
};
use axum::{
    extract::{Multipart, State},
    http::StatusCode,
    response::{IntoResponse, Json, Response},
};
use std::{
    io::Write,
    path::{Component, Path, PathBuf},
    sync::PoisonError,
};
use steradian::{
    archive,
    formats::Options,
    image::{FileKind, TemporaryFolder},
    load::extensions,
};
use tokio::sync::oneshot;

/// Bytes of an upload.
pub const MOST_BYTES: usize = 1 << 30;
/// Files of an upload.
const MOST_FILES: usize = 4096;
/// Folders within each other.
const DEEPEST: usize = 16;

/// Bytes that an archive may stand for.
const MOST_UNPACKED: u64 = 8 << 30;
/// Bytes of an environment map.
const MOST_OF_PICTURE: u64 = 256 << 20;

/// Opens the scene among the files that come, form fields `file` with their names; where there is none but a picture,
/// makes that the environment map.
pub async fn open(State(app): State<App>, form: Multipart) -> Result<Response, Refused> {
    let failed =
        |e: std::io::Error| Refused(StatusCode::INTERNAL_SERVER_ERROR, format!("the files cannot be kept: {e}"));
    let folder = TemporaryFolder::new("steradian-view-").map_err(failed)?;
    let names =
        receive(form, &folder).await.inspect_err(|why| app.log.refused(&format!("refused an upload: {}", why.1)))?;
    let (mut upload, mut inside) = (Upload { folder, unpacked: None }, None);
    let scene = match (scene_of(&names), &names[..]) {
        (Some(scene), _) => scene,
        (None, [archive]) if archive.extension().is_some_and(|e| e.eq_ignore_ascii_case(archive::EXTENSION)) => {
            let path = upload.folder.path().join(archive);
            let unpacked =
                tokio::task::spawn_blocking(move || archive::unpack_at_most(&path, Path::new(""), MOST_UNPACKED));
            let unfit =
                |why: String| Refused(StatusCode::UNPROCESSABLE_ENTITY, format!("'{}' {why}", archive.display()));
            let unpacked = unpacked.await.map_err(|e| unfit(e.to_string()))?.map_err(|e| unfit(e.to_string()))?;
            let name = unpacked.scene.strip_prefix(unpacked.folder.path()).unwrap_or(&unpacked.scene).to_owned();
            upload.unpacked = Some(unpacked);
            inside.insert(name)
        }
        (None, [picture]) if FileKind::from_extension(picture).is_some() => {
            return set_environment(&app, &upload.folder.path().join(picture)).await;
        }
        (None, _) => {
            let known = extensions().map(|e| format!(".{}", e.0)).collect::<Vec<_>>().join(", ");
            let why = format!(
                "there is no scene among the files, nor is it one picture, for an environment map; \
                 scenes are {known}, .zip"
            );
            return Err(Refused(StatusCode::UNPROCESSABLE_ENTITY, why));
        }
    };
    let within = upload.path().canonicalize().map_err(failed)?;
    let source = Source {
        name: within.join(scene),
        reading: Options { within: Some(within), ..Options::default() },
        ..Source::default()
    };
    let (tell, told) = oneshot::channel();
    app.viewer.send(Task::Open(Box::new(source), tell));
    let opened = told.await.map_err(|_| Refused(StatusCode::SERVICE_UNAVAILABLE, "the view has ended".into()))?;
    match opened {
        Ok(()) => {
            // The folder of the scene before goes away now.
            *app.upload.lock().unwrap_or_else(PoisonError::into_inner) = Some(upload);
            Ok(Json(serde_json::json!({ "opened": scene })).into_response())
        }
        Err(messages) => {
            let body = serde_json::json!({ "error": messages.join("\n"), "messages": messages });
            Ok((StatusCode::UNPROCESSABLE_ENTITY, Json(body)).into_response())
        }
    }
}

/// Lights the scene by an environment map.
async fn set_environment(app: &App, picture: &Path) -> Result<Response, Refused> {
    let unfit = |why: String| Refused(StatusCode::UNPROCESSABLE_ENTITY, why);
    let length = picture.metadata().map_or(0, |m| m.len());
    if length > MOST_OF_PICTURE {
        return Err(unfit(format!("an environment map has at most {MOST_OF_PICTURE} bytes, not {length}")));
    }
    let name = picture.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let bytes = std::fs::read(picture).map_err(|e| unfit(format!("'{name}' cannot be read: {e}")))?;
    let (tell, told) = oneshot::channel();
    app.viewer.send(Task::Environment(name.clone(), bytes.into(), tell));
    let done = told.await.map_err(|_| Refused(StatusCode::SERVICE_UNAVAILABLE, "the view has ended".into()))?;
    done.map_err(unfit)?;
    Ok(Json(serde_json::json!({ "environment": name })).into_response())
}

/// Keeps all files; their names.
///
/// # Errors
/// Names that lead out of the folder, and files that cannot be kept.
pub async fn receive(mut form: Multipart, folder: &TemporaryFolder) -> Result<Vec<PathBuf>, Refused> {
    let bad = |why: &str| Refused(StatusCode::BAD_REQUEST, why.into());
    let mut names: Vec<PathBuf> = Vec::new();
    while let Some(mut field) = form.next_field().await.map_err(|e| Refused(e.status(), e.body_text()))? {
        let name =
            field.file_name().and_then(within).ok_or_else(|| bad("a file has no name of a file below its folder"))?;
        if names.len() >= MOST_FILES || names.contains(&name) {
            return Err(bad("there are too many files, or two of a name"));
        }
        let path = folder.path().join(&name);
        let failed = |e: std::io::Error| Refused(fault_of(&e), format!("'{}' cannot be kept: {e}", name.display()));
        if let Some(inner) = path.parent().filter(|inner| *inner != folder.path()) {
            std::fs::create_dir_all(inner).map_err(failed)?;
        }
        let mut file = std::fs::File::create_new(&path).map_err(failed)?;
        while let Some(bytes) = field.chunk().await.map_err(|e| Refused(e.status(), e.body_text()))? {
            file.write_all(&bytes).map_err(failed)?;
        }
        names.push(name);
    }
    Ok(names)
}

/// The status for an error of the system: a name that no file can have, or that another file's folder has, is the
/// request's fault.
fn fault_of(error: &std::io::Error) -> StatusCode {
    use std::io::ErrorKind::{AlreadyExists, InvalidFilename, InvalidInput, IsADirectory, NotADirectory};
    match error.kind() {
        AlreadyExists | InvalidFilename | InvalidInput | IsADirectory | NotADirectory => StatusCode::BAD_REQUEST,
        _ => StatusCode::INTERNAL_SERVER_ERROR,
    }
}

/// A name as a path below a folder, if it is one.
fn within(name: &str) -> Option<PathBuf> {
    if name.is_empty() || name.len() > 1024 || name.contains('\\') || !is_printable(name) {
        return None;
    }
    let parts: Option<Vec<_>> = Path::new(name)
        .components()
        .map(|part| match part {
            Component::Normal(part) if part.len() <= LONGEST_NAME => Some(part),
            _ => None,
        })
        .collect();
    parts.filter(|p| !p.is_empty() && p.len() <= DEEPEST).map(|p| p.into_iter().collect())
}

/// The scene among files: the one least deep, and of those the one whose kind names others.
fn scene_of(names: &[PathBuf]) -> Option<&PathBuf> {
    let rank = |path: &PathBuf| {
        let name = path.to_string_lossy().to_ascii_lowercase();
        let name = name.strip_suffix(".gz").unwrap_or(&name);
        extensions().position(|e| name.strip_suffix(e.0).is_some_and(|stem| stem.ends_with('.')))
    };
    let found = names.iter().filter_map(|path| Some((path.components().count(), rank(path)?, path)));
    found.min().map(|(_, _, path)| path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_nowhere_else() {
        assert_eq!(within("a/b.png"), Some("a/b.png".into()));
        assert_eq!(within("a.obj"), Some("a.obj".into()));
        let (deep, long) = ("a/".repeat(17) + "b", "x".repeat(256));
        assert_eq!(within(&long[1..]), Some(long[1..].into()));
        for bad in [
            "",
            "/etc/passwd",
            "../a",
            "a/../../b",
            "./a/..",
            "..",
            ".",
            "a\\b",
            "a\0b",
            "a\nb",
            "a\u{202e}b",
            &*deep,
            &*long,
        ] {
            assert_eq!(within(bad), None, "{bad:?}");
        }
    }

    #[test]
    fn the_scene_is_found_among_what_belongs_to_it() {
        let of = |names: &[&str]| {
            let names: Vec<PathBuf> = names.iter().map(PathBuf::from).collect();
            scene_of(&names).map(|p| p.to_string_lossy().into_owned())
        };
        assert_eq!(of(&["models/a.ply", "scene.xml", "b.png"]).as_deref(), Some("scene.xml"));
        assert_eq!(of(&["a.ply", "scene.PBRT.gz"]).as_deref(), Some("scene.PBRT.gz"));
        assert_eq!(of(&["a.png", "glb", "x.objx"]), None);
    }
}
