//! Tasks of the thread that renders, and its handle for others.

use crate::{
    document::{Document, Source},
    frame::{Frame, Shown},
    job::Waiting,
    look::Look,
    names::Names,
    protocol::Request,
};
use std::sync::{Arc, Mutex, PoisonError, mpsc::Sender};
use steradian::{Quality, Scene};
use tokio::sync::{broadcast, oneshot, watch};

/// A question about the scene as it is.
pub(super) type Question = Box<dyn FnOnce(&Document, &Look) + Send>;

/// Result of a request; an error says what is wrong with it.
pub(super) type Done = Result<(), String>;

/// Task of the thread.
pub enum Task {
    /// By a page, with an answer for it: what is wrong. Pages are told the state with the change first.
    Page(Request, oneshot::Sender<Done>),
    /// Another scene.
    Open(Box<Source>, oneshot::Sender<Result<(), Vec<String>>>),
    /// An environment map, by its name and bytes.
    Environment(String, Arc<[u8]>, oneshot::Sender<Done>),
    /// Something about the scene as it is.
    Ask(Question),
}

/// Subject of the render; the picture that is shown may still be a coarser one of it.
pub struct Subject {
    /// Generation of the view's state.
    pub generation: u32,
    /// The scene.
    pub scene: Arc<Scene>,
    /// Quality of the render.
    pub quality: Quality,
    /// Names of its nodes.
    pub names: Arc<Names>,
}

/// Handle of the thread for others.
#[derive(Clone)]
pub struct Handle {
    pub(super) tasks: Sender<Task>,
    pub(super) waiting: Waiting,
    /// The last frame.
    pub frames: watch::Receiver<Arc<Frame>>,
    /// State for pages, as JSON.
    pub states: watch::Receiver<Arc<str>>,
    /// Messages to all pages, as JSON.
    pub messages: broadcast::Sender<String>,
    pub(super) shown: Arc<Mutex<Option<Arc<Shown>>>>,
    pub(super) subjects: watch::Receiver<Arc<Subject>>,
}

impl Handle {
    /// Asks for something. What is being rendered is broken off for it.
    pub fn send(&self, task: Task) {
        self.waiting.add();
        let _ = self.tasks.send(task);
    }

    /// Subject of the render.
    pub fn subject(&self) -> Arc<Subject> {
        self.subjects.borrow().clone()
    }

    /// The picture that is shown; `None` before there is one.
    pub fn shown(&self) -> Option<Arc<Shown>> {
        self.shown.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}
