//! The file of a job: the render that is asked for, and how it is cut.
//!
//! A render falls into pieces of equal work per frame (tiles, or passes), numbered over all frames. A chunk is a range
//! of these; its *parts* are what it has of each frame, and every part has a state file of its own.

use crate::{args::RenderArgs, failure::Failure};
use clap::{Args, Command, FromArgMatches};
use serde::{Deserialize, Serialize};
use std::{
    fs,
    ops::Range,
    path::{Path, PathBuf},
};
use steradian::resume::{self, StateFile};

/// Name of the file in the folder of a job.
const FILE: &str = "job.json";
/// Longest file of a job, bytes.
const LONGEST: u64 = 1 << 20;
/// Most chunks of a job.
pub const MOST_CHUNKS: u32 = 1 << 20;

/// A job.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JobFile {
    /// Version of the program that planned it.
    pub steradian: String,
    /// BLAKE3 hash of the scene's description, as of the first frame, and of the files that it names, in hexadecimal
    /// digits.
    pub scene: String,
    /// Arguments of `steradian render`, without outputs.
    pub arguments: Vec<String>,
    /// The first frame of an animation, and the last.
    pub frames: Option<[u32; 2]>,
    /// Number of pieces of a frame.
    pub pieces: u32,
    /// Number of chunks.
    pub chunks: u32,
}

/// Share of a chunk in a frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// Number of the frame of an animation.
    pub frame: Option<u32>,
    /// Pieces of that frame.
    pub pieces: Range<u32>,
}

impl JobFile {
    /// Reads the job of a folder.
    ///
    /// # Errors
    /// Why there is none, or none that this program can compute.
    pub fn read(folder: &Path) -> Result<Self, Failure> {
        let path = folder.join(FILE);
        let refuse = |why: String| Failure::bad_input(format!("'{}' {why}", path.display()));
        let length = fs::metadata(&path).map_err(|e| refuse(format!("cannot be read: {e}")))?.len();
        if length > LONGEST {
            return Err(refuse(format!("is no job of steradian: it has {length} bytes")));
        }
        let bytes = fs::read(&path).map_err(|e| refuse(format!("cannot be read: {e}")))?;
        let job: Self = serde_json::from_slice(&bytes).map_err(|e| refuse(format!("is no job of steradian: {e}")))?;
        if job.steradian != version() {
            let (theirs, ours) = (&job.steradian, version());
            return Err(refuse(format!("was planned by version {theirs}; this is {ours}, whose bits may differ")));
        }
        let [first, last] = job.frames.unwrap_or_default();
        if job.pieces == 0 || job.chunks == 0 || first > last || u64::from(job.chunks) > job.all_pieces() {
            return Err(refuse("is damaged: its numbers do not fit each other".into()));
        }
        Ok(job)
    }

    /// Writes the job to a folder.
    ///
    /// # Errors
    /// The system's answer, and another job that is there.
    pub fn write(&self, folder: &Path) -> Result<(), Failure> {
        let path = folder.join(FILE);
        let bytes = serde_json::to_vec_pretty(self).map_err(|e| Failure::failed(e.to_string()))?;
        if path.exists() && fs::read(&path).ok().as_ref() != Some(&bytes) {
            let name = folder.display();
            return Err(Failure::bad_input(format!("'{name}' holds another job: remove it, or give another folder")));
        }
        steradian::image::write_whole(&path, &bytes).map_err(|e| Failure::failed(e.to_string()))
    }

    /// Number of pieces of all frames.
    fn all_pieces(&self) -> u64 {
        let [first, last] = self.frames.unwrap_or_default();
        u64::from(self.pieces) * (u64::from(last - first) + 1)
    }

    /// Refuses the number of a chunk that the job does not have.
    ///
    /// # Errors
    /// Numbers of those that it has.
    pub fn check(&self, chunk: u32) -> Result<(), Failure> {
        let last = self.chunks - 1;
        match chunk <= last {
            true => Ok(()),
            false => Err(Failure::bad_input(format!("there is no chunk {chunk}: those of this job are 0 to {last}"))),
        }
    }

    /// Parts of a chunk, which is counted from zero.
    pub fn parts(&self, chunk: u32) -> Vec<Part> {
        let (all, of) = (self.all_pieces(), u64::from(self.pieces));
        let bound = |chunk: u32| (u128::from(all) * u128::from(chunk) / u128::from(self.chunks)) as u64;
        let (begin, end) = (bound(chunk), bound(chunk + 1));
        let mut parts = Vec::new();
        let mut at = begin;
        while at < end {
            let frame = at / of;
            let stop = end.min((frame + 1) * of);
            let pieces = (at - frame * of) as u32..(stop - frame * of) as u32;
            parts.push(Part { frame: self.frames.map(|[first, _]| first + frame as u32), pieces });
            at = stop;
        }
        parts
    }

    /// True if the result of a chunk is in its files.
    pub fn has(&self, folder: &Path, chunk: u32) -> bool {
        self.parts(chunk).iter().all(|part| {
            resume::state_file(&state_of(folder, chunk, part))
                .is_ok_and(|there| there.is_finished && part.is_kept_in(&there, self))
        })
    }

