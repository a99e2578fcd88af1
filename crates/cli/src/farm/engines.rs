//! The engines that deal out chunks, and the files that each of them reads.

use super::quote::{command, container, double, fill, list, shell};
use clap::ValueEnum;

/// Times that a chunk is computed before it is given up.
pub const TRIES: u32 = 5;
/// Most tasks of an array of Slurm as it is set up (MaxArraySize).
const SLURM_TASKS: u32 = 1000;
/// Most tasks of a job of HyperQueue, whose file names each.
const HYPERQUEUE_TASKS: u32 = 10_000;
/// Most completions of a job of Kubernetes that counts failures of each.
pub const KUBERNETES_CHUNKS: u32 = 100_000;

/// An engine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Engine {
    /// Worker processes of this machine.
    Local,
    /// Dask.
    Dask,
    /// HyperQueue.
    #[value(name = "hyperqueue")]
    HyperQueue,
    /// Slurm.
    Slurm,
    /// Kubernetes: an indexed job.
    Kubernetes,
    /// Flamenco.
    Flamenco,
    /// OpenCue.
    #[value(name = "opencue")]
    OpenCue,
}

/// A planned job as engines see it.
#[derive(Debug)]
pub struct Planned {
    /// Folder of the job, from the root on.
    pub folder: String,
    /// Number of chunks.
    pub chunks: u32,
    /// Number of workers, where it is given.
    pub workers: Option<u32>,
    /// Workers of this machine, where it is not.
    pub local_workers: u32,
    /// The merged pictures, from the root on.
    pub pictures: Vec<String>,
    /// The image of containers.
    pub image: String,
    /// The claim to the volume that holds the folder.
    pub claim: String,
    /// The scene in the folder as containers see it.
    pub scene: Option<String>,
}

