//! Log of refused requests: only as many lines as people read, however many requests there are.

use std::{
    sync::{Arc, Mutex, PoisonError},
    time::{Duration, Instant},
};

/// Time after which lines are counted anew.
const WINDOW: Duration = Duration::from_secs(60);
/// Lines about refusals within that time.
const MOST_LINES: u64 = 60;
/// Characters of a line.
const LONGEST: usize = 240;

/// Log with a limit on lines about refusals.
pub struct Log {
    tell: Arc<dyn Fn(&str) + Send + Sync>,
    count: Mutex<Count>,
}

/// Lines about refusals since a moment.
#[derive(Default)]
struct Count {
    since: Option<Instant>,
    lines: u64,
}

impl Log {
    /// To whoever listens.
    pub fn new(tell: Arc<dyn Fn(&str) + Send + Sync>) -> Self {
        Self { tell, count: Mutex::default() }
    }

    /// Tells what was done.
    pub fn done(&self, line: &str) {
        (self.tell)(line);
    }

    /// Tells what was refused. Of many lines within a minute the first ones are told, and then how many there were.
    pub fn refused(&self, line: &str) {
        self.refused_at(line, Instant::now());
    }

    fn refused_at(&self, line: &str, now: Instant) {
        let mut count = self.count.lock().unwrap_or_else(PoisonError::into_inner);
        if count.since.is_none_or(|since| now.saturating_duration_since(since) >= WINDOW) {
            let left_out = count.lines.saturating_sub(MOST_LINES);
            *count = Count { since: Some(now), lines: 0 };
            if left_out > 0 {
                (self.tell)(&format!("{left_out} further refusals were left out"));
            }
        }
        count.lines += 1;
        if count.lines <= MOST_LINES {
            (self.tell)(&line.chars().take(LONGEST).collect::<String>());
        }
        if count.lines == MOST_LINES {
            (self.tell)("further refusals within this minute are only counted");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_many_refusals_the_first_are_told_and_then_their_number() {
        let told: Arc<Mutex<Vec<String>>> = Arc::default();
        let lines = Arc::clone(&told);
        let log = Log::new(Arc::new(move |line: &str| lines.lock().unwrap().push(line.into())));
        let start = Instant::now();
        for k in 0..1000 {
            log.refused_at(&format!("refused {k}"), start + WINDOW / 2000 * k);
        }
        let most = MOST_LINES as usize;
        assert_eq!(told.lock().unwrap().len(), most + 1);
        assert_eq!(told.lock().unwrap()[most], "further refusals within this minute are only counted");
        log.refused_at(&"x".repeat(10_000), start + WINDOW);
        let last = told.lock().unwrap().split_off(most + 1);
        assert_eq!(last, ["940 further refusals were left out".to_owned(), "x".repeat(LONGEST)]);
        // What was done is told whatever was refused.
        log.done("saved");
        assert_eq!(told.lock().unwrap().last().unwrap(), "saved");
    }
}
