//! Materials, textures and integrators of a Python program's own, for all scenes that are loaded after them.

use crate::{
    batch::{Batch, Row},
    own_method,
};
use pyo3::{
    exceptions::{PyTypeError, PyValueError},
    prelude::*,
};
use std::{
    collections::BTreeMap,
    sync::{Arc, LazyLock, Mutex, MutexGuard, PoisonError},
};
use steradian::{
    CompileOptions, Registry, RegistryError,
    bsdf::{Draw, Inputs, OwnScatter, TransportMode},
    engine::MethodKind,
    formats,
    math::{Spectrum, Vec2, Vec3},
    schema::{Family, Group, Model, Parameter, Type, material::DETAIL, texture::MAPPING},
    texture::{OwnTexture, OwnValue, own::OwnPoint},
};

/// All that is of the program's own, and the registry that it makes.
#[derive(Default)]
struct Own {
    materials: BTreeMap<&'static str, (&'static Model, Arc<Scatter>)>,
    textures: BTreeMap<&'static str, (&'static Model, Arc<Batch>)>,
    methods: BTreeMap<&'static str, &'static Model>,
    registry: Registry,
}

static OWN: LazyLock<Mutex<Own>> = LazyLock::new(Mutex::default);

fn own() -> MutexGuard<'static, Own> {
    OWN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The models that scenes may name.
pub fn registry() -> Registry {
    own().registry.clone()
}

/// Options of readers that know them.
pub fn reading() -> formats::Options {
    registry().reading()
}

/// Options of compiling that have them.
pub fn compiling() -> CompileOptions {
    registry().compiling()
}

impl Own {
    /// The registry, with what is there now; a kind that is there again replaces the earlier one.
    fn renew(&mut self) -> Result<(), RegistryError> {
        let mut registry = Registry::new();
        for (model, scatter) in self.materials.values() {
            registry = registry.material(model, Shared(Arc::clone(scatter)))?;
        }
        for (model, function) in self.textures.values() {
            let function = Arc::clone(function);
            registry = registry.texture(model, move |_| Ok(Texture(Arc::clone(&function))))?;
        }
        for model in self.methods.values() {
            registry = registry.method(model, MethodKind::new(model.kind, own_method::make))?;
        }
        self.registry = registry;
        Ok(())
    }
}

/// Names that live as long as the program, which rows of the schema have.
fn kept(text: &str) -> &'static str {
    Box::leak(text.to_owned().into_boxed_str())
}

/// A name that scene files can have.
fn name_of(name: &str) -> PyResult<&'static str> {
    let is_word = name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    match is_word {
        true => Ok(kept(name)),
        false => Err(PyValueError::new_err(format!("'{name}' is no name: it has letters, digits and _ alone"))),
    }
}

/// A name of a parameter that no other one has.
fn parameter_of(name: &str, others: &[Vec<&str>; 2]) -> PyResult<&'static str> {
    let is_taken = others.iter().flatten().any(|other| *other == name)
        || DETAIL.parameters.iter().any(|parameter| parameter.name == name);
    match is_taken {
        true => Err(PyValueError::new_err(format!("there are two parameters '{name}'; all materials have bumps"))),
        false => name_of(name),
    }
}

fn model(
    kind: &str,
    function: &Bound<'_, PyAny>,
    doc: &'static str,
    parameters: Vec<Parameter>,
    family: Family,
) -> PyResult<&'static Model> {
    let kind = name_of(kind)?;
    if !function.is_callable() {
        let type_name = function.get_type().name()?;
        return Err(PyTypeError::new_err(format!("the {} '{kind}' needs a function, not {type_name}", family.noun())));
    }
    if family.model(kind).is_some() {
        return Err(PyValueError::new_err(format!("the {} '{kind}' is there already", family.noun())));
    }
    static OF_MATERIALS: [&Group; 1] = [&DETAIL];
    static OF_TEXTURES: [&Group; 1] = [&MAPPING];
    let groups: &[&Group] = match family {
        Family::Material => &OF_MATERIALS,
        Family::Texture => &OF_TEXTURES,
        _ => &[],
    };
    let parameters = Box::leak(parameters.into_boxed_slice());
    Ok(Box::leak(Box::new(Model { kind, doc, parameters, groups, source: "" })))
}

fn refused(why: &RegistryError) -> PyErr {
    PyValueError::new_err(why.to_string())
}

