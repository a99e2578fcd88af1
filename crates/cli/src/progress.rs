//! Progress of a render: a bar on a terminal; elsewhere a line when each pixel has a sample, and then every ten
//! seconds.

use crate::terminal::{Event, Terminal};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::{
    io::IsTerminal,
    time::{Duration, Instant},
};

/// Interval between lines where there is no terminal.
const LINE_EVERY: Duration = Duration::from_secs(10);
/// Interval between events for programs.
const EVENT_EVERY: Duration = Duration::from_secs(1);
/// When the first line is written, if each pixel has a sample by then.
const FIRST_LINE: Duration = Duration::from_secs(1);
/// Steps of the bar.
const STEPS: u64 = 10_000;

/// State of a render on its way.
#[derive(Clone, Copy, Debug)]
pub struct Snapshot {
    /// True during trials, before the first sample.
    pub is_trying: bool,
    /// Samples that were there when it began.
    pub before: u64,
    /// Samples taken since.
    pub samples: u64,
    /// Rays traced.
    pub rays: u64,
    /// Samples of the whole render.
    pub planned: u64,
    /// Pixels.
    pub pixels: u64,
    /// Time since it started.
    pub elapsed: Duration,
    /// Time it may take.
    pub budget: Option<Duration>,
}

impl Snapshot {
    /// The part that is done, by samples or by time, whichever ends it.
    pub fn fraction(&self) -> f64 {
        let by_samples = (self.before + self.samples) as f64 / self.planned.max(1) as f64;
        let by_time = self.budget.map_or(0.0, |b| self.elapsed.as_secs_f64() / b.as_secs_f64().max(1e-9));
        by_samples.max(by_time).clamp(0.0, 1.0)
    }

    /// Time until it is done, at the pace so far.
    pub fn left(&self) -> Option<Duration> {
        let to_come = self.planned.saturating_sub(self.before + self.samples) as f64 / self.samples as f64;
        let by_samples = Duration::try_from_secs_f64(self.elapsed.as_secs_f64() * to_come).ok();
        let by_time = self.budget.map(|b| b.saturating_sub(self.elapsed));
        by_samples.into_iter().chain(by_time).min()
    }

    /// The state for programs.
    fn event(&self) -> Event<'static> {
        Event::Progress {
            done: self.before + self.samples,
            of: self.planned,
            unit: "samples",
            fraction: self.fraction(),
            seconds: self.elapsed.as_secs_f64(),
            left: self.left().map(|left| left.as_secs_f64()),
        }
    }

    /// `42 % · 108/256 spp · 3.10 Msamples/s · 12.10 Mray/s · 0:16 left · 0:12`: what matters least is where a narrow
    /// terminal cuts.
    pub fn line(&self) -> String {
        if self.is_trying {
            return format!("trying which paths pay · {}", clock(self.elapsed));
        }
        let seconds = self.elapsed.as_secs_f64().max(1e-9);
        let spp = (self.before + self.samples) / self.pixels.max(1);
        let planned = self.planned / self.pixels.max(1);
        // The number of samples is no goal where time alone ends the render.
        let of = if planned < u64::from(crate::values::MAX_SPP) { format!("/{planned}") } else { String::new() };
        let left = self.left().map_or("–".into(), clock);
        format!(
            "{:3.0} % · {spp}{of} spp · {} · {:.2} Mray/s · {left} left · {}",
            (100.0 * self.fraction()).floor(),
            rate(self.samples as f64 / seconds),
            self.rays as f64 / seconds * 1e-6,
            clock(self.elapsed),
        )
    }
}

/// Samples per second for people.
pub fn rate(per_second: f64) -> String {
    match per_second {
        r if r >= 1e5 => format!("{:.2} Msamples/s", r * 1e-6),
        r if r >= 1e2 => format!("{:.2} ksamples/s", r * 1e-3),
        r => format!("{r:.1} samples/s"),
    }
}

