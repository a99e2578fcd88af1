use super::*;
use std::sync::atomic::AtomicU32;
use steradian_compile::{Options, compile};
use steradian_core::{film::Splat, sampler::SamplerKind};
use steradian_scene::{Family, Format, Node, SceneDesc};

/// Each of many particles lands somewhere on the film, and each camera ray brings its place.
#[derive(Debug)]
struct Rain {
    /// Cancels when so many pieces of work were begun.
    cancel_at: u32,
    begun: AtomicU32,
}

const PARTICLES: usize = 1000;

impl Pass for Rain {
    fn pass(&self, run: &Run<'_>, number: u32, film: &mut PassFilm<'_>) -> Option<Counters> {
        let size = Vec2::new(run.scene.film().width as f32, run.scene.film().height as f32);
        let (splats, counters) = run.in_order(PARTICLES / 50, |piece, counters| {
            if self.begun.fetch_add(1, Ordering::Relaxed) == self.cancel_at {
                run.control.cancel.store(true, Ordering::Relaxed);
            }
            counters.samples += 1;
            let splat = |k: usize| {
                let u = run.sampler.pixel(piece as u32, k as u32, number);
                Splat { at: u.get_2d(0) * size, rgb: Vec3::new(1.0, u.get_1d(1), 1e-9 * u.get_1d(2)) }
            };
            (0..50).map(splat).collect::<Vec<_>>()
        })?;
        splats.iter().flatten().for_each(|s| film.splat(s));
        let crop = film.crop();
        for y in crop.y0..crop.y1 {
            for x in crop.x0..crop.x1 {
                film.add(x, y, Vec3::X * run.camera_sample(x, y, number).at.x);
            }
        }
        Some(counters)
    }
}

fn scene(filter: &str) -> Scene {
    let mut desc = SceneDesc { format: Format::Native, ..SceneDesc::default() };
    let film = Node::new(Family::Film, "rgb", None).with("width", 19i64).with("height", 13i64);
    desc.cameras = vec![desc.add(Node::new(Family::Camera, "perspective", None))];
    (desc.film, desc.filter) = (Some(desc.add(film)), Some(desc.add(Node::new(Family::Filter, filter, None))));
    let compiled = compile(&desc, &Options::default());
    let said: Vec<_> = compiled.diagnostics.iter().map(|d| d.message.clone()).collect();
    compiled.scene.unwrap_or_else(|| panic!("{said:?}"))
}

fn plan(threads: usize, spp: u32) -> Plan {
    Plan {
        threads,
        inputs: LayerInputs::FIRST_HITS,
        ..Plan::new(Sampler { kind: SamplerKind::Independent, spp, seed: 3 })
    }
}

fn session(scene: &Scene, plan: Plan, cancel_at: u32) -> Passes<Rain> {
    Passes::new(Arc::new(scene.clone()), Rain { cancel_at, begun: AtomicU32::new(0) }, plan)
}

fn bits(session: &Passes<Rain>) -> Vec<[[u64; 3]; 2]> {
    let bits = |v: [f64; 3]| v.map(f64::to_bits);
    session.film().pixels.iter().map(|p| [bits(p.sum), bits(p.sum_squares)]).collect()
}

/// Neither threads, steps, a cancelled step, nor a render that is left and gone on with change a bit.
#[test]
fn sums_depend_on_the_plan_alone() {
    let scene = scene("gaussian");
    let mut whole = session(&scene, plan(1, 6), u32::MAX);
    whole.step(6, &Control::default());
    assert!(whole.is_done() && whole.counters().samples == 6 * 20);
    for threads in [2, 5] {
        let mut parts = session(&scene, plan(threads, 6), 50);
        parts.step(6, &Control::default());
        assert_eq!(parts.samples(), 2, "the third pass was cancelled");
        let mut state = Vec::new();
        parts.save(&mut state).expect("memory takes it");
        let mut others = session(&scene, plan(threads, 6), u32::MAX);
        others.restore(&mut &state[..]).expect("what was saved");
        for _ in 0..4 {
            others.step(1, &Control::default());
        }
        assert!(others.is_done());
        assert_eq!(bits(&whole), bits(&others));
        let cut = session(&scene, plan(threads, 6), u32::MAX).restore(&mut &state[..state.len() - 1]);
        assert!(cut.is_err());
    }
}

/// Splats that fall uniformly give every pixel within the frame the same, whatever the filter: its density integrates
/// to one.
#[test]
fn filters_spread_splats_evenly() {
    for filter in ["box", "tent", "gaussian", "mitchell"] {
        let scene = scene(filter);
        let mut session = session(&scene, plan(2, 400), u32::MAX);
        session.step(400, &Control::default());
        let film = session.film();
        let inner = |k: &usize| (3..16).contains(&(k % 19)) && (3..10).contains(&(k / 19));
        let (mut mean, mut variance, mut count) = (0.0, 0.0, 0.0);
        for k in (0..film.pixels.len()).filter(inner) {
            // Green has the splats alone, of mean one half.
            mean += film.pixels[k].mean()[1];
            variance += film.pixels[k].variance_of_mean()[1];
            count += 1.0;
        }
        let expected = 0.5 * PARTICLES as f64 / (19.0 * 13.0);
        let (mean, sigma) = (mean / count, f64::sqrt(variance) / count);
        // Splats reach several pixels, so errors of neighbours are correlated: at most all those under a filter's
        // radius of two.
        assert!(sigma < 0.01 * expected && (mean - expected).abs() < 4.0 * 4.0 * sigma, "{filter}: {mean} {expected}");
    }
}

/// Values that are no numbers count as black and are counted.
#[test]
fn splats_that_are_no_numbers_are_black() {
    let scene = scene("box");
    let mut film = PassFilm::new(scene.film(), 0);
    film.splat(&Splat { at: Vec2::splat(2.5), rgb: Vec3::new(1.0, f32::NAN, 1.0) });
    film.splat(&Splat { at: Vec2::new(f32::INFINITY, 2.5), rgb: Vec3::ONE });
    film.splat(&Splat { at: Vec2::splat(-1e30), rgb: Vec3::ONE });
    assert!(film.nonfinite() == 2 && film.sums().iter().flatten().all(|v| *v == 0.0));
}

/// Work that is under way when a stop is asked for sees it, may break off, and counts for nothing.
#[test]
fn work_sees_that_a_stop_is_asked_for() {
    let scene = scene("box");
    for threads in [1, 2] {
        let control = Control::default();
        let sampler = Sampler { kind: SamplerKind::Independent, spp: 1, seed: 0 };
        let run = Run { scene: &scene, sampler, threads, control: &control };
        let found = run.in_order(1, |_, counters| {
            let steps = (0..1000).take_while(|step| {
                if *step == 10 {
                    control.cancel.store(true, Ordering::Relaxed);
                }
                !counters.stop.is_asked()
            });
            assert_eq!(steps.count(), 10);
        });
        assert!(found.is_none());
    }
}
