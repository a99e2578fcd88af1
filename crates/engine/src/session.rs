//! The boundary between those who render and methods that compute pictures.

use crate::{Control, Counters, Doubt, Indivisible, SCALES};
use std::{
    any::Any,
    fmt::Debug,
    io::{self, Read, Write},
    ops::Range,
    sync::Arc,
    time::Duration,
};
use steradian_core::{Scene, film::Film};

/// State that a picture of a sequence leaves to the next one. Only the method that made it knows what it is.
#[derive(Clone, Debug)]
pub struct History(pub Arc<dyn Any + Send + Sync>);

/// State that pictures with layers of motion leave.
#[derive(Debug)]
pub(crate) struct Earlier {
    /// Scene of that picture.
    pub scene: Arc<Scene>,
    /// State of the method itself.
    pub own: Option<History>,
}

impl Earlier {
    /// Earlier picture in a history, if the next picture has as many pixels.
    pub fn of(history: &History, scene: &Scene) -> Option<Arc<Self>> {
        let earlier: Arc<Self> = Arc::clone(&history.0).downcast().ok()?;
        let size = |scene: &Scene| [scene.film().width, scene.film().height];
        (size(&earlier.scene) == size(scene)).then_some(earlier)
    }
}

/// A way to compute a picture, under way: it advances in steps, tells of its progress, stops when asked, and can be
/// saved and gone on with. What it computes does not depend on the number of threads, nor on the steps.
pub trait Session: Debug + Send {
    /// Takes further samples of every pixel, up to the plan's number or error; fewer where `control` cancels. What a
    /// cancelled step did not reach is caught up by the next one.
    fn step(&mut self, samples: u32, control: &Control);

    /// Does without trials that a cancelled step did not finish, so that the next one takes samples at once; they may
    /// be noisier. `false`, and nothing is changed, where there are none that can be left out.
    fn skip_trials(&mut self) -> bool {
        false
    }

    /// Goes on to more samples per pixel than the plan has; those that are there stay, and the further ones are
    /// independent of them. `false`, and nothing is changed, where there are to be more already.
    fn extend(&mut self, _samples: u32) -> bool {
        false
    }

    /// Threads that a step uses.
    fn threads(&self) -> usize;

    /// Samples that a pixel has, in the mean, when the steps so far are complete.
    fn samples(&self) -> u32;

    /// True if the plan is carried out: all samples are taken, or the error is small enough.
    fn is_done(&self) -> bool;

    /// True if the plan's error was reached.
    fn is_good_enough(&self) -> bool;

    /// True if parts of the picture get more samples than others, as the plan's `adaptive` allows.
    fn is_uneven(&self) -> bool {
        false
    }

    /// True if photons guide paths towards caustics.
    fn asks_photons(&self) -> bool {
        false
    }

    /// Number of paths of neighbouring pixels that share what they find.
    fn sharing(&self) -> u32 {
        1
    }

    /// The estimated relative error of the picture: the square root of the mean, over pixels and channels, of the
    /// variance of the pixel over `I² + 0.01`, which is the root of what the metric relMSE expects. Variances are those
    /// of independent samples: with a sampler that spreads them well the true error is smaller. `None` before all
    /// pixels have two samples.
    fn error(&self) -> Option<f64>;

    /// Reason not to trust [`Self::error`], if there is one: light arrives by paths that are hardly ever found.
    fn doubt(&self) -> Option<Doubt> {
        None
    }

    /// The estimated relative errors of means over squares of pixels, of the edges [`SCALES`]; `None` where they are
    /// not watched.
    fn errors_of_means(&self) -> Option<[f64; SCALES.len()]> {
        None
    }

    /// Counters of the work so far.
    fn counters(&self) -> Counters;

    /// Wall and CPU time spent in steps.
    fn time(&self) -> [Duration; 2];

    /// Wall time spent in steps.
    fn wall(&self) -> Duration {
        self.time()[0]
    }

    /// CPU time of all threads spent in steps.
    fn cpu(&self) -> Duration {
        self.time()[1]
    }

    /// Hands over what the next picture of a sequence can go on from, where the method does that; after the last step.
    fn take_history(&mut self) -> Option<History> {
        None
    }

    /// Goes on from the picture before, if the method does that; before the first step.
    fn follow(&mut self, _history: &History) {}

    /// Notes on the picture so far.
    fn notes(&self) -> Vec<String> {
        Vec::new()
    }

    /// Reason why the session cannot go on, if so; it is done then.
    fn failure(&self) -> Option<String> {
        None
    }

    /// The film as it is.
    fn film(&self) -> Film;

    /// Writes what it takes to go on later. Not while a step is under way, which `&mut` sees to.
    ///
    /// # Errors
    /// Those of the writer.
    fn save(&mut self, out: &mut dyn Write) -> io::Result<()>;

    /// Goes on from what another session of the same scene and plan [saved](Self::save); the picture then has the bits
    /// of one that was never left. How many threads there are may differ.
    ///
    /// # Errors
    /// Those of the reader, and [`io::ErrorKind::InvalidData`] where no such session can have been; the session is of
    /// no use then.
    fn restore(&mut self, from: &mut dyn Read) -> io::Result<()>;

    /// Number of pieces that the work of the plan falls into: each is a function of scene and plan alone, and pieces
    /// that several sessions computed are [joined](Self::join) to the very bits of one run.
    ///
    /// # Errors
    /// Why the work is one.
    fn pieces(&self) -> Result<u32, Indivisible> {
        Err(Indivisible::OneState)
    }

    /// Begins anew with these pieces only: steps, the end, samples, counters and saved states are those of the pieces,
    /// and so is the film, which is empty elsewhere. Such a session is not [extended](Self::extend). What trials found
    /// is kept, so that a session can compute some pieces after others.
    ///
    /// # Errors
    /// Why the work is one, or that there are no such pieces; nothing is changed then.
    fn restrict(&mut self, _pieces: Range<u32>) -> Result<(), Indivisible> {
        Err(self.pieces().err().unwrap_or(Indivisible::OneState))
    }

    /// Takes over finished pieces that another session of the same scene and plan, [restricted](Self::restrict) to
    /// them, has [saved](Self::save), in any order. From the first of them on the session takes no samples; when all
    /// are there it is done, its film and counters are those of one run, and its time is that of all parts together.
    ///
    /// # Errors
    /// Those of the reader, [`io::ErrorKind::AlreadyExists`] for pieces that are there already, and
    /// [`io::ErrorKind::InvalidData`] where no such session can have been; the session is of no use then.
    fn join(&mut self, _from: &mut dyn Read, _pieces: Range<u32>) -> io::Result<()> {
        Err(io::Error::new(io::ErrorKind::InvalidData, Indivisible::OneState))
    }
}
