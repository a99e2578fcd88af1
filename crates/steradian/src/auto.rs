//! Choice of a method by a trial, which the name [`AUTO`] asks for.
//!
//! Path tracing is best where lights are seen from what they light. It errs much, or finds nothing, where light comes
//! through glass from small lamps; which of the other methods is best then depends on what the camera sees.
//!
//! So each candidate that renders the scene as it is asked for renders small pictures, twice with other numbers, at
//! equal cost: a cost is a number of rays by what a ray of that method costs. What the two differ by is noise. What the
//! mean of both differs by from the candidates that find all light is light that was missed, or bias. The score is the
//! expected error of a picture of 128 samples, the geometric mean over single pixels and squares of four; the
//! least one wins, and path tracing where another one is not much better. The choice depends on the scene and the
//! request alone, not on time, threads, or the seed.

use crate::{
    Control, Error, Film, Scene,
    method::{Choice, Render},
};
use std::sync::Arc;
use steradian_film::Crop;
use steradian_request::{MethodRequest, Request};
use steradian_schema::integrator::path_tracer;

/// The name by which a method is chosen.
pub const AUTO: &str = "auto";

/// Longest edge of the pictures, pixels.
const EDGE: u32 = 64;
/// Rays of path tracing that are as dear as a picture of a trial.
const RAYS: f64 = 400_000.0;
/// Most samples of such a picture.
const MOST_SAMPLES: u32 = 1 << 12;
/// Samples per pixel of path tracing for whose cost errors are expected.
const SAMPLES: f64 = 128.0;
/// Edges of the squares of pixels whose means are scored.
const SCALES: [usize; 2] = [1, 4];
/// Edge of the squares in which light is missed.
const MISSED: usize = 8;
/// Another method than path tracing is to err less by this factor.
const BETTER: f64 = 1.5;
/// Added to squares of pixels, to which errors are relative.
const FLOOR: f64 = 0.01;
/// Candidates: the cost of a ray relative to one of path tracing (CPU seconds per ray, medians of eight scenes), and
/// the squared relative error of their known bias.
const CANDIDATES: [Candidate; 4] = [
    Candidate { name: "path", cost: 1.0, bias: 0.0, finds_all: false },
    Candidate { name: "bdpt", cost: 1.4, bias: 0.0, finds_all: false },
    Candidate { name: "vcm", cost: 1.9, bias: 1e-5, finds_all: true },
    Candidate { name: "sppm", cost: 1.8, bias: 1e-3, finds_all: true },
];

#[derive(Clone, Copy, Debug)]
struct Candidate {
    name: &'static str,
    cost: f64,
    bias: f64,
    /// True if it finds light by way of mirrors and glass, also what is seen in these.
    finds_all: bool,
}

/// Pictures of a candidate.
struct Tried {
    candidate: Candidate,
    pictures: [Vec<[f64; 3]>; 2],
    /// Camera samples per pixel of each.
    samples: f64,
}

/// The render of a request, by the method that is chosen for the scene.
///
/// # Errors
/// Errors of path tracing, where it does not render the scene as it is asked for.
pub(crate) fn choose(request: &Request, scene: &Scene) -> Result<Render, Error> {
    let plain = path_tracer(scene.has_media());
    let method = |c: &Candidate| match c.name {
        "path" => Ok(MethodRequest::new(plain)),
        name => MethodRequest::named(name).map_err(Error::from),
    };
    // Candidates that leave nothing out of this scene and of this request.
    let mut able = Vec::new();
    for candidate in CANDIDATES {
        let method = method(&candidate)?;
        let is_path = candidate.name == "path";
        match Render::new(&Request { method: Some(method.clone()), ..request.clone() }, scene) {
            Err(e) if is_path => return Err(e),
            Ok(render) if is_path || render.left_out(scene).is_none() => {
                able.push((candidate, method, render));
            }
            _ => {}
        }
    }
    if able.len() < 2 {
        return Ok(Render { choice: Some(Choice { tried: Vec::new() }), ..able.swap_remove(0).2 });
    }
    let small = Arc::new(small(scene));
    let size = [small.film().width as usize, small.film().height as usize];
    let (mut tried, mut renders) = (Vec::new(), Vec::new());
    for (candidate, method, render) in able {
        match pictures(request, &small, candidate, &method) {
            Err(e) if candidate.name == "path" => return Err(e),
            // Some scenes are refused as a picture begins.
            Err(_) => {}
            Ok(pictures) => {
                tried.push(pictures);
                renders.push(render);
            }
        }
    }
    let scores = scores(&tried, size);
    let best = (0..scores.len()).min_by(|a, b| scores[*a].total_cmp(&scores[*b])).unwrap_or(0);
    let chosen = if scores[best] * BETTER < scores[0] { best } else { 0 };
    let tried = renders.iter().zip(&scores).map(|(render, score)| (render.name, *score)).collect();
    Ok(Render { choice: Some(Choice { tried }), ..renders.swap_remove(chosen) })
}

/// The scene with a small picture.
fn small(scene: &Scene) -> Scene {
    scene.clone().changed(|parts| {
        let film = &mut parts.film;
        let longest = film.width.max(film.height);
        let scaled = |edge: u32| (u64::from(edge) * u64::from(EDGE.min(longest)) / u64::from(longest)).max(1) as u32;
        (film.width, film.height) = (scaled(film.width), scaled(film.height));
        film.crop = Crop { x0: 0, y0: 0, x1: film.width, y1: film.height };
    })
}

