//! Calls of the system that tests let fail: every call that changes files goes through [`attempt`].

use std::io;

/// Makes a call, unless a test has it fail.
pub(crate) fn attempt<T>(call: impl FnOnce() -> io::Result<T>) -> io::Result<T> {
    #[cfg(test)]
    tests::come()?;
    call()
}

/// The bytes that a call of the system takes: of short writes a part.
pub(crate) fn part(bytes: &[u8]) -> &[u8] {
    #[cfg(test)]
    return tests::short(bytes);
    #[cfg(not(test))]
    bytes
}

#[cfg(test)]
mod tests {
    use crate::{write_together, write_whole};
    use std::{
        cell::Cell,
        fs,
        io::{self, ErrorKind},
        path::{Path, PathBuf},
    };

    thread_local! {
        /// Calls until one fails, and how it does.
        static NEXT: Cell<Option<(usize, ErrorKind)>> = const { Cell::new(None) };
        /// True if writes take a part of their bytes.
        static SHORT: Cell<bool> = const { Cell::new(false) };
    }

    /// Counts a call; the error of the one that is to fail.
    pub fn come() -> io::Result<()> {
        match NEXT.get() {
            Some((0, kind)) => {
                NEXT.set(None);
                Err(kind.into())
            }
            Some((n, kind)) => {
                NEXT.set(Some((n - 1, kind)));
                Ok(())
            }
            None => Ok(()),
        }
    }

    pub fn short(bytes: &[u8]) -> &[u8] {
        if SHORT.get() { &bytes[..bytes.len().div_ceil(3)] } else { bytes }
    }

    /// All files below a folder with their bytes.
    fn files(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
        let mut all = Vec::new();
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() { all.extend(files(&path)) } else { all.push((path.clone(), fs::read(&path).unwrap())) }
        }
        all.sort();
        all
    }

    /// Lets each call of `write` fail in turn: everything there is stays, and nothing is added, or all is done.
    /// Gives the number of calls.
    fn each_call(old: &[(&str, &[u8])], write: impl Fn(&Path) -> crate::Result<()>) -> usize {
        let fresh = || {
            let folder = tempfile::tempdir().unwrap();
            for (name, bytes) in old {
                fs::write(folder.path().join(name), bytes).unwrap();
            }
            folder
        };
        let relative = |folder: &Path| -> Vec<(PathBuf, Vec<u8>)> {
            files(folder).into_iter().map(|(p, b)| (p.strip_prefix(folder).unwrap().into(), b)).collect()
        };
        let whole = fresh();
        write(whole.path()).unwrap();
        let done = relative(whole.path());
        let mut calls = 0;
        for is_short in [false, true] {
            SHORT.set(is_short);
            for kind in [
                ErrorKind::StorageFull,
                ErrorKind::PermissionDenied,
                ErrorKind::ReadOnlyFilesystem,
                ErrorKind::QuotaExceeded,
                ErrorKind::Other,
            ] {
                for call in 0.. {
                    let folder = fresh();
                    let before = relative(folder.path());
                    NEXT.set(Some((call, kind)));
                    let answer = write(folder.path());
                    let has_failed = NEXT.take().is_none();
                    let after = relative(folder.path());
                    if !has_failed {
                        assert!(answer.is_ok() && after == done, "{kind}: {call} calls");
                        calls = calls.max(call);
                        break;
                    }
                    let message = answer.expect_err("the call has failed").to_string();
                    assert!(message.contains("a.exr") || message.contains("beside"), "{message}");
                    assert!(message.contains(&io::Error::from(kind).to_string()), "{message}");
                    assert_eq!(after, before, "{kind} at call {call}");
                    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), old.len(), "{kind} at call {call}");
                }
            }
        }
        SHORT.set(false);
        calls
    }

    #[test]
    fn whatever_call_fails_the_old_file_stays() {
        let bytes = vec![7; 100_000];
        let write = |folder: &Path| write_whole(&folder.join("a.exr"), &bytes);
        // A draft, its bytes, the old permissions, the disk, the name.
        assert!(each_call(&[("a.exr", b"old")], write) >= 5);
        assert!(each_call(&[], write) >= 4);
    }

    #[test]
    fn whatever_call_fails_a_document_and_its_files_stay() {
        let beside = [("beside/1".into(), vec![1; 5000]), ("beside/2".into(), b"two".to_vec())];
        let write = |folder: &Path| write_together(&folder.join("a.exr"), b"document", &beside);
        // A folder, two files of three calls each, the document's four, two names and their folder.
        assert!(each_call(&[("a.exr", b"old")], write) >= 14);
        assert!(each_call(&[], write) >= 13);
    }

    /// A call that was interrupted is made again.
    #[test]
    fn interrupted_writes_go_on() {
        let folder = tempfile::tempdir().unwrap();
        // The second call writes.
        NEXT.set(Some((1, ErrorKind::Interrupted)));
        write_whole(&folder.path().join("a.exr"), &[1; 10_000]).unwrap();
        assert_eq!(NEXT.take(), None);
        assert_eq!(fs::read(folder.path().join("a.exr")).unwrap(), [1; 10_000]);
    }
}
