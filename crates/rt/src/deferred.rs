//! Deferred builds (Vulkan, `VK_KHR_deferred_host_operations`): an operation in which the threads of the caller take
//! part as they like. DXR builds on the device alone and has none.
//!
//! The work of an operation is the geometries of its structures, to be read each by itself, and the hierarchies, each
//! to be built when its geometries have been read.

use crate::bottom_level::{BottomLevel, BuildOptions, Content, MAX_GEOMETRIES};
use crate::error::{BuildError, DeferredError};
use crate::geometry::Geometries;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Result of a thread's part in an operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Join {
    /// The operation is complete (`VK_SUCCESS`).
    Done,
    /// There is no more work for this thread, but others are still at work (`VK_THREAD_DONE_KHR`).
    ThreadDone,
    /// There is no work now, but there will be: the thread may join again (`VK_THREAD_IDLE_KHR`).
    Idle,
}

/// Builds of bottom levels that go on while threads take part in them.
#[derive(Debug)]
pub struct DeferredBuild<'a> {
    builds: Vec<(Geometries<'a>, BuildOptions)>,
    state: Mutex<Vec<State>>,
}

/// Progress of a build.
#[derive(Debug)]
struct State {
    /// Numbers of geometries in all and of those taken by threads, and the contents read so far.
    geometries: usize,
    taken: usize,
    read: Vec<Option<Result<Content, BuildError>>>,
    missing: usize,
    /// Set once a thread has taken the hierarchy.
    is_taken: bool,
    built: Option<Result<Arc<BottomLevel>, BuildError>>,
}

/// A piece of work.
#[derive(Debug)]
enum Task {
    Read { build: usize, geometry: usize },
    Build { build: usize, read: Vec<Option<Result<Content, BuildError>>> },
}

/// Result of a piece of work.
enum Made {
    Geometry { build: usize, geometry: usize, read: Result<Content, BuildError> },
    Structure { build: usize, built: Result<BottomLevel, BuildError> },
}

impl State {
    /// Pieces of work that could be taken at once, now or later.
    fn concurrency(&self) -> usize {
        (self.geometries - self.taken).max(usize::from(!self.is_taken))
    }
}