/// Two pictures of a method for a cost.
fn pictures(
    request: &Request,
    scene: &Arc<Scene>,
    candidate: Candidate,
    method: &MethodRequest,
) -> Result<Tried, Error> {
    let most = (RAYS / candidate.cost) as u64;
    let mut samples = 0.0;
    let mut picture = |seed: u64| -> Result<_, Error> {
        let method = Some(method.clone());
        let (spp, seed) = (Some(MOST_SAMPLES), Some(seed));
        let plain =
            Request { method, spp, seed, threads: request.threads, max_depth: request.max_depth, ..Request::default() };
        let mut session = Render::new(&plain, scene)?.session(scene)?;
        let control = Control::default();
        while session.counters().rays < most && !session.is_done() {
            session.step(1, &control);
        }
        samples += 0.5 * f64::from(session.samples());
        Ok(means(&session.film()))
    };
    let pictures = [picture(1)?, picture(2)?];
    Ok(Tried { candidate, pictures, samples })
}

fn means(film: &Film) -> Vec<[f64; 3]> {
    film.pixels.iter().map(|p| p.mean().map(f64::from)).collect()
}

/// Expected squared relative errors.
fn scores(tried: &[Tried], size: [usize; 2]) -> Vec<f64> {
    let mean = |t: &Tried| -> Vec<[f64; 3]> {
        let pairs = t.pictures[0].iter().zip(&t.pictures[1]);
        pairs.map(|(a, b)| std::array::from_fn(|c| 0.5 * (a[c] + b[c]))).collect()
    };
    // What there is: of those that find all light, weighted by the inverse of their noise in large squares.
    let all: Vec<&Tried> = match tried.iter().any(|t| t.candidate.finds_all) {
        true => tried.iter().filter(|t| t.candidate.finds_all).collect(),
        false => tried.iter().collect(),
    };
    let plain = average(&all.iter().map(|t| (1.0, mean(t))).collect::<Vec<_>>());
    let noise = |t: &Tried, scale: usize| {
        let of = |k: usize| blocks(&t.pictures[k], size, scale);
        // Var[a] = (a − b)² / 2.
        0.5 * relative(&of(0), &of(1), &blocks(&plain, size, scale))
    };
    let weigh = |t: &&Tried| 1.0 / (noise(t, MISSED) + 1e-6);
    let known = average(&all.iter().map(|t| (weigh(t), mean(t))).collect::<Vec<_>>());
    let known = blocks(&known, size, MISSED);
    let least = all.iter().map(|t| noise(t, MISSED)).fold(f64::INFINITY, f64::min);
    let samples = tried.first().map_or(1.0, |t| t.samples);
    let score = |t: &Tried| {
        // (E[m] − k)² = (m − k)² − Var[m] − Var[k], where m and k are means of two.
        let difference = relative(&blocks(&mean(t), size, MISSED), &known, &known);
        let missed = (difference - 0.5 * (noise(t, MISSED) + least)).max(0.0);
        // Noise at equal cost, for as many samples as path tracing takes; bias stays.
        let error = |scale: usize| noise(t, scale) * samples / SAMPLES + missed + t.candidate.bias;
        SCALES.iter().map(|s| error(*s).ln()).sum::<f64>() / SCALES.len() as f64
    };
    tried.iter().map(|t| score(t).exp()).collect()
}

/// Weighted mean of pictures.
fn average(pictures: &[(f64, Vec<[f64; 3]>)]) -> Vec<[f64; 3]> {
    let total: f64 = pictures.iter().map(|(weight, _)| weight).sum();
    let at = |k: usize, c: usize| pictures.iter().map(|(weight, p)| weight * p[k][c]).sum::<f64>() / total;
    (0..pictures.first().map_or(0, |p| p.1.len())).map(|k| std::array::from_fn(|c| at(k, c))).collect()
}

/// Means over squares of pixels; those at the far edges are smaller.
fn blocks(picture: &[[f64; 3]], [width, height]: [usize; 2], edge: usize) -> Vec<[f64; 3]> {
    let columns = width.div_ceil(edge);
    let mut sums = vec![([0.0; 3], 0.0); columns * height.div_ceil(edge)];
    for (k, pixel) in picture.iter().enumerate() {
        let (sum, count) = &mut sums[k / width / edge * columns + k % width / edge];
        (0..3).for_each(|c| sum[c] += pixel[c]);
        *count += 1.0;
    }
    sums.into_iter().map(|(sum, count)| sum.map(|v| v / count)).collect()
}

/// Mean over pixels and channels of `(a − b)² / (r² + 0.01)`.
fn relative(a: &[[f64; 3]], b: &[[f64; 3]], r: &[[f64; 3]]) -> f64 {
    let one = |((a, b), r): ((&[f64; 3], &[f64; 3]), &[f64; 3])| -> f64 {
        (0..3).map(|c| (a[c] - b[c]).powi(2) / (r[c] * r[c] + FLOOR)).sum()
    };
    a.iter().zip(b).zip(r).map(one).sum::<f64>() / (3 * a.len().max(1)) as f64
}