    /// Parts of all chunks that belong to a frame, with the numbers of these.
    pub fn parts_of(&self, frame: Option<u32>) -> Vec<(u32, Part)> {
        let parts = (0..self.chunks).flat_map(|chunk| self.parts(chunk).into_iter().map(move |part| (chunk, part)));
        parts.filter(|(_, part)| part.frame == frame).collect()
    }

    /// Frames of the job; one without a number where nothing moves.
    pub fn all_frames(&self) -> Vec<Option<u32>> {
        self.frames.map_or(vec![None], |[first, last]| (first..=last).map(Some).collect())
    }

    /// The render of all frames, of the scene where it lies here, if that is elsewhere.
    ///
    /// # Errors
    /// Arguments that this program does not know.
    pub fn render_args(&self, folder: &Path, scene: Option<&Path>) -> Result<RenderArgs, Failure> {
        let damaged = |why: String| Failure::bad_input(format!("'{}' is damaged: {why}", folder.join(FILE).display()));
        let words = ["render"].into_iter().chain(self.arguments.iter().map(String::as_str));
        let parsed = RenderArgs::augment_args(Command::new("render")).try_get_matches_from(words);
        let parsed = parsed.and_then(|matches| RenderArgs::from_arg_matches(&matches));
        let mut args = parsed.map_err(|e| damaged(e.to_string()))?;
        if args.frames.map(|all| [all.first, all.last]) != self.frames {
            return Err(damaged("its frames do not fit each other".into()));
        }
        args.scene = scene.map(Path::to_path_buf).or(args.scene);
        Ok(args)
    }
}

impl Part {
    /// True if a state file is of this part of a job.
    pub fn is_kept_in(&self, there: &StateFile, job: &JobFile) -> bool {
        let pieces = there.pieces.clone().unwrap_or((0..job.pieces, job.pieces));
        self.may_be_of(&there.scene, job) && pieces == (self.pieces.clone(), job.pieces)
    }

    /// True unless the job was planned for another scene than that of a fingerprint. Of later frames only merging
    /// knows, which reads their scenes.
    pub fn may_be_of(&self, scene: &str, job: &JobFile) -> bool {
        self.frame != job.frames.map(|[first, _]| first) || scene == job.scene
    }
}

/// The file that keeps a part of a chunk.
pub fn state_of(folder: &Path, chunk: u32, part: &Part) -> PathBuf {
    let frame = part.frame.map(|frame| format!(".{frame:04}")).unwrap_or_default();
    folder.join(format!("{chunk:06}{frame}.part"))
}

/// Version of the program, with the commit of its sources.
pub fn version() -> &'static str {
    concat!(env!("CARGO_PKG_VERSION"), env!("STERADIAN_COMMIT"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn job(frames: Option<[u32; 2]>, pieces: u32, chunks: u32) -> JobFile {
        JobFile { steradian: version().into(), scene: String::new(), arguments: Vec::new(), frames, pieces, chunks }
    }

    /// The parts of all chunks are each piece of each frame, once, in their order, and chunks differ by one piece at
    /// most.
    #[test]
    fn chunks_are_a_partition() {
        for (frames, pieces, chunks) in
            [(None, 1, 1), (None, 100, 17), (Some([3, 7]), 12, 7), (Some([0, 9]), 5, 3), (Some([4, 4]), 6, 6)]
        {
            let job = job(frames, pieces, chunks);
            let sizes: Vec<u32> =
                (0..chunks).map(|k| job.parts(k).iter().map(|part| part.pieces.len() as u32).sum()).collect();
            assert!(sizes.iter().max().unwrap() - sizes.iter().min().unwrap() <= 1, "{sizes:?}");
            for frame in job.all_frames() {
                let all = job.parts_of(frame).into_iter().flat_map(|(_, part)| part.pieces);
                assert!(all.eq(0..pieces), "{frames:?} {pieces} {chunks}");
            }
        }
    }

    /// A job is read as it was written; others are refused.
    #[test]
    fn jobs_are_read_as_written() {
        let folder = tempfile::tempdir().unwrap();
        let job = job(Some([2, 5]), 30, 4);
        job.write(folder.path()).unwrap();
        job.write(folder.path()).unwrap();
        assert_eq!(JobFile::read(folder.path()).unwrap(), job);
        let other = JobFile { chunks: 5, ..job.clone() };
        assert!(other.write(folder.path()).unwrap_err().message.contains("holds another job"));
        let path = folder.path().join(FILE);
        for (bad, why) in [
            (JobFile { chunks: 0, ..job.clone() }, "damaged"),
            (JobFile { chunks: 121, ..job.clone() }, "damaged"),
            (JobFile { frames: Some([3, 2]), ..job.clone() }, "damaged"),
            (JobFile { steradian: "0.0.1".into(), ..job }, "version 0.0.1"),
        ] {
            fs::write(&path, serde_json::to_vec(&bad).unwrap()).unwrap();
            assert!(JobFile::read(folder.path()).unwrap_err().message.contains(why), "{bad:?}");
        }
        fs::write(&path, b"{}").unwrap();
        assert!(JobFile::read(folder.path()).unwrap_err().message.contains("no job"));
    }
}
