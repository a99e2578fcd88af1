//! The cost of scattering: nanoseconds for one sample, one evaluation and one density of each registered model, and of
//! all shuffled.
//!
//! `cargo bench -p steradian-bsdf --bench bsdf [-- NAME [CASE]]`, with parts of the names; the cases are listed where a
//! name is given. Each figure is the median over repetitions, that in brackets the least, which a busy machine disturbs
//! less. Values are drawn from all cases of the registry; in the shuffled run, of the first case of each, neighbours
//! are of different models, as in a scene.
#![expect(clippy::print_stdout, reason = "a benchmark's output")]

use std::{hint::black_box, time::Instant};
use steradian_bsdf::{Bsdf, Model, TransportMode, models};
use steradian_math::{
    Vec2, Vec3,
    hash::{HashRng, mix64},
    warp,
};

/// Scattering events per repetition, and repetitions: short ones and many, so that most of them are not interrupted.
const EVENTS: usize = 1 << 11;
const REPETITIONS: usize = 301;

/// Random numbers and a direction for one event.
struct Event {
    wo: Vec3,
    wi: Vec3,
    u: f32,
    u2: Vec2,
}

fn events() -> Vec<Event> {
    let mut rng = HashRng::new(1);
    let mut event = || {
        let mut w = || warp::cosine_hemisphere(Vec2::new(rng.next_f32(), rng.next_f32()));
        let (wo, wi) = (w(), w());
        Event { wo, wi, u: rng.next_f32(), u2: Vec2::new(rng.next_f32(), rng.next_f32()) }
    };
    (0..EVENTS).map(|_| event()).collect()
}

/// One sample and one evaluation, which gives the density too.
fn scatter(b: &Bsdf<'_>, e: &Event) {
    let e = black_box(e);
    black_box(&b.sample(e.wo, e.u, e.u2, TransportMode::Radiance));
    black_box(&b.eval(e.wo, e.wi, TransportMode::Radiance));
}

/// Median and least of some times.
fn middle_and_least(mut times: Vec<f64>) -> [f64; 2] {
    times.sort_by(f64::total_cmp);
    [times[times.len() / 2], times[0]]
}

/// Median and least nanoseconds per event over values taken in turn.
fn measure(values: &[Bsdf<'_>], events: &[Event]) -> [f64; 2] {
    let once = |_| {
        let start = Instant::now();
        for (b, e) in values.iter().cycle().zip(events) {
            scatter(b, e);
        }
        start.elapsed().as_nanos() as f64 / events.len() as f64
    };
    middle_and_least((0..REPETITIONS).map(once).collect())
}

/// The mean of the middle half of some times, which is finer than the steps of a clock.
fn mean_of_middle(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    let middle = &times[times.len() / 4..times.len() - times.len() / 4];
    middle.iter().sum::<f64>() / middle.len() as f64
}

/// Nanoseconds of one event of each value where all take turns and each event is timed by itself, less those of timing
/// nothing. What a processor does of one event during the next is left out, so that these times are longer than those
/// of many events alike.
fn measure_each(values: &[Bsdf<'_>], events: &[Event]) -> Vec<f64> {
    let time = |work: &dyn Fn()| {
        let start = Instant::now();
        work();
        start.elapsed().as_nanos() as f64
    };
    let (mut nothing, mut times) = (Vec::new(), vec![Vec::new(); values.len()]);
    for _ in 0..REPETITIONS / 10 {
        for (i, e) in events.iter().enumerate() {
            let b = &values[i % values.len()];
            nothing.push(time(&|| _ = black_box(e)));
            times[i % values.len()].push(time(&|| scatter(b, e)));
        }
    }
    let nothing = mean_of_middle(nothing);
    times.into_iter().map(|t| mean_of_middle(t) - nothing).collect()
}

/// All cases of all models, shuffled, are handed to `done`. Values borrow from their visitors, so visits are nested:
/// those of the next model inside the last case of this one.
fn shuffled(models: &[&Model], values: &[Bsdf<'_>], done: &mut dyn FnMut(&[Bsdf<'_>])) {
    let Some((model, rest)) = models.split_first() else {
        // A fixed shuffle.
        let mut order: Vec<usize> = (0..values.len()).collect();
        order.sort_by_key(|i| mix64(*i as u64 + 1));
        return done(&order.iter().map(|i| values[*i]).collect::<Vec<_>>());
    };
    let mut visited = false;
    (model.cases)(&mut |case| {
        if !std::mem::replace(&mut visited, true) {
            let with: Vec<Bsdf<'_>> = values.iter().copied().chain([case.bsdf]).collect();
            shuffled(rest, &with, done);
        }
    });
}

fn main() {
    let mut arguments = std::env::args().skip(1).filter(|a| !a.starts_with('-'));
    let (wanted, wanted_case) = (arguments.next().unwrap_or_default(), arguments.next().unwrap_or_default());
    let events = events();
    let (mut medians, mut leasts) = (Vec::new(), Vec::new());
    for model in models().filter(|m| m.name.contains(&wanted)) {
        let mut times = Vec::new();
        (model.cases)(&mut |case| {
            if !case.label.contains(&wanted_case) {
                return;
            }
            let time = measure(&[case.bsdf], &events);
            if !wanted.is_empty() {
                println!("    {:40} {:7.1} ns ({:6.1})", case.label, time[0], time[1]);
            }
            times.push((time, case.label));
        });
        times.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]));
        if times.is_empty() {
            continue;
        }
        let ([median, least], slowest) = (times[times.len() / 2].0, &times[times.len() - 1]);
        println!("{:24} {median:7.1} ns ({least:6.1})   slowest {:.1} ns: {}", model.name, slowest.0[0], slowest.1);
        medians.push(median);
        leasts.push(least);
    }
    for list in [&mut medians, &mut leasts] {
        list.sort_by(f64::total_cmp);
    }
    let Some(median) = medians.get(medians.len() / 2) else { return };
    println!("{:24} {median:7.1} ns ({:6.1})", "median over models", leasts[leasts.len() / 2]);
    if wanted.is_empty() {
        shuffled(&models().collect::<Vec<_>>(), &[], &mut |values| {
            let [median, least] = measure(values, &events);
            println!("{:24} {median:7.1} ns ({least:6.1})", "one of each, shuffled");
            let [median, least] = middle_and_least(measure_each(values, &events));
            println!("{:24} {median:7.1} ns ({least:6.1})", "median over the shuffled");
        });
    }
}
