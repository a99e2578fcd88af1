//! Samples of cameras and of lights, for arrays of random numbers.

use crate::{
    rays::{column, columns, rows},
    scene::Scene,
    settings::Settings,
};
use numpy::PyReadonlyArray2;
use pyo3::{exceptions::PyValueError, prelude::*, types::PyDict};
use rayon::prelude::*;
use std::f32::consts::PI;
use steradian::{
    ColorMode,
    core::light::{Light, LightContext},
    math::{Frame, Ray, Vec2, Vec3, spectra::Wavelengths, warp},
};

/// Samples that one thread takes at least.
const AT_ONCE: usize = 256;

/// Camera rays through points of the full frame, pixels, at moments of the exposure: origins, directions, and the share
/// of the radiance that counts.
#[pyfunction]
pub fn sample_ray<'py>(
    py: Python<'py>,
    scene: &Scene,
    settings: &Settings,
    xy: PyReadonlyArray2<'py, f32>,
    lens: PyReadonlyArray2<'py, f32>,
    times: PyReadonlyArray2<'py, f32>,
) -> PyResult<Bound<'py, PyDict>> {
    let count = xy.as_array().nrows();
    let (xy, lens) = (rows::<_, 2>("xy", &xy, count)?, rows::<_, 2>("u_lens", &lens, count)?);
    let times = rows::<_, 1>("time", &times, count)?;
    finite("xy", &xy)?;
    within("u_lens", &lens)?;
    within("time", &times)?;
    let scene = scene.ready(py, settings)?.scene;
    let asked: Vec<_> = xy.into_iter().zip(lens).zip(times).collect();
    let found: Vec<(Ray, f32)> = py.detach(|| {
        let one = |&((p, u), [time]): &(([f32; 2], [f32; 2]), [f32; 1])| {
            let mut lambda = Wavelengths::RGB.at_time(time);
            scene.camera().sample(scene.film(), Vec2::from(p), Vec2::from(u), &mut lambda)
        };
        asked.par_iter().with_min_len(AT_ONCE).map(one).collect()
    });
    let all = PyDict::new(py);
    all.set_item("origin", columns(py, &found, |(ray, _)| scene.to_file(ray.origin).as_vec3().to_array())?)?;
    all.set_item("direction", columns(py, &found, |(ray, _)| ray.direction.to_array())?)?;
    all.set_item("weight", column(py, &found, |(_, weight)| *weight))?;
    Ok(all)
}

/// Sample of a light.
#[derive(Clone, Copy)]
struct Lit {
    wi: Vec3,
    distance: f32,
    weight: Vec3,
    pdf: f32,
    is_delta: bool,
    /// Number of its group, from one; zero for none.
    group: u32,
}

impl Lit {
    const NONE: Self = Self { wi: Vec3::ZERO, distance: 0.0, weight: Vec3::ZERO, pdf: 0.0, is_delta: false, group: 0 };
}

/// Sampling of all lights. Next-event estimation leaves the even part of environments to scattering; here half of the
/// samples go to environments by the cosine, or evenly without a normal, and the mixture of both has the density that
/// counts.
struct Emitters<'a> {
    scene: &'a steradian::Scene,
    /// Environments that next-event estimation does not find all of.
    spread: Vec<u32>,
    /// Probability with which one of them is chosen.
    share: f32,
}

impl<'a> Emitters<'a> {
    fn new(scene: &'a steradian::Scene) -> Self {
        let lights = scene.lights();
        let is_spread = |i: &u32| match lights.lights.get(*i as usize) {
            Some(Light::Environment(e)) => e.portal.is_none(),
            _ => false,
        };
        let spread: Vec<u32> = lights.environments.iter().copied().filter(is_spread).collect();
        let share = match (spread.is_empty(), lights.can_sample()) {
            (true, _) => 0.0,
            (false, true) => 0.5,
            (false, false) => 1.0,
        };
        Self { scene, spread, share }
    }

    fn sample(&self, ctx: &LightContext, u: Vec3, lambda: &Wavelengths) -> Option<Lit> {
        let (lights, below_one) = (self.scene.lights(), 1.0 - f32::EPSILON);
        let (u, place) = (u.x.min(below_one), Vec2::new(u.y, u.z));
        if u < self.share {
            let k = (u / self.share * self.spread.len() as f32) as usize;
            let light = *self.spread.get(k.min(self.spread.len() - 1))?;
            let wi = match ctx.n == Vec3::ZERO {
                true => warp::uniform_sphere(place),
                false => Frame::from_z(ctx.n).to_world(warp::cosine_hemisphere(place)),
            };
            return self.environment(light, ctx, wi, lambda);
        }
        let rest = 1.0 - self.share;
        let (light, probability) = lights.choose(ctx, ((u - self.share) / rest).min(below_one))?;
        let s = lights.sample(light, ctx, place, lambda, self.scene.textures())?;
        if self.spread.contains(&light) {
            return self.environment(light, ctx, s.wi, lambda);
        }
        let pdf = s.pdf * probability * rest;
        let weight = self.scene.mode().to_rgb(s.radiance, lambda) / pdf;
        Some(Lit { wi: s.wi, distance: s.distance, weight, pdf, is_delta: s.is_delta, group: self.group(light) })
    }