/// A material by functions of arrays; see `steradian.material`.
#[pyfunction]
#[pyo3(signature = (name, eval, sample, pdf, colors, numbers, transmits, reciprocal))]
#[expect(clippy::too_many_arguments, reason = "the signature of a function of Python")]
pub fn own_material(
    py: Python<'_>,
    name: &str,
    eval: Py<PyAny>,
    sample: Option<Py<PyAny>>,
    pdf: Option<Py<PyAny>>,
    colors: Vec<(String, [f64; 3])>,
    numbers: Vec<(String, f64)>,
    transmits: bool,
    reciprocal: bool,
) -> PyResult<()> {
    let mut parameters = Vec::new();
    let mut names = [Vec::new(), Vec::new()];
    for (name, rgb) in &colors {
        let name = parameter_of(name, &names)?;
        if !rgb.iter().all(|v| (0.0..=1.0).contains(v)) {
            return Err(PyValueError::new_err(format!("the colour '{name}' is {rgb:?}, not within 0 and 1")));
        }
        names[0].push(name);
        let default = rgb.map(|v| v.to_string()).join(", ");
        parameters.push(Parameter::new(Type::Texture, name, (0.0, 1.0), kept(&default), "a colour"));
    }
    for (name, v) in &numbers {
        let name = parameter_of(name, &names)?;
        if !v.is_finite() {
            return Err(PyValueError::new_err(format!("the number '{name}' is {v}, which is not finite")));
        }
        names[1].push(name);
        let any = (f64::NEG_INFINITY, f64::INFINITY);
        parameters.push(Parameter::new(Type::Scalar, name, any, kept(&v.to_string()), "a number"));
    }
    let model = model(name, eval.bind(py), "a material of a Python program", parameters, Family::Material)?;
    let scatter = Scatter {
        eval: Batch::new(eval, model.kind, "eval", [3, 3], &[1, 3, 4], names.clone()),
        sample: sample.map(|f| Batch::new(f, model.kind, "sample", [3, 3], &[3], names.clone())),
        pdf: pdf.map(|f| Batch::new(f, model.kind, "pdf", [3, 3], &[1], names)),
        transmits,
        reciprocal,
    };
    let mut own = own();
    let before = own.materials.insert(model.kind, (model, Arc::new(scatter)));
    own.renew().map_err(|why| {
        // A model that cannot be is not kept.
        match before {
            Some(before) => own.materials.insert(model.kind, before),
            None => own.materials.remove(model.kind),
        };
        refused(&why)
    })
}

/// A texture by a function of arrays; see `steradian.texture`.
#[pyfunction]
pub fn own_texture(py: Python<'_>, name: &str, function: Py<PyAny>) -> PyResult<()> {
    let model = model(name, function.bind(py), "a texture of a Python program", Vec::new(), Family::Texture)?;
    let batch = Batch::new(function, model.kind, "texture", [2, 3], &[1, 3], [Vec::new(), Vec::new()]);
    let mut own = own();
    own.textures.insert(model.kind, (model, Arc::new(batch)));
    own.renew().map_err(|why| refused(&why))
}

/// An integrator by a function of waves; see `steradian.integrator`.
#[pyfunction]
pub fn own_integrator(py: Python<'_>, name: &str, function: Py<PyAny>) -> PyResult<()> {
    let model = model(name, function.bind(py), "an integrator of a Python program", Vec::new(), Family::Integrator)?;
    let mut own = own();
    own_method::keep(model.kind, function);
    own.methods.insert(model.kind, model);
    own.renew().map_err(|why| refused(&why))
}

/// A material by its functions.
#[derive(Debug)]
struct Scatter {
    eval: Batch,
    sample: Option<Batch>,
    pdf: Option<Batch>,
    transmits: bool,
    reciprocal: bool,
}

/// [`Scatter`] in a registry.
#[derive(Debug)]
struct Shared(Arc<Scatter>);

/// Defaults of the trait, which functions may replace.
#[derive(Debug)]
struct Cosine;

impl OwnScatter for Cosine {
    fn value(&self, _: &Inputs, _: Vec3, _: Vec3, _: TransportMode) -> Spectrum {
        Spectrum::ZERO
    }
}

fn row(at: &Inputs, a: Vec3, b: Vec3) -> Row {
    Row { vectors: [a.to_array(), b.to_array()], at: Some(*at) }
}

impl OwnScatter for Shared {
    fn value(&self, at: &Inputs, wo: Vec3, wi: Vec3, _: TransportMode) -> Spectrum {
        // Below the surface there is nothing to ask for.
        let is_below = wo.z <= 0.0 || wi.z <= 0.0;
        if is_below && !self.0.transmits { Spectrum::ZERO } else { Spectrum::new(self.0.eval.ask(row(at, wo, wi))) }
    }

    fn pdf(&self, at: &Inputs, wo: Vec3, wi: Vec3, mode: TransportMode) -> f32 {
        let is_below = wo.z <= 0.0 || wi.z <= 0.0;
        match &self.0.pdf {
            _ if is_below && !self.0.transmits => 0.0,
            Some(pdf) => pdf.ask(row(at, wo, wi))[0],
            None => Cosine.pdf(at, wo, wi, mode),
        }
    }

    fn sample(&self, at: &Inputs, wo: Vec3, u: f32, u2: Vec2, mode: TransportMode) -> Option<Draw> {
        match &self.0.sample {
            _ if wo.z <= 0.0 && !self.0.transmits => None,
            Some(sample) => {
                let [x, y, z, _] = sample.ask(row(at, wo, Vec3::new(u, u2.x, u2.y)));
                let wi = Vec3::new(x, y, z);
                (wi != Vec3::ZERO).then_some(Draw::Spread(wi))
            }
            None => Cosine.sample(at, wo, u, u2, mode),
        }
    }

    fn transmits(&self) -> bool {
        self.0.transmits
    }

    fn is_reciprocal(&self) -> bool {
        self.0.reciprocal
    }

    fn is_anisotropic(&self) -> bool {
        true
    }
}

/// A texture by its function.
#[derive(Debug)]
struct Texture(Arc<Batch>);

impl OwnTexture for Texture {
    fn value(&self, at: &OwnPoint<'_>) -> OwnValue {
        let uv = at.uv.uv;
        let [r, g, b, more] = self.0.ask(Row { vectors: [[uv.x, uv.y, 0.0], at.p.to_array()], at: None });
        // Single numbers fill all lanes.
        if more == r && g == r && b == r { OwnValue::Number(r) } else { OwnValue::Rgb(Vec3::new(r, g, b)) }
    }
}
