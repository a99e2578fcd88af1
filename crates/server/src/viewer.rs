//! The thread that renders what pages look at: it takes requests, makes a picture at once, then a better one, and shows
//! it as it grows.
//!
//! The thread owns the description, its compiled scene, and the session. A request comes with a place for its answer
//! and breaks off the step under way; all requests that wait are carried out before anything is rendered. The answer
//! follows the state that knows of the request; until then the page keeps the changes in its fields (`fields` in
//! `web/src/connection.ts`). Then come a preview as coarse as its time allows, first paths of a coarse picture, and the
//! session, in steps of 0.1 to 1 s.
//!
//! Each picture is encoded once (`tile`: half floats) and handed to all sockets by a `watch` channel, so that a slow
//! page misses frames and holds up none. The preview stands until the render, without its noise, is better (`preview`).
//! Edits (`edits`) are parameters of nodes and places, set by texts in Steradian's own language, or an environment map;
//! they are undone, made again after files have changed, and compiled with what the last compilation kept. Light groups
//! are further planes of a frame, weighed by the page (`groups`). The path of one sample (`path`) is traced beside the
//! render by the path tracer itself, with a `Sink` that keeps its steps. Readers hold files of uploads and edits to a
//! folder (`Options::within`).

mod defining;
mod files;
mod handle;
mod opening;
mod pictures;

pub use handle::{Handle, Subject, Task};
pub use opening::{compile, start};

use crate::{
    denoiser::Denoisers,
    document::{Document, Stamps},
    frame::{Frame, Shown},
    job::{Job, Progress, Waiting},
    look::{Look, quality},
    preview::Preview,
    protocol::{Message, ServerMessage, Severity},
    state,
};
use handle::Done;
use std::{
    sync::{
        Arc, Mutex,
        mpsc::{Receiver, RecvTimeoutError},
    },
    time::{Duration, Instant},
};
use steradian::Scene;
use tokio::sync::{broadcast, oneshot, watch};

/// Interval between looks for changed files.
const WATCH_EVERY: Duration = Duration::from_millis(400);

/// Part of the view that a change invalidates; each includes those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Invalidates {
    /// Nowhere.
    Nothing,
    /// State that pages are told.
    State,
    /// Part of the picture that is sent.
    Layers,
    /// The picture.
    Picture,
    /// The scene.
    Scene,
}

/// The thread.
pub struct Viewer {
    /// The scene as it is described.
    pub document: Document,
    /// View of the scene.
    pub look: Look,
    /// As it is rendered.
    pub scene: Arc<Scene>,
    /// Bytes that its pictures take.
    pub held: u64,
    /// Scene of the preview, where an edit was checked with it.
    pub drawn: Option<Arc<Scene>>,
    generation: u32,
    /// Speed of previews.
    pixels_per_second: f64,
    /// Speed of first paths.
    paths_per_second: f64,
    /// Picture that is shown until the render is better.
    preview: Option<Preview>,
    /// True once the preview is as fine as it gets.
    is_fine: bool,
    /// Stamps of the files that the scene was read from, and the stamps seen last.
    stamps: Stamps,
    seen: Stamps,
    /// When they were looked at.
    watched: Instant,
    /// Denoisers that can be had.
    pub denoisers: Denoisers,
    /// Time of the last denoising on the way, and of the last by the chosen denoiser, seconds per pixel.
    denoising: f64,
    chosen_denoising: f64,
    /// The render under way.
    pub job: Option<Job>,
    /// Progress of the render when it was shown last.
    published: Option<Progress>,
    tasks: Receiver<Task>,
    /// Answers to pages, sent once the state is told.
    answers: Vec<(oneshot::Sender<Done>, Done)>,
    waiting: Waiting,
    /// Number of times that the preview of this state was broken off for tasks.
    broken_off: u32,
    /// True if the picture of this state has not begun.
    owed: bool,
    frame: watch::Sender<Arc<Frame>>,
    state: watch::Sender<Arc<str>>,
    messages: broadcast::Sender<String>,
    shown: Arc<Mutex<Option<Arc<Shown>>>>,
    subject: watch::Sender<Arc<Subject>>,
}

