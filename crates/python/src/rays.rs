//! Rays through a scene: what they meet, and whether anything is in between.

use crate::{
    batch::each,
    faults::Watch,
    scene::{Ready, Scene},
};
use numpy::{
    Element, IntoPyArray, PyArray1, PyReadonlyArray1, PyReadonlyArray2,
    ndarray::{Array1, Array2},
};
use pyo3::{exceptions::PyValueError, prelude::*, types::PyDict};
use steradian::math::{DVec3, Ray, Vec3, spectra::Wavelengths};

/// Rays that one thread takes at least.
const RAYS_AT_ONCE: usize = 256;

/// A ray of unit direction, and the length of the direction that was given, in units of which distances count.
struct Measured {
    ray: Ray,
    unit: f32,
}

/// Hit of a ray.
#[derive(Clone, Copy)]
struct Found {
    t: f32,
    position: Vec3,
    geometric_normal: Vec3,
    normal: Vec3,
    uv: [f32; 2],
    primitive: i32,
    instance: i32,
    shape: u32,
    material: u32,
}

impl Found {
    const NOTHING: Self = Self {
        t: f32::INFINITY,
        position: Vec3::INFINITY,
        geometric_normal: Vec3::ZERO,
        normal: Vec3::ZERO,
        uv: [0.0; 2],
        primitive: -1,
        instance: -1,
        shape: 0,
        material: 0,
    };

    fn along(scene: &steradian::Scene, Measured { ray, unit }: &Measured) -> Self {
        let Some(hit) = scene.intersect(ray) else { return Self::NOTHING };
        let i = scene.interaction(ray, &hit);
        // Where wavelengths are asked for they change nothing about the shading frame.
        let mut lambda = Wavelengths::at([450.0, 550.0, 600.0, 650.0]);
        let frame = scene.scattering(&i, 0.5, &mut lambda).map(|(_, frame)| frame);
        let geometry = &scene.geometries()[i.geometry as usize];
        Self {
            t: hit.t / unit,
            position: scene.to_file(i.surface.p).as_vec3(),
            geometric_normal: i.surface.n,
            normal: frame.map_or(i.surface.ns, |f| f.z),
            uv: i.surface.uv.to_array(),
            primitive: hit.id.prim as i32,
            // The world is the largest number, which becomes -1.
            instance: hit.id.instance as i32,
            shape: geometry.id,
            material: geometry.material + 1,
        }
    }
}

fn rays(
    scene: &steradian::Scene,
    origins: &PyReadonlyArray2<'_, f32>,
    directions: &PyReadonlyArray2<'_, f32>,
    ends: &PyReadonlyArray1<'_, f32>,
    time: f32,
) -> PyResult<Vec<Measured>> {
    let (o, d, ends) = (origins.as_array(), directions.as_array(), ends.as_array());
    if (o.ncols(), d.ncols()) != (3, 3) || o.nrows() != d.nrows() || o.nrows() != ends.len() {
        let shapes = format!("{:?}, {:?} and {:?}", o.shape(), d.shape(), ends.shape());
        let wanted = "origins, directions and max_distance have the shapes (n, 3), (n, 3) and (n,)";
        return Err(PyValueError::new_err(format!("{wanted}, not {shapes}")));
    }
    if !(0.0..=1.0).contains(&time) {
        return Err(PyValueError::new_err(format!("time is a number from 0 to 1, not {time}")));
    }
    let one = |(row, ((o, d), end)): (usize, _)| {
        let (o, d): (numpy::ndarray::ArrayView1<'_, f32>, numpy::ndarray::ArrayView1<'_, f32>) = (o, d);
        let end: &f32 = end;
        let (origin, given) = (Vec3::new(o[0], o[1], o[2]), Vec3::new(d[0], d[1], d[2]));
        let fault = |what: &str| PyValueError::new_err(format!("row {row} of {what}"));
        if !origin.is_finite() {
            return Err(fault("origins is not finite"));
        }
        let length = DVec3::new(given.x.into(), given.y.into(), given.z.into()).length();
        if !(length > 0.0 && length < f32::MAX.into()) {
            return Err(fault("directions has no length, or is not finite"));
        }
        if end.is_nan() || *end <= 0.0 {
            return Err(fault("max_distance is not above 0"));
        }
        let unit = length as f32;
        let direction = (given.as_dvec3() / length).as_vec3();
        let origin = scene.from_file(origin.as_dvec3());
        let ray = Ray { t_max: end * unit, time, ..Ray::new(origin, direction) };
        Ok(Measured { ray, unit })
    };
    o.rows().into_iter().zip(d.rows()).zip(ends.iter()).enumerate().map(one).collect()
}