/// A file for the folder of the job: its name and text.
pub type File = (&'static str, String);

impl Engine {
    /// The files of a job.
    pub fn files(self, job: &Planned) -> Vec<File> {
        match self {
            Self::Local => Vec::new(),
            Self::Dask => vec![("dask_job.py", dask(job))],
            Self::HyperQueue => vec![chunk(job), merge(job), ("hq_job.toml", hyperqueue(job))],
            Self::Slurm => slurm(job),
            Self::Kubernetes => vec![("kubernetes.yaml", kubernetes(job))],
            Self::Flamenco => flamenco(job),
            Self::OpenCue => vec![chunk(job), merge(job), ("opencue_job.py", opencue(job))],
        }
    }

    /// The command that submits the job: the tool that it takes, and its words.
    pub fn submission(self, folder: &str) -> Option<(&'static str, Vec<String>)> {
        let file = |name: &str| format!("{folder}/{name}");
        let words = |words: &[&str], name| words.iter().map(|w| (*w).to_owned()).chain([file(name)]).collect();
        match self {
            Self::Local | Self::Flamenco => None,
            Self::Dask => Some(("python3", words(&["python3"], "dask_job.py"))),
            Self::HyperQueue => Some(("hq", words(&["hq", "job", "submit-file"], "hq_job.toml"))),
            Self::Slurm => Some(("sbatch", words(&["sh"], "submit.sh"))),
            Self::Kubernetes => Some(("kubectl", words(&["kubectl", "apply", "-f"], "kubernetes.yaml"))),
            Self::OpenCue => Some(("python3", words(&["python3"], "opencue_job.py"))),
        }
    }

    /// The next step, for people.
    pub fn next(self, folder: &str) -> String {
        match self.submission(folder) {
            Some((_, words)) => command(words.iter().map(String::as_str)),
            None => {
                let job = shell(&format!("@{folder}/flamenco_job.json"));
                let post = format!("curl -H 'Content-Type: application/json' -d {job} http://MANAGER:8080/api/v3/jobs");
                format!(
                    "copy {} into the folder 'scripts' of Flamenco's manager, then {post}",
                    shell(&format!("{folder}/steradian.js"))
                )
            }
        }
    }
}

impl Planned {
    /// The words that merge the chunks.
    fn merging(&self) -> Vec<&str> {
        let outputs = self.pictures.iter().flat_map(|picture| ["-o", picture]);
        ["steradian", "merge", &self.folder].into_iter().chain(outputs).collect()
    }

    /// Ranges of chunks, as even as can be and at most so many: `K` or `A..B`.
    fn ranges(&self, most: u32) -> Vec<String> {
        let tasks = self.chunks.min(most);
        let bound = |task: u32| (u64::from(self.chunks) * u64::from(task) / u64::from(tasks)) as u32;
        let range = |task| match (bound(task), bound(task + 1) - 1) {
            (first, last) if first == last => first.to_string(),
            (first, last) => format!("{first}..{last}"),
        };
        (0..tasks).map(range).collect()
    }
}

/// A script that computes chunks, for engines that cannot tell exit codes apart.
fn chunk(job: &Planned) -> File {
    let values = [("JOB", &*shell(&job.folder)), ("TRIES", &TRIES.to_string())];
    ("chunk.sh", fill(include_str!("templates/chunk.sh"), &values))
}

/// A script that merges them.
fn merge(job: &Planned) -> File {
    ("merge.sh", fill(include_str!("templates/merge.sh"), &[("MERGE", &command(job.merging()))]))
}

fn dask(job: &Planned) -> String {
    let values = [
        ("JOB", &*double(&job.folder)),
        ("CHUNKS", &job.chunks.to_string()),
        ("WORKERS", &job.workers.unwrap_or(job.local_workers).to_string()),
        ("MERGE", &list(job.merging())),
        ("TRIES", &TRIES.to_string()),
    ];
    fill(include_str!("templates/dask_job.py"), &values)
}

/// A task for each range of chunks, and one that depends on all of them.
fn hyperqueue(job: &Planned) -> String {
    let script = |name: &str| format!("{}/{name}", job.folder);
    let task = |id: usize, words: &[&str], deps: &str| {
        let values = [
            ("ID", &*id.to_string()),
            ("COMMAND", &list(words.iter().copied())),
            ("TRIES", &TRIES.to_string()),
            ("DEPS", deps),
        ];
        fill(include_str!("templates/hyperqueue_task.toml"), &values)
    };
    let ranges = job.ranges(HYPERQUEUE_TASKS);
    let all: Vec<String> = (0..ranges.len()).map(|id| id.to_string()).collect();
    let mut text = String::from("name = \"steradian\"\n");
    for (id, range) in ranges.iter().enumerate() {
        text.push_str(&task(id, &["sh", &script("chunk.sh"), range], ""));
    }
    let deps = format!("deps = [{}]\n", all.join(", "));
    text.push_str(&task(ranges.len(), &["sh", &script("merge.sh")], &deps));
    text
}

fn slurm(job: &Planned) -> Vec<File> {
    let tasks = job.chunks.min(SLURM_TASKS);
    let values = [
        ("JOB", &*shell(&job.folder)),
        ("MERGE", &command(job.merging())),
        ("CHUNKS", &job.chunks.to_string()),
        ("TASKS", &tasks.to_string()),
        ("LAST", &(tasks - 1).to_string()),
        ("LIMIT", &job.workers.map_or(String::new(), |workers| format!("%{workers}"))),
        ("TRIES", &TRIES.to_string()),
    ];
    vec![
        ("chunks.sbatch", fill(include_str!("templates/chunks.sbatch"), &values)),
        ("merge.sbatch", fill(include_str!("templates/merge.sbatch"), &values)),
        ("submit.sh", fill(include_str!("templates/submit.sh"), &values)),
    ]
}

/// Containers see the folder as `/job`, whatever it is called elsewhere, and write the pictures into it.
fn kubernetes(job: &Planned) -> String {
    let scene: Vec<&str> = job.scene.iter().flat_map(|scene| ["--scene", scene]).collect();
    let pictures: Vec<String> = job.pictures.iter().map(|picture| in_container(picture)).collect();
    let outputs = pictures.iter().flat_map(|picture| ["-o", picture]);
    let merging = command(["steradian", "merge", "/job"].into_iter().chain(scene.iter().copied()).chain(outputs));
    let waiting =
        format!("while :; do code=0; {merging} || code=$?; [ \"$code\" = 75 ] || exit \"$code\"; sleep 10; done");
    let chunk = ["steradian", "chunk", "/job"].into_iter().chain(scene).map(container);
    let mut chunk: Vec<String> = chunk.collect();
    chunk.splice(3..3, ["$(JOB_COMPLETION_INDEX)".to_owned(), "--quiet".to_owned()]);
    let values = [
        ("NAME", &*name(&job.folder)),
        ("CHUNKS", &job.chunks.to_string()),
        ("WORKERS", &job.workers.unwrap_or(job.chunks).to_string()),
        ("TRIES", &TRIES.to_string()),
        ("IMAGE", &double(&job.image)),
        ("CLAIM", &double(&job.claim)),
        ("CHUNK", &list(chunk.iter().map(String::as_str))),
        ("MERGE", &list(["sh", "-c", &container(&waiting)])),
    ];
    fill(include_str!("templates/kubernetes.yaml"), &values)
}

/// A file of the folder as containers see it.
pub fn in_container(path: &str) -> String {
    format!("/job/{}", path.rsplit('/').next().unwrap_or(path))
}

fn flamenco(job: &Planned) -> Vec<File> {
    let platform = if cfg!(target_os = "macos") { "darwin" } else { std::env::consts::OS };
    let submitted = serde_json::json!({
        "name": name(&job.folder),
        "type": "steradian",
        "priority": 50,
        "submitter_platform": platform,
        "settings": { "job": job.folder, "chunks": job.chunks },
    });
    let script = include_str!("templates/steradian.js").to_owned();
    vec![chunk(job), merge(job), ("steradian.js", script), ("flamenco_job.json", format!("{submitted:#}\n"))]
}

fn opencue(job: &Planned) -> String {
    let values =
        [("JOB", &*double(&job.folder)), ("CHUNKS", &job.chunks.to_string()), ("NAME", &double(&name(&job.folder)))];
    fill(include_str!("templates/opencue_job.py"), &values)
}

/// A name of a job by its folder that all engines take: a label of DNS with room for more.
fn name(folder: &str) -> String {
    let stem = folder.rsplit('/').next().unwrap_or(folder).to_ascii_lowercase();
    let stem: String = stem.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).take(30).collect();
    format!("steradian-{}", stem.trim_matches('-')).trim_end_matches('-').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_a_partition() {
        let ranges = |chunks, most| {
            let job = Planned {
                folder: "/j".into(),
                chunks,
                workers: None,
                local_workers: 1,
                pictures: Vec::new(),
                image: String::new(),
                claim: String::new(),
                scene: None,
            };
            job.ranges(most)
        };
        assert_eq!(ranges(3, 10), ["0", "1", "2"]);
        assert_eq!(ranges(7, 3), ["0..1", "2..3", "4..6"]);
        assert_eq!(ranges(1 << 20, 1000).len(), 1000);
        assert!(ranges(1 << 20, 1000).last().unwrap().ends_with("..1048575"));
    }

    #[test]
    fn names_are_labels() {
        assert_eq!(name("/a/My Job.1"), "steradian-my-job-1");
        assert_eq!(name("/a/éß"), "steradian");
        assert!(name(&"x".repeat(99)).len() <= 41);
    }
}