impl Viewer {
    fn run(&mut self) {
        let mut invalid = if self.generation == 0 { Invalidates::Scene } else { Invalidates::Nothing };
        loop {
            if invalid > Invalidates::Nothing {
                self.tell_state(invalid);
            }
            for (answer, done) in self.answers.drain(..) {
                // Its page may be gone.
                let _ = answer.send(done);
            }
            if invalid > Invalidates::Nothing {
                self.show_change(invalid);
            }
            let is_idle = !self.owed && (self.look.paused || self.job.as_ref().is_none_or(Job::is_done));
            let first = match is_idle {
                true => match self.tasks.recv_timeout(WATCH_EVERY) {
                    Ok(task) => Some(task),
                    Err(RecvTimeoutError::Timeout) => None,
                    Err(RecvTimeoutError::Disconnected) => return,
                },
                false => self.tasks.try_recv().ok(),
            };
            invalid = Invalidates::Nothing;
            let mut next = first;
            while let Some(task) = next {
                self.waiting.remove();
                invalid = invalid.max(self.take(task));
                next = self.tasks.try_recv().ok();
            }
            if self.files_changed() {
                invalid = invalid.max(self.reload());
            }
            if invalid == Invalidates::Nothing && self.owed {
                self.show_picture();
            } else if invalid == Invalidates::Nothing && !self.look.paused {
                self.advance();
            }
        }
    }

    /// Carries a task out; how far what it changed reaches.
    fn take(&mut self, task: Task) -> Invalidates {
        match task {
            Task::Page(request, answer) => {
                let done = self.request(request);
                let invalid = *done.as_ref().unwrap_or(&Invalidates::Nothing);
                self.answers.push((answer, done.map(|_| ())));
                invalid
            }
            Task::Open(source, answer) => {
                let opened = self.open(*source);
                let invalid = if opened.is_ok() { Invalidates::Scene } else { Invalidates::Nothing };
                let _ = answer.send(opened);
                invalid
            }
            Task::Environment(name, picture, answer) => {
                let done = self.set_environment(name, picture);
                let invalid = if done.is_ok() { Invalidates::Scene } else { Invalidates::Nothing };
                let _ = answer.send(done);
                invalid
            }
            Task::Ask(ask) => {
                ask(&self.document, &self.look);
                Invalidates::Nothing
            }
        }
    }

    /// Tells pages what has changed.
    fn tell_state(&mut self, invalid: Invalidates) {
        if invalid >= Invalidates::Picture {
            self.generation += 1;
            (self.job, self.published, self.preview, self.is_fine) = (None, None, None, false);
            (self.broken_off, self.owed) = (0, true);
            let (generation, scene) = (self.generation, Arc::clone(&self.scene));
            let (quality, names) = (quality(&self.look), self.document.names());
            self.subject.send_replace(Arc::new(Subject { generation, scene, quality, names }));
        }
        let state = state::of(self.generation, &self.document, &self.look, &self.scene, &self.denoisers.library);
        self.state.send_replace(state);
    }

    /// Shows what has changed: a preview, and the beginning of a render.
    fn show_change(&mut self, invalid: Invalidates) {
        if invalid < Invalidates::Picture {
            // Other layers are sent of the same picture.
            if self.has_news() {
                self.publish();
            }
            if invalid == Invalidates::Layers {
                self.show_again();
            }
            return;
        }
        self.show_picture();
    }

    fn say(&self, severity: Severity, text: String) {
        // Nobody may be there.
        let _ = self.messages.send(ServerMessage::Message(Message { severity, text }).text());
    }
}

#[cfg(test)]
mod tests;
