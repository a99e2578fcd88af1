//! Registration of scattering models: cases at the corners of their parameters, on which the laws of scattering are
//! checked, and recipes that make them from parameters alone.

use super::Bsdf;
use steradian_math::{Spectrum, Vec3};

/// A model, or a form of one that keeps to other laws.
pub struct Model {
    /// Its name.
    pub name: &'static str,
    /// Description in one sentence.
    pub doc: &'static str,
    /// Hands each test case to the visitor.
    pub cases: fn(&mut Visitor<'_>),
    /// True if the model is the same with the two directions exchanged.
    pub is_reciprocal: bool,
    /// True if it never reflects more light than it gets.
    pub conserves: bool,
}

impl Model {
    /// A model that keeps to all laws.
    pub(super) const fn new(name: &'static str, doc: &'static str, cases: fn(&mut Visitor<'_>)) -> Self {
        Self { name, doc, cases, is_reciprocal: true, conserves: true }
    }

    /// Marks the model as not reciprocal: with the two directions exchanged it is another one.
    pub(super) const fn not_reciprocal(mut self) -> Self {
        self.is_reciprocal = false;
        self
    }

    /// Marks the model as one that may reflect more light than it gets.
    pub(super) const fn gains_energy(mut self) -> Self {
        self.conserves = false;
        self
    }
}

/// A value of a model that the laws of scattering are checked on.
pub struct Case<'a> {
    /// Label: the special feature of the case.
    pub label: &'static str,
    /// The value.
    pub bsdf: Bsdf<'a>,
    /// True if it neither absorbs nor loses light, so that it is invisible in a white furnace.
    pub lossless: bool,
}

/// Callback for each case.
pub type Visitor<'v> = dyn FnMut(Case<'_>) + 'v;

/// Most colours, and most numbers, that a recipe takes.
pub const MOST_INPUTS: usize = 4;

/// Values of a model's parameters at a point. Those of a type are in the order in which the schema has them.
#[derive(Clone, Copy, Debug)]
pub struct Inputs {
    /// Reflectances, in [0, 1].
    pub colors: [Spectrum; MOST_INPUTS],
    /// Numbers.
    pub numbers: [f32; MOST_INPUTS],
    /// Which of the words its `form` or the like is, from zero.
    pub choice: u32,
    /// A vector.
    pub vector: Vec3,
}

/// Recipe that makes a model from the values of its parameters, if it takes nothing else.
#[derive(Clone, Copy, Debug)]
pub struct Recipe {
    /// The kind of material that it is in descriptions.
    pub kind: &'static str,
    /// True if the orientation of the tangent matters.
    pub is_anisotropic: bool,
    /// True for plates that light goes straight through, with another polarisation.
    pub polarizes: bool,
    /// Makes it.
    pub make: fn(&Inputs) -> Bsdf<'static>,
}

impl Recipe {
    pub(super) const fn new(kind: &'static str, make: fn(&Inputs) -> Bsdf<'static>) -> Self {
        Self { kind, is_anisotropic: false, polarizes: false, make }
    }

    /// Marks the recipe as one of an anisotropic model, for which the orientation of the tangent matters.
    pub(super) const fn anisotropic(mut self) -> Self {
        self.is_anisotropic = true;
        self
    }

    /// Marks the recipe as one of a plate that acts on polarisation.
    pub(super) const fn polarizing(mut self) -> Self {
        self.polarizes = true;
        self
    }
}

/// Colours of cases.
pub(super) const GREY: Spectrum = Spectrum::new([0.2, 0.5, 0.8, 0.4]);
pub(super) const WHITE: Spectrum = Spectrum::ONE;
pub(super) const BLACK: Spectrum = Spectrum::ZERO;

/// Both parts of the index of gold, of cases.
pub(super) fn gold() -> (Spectrum, Spectrum) {
    (Spectrum::new([0.18, 0.42, 1.37, 0.37]), Spectrum::new([3.1, 2.35, 1.77, 2.82]))
}
