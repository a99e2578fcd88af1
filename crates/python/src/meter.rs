//! Light meters at many points of a scene.

use crate::{
    batch,
    faults::Watch,
    message,
    rays::{columns, rows},
    scene::{Ready, Scene},
    settings,
};
use numpy::{IntoPyArray, PyReadonlyArray2, ndarray::Array1};
use pyo3::{exceptions::PyValueError, prelude::*, types::PyDict};
use steradian::{
    ColorMode,
    integrators::Depth,
    math::{DVec3, Vec3},
    meter::{self as instrument, Reading, Receiver, Settings},
};

/// Readings of a meter at points, as a dictionary of arrays. `aims` are normals of planes, or directions where
/// `are_directions`; without them light from all sides counts. With a radius the flux is measured.
#[pyfunction]
#[pyo3(signature = (scene, points, aims = None, *, are_directions = false, flux = None, spp = 64000, error = None,
    seed = 0, max_depth = None, integrator = None, color = "auto"))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub fn meter<'py>(
    py: Python<'py>,
    scene: &Scene,
    points: PyReadonlyArray2<'py, f64>,
    aims: Option<PyReadonlyArray2<'py, f32>>,
    are_directions: bool,
    flux: Option<f32>,
    spp: u32,
    error: Option<f64>,
    seed: u64,
    max_depth: Option<i64>,
    integrator: Option<&str>,
    color: &str,
) -> PyResult<Bound<'py, PyDict>> {
    let fault = |what: String| Err(PyValueError::new_err(what));
    if spp == 0 {
        return fault("spp is a whole number above 0".into());
    }
    for (name, value) in [("error", error), ("flux", flux.map(f64::from))] {
        if value.is_some_and(|v| !(v > 0.0 && v.is_finite())) {
            return fault(format!("{name} is a number above 0"));
        }
    }
    let points = rows::<_, 3>("points", &points, points.as_array().nrows())?;
    let is_far = |p: &[f64; 3]| !p.iter().all(|v| v.abs() <= f32::MAX.into());
    if let Some(row) = points.iter().position(is_far) {
        return fault(format!("row {row} of points is not finite"));
    }
    let unit = |(row, aim): (usize, [f32; 3])| {
        let name = if are_directions { "directions" } else { "normals" };
        let none = || PyValueError::new_err(format!("row {row} of {name} has no length, or is not finite"));
        Vec3::from(aim).try_normalize().ok_or_else(none)
    };
    let aims = aims.map(|aims| rows::<_, 3>("normals or directions", &aims, points.len())).transpose()?;
    let aims: Option<Vec<Vec3>> = aims.map(|aims| aims.into_iter().enumerate().map(unit).collect()).transpose()?;
    batch::refuse_inside("measure light")?;
    let Ready { scene, models, .. } = scene.queried(py, settings::color(color)?)?;
    let faults = Watch::begin(&models);
    let media = match integrator {
        None => scene.has_media(),
        Some("path") => false,
        Some("volpath") => true,
        Some(other) => return fault(format!("the meter's integrator is path or volpath, not '{other}'")),
    };
    let asked = scene.settings();
    if max_depth.is_some_and(|depth| depth < -1) {
        return fault("max_depth is a whole number, -1 for no limit".into());
    }
    let max = max_depth.map_or(asked.max_depth, |depth| u32::try_from(depth).unwrap_or(u32::MAX));
    let depth = Depth { max, roulette_after: asked.rr_depth, hide_emitters: false };
    let settings = Settings { samples: spp, error, seed, media, depth };
    let receiver = |point: &[f64; 3], aim: Option<Vec3>| {
        let at = scene.from_file(DVec3::from(*point));
        match (aim, are_directions, flux) {
            (Some(n), false, Some(r)) => Receiver::Disc(at, n, r),
            (Some(n), false, None) => Receiver::Plane(at, n),
            (Some(d), true, _) => Receiver::Radiance(at, d),
            (None, _, Some(r)) => Receiver::Ball(at, r),
            (None, _, None) => Receiver::Sphere(at),
        }
    };
    let mut readings: Vec<Reading> = Vec::new();
    for (row, point) in points.iter().enumerate() {
        let aim = aims.as_ref().and_then(|aims| aims.get(row)).copied();
        py.check_signals()?;
        faults.fault()?;
        readings.push(py.detach(|| instrument::read(&scene, &receiver(point, aim), &settings)));
    }
    faults.fault()?;
    let nonfinite: u64 = readings.iter().map(|r| r.nonfinite).sum();
    if nonfinite > 0 {
        message::warn(py, &format!("{nonfinite} samples were not finite and count as black"))?;
    }
    let is_short = |r: &&Reading| error.is_some_and(|e| r.luminous.plus_minus > e * r.luminous.value.abs());
    let (short, count) = (readings.iter().filter(is_short).count(), readings.len());
    if let Some(e) = error.filter(|_| short > 0) {
        message::warn(py, &format!("the error {e} is not reached at {short} of {count} points"))?;
    }
    let column = |of: &dyn Fn(&Reading) -> f64| Array1::from_iter(readings.iter().map(of)).into_pyarray(py);
    let all = PyDict::new(py);
    all.set_item("rgb", columns(py, &readings, |r| r.rgb.map(|e| e.value))?)?;
    all.set_item("rgb_error", columns(py, &readings, |r| r.rgb.map(|e| e.plus_minus))?)?;
    all.set_item("luminous", column(&|r| r.luminous.value))?;
    all.set_item("luminous_error", column(&|r| r.luminous.plus_minus))?;
    let is_spectral = scene.mode() == ColorMode::Spectral;
    let radiant = |of: fn(&instrument::Estimate) -> f64| {
        is_spectral.then(|| column(&|r| r.radiant.as_ref().map_or(f64::NAN, of)))
    };
    all.set_item("radiant", radiant(|e| e.value))?;
    all.set_item("radiant_error", radiant(|e| e.plus_minus))?;
    let samples = Array1::from_iter(readings.iter().map(|r| r.samples));
    all.set_item("samples", samples.into_pyarray(py))?;
    Ok(all)
}