impl<'a> DeferredBuild<'a> {
    /// An operation that builds structures, each as [`BottomLevel::build`] does (`vkCreateDeferredOperationKHR`, then
    /// `vkBuildAccelerationStructuresKHR`). Nothing is built until threads join.
    pub fn new(builds: Vec<(Geometries<'a>, BuildOptions)>) -> Self {
        let state = |(geometries, _): &(Geometries, BuildOptions)| {
            let count = match geometries {
                Geometries::Triangles(all) => all.len(),
                Geometries::Boxes(all) => all.len(),
            };
            // What has too many is not read at all.
            let geometries = if count as u64 <= MAX_GEOMETRIES { count } else { 0 };
            let read = (0..geometries).map(|_| None).collect();
            State { geometries, taken: 0, read, missing: geometries, is_taken: false, built: None }
        };
        let state = Mutex::new(builds.iter().map(state).collect());
        Self { builds, state }
    }

    /// Most threads that can still be of use; zero when all work has been taken
    /// (`vkGetDeferredOperationMaxConcurrencyKHR`).
    pub fn max_concurrency(&self) -> usize {
        self.state().iter().map(State::concurrency).sum()
    }

    /// Takes part in the operation until there is no work for this thread (`vkDeferredOperationJoinKHR`). The work of
    /// the thread is one thread's: the hierarchies are built in a pool of one.
    pub fn join(&self) -> Join {
        let mut pool = None;
        loop {
            let task = match self.take() {
                Ok(task) => task,
                Err(told) => return told,
            };
            let pool = pool.get_or_insert_with(|| rayon::ThreadPoolBuilder::new().num_threads(1).build().ok());
            let made = match pool {
                Some(pool) => pool.install(|| self.perform(task)),
                None => self.perform(task),
            };
            self.finish(made);
        }
    }

    /// The structures, in the order of the builds (`vkGetDeferredOperationResultKHR`).
    ///
    /// # Errors
    /// [`DeferredError::NotReady`] before the operation is complete; what is wrong with the first build that failed.
    pub fn result(&self) -> Result<Vec<Arc<BottomLevel>>, DeferredError> {
        let state = self.state();
        let unfinished = state.iter().filter(|of_build| of_build.built.is_none()).count();
        if unfinished > 0 {
            return Err(DeferredError::NotReady { unfinished });
        }
        let built = state.iter().filter_map(|of_build| of_build.built.clone()).enumerate();
        built.map(|(build, made)| made.map_err(|error| DeferredError::Build { build, error })).collect()
    }

    fn state(&self) -> MutexGuard<'_, Vec<State>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The next piece of work, or what a thread is told when there is none: hierarchies first, which are larger.
    fn take(&self) -> Result<Task, Join> {
        let mut all = self.state();
        if let Some((build, of_build)) = all.iter_mut().enumerate().find(|(_, b)| b.missing == 0 && !b.is_taken) {
            of_build.is_taken = true;
            return Ok(Task::Build { build, read: std::mem::take(&mut of_build.read) });
        }
        if let Some((build, of_build)) = all.iter_mut().enumerate().find(|(_, b)| b.taken < b.geometries) {
            of_build.taken += 1;
            return Ok(Task::Read { build, geometry: of_build.taken - 1 });
        }
        Err(match () {
            () if all.iter().all(|of_build| of_build.built.is_some()) => Join::Done,
            () if all.iter().all(|of_build| of_build.is_taken) => Join::ThreadDone,
            () => Join::Idle,
        })
    }

    fn perform(&self, task: Task) -> Made {
        match task {
            Task::Read { build, geometry } => {
                let read = Content::of_some(&self.builds[build].0, geometry..geometry + 1);
                Made::Geometry { build, geometry, read }
            }
            Task::Build { build, read } => {
                let (geometries, options) = &self.builds[build];
                let mut parts = read.into_iter().flatten();
                let built = match parts.next() {
                    None => BottomLevel::build(*geometries, *options),
                    Some(first) => {
                        let joined = first.and_then(|first| {
                            parts.try_fold(first, |mut all, part| {
                                all.append(part?);
                                Ok(all)
                            })
                        });
                        joined.and_then(|content| BottomLevel::from_content(content, *options))
                    }
                };
                Made::Structure { build, built }
            }
        }
    }

    fn finish(&self, made: Made) {
        let mut all = self.state();
        match made {
            Made::Geometry { build, geometry, read } => {
                all[build].read[geometry] = Some(read);
                all[build].missing -= 1;
            }
            Made::Structure { build, built } => all[build].built = Some(built.map(Arc::new)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::TriangleGeometry;
    use steradian_math::Vec3;

    #[test]
    fn threads_are_told_what_is_left() {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let geometries = [TriangleGeometry::new(&corners); 2];
        let operation = DeferredBuild::new(vec![(Geometries::Triangles(&geometries), BuildOptions::default())]);
        assert_eq!(operation.max_concurrency(), 2);
        // Two threads take the geometries: a third one has nothing to do yet.
        let tasks = [operation.take(), operation.take()].map(|task| task.expect("two geometries"));
        assert_eq!((operation.join(), operation.max_concurrency()), (Join::Idle, 1));
        tasks.into_iter().for_each(|task| operation.finish(operation.perform(task)));
        let hierarchy = operation.take().expect("the hierarchy");
        assert_eq!((operation.join(), operation.max_concurrency()), (Join::ThreadDone, 0));
        assert_eq!(operation.result().err(), Some(DeferredError::NotReady { unfinished: 1 }));
        operation.finish(operation.perform(hierarchy));
        assert_eq!(operation.join(), Join::Done);
        let built = operation.result().expect("complete");
        let plain = BottomLevel::build(Geometries::Triangles(&geometries), BuildOptions::default()).expect("valid");
        assert!(built.len() == 1 && built[0].same_bits(&plain));
    }
}
