//! Single rays and many rays on one thread, against Embree 4 on the very same rays where its library is named: both
//! trace in this process, in turns.

mod building;
mod case;
mod embree;
mod judge;
mod scene;
mod trace;

pub use building::builders;
pub use case::read_mesh;
pub use scene::displaced_sphere;

use crate::{
    arguments::Bench,
    clock::{median, thread},
    report::{Report, Table},
};
use embree::{Built, Embree, Packing};
use serde_json::{Value, json};
use std::{error::Error, time::Duration};
use steradian_accel::TopLevel;
use steradian_math::Ray;
use trace::{Found, Mode, Query};

/// Number of turns of each tracer, and least duration of a turn.
const ROUNDS: usize = 7;
const LEAST: Duration = Duration::from_millis(60);

/// Embree's scenes of one case: with fast tests and with watertight ones.
type Scenes<'a> = [(&'static str, Built<'a>); 2];

/// A way to trace rays: what it traces through, and how.
#[derive(Clone, Copy)]
enum Tracer<'a> {
    Ours(&'a TopLevel, Mode),
    Embree(&'a Built<'a>, Packing),
}

impl Tracer<'_> {
    fn trace(self, rays: &[Ray], query: Query) -> Found {
        match self {
            Self::Ours(top, mode) => trace::trace(top, rays, query, mode),
            Self::Embree(built, packing) => built.trace(rays, query, packing),
        }
    }

    fn is_single(self) -> bool {
        matches!(self, Self::Ours(_, Mode::Single) | Self::Embree(_, Packing { width: 1, .. }))
    }

    fn name(self) -> String {
        match self {
            Self::Ours(_, mode) => format!("{mode:?}").to_lowercase(),
            Self::Embree(_, Packing { width, coherent }) => {
                format!("{width}{}", if coherent { " coherent" } else { "" })
            }
        }
    }
}

/// Best of several tracers: the fastest, single or of all.
struct Best {
    single: f64,
    many: f64,
    way: String,
}

impl Best {
    fn of(measured: &[(Tracer, f64)]) -> Self {
        let best = |ways: &mut dyn Iterator<Item = &(Tracer, f64)>| {
            ways.map(|&(way, rate)| (rate, way.name()))
                .max_by(|a, b| a.0.total_cmp(&b.0))
                .unwrap_or((f64::NAN, String::new()))
        };
        let (single, _) = best(&mut measured.iter().filter(|(way, _)| way.is_single()));
        let (many, way) = best(&mut measured.iter().filter(|(way, _)| !matches!(way, Tracer::Ours(_, Mode::Single))));
        Self { single, many, way }
    }
}

