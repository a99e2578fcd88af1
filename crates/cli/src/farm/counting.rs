//! Progress over the chunks of a job.

use crate::{
    progress::{Progress, clock},
    terminal::{Event, Terminal},
};
use std::time::{Duration, Instant};

/// Time before the first line where there is no terminal.
const FIRST_LINE: Duration = Duration::from_secs(10);

/// Counts chunks.
#[derive(Debug)]
pub struct Counting {
    progress: Progress,
    start: Instant,
    all: u32,
    before: u32,
}

impl Counting {
    /// Begins with those that are there.
    pub fn new(all: u32, before: u32, terminal: Terminal) -> Self {
        Self { progress: Progress::new(terminal), start: Instant::now(), all, before }
    }

    /// Shows how many are there.
    pub fn show(&mut self, done: u32) {
        let elapsed = self.start.elapsed();
        let left = left(done, self.all, done - self.before, elapsed);
        let event = Event::Progress {
            done: done.into(),
            of: self.all.into(),
            unit: "chunks",
            fraction: f64::from(done) / f64::from(self.all),
            seconds: elapsed.as_secs_f64(),
            left: left.map(|left| left.as_secs_f64()),
        };
        self.progress.tell(&event, elapsed >= FIRST_LINE, || line(done, self.all, left, elapsed));
    }

    /// Takes the bar away.
    pub fn finish(self) {
        self.progress.finish();
    }
}

/// Time that is left at the pace of those that came since.
fn left(done: u32, all: u32, came: u32, elapsed: Duration) -> Option<Duration> {
    (came > 0).then(|| elapsed.mul_f64(f64::from(all - done) / f64::from(came)))
}

/// `3/8 chunks · 0:25 left · 0:15`.
fn line(done: u32, all: u32, left: Option<Duration>, elapsed: Duration) -> String {
    format!("{done}/{all} chunks · {} left · {}", left.map_or("–".into(), clock), clock(elapsed))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_is_left_at_the_pace_so_far() {
        assert_eq!(
            line(5, 8, left(5, 8, 3, Duration::from_secs(15)), Duration::from_secs(15)),
            "5/8 chunks · 0:15 left · 0:15"
        );
        assert_eq!(
            line(5, 8, left(5, 8, 0, Duration::from_secs(1)), Duration::from_secs(1)),
            "5/8 chunks · – left · 0:01"
        );
    }
}