/// Nearest hits of rays, as a dictionary of arrays; numbers of shapes and materials count from one, zero is nothing.
/// Distances are in units of the length of the direction.
#[pyfunction]
#[pyo3(signature = (scene, origins, directions, max_distance, *, time = 0.0))]
pub fn trace<'py>(
    py: Python<'py>,
    scene: &Scene,
    origins: PyReadonlyArray2<'py, f32>,
    directions: PyReadonlyArray2<'py, f32>,
    max_distance: PyReadonlyArray1<'py, f32>,
    time: f32,
) -> PyResult<Bound<'py, PyDict>> {
    let Ready { scene, models, .. } = scene.queried(py, None)?;
    let faults = Watch::begin(&models);
    let rays = rays(&scene, &origins, &directions, &max_distance, time)?;
    let found: Vec<Found> = each(py, rays.len(), RAYS_AT_ONCE, |i| Found::along(&scene, &rays[i]));
    faults.fault()?;
    let all = PyDict::new(py);
    all.set_item("t", column(py, &found, |f| f.t))?;
    all.set_item("position", columns(py, &found, |f| f.position.to_array())?)?;
    all.set_item("geometric_normal", columns(py, &found, |f| f.geometric_normal.to_array())?)?;
    all.set_item("normal", columns(py, &found, |f| f.normal.to_array())?)?;
    all.set_item("uv", columns(py, &found, |f| f.uv)?)?;
    all.set_item("primitive", column(py, &found, |f| f.primitive))?;
    all.set_item("instance", column(py, &found, |f| f.instance))?;
    all.set_item("shape", column(py, &found, |f| f.shape))?;
    all.set_item("material", column(py, &found, |f| f.material))?;
    all.set_item("shape_names", scene.object_names().clone())?;
    let numbered: Vec<(usize, &str)> = (1..).zip(scene.material_names().iter().map(String::as_str)).collect();
    all.set_item("material_names", numbered)?;
    Ok(all)
}

/// True for rays that meet anything that scatters before their distance.
#[pyfunction]
#[pyo3(signature = (scene, origins, directions, max_distance, *, time = 0.0))]
pub fn occluded<'py>(
    py: Python<'py>,
    scene: &Scene,
    origins: PyReadonlyArray2<'py, f32>,
    directions: PyReadonlyArray2<'py, f32>,
    max_distance: PyReadonlyArray1<'py, f32>,
    time: f32,
) -> PyResult<Bound<'py, PyArray1<bool>>> {
    let Ready { scene, models, .. } = scene.queried(py, None)?;
    let faults = Watch::begin(&models);
    let rays = rays(&scene, &origins, &directions, &max_distance, time)?;
    let found: Vec<bool> = each(py, rays.len(), RAYS_AT_ONCE, |i| scene.occluded(&rays[i].ray));
    faults.fault()?;
    Ok(found.into_pyarray(py))
}

/// Rows of an array, of which so many are expected.
pub fn rows<T: Element + Copy, const N: usize>(
    name: &str,
    array: &PyReadonlyArray2<'_, T>,
    count: usize,
) -> PyResult<Vec<[T; N]>> {
    let array = array.as_array();
    if array.dim() != (count, N) {
        return Err(PyValueError::new_err(format!("{name} has the shape {:?}, not ({count}, {N})", array.shape())));
    }
    Ok(array.rows().into_iter().map(|row| std::array::from_fn(|k| row[k])).collect())
}

/// An array of one number for each.
pub fn column<'py, S, T: Element>(py: Python<'py>, found: &[S], of: impl Fn(&S) -> T) -> Bound<'py, PyArray1<T>> {
    Array1::from_iter(found.iter().map(of)).into_pyarray(py)
}

/// An array of a row for each.
pub fn columns<'py, S, T: Element, const N: usize>(
    py: Python<'py>,
    found: &[S],
    of: impl Fn(&S) -> [T; N],
) -> PyResult<Bound<'py, PyAny>> {
    let flat: Vec<T> = found.iter().flat_map(of).collect();
    let array = Array2::from_shape_vec((found.len(), N), flat).map_err(|e| PyValueError::new_err(e.to_string()))?;
    Ok(array.into_pyarray(py).into_any())
}
