//! The numbers of a chain's proposal in primary sample space, with lazy evaluation (Kelemen et al. 2002).
//!
//! Each number is a function of what it is for: decisions of the camera subpath, of the light subpath, and of their
//! connection have coordinates of their own, so that none changes its meaning with the length of another.

use super::MUTATIONS;
use crate::passes::subpath::Numbers;
use std::{cell::RefCell, collections::HashMap};
use steradian_math::{
    Vec2,
    hash::{HashRng, ONE_MINUS_EPSILON},
};

/// The range of small changes.
const SMALLEST: f32 = 1.0 / 1024.0;
const LARGEST: f32 = 1.0 / 64.0;
/// The coordinate that chooses a technique: beyond all dimensions.
const TECHNIQUE: u32 = u32::MAX;

/// A coordinate of a sample: its value, and the mutation after which it has it.
#[derive(Clone, Copy)]
struct Coordinate {
    value: f32,
    time: u64,
}

/// The random numbers of a chain's proposal, made when they are asked for.
struct State {
    rng: HashRng,
    coordinates: HashMap<u32, Coordinate>,
    /// Coordinates before the proposal, for rejection.
    before: Vec<(u32, Option<Coordinate>)>,
    time: u64,
    last_large: u64,
    is_large: bool,
}

/// A chain's point of primary sample space, and its proposal.
pub(super) struct Proposal(RefCell<State>);

impl Proposal {
    /// Independent numbers.
    pub fn new(seed: u64) -> Self {
        Self(RefCell::new(State {
            rng: HashRng::new(seed),
            coordinates: HashMap::new(),
            before: Vec::new(),
            time: 0,
            last_large: 0,
            is_large: true,
        }))
    }

    /// Begins a mutation.
    pub fn mutate(&self, is_large: bool) {
        let s = &mut *self.0.borrow_mut();
        s.time += 1;
        s.is_large = is_large;
        s.before.clear();
    }

    /// The proposal becomes the state.
    pub fn accept(&self) {
        let s = &mut *self.0.borrow_mut();
        // An accepted large step has drawn all coordinates anew.
        if s.is_large {
            s.last_large = s.time;
        }
    }

    /// The state stays.
    pub fn reject(&self) {
        let s = &mut *self.0.borrow_mut();
        // Rejected: coordinates go back to what they were before the proposal.
        s.time -= 1;
        while let Some((key, was)) = s.before.pop() {
            match was {
                Some(c) => s.coordinates.insert(key, c),
                None => s.coordinates.remove(&key),
            };
        }
    }

    /// A number that is no coordinate.
    pub fn uniform(&self) -> f32 {
        self.0.borrow_mut().rng.next_f32()
    }

    /// Draws all further numbers from another seed.
    pub fn reseed(&self, seed: u64) {
        self.0.borrow_mut().rng = HashRng::new(seed);
    }

    /// One of `count` techniques.
    pub fn technique(&self, count: u32) -> u32 {
        ((f64::from(self.get(TECHNIQUE)) * f64::from(count)) as u32).min(count - 1)
    }

    /// Puts the coordinate of techniques at a point drawn from those of one of `count`.
    pub fn set_technique(&self, technique: u32, count: u32) {
        let s = &mut *self.0.borrow_mut();
        let value = ((f64::from(technique) + f64::from(s.rng.next_f32())) / f64::from(count)) as f32;
        s.coordinates.insert(TECHNIQUE, Coordinate { value: value.min(ONE_MINUS_EPSILON), time: s.time });
    }

    fn get(&self, key: u32) -> f32 {
        let s = &mut *self.0.borrow_mut();
        // Lazy evaluation (Kelemen et al. 2002): a coordinate is brought up to date only when it is asked for.
        let was = s.coordinates.get(&key).copied();
        if let Some(c) = was.filter(|c| c.time == s.time) {
            return c.value;
        }
        // Coordinates that were not asked for since the last large step have been drawn anew by it.
        let mut c = match was {
            Some(c) if c.time >= s.last_large => c,
            _ => Coordinate { value: s.rng.next_f32(), time: s.last_large },
        };
        if s.is_large {
            c.value = s.rng.next_f32();
        } else {
            // Small steps that it did not take part in, all at once: in truth one for each, which only this many are
            // made of.
            for _ in 0..(s.time - c.time).min(MUTATIONS as u64) {
                c.value = perturbed(c.value, s.rng.next_f32());
            }
        }
        c.time = s.time;
        s.before.push((key, was));
        s.coordinates.insert(key, c);
        c.value
    }
}

/// A small change of a number, exponentially distributed, around the unit interval.
fn perturbed(value: f32, u: f32) -> f32 {
    // s₂ exp(−ln(s₂/s₁) u) in either direction, wrapped around [0, 1).
    let (u, sign) = if u < 0.5 { (2.0 * u, 1.0) } else { (2.0 * u - 1.0, -1.0) };
    let step = LARGEST * (-(LARGEST / SMALLEST).ln() * u).exp();
    let v = value + sign * step;
    (v - v.floor()).min(ONE_MINUS_EPSILON)
}

impl Numbers for Proposal {
    fn one(&self, dimension: u32) -> f32 {
        self.get(2 * dimension)
    }

    fn two(&self, dimension: u32) -> Vec2 {
        Vec2::new(self.get(2 * dimension), self.get(2 * dimension + 1))
    }
}