/// `1:02:03` or `2:03`.
pub fn clock(time: Duration) -> String {
    let s = time.as_secs();
    match s / 3600 {
        0 => format!("{}:{:02}", s / 60, s % 60),
        h => format!("{h}:{:02}:{:02}", s / 60 % 60, s % 60),
    }
}

/// Shows snapshots.
#[derive(Debug)]
pub enum Progress {
    /// On a terminal.
    Bar(ProgressBar),
    /// Elsewhere: with the moment of the last line.
    Lines(Terminal, Option<Instant>),
    /// As events for programs: with the moment of the last one.
    Events(Terminal, Option<Instant>),
    /// Not at all.
    Silent,
}

impl Progress {
    /// As fits stderr.
    pub fn new(terminal: Terminal) -> Self {
        if terminal.quiet {
            return Self::Silent;
        }
        if terminal.tells_events() {
            return Self::Events(terminal, None);
        }
        if !std::io::stderr().is_terminal() {
            return Self::Lines(terminal, None);
        }
        let bar = ProgressBar::with_draw_target(Some(STEPS), ProgressDrawTarget::stderr_with_hz(10));
        if let Ok(style) = ProgressStyle::with_template("{bar:8} {wide_msg}") {
            bar.set_style(style.progress_chars("━━╌"));
        }
        Self::Bar(bar)
    }

    /// Shows how far a render is.
    pub fn show(&mut self, snapshot: &Snapshot) {
        let first = if snapshot.samples < snapshot.pixels { LINE_EVERY } else { FIRST_LINE };
        self.tell(&snapshot.event(), snapshot.elapsed >= first, || snapshot.line());
    }

    /// Shows an [`Event::Progress`], for people as a line; where there is no terminal, not before it is told to begin.
    pub fn tell(&mut self, event: &Event<'_>, begins: bool, line: impl FnOnce() -> String) {
        match self {
            Self::Bar(bar) => {
                let Event::Progress { fraction, .. } = event else { return };
                bar.set_position((fraction * STEPS as f64) as u64);
                bar.set_message(line());
            }
            Self::Lines(terminal, last) => {
                if last.map_or(begins, |last| last.elapsed() >= LINE_EVERY) {
                    *last = Some(Instant::now());
                    terminal.say(line().trim_start());
                }
            }
            Self::Events(terminal, last) => {
                if last.is_none_or(|last| last.elapsed() >= EVENT_EVERY) {
                    *last = Some(Instant::now());
                    terminal.event(event);
                }
            }
            Self::Silent => {}
        }
    }

    /// Takes the bar away.
    pub fn finish(self) {
        if let Self::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn half() -> Snapshot {
        Snapshot {
            is_trying: false,
            before: 0,
            samples: 500_000,
            rays: 2_000_000,
            planned: 1_000_000,
            pixels: 10_000,
            elapsed: Duration::from_secs(2),
            budget: None,
        }
    }

    #[test]
    fn line_of_a_render_half_done() {
        assert_eq!(half().line(), " 50 % · 50/100 spp · 0.25 Msamples/s · 1.00 Mray/s · 0:02 left · 0:02");
    }

    #[test]
    fn whichever_ends_first_counts() {
        let timed = Snapshot { budget: Some(Duration::from_millis(2500)), ..half() };
        assert_eq!(timed.fraction(), 0.8);
        assert_eq!(timed.left(), Some(Duration::from_millis(500)));
        let none = Snapshot { samples: 0, ..half() };
        assert_eq!((none.fraction(), none.left()), (0.0, None));
    }

    #[test]
    fn clocks_and_rates() {
        assert_eq!(clock(Duration::from_secs(3723)), "1:02:03");
        assert_eq!(clock(Duration::from_secs(59)), "0:59");
        assert_eq!(rate(12.0), "12.0 samples/s");
        assert_eq!(rate(1234.0), "1.23 ksamples/s");
        assert_eq!(rate(2.5e6), "2.50 Msamples/s");
    }
}