/// Measures the rays that are wanted.
pub fn measure(bench: &Bench, report: &mut Report) -> Result<(), Box<dyn Error>> {
    let embree = bench.embree.as_deref().map(Embree::load).transpose()?;
    let columns = [
        "scene",
        "rays",
        "query",
        "single: ratio",
        "here",
        "Embree",
        "many: ratio",
        "here, many",
        "way",
        "Embree, best",
        "width",
    ];
    let mut tables =
        ["Rays against Embree", "Rays against Embree's watertight tests"].map(|title| Table::new(title, &columns));
    let (mut differ, mut verdicts) = (Vec::new(), Vec::new());
    for case in case::all(&bench.mesh)? {
        if !case.may_be(&bench.rays) {
            continue;
        }
        let top = case.build()?;
        let scenes: Option<Scenes> = match &embree {
            Some(embree) => Some([
                ("fast", embree.build(&case.mesh, &case.places, false, 1)?),
                ("robust", embree.build(&case.mesh, &case.places, true, 1)?),
            ]),
            None => None,
        };
        for (rays, set) in case.rays(&top) {
            if let Some((_, robust)) = scenes.as_ref().map(|scenes| &scenes[1]).filter(|_| !case.places.is_empty()) {
                let judge::Verdict { differ, ours, theirs, neither } =
                    judge::judge(&case, &top, &set, &robust.nearest(&set));
                verdicts.push(format!(
                    "{} {rays}: {differ} of {} name other triangles; in doubles we are right about {ours}, Embree about {theirs}, neither {neither}",
                    case.name,
                    set.len()
                ));
            }
            for query in [Query::Closest, Query::Occluded] {
                let names = [&case.name, &rays, query.name()];
                if (rays.starts_with("shadow") && query == Query::Closest) || !is_wanted(&bench.rays, &names) {
                    continue;
                }
                let ours = Mode::ALL.map(|mode| Tracer::Ours(&top, mode));
                let theirs = scenes
                    .iter()
                    .flatten()
                    .map(|(_, built)| Packing::all().map(|p| Tracer::Embree(built, p)).collect());
                let groups: Vec<Vec<Tracer>> = std::iter::once(ours.to_vec()).chain(theirs).collect();
                let (measured, found) = compare(&groups, &set, query);
                if let Some(other) = found[1..].iter().find(|other| !other.agrees(found[0])) {
                    differ.push(format!("{} (here {:?}, Embree {other:?})", names.join(" "), found[0]));
                }
                let ours = Best::of(&measured[0]);
                let rivals = measured[1..].iter().map(|m| Best::of(m)).chain(std::iter::repeat_with(|| Best::of(&[])));
                for (table, theirs) in tables.iter_mut().zip(rivals) {
                    let mut row: Vec<Value> = names.iter().map(|name| json!(name)).collect();
                    row.extend([number(ours.single / theirs.single), number(ours.single), number(theirs.single)]);
                    row.extend([number(ours.many / theirs.many), number(ours.many), json!(ours.way)]);
                    row.extend([number(theirs.many), json!(theirs.way)]);
                    table.row(row);
                }
            }
        }
    }
    let agreement = match &differ[..] {
        [] => "Both find the same hits.".to_owned(),
        rows => format!("OTHER HITS: {}.", rows.join("; ")),
    };
    let verdict = if verdicts.is_empty() { String::new() } else { format!("{}. ", verdicts.join("; ")) };
    for (mut table, tests) in tables.into_iter().zip(["its fast tests", "RTC_SCENE_FLAG_ROBUST"]) {
        table.note(format!(
            "{verdict}One thread, millions of rays in a second of the processor, {ROUNDS} turns, medians; ratios above one are in our favour. Here tests are \
             always watertight; Embree: {tests}. Many: the better of slices of 256 rays and sorted streams, against the best of Embree's \
             widths. {agreement}"
        ));
        report.add(table);
    }
    Ok(())
}

/// Measures building, and what is built.
pub fn builds(bench: &Bench, report: &mut Report) -> Result<(), Box<dyn Error>> {
    let embree = bench.embree.as_deref().map(Embree::load).transpose()?;
    let mut table = building::table();
    for case in case::all(&bench.mesh)? {
        table.row(building::measure(&case, embree.as_ref())?);
    }
    report.add(table);
    Ok(())
}

/// True if each of some words is part of a name, or none is asked for.
fn is_wanted(words: &[String], names: &[&str]) -> bool {
    words.iter().all(|word| names.iter().any(|name| name.contains(word.as_str())))
}

/// A cell; empty for what was not measured.
fn number(x: f64) -> Value {
    if x.is_finite() { json!(x) } else { json!("") }
}

/// Rates of groups of ways that take turns, in millions of rays in a second; and what the first way of each group
/// finds.
fn compare<'a>(groups: &[Vec<Tracer<'a>>], rays: &[Ray], query: Query) -> (Vec<Vec<(Tracer<'a>, f64)>>, Vec<Found>) {
    let found = groups.iter().filter_map(|group| group.first()).map(|way| way.trace(rays, query)).collect();
    let mut rates: Vec<Vec<Vec<f64>>> = groups.iter().map(|group| vec![Vec::new(); group.len()]).collect();
    for _ in 0..ROUNDS {
        for (group, rates) in groups.iter().zip(&mut rates) {
            for (way, rates) in group.iter().zip(rates) {
                let (start, mut traced) = (thread(), 0);
                let spent = loop {
                    std::hint::black_box(way.trace(rays, query));
                    traced += rays.len();
                    let spent = thread().saturating_sub(start);
                    if spent >= LEAST || rays.is_empty() {
                        break spent;
                    }
                };
                rates.push(traced as f64 * 1e-6 / spent.as_secs_f64());
            }
        }
    }
    let of_group = |(group, rates): (&Vec<Tracer<'a>>, Vec<Vec<f64>>)| {
        group.iter().copied().zip(rates.into_iter().map(median)).collect()
    };
    (groups.iter().zip(rates).map(of_group).collect(), found)
}