    /// Light of an environment from a direction, by the density of the mixture.
    fn environment(&self, light: u32, ctx: &LightContext, wi: Vec3, lambda: &Wavelengths) -> Option<Lit> {
        let lights = self.scene.lights();
        let Light::Environment(sky) = lights.lights.get(light as usize)? else { return None };
        if !lights.shines(light, lambda) {
            return None;
        }
        let even = if ctx.n == Vec3::ZERO { 0.25 / PI } else { ctx.n.dot(wi).max(0.0) / PI };
        let pdf =
            self.share / self.spread.len() as f32 * even + (1.0 - self.share) * lights.environment_pdf(light, ctx, wi);
        let weight = self.scene.mode().to_rgb(sky.radiance(ctx.p, wi, lambda), lambda) / pdf;
        Some(Lit { wi, distance: f32::INFINITY, weight, pdf, is_delta: false, group: self.group(light) })
    }

    fn group(&self, light: u32) -> u32 {
        self.scene.light_groups().of_lights.get(light as usize).map_or(0, |group| group + 1)
    }
}

/// A light for each point, and a point on it, by three numbers each. Light from behind a normal is left out; a normal
/// of zero is of both sides.
#[pyfunction]
pub fn sample_emitter<'py>(
    py: Python<'py>,
    scene: &Scene,
    points: PyReadonlyArray2<'py, f32>,
    normals: PyReadonlyArray2<'py, f32>,
    u: PyReadonlyArray2<'py, f32>,
    times: PyReadonlyArray2<'py, f32>,
) -> PyResult<Bound<'py, PyDict>> {
    let count = points.as_array().nrows();
    let (points, normals) = (rows::<_, 3>("points", &points, count)?, rows::<_, 3>("normals", &normals, count)?);
    let (u, times) = (rows::<_, 3>("u", &u, count)?, rows::<_, 1>("time", &times, count)?);
    finite("points", &points)?;
    finite("normals", &normals)?;
    within("u", &u)?;
    within("time", &times)?;
    let scene = scene.queried(py, Some(ColorMode::Rgb))?.scene;
    let emitters = Emitters::new(&scene);
    let found: Vec<Lit> = py.detach(|| {
        let one = |i: usize| {
            let (p, n) = (Vec3::from(points[i]), Vec3::from(normals[i]).normalize_or_zero());
            let ctx = LightContext { p: scene.from_file(p.as_dvec3()), n };
            let lit = emitters.sample(&ctx, Vec3::from(u[i]), &Wavelengths::RGB.at_time(times[i][0]));
            let counts = |s: &Lit| s.pdf > 0.0 && (n == Vec3::ZERO || n.dot(s.wi) > 0.0);
            lit.filter(counts).unwrap_or(Lit::NONE)
        };
        (0..count).into_par_iter().with_min_len(AT_ONCE).map(one).collect()
    });
    let all = PyDict::new(py);
    all.set_item("wi", columns(py, &found, |s| s.wi.to_array())?)?;
    all.set_item("distance", column(py, &found, |s| s.distance))?;
    all.set_item("weight", columns(py, &found, |s| s.weight.to_array())?)?;
    all.set_item("pdf", column(py, &found, |s| s.pdf))?;
    all.set_item("delta", column(py, &found, |s| s.is_delta))?;
    all.set_item("light", column(py, &found, |s| s.group))?;
    let names: Vec<(usize, &str)> = (1..).zip(scene.light_groups().names.iter().map(String::as_str)).collect();
    all.set_item("light_names", names)?;
    Ok(all)
}

fn finite<const N: usize>(name: &str, rows: &[[f32; N]]) -> PyResult<()> {
    check(name, rows, f32::is_finite, "finite")
}

fn within<const N: usize>(name: &str, rows: &[[f32; N]]) -> PyResult<()> {
    check(name, rows, |v| (0.0..=1.0).contains(&v), "within 0 and 1")
}

fn check<const N: usize>(name: &str, rows: &[[f32; N]], is_good: fn(f32) -> bool, wanted: &str) -> PyResult<()> {
    match rows.iter().position(|row| !row.iter().all(|v| is_good(*v))) {
        Some(row) => Err(PyValueError::new_err(format!("row {row} of {name} is not {wanted}"))),
        None => Ok(()),
    }
}
