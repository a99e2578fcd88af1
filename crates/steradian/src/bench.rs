//! Measuring the structures that rays go through, on the rays of a scene: from its camera, from what these meet in
//! random directions, and to its lights.

use std::time::Duration;
use steradian_accel::Steps;
use steradian_core::{Scene, light::LightContext, scene::Interaction};
use steradian_math::{Frame, Ray, Vec2, Vec3, hash::HashRng, warp};

/// Rays of a kind, and whether they are asked for any hit or for the nearest.
#[derive(Clone, Debug)]
pub struct RaySet {
    /// `primary`, `bounce` or `shadow`.
    pub name: &'static str,
    /// The rays.
    pub rays: Vec<Ray>,
    /// True if any hit will do.
    pub is_shadow: bool,
}

/// The rays of a scene, at most so many of each kind: through the middles of pixels; in directions distributed by the
/// cosine from what these meet; and from there to points on lights. The same for every structure, and for every run.
pub fn ray_sets(scene: &Scene, most: usize) -> [RaySet; 3] {
    let crop = scene.film().crop;
    let pixels = u64::from(crop.width()) * u64::from(crop.height());
    // Every n-th column and row.
    let step = ((pixels as f64 / most.max(1) as f64).sqrt().ceil() as usize).max(1);
    let columns = || (crop.x0..crop.x1).step_by(step);
    let middle = |x: u32, y: u32| Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
    let ray = |p: Vec2| scene.camera().ray(scene.film(), p, Vec2::splat(0.5));
    let rows = (crop.y0..crop.y1).step_by(step);
    let primary: Vec<Ray> = rows.flat_map(|y| columns().map(move |x| ray(middle(x, y)))).collect();
    let mut rng = HashRng::new(1);
    let (mut bounce, mut shadow) = (Vec::new(), Vec::new());
    for ray in &primary {
        let Some(hit) = scene.intersect(ray) else { continue };
        let i = scene.interaction(ray, &hit);
        let mut u = || Vec2::new(rng.next_f32(), rng.next_f32());
        let (on_lobe, choice, on_light) = (u(), u().x, u());
        let n = if i.surface.n.dot(i.wo) < 0.0 { -i.surface.n } else { i.surface.n };
        bounce.push(i.spawn(Frame::from_z(n).to_world(warp::cosine_hemisphere(on_lobe))));
        shadow.extend(to_light(scene, &i, n, choice, on_light));
    }
    let set = |name, rays, is_shadow| RaySet { name, rays, is_shadow };
    [set("primary", primary, false), set("bounce", bounce, false), set("shadow", shadow, true)]
}

/// A shadow ray from a surface to a light.
fn to_light(scene: &Scene, i: &Interaction, n: Vec3, choice: f32, u: Vec2) -> Option<Ray> {
    let lambda = scene.mode().wavelengths(|| 0.5);
    let context = LightContext { p: i.surface.p, n };
    let (light, _) = scene.lights().choose(&context, choice)?;
    let sample = scene.lights().sample(light, &context, u, &lambda, scene.textures())?;
    Some(i.spawn_towards(sample.wi, sample.distance))
}

/// Speed of a structure on a set of rays.
#[derive(Clone, Copy, Debug)]
pub struct Measured {
    /// Millions of rays for each second of the processor, on one thread.
    pub mrays_per_cpu_second: f64,
    /// Nodes or cells visited for each ray.
    pub steps: f64,
    /// Primitives tested for each ray.
    pub tests: f64,
    /// The share of rays that hit something, among those looked at for this.
    pub hits: f64,
    /// A checksum of all that was found there: equal for structures that agree in every bit.
    pub found: u64,
}

/// Rays that are looked at one by one.
const COUNTED: usize = 2000;
/// Rays that are traced together between two looks at the clock.
const CHUNK: usize = 256;

/// Traces rays on this thread for about so long, and counts what some of them cost. `None` without rays.
pub fn measure(scene: &Scene, set: &RaySet, time: Duration) -> Option<Measured> {
    let rays = &set.rays;
    if rays.is_empty() {
        return None;
    }
    let (mut total, mut hits, mut found, mut count) = (Steps::default(), 0_u32, 0_u64, 0_u32);
    for ray in rays.iter().step_by(rays.len().div_ceil(COUNTED)) {
        let cost = if set.is_shadow { scene.occluded_cost(ray) } else { scene.intersect_cost(ray) };
        (total.steps, total.tests) = (total.steps + cost.steps, total.tests + cost.tests);
        count += 1;
        let bits = if set.is_shadow {
            u64::from(scene.occluded(ray))
        } else {
            scene.intersect(ray).map_or(0, |hit| {
                let words =
                    [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.id.instance, hit.id.geom, hit.id.prim];
                words.iter().fold(1, |h: u64, &w| (h ^ u64::from(w)).wrapping_mul(0x9E37_79B9_7F4A_7C15))
            })
        };
        hits += u32::from(bits != 0);
        found = (found.rotate_left(5) ^ bits).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    }
    let count = f64::from(count);
    Some(Measured {
        mrays_per_cpu_second: rate(scene, set, time) / 1e6,
        steps: total.steps as f64 / count,
        tests: total.tests as f64 / count,
        hits: f64::from(hits) / count,
        found,
    })
}

/// Rays for each second.
fn rate(scene: &Scene, set: &RaySet, time: Duration) -> f64 {
    // Chunks in a scattered order, so that a few of them stand for all where rays are slow.
    let chunks: Vec<&[Ray]> = set.rays.chunks(CHUNK).collect();
    let stride = (0x9E37_79B1 % chunks.len().max(2)) | 1;
    let order = (0..).map(|i: usize| chunks[(i % chunks.len()) * stride % chunks.len()]);
    let trace = |rays: &[Ray]| -> usize {
        let is_hit = |ray: &&Ray| if set.is_shadow { scene.occluded(ray) } else { scene.intersect(ray).is_some() };
        rays.iter().filter(is_hit).count()
    };
    // Once to warm up.
    std::hint::black_box(trace(chunks[0]));
    let start = thread_time();
    let mut traced = 0;
    for chunk in order {
        std::hint::black_box(trace(chunk));
        traced += chunk.len();
        let spent = thread_time().saturating_sub(start);
        if spent >= time {
            return traced as f64 / spent.as_secs_f64();
        }
    }
    0.0
}

/// Time that this thread has run.
fn thread_time() -> Duration {
    let t = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Duration::new(t.tv_sec.unsigned_abs(), t.tv_nsec.unsigned_abs() as u32)
}
