//! Search for the library of Open Image Denoise.

use std::{
    env, fs,
    path::{Path, PathBuf},
};

/// The environment variable that names it.
const VARIABLE: &str = "STERADIAN_OIDN";
/// Beginning of the file names of version 2.
const NAME: &str = "libOpenImageDenoise.so.2";
/// Places of the library in a folder: of an archive of Open Image Denoise, of the package pyoidn, of a Python
/// environment.
const IN_FOLDER: [&str; 5] = ["", "lib", "lib64", "oidn/lib", "pyoidn/oidn/lib"];
const IN_PYTHON: &str = "site-packages/pyoidn/oidn/lib";
/// Usual folders of systems. Nothing else is searched, not what the dynamic linker would.
const USUAL: [&str; 9] = [
    "/usr/local/lib",
    "/usr/local/lib64",
    "/usr/lib",
    "/usr/lib64",
    "/usr/lib/x86_64-linux-gnu",
    "/usr/lib/aarch64-linux-gnu",
    "/opt/oidn/lib",
    "/opt/intel/oidn/lib",
    "/opt/intel/oneapi/oidn/latest/lib",
];
const HOW: &str =
    "`pip install --no-deps --target oidn pyoidn` brings it into the folder oidn, which --oidn oidn then names";

/// The file of the library of Open Image Denoise that `named`, the environment or a usual place has.
///
/// # Errors
/// The places that were searched, and how the library can be had.
pub fn oidn_library(named: Option<&Path>) -> Result<PathBuf, String> {
    find(named, env::var_os(VARIABLE).filter(|v| !v.is_empty()).map(PathBuf::from))
}

fn find(named: Option<&Path>, variable: Option<PathBuf>) -> Result<PathBuf, String> {
    let variable = match variable {
        Some(path) if path.is_relative() && named.is_none() => {
            return Err(format!("{VARIABLE} is an absolute path, not '{}'", path.display()));
        }
        variable => variable,
    };
    if let Some(path) = named.or(variable.as_deref()) {
        let whole = fs::canonicalize(path).map_err(|e| format!("'{}': {e}", path.display()))?;
        return match whole.is_dir() {
            false => Ok(whole),
            true => in_folder(&whole)
                .ok_or_else(|| format!("'{}' has no {NAME}, in it or where packages have it; {HOW}", path.display())),
        };
    }
    USUAL.iter().find_map(|folder| directly_in(Path::new(folder))).ok_or_else(|| {
        let places = USUAL.join(", ");
        format!(
            "Open Image Denoise 2 is not found: {HOW}. It is looked for where --oidn says, where {VARIABLE} says, \
             and as {NAME} in {places}"
        )
    })
}

fn in_folder(folder: &Path) -> Option<PathBuf> {
    let pythons = fs::read_dir(folder.join("lib")).into_iter().flatten().flatten();
    let pythons = pythons.filter(|entry| entry.file_name().to_string_lossy().starts_with("python"));
    let known = IN_FOLDER.iter().map(|inner| folder.join(inner));
    known.chain(pythons.map(|entry| entry.path().join(IN_PYTHON))).find_map(|folder| directly_in(&folder))
}

/// The library in a folder, the shortest name of several.
fn directly_in(folder: &Path) -> Option<PathBuf> {
    let names = fs::read_dir(folder).ok()?.flatten().map(|entry| entry.path());
    let is_it = |path: &PathBuf| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(NAME));
    let found = names.filter(is_it).min()?;
    fs::canonicalize(found).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An archive's folder, a package's, an environment's, and one of version 1.
    #[test]
    fn it_is_found_in_folders() {
        let place = tempfile::tempdir().unwrap();
        let root = fs::canonicalize(place.path()).unwrap();
        let python = "lib/python3.11/site-packages/pyoidn/oidn/lib";
        for inner in ["", "lib", "pyoidn/oidn/lib", python] {
            let folder = root.join(format!("at-{}", inner.len())).join(inner);
            fs::create_dir_all(&folder).unwrap();
            for name in [".2.5.1", ".1.4.3", ".2", ""] {
                fs::write(folder.join(format!("libOpenImageDenoise.so{name}")), "").unwrap();
            }
            let found = find(Some(&root.join(format!("at-{}", inner.len()))), None);
            assert_eq!(found.ok(), Some(folder.join(NAME)), "{inner}");
        }
        let old = root.join("old");
        fs::create_dir(&old).unwrap();
        fs::write(old.join("libOpenImageDenoise.so.1"), "").unwrap();
        let refusal = find(Some(&old), None).unwrap_err();
        assert!(refusal.contains("pip install"), "{refusal}");
        // What is named is taken, whatever the environment says; else what that says.
        let (file, other) = (old.join("libOpenImageDenoise.so.1"), root.join("none"));
        assert_eq!(find(Some(&file), Some(other.clone())).ok(), Some(file.clone()));
        assert_eq!(find(None, Some(file.clone())).ok(), Some(file));
        assert!(find(None, Some(other)).is_err());
        let relative = find(None, Some("lib".into())).unwrap_err();
        assert!(relative.contains("absolute"), "{relative}");
    }
}
