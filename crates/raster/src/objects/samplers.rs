//! Sampler objects: states of sampling apart from textures (OpenGL 4.6 core, section 8.2).

use super::{
    context::{Context, MAX_UNITS},
    error::invalid_value,
    names::written,
    sampling::{Parameters, TextureParameter, set_sampling},
};
use crate::{
    error::Result,
    texture::{Sampler, TextureKind},
};

/// The state of a sampler at first, which is that of most textures.
fn new() -> Sampler {
    Parameters::new(TextureKind::D2).sampler()
}

impl Context {
    /// Reserves names of samplers.
    ///
    /// # Errors
    /// For more than 2²⁰ names.
    pub fn gen_samplers(&mut self, count: usize) -> Result<Vec<u32>> {
        self.shared.borrow_mut().samplers.generate(count, "gen_samplers")
    }

    /// Makes samplers.
    ///
    /// # Errors
    /// For more than 2²⁰ names.
    pub fn create_samplers(&mut self, count: usize) -> Result<Vec<u32>> {
        self.shared.borrow_mut().samplers.create(count, "create_samplers", new)
    }

    /// Deletes names of samplers. Units of this context that they are bound to have none then; other contexts keep
    /// them.
    pub fn delete_samplers(&mut self, names: &[u32]) {
        for name in names {
            let deleted = self.shared.borrow_mut().samplers.delete(*name);
            if let Some(sampler) = deleted {
                self.samplers.retain(|_, bound| !std::rc::Rc::ptr_eq(bound, &sampler));
            }
        }
    }

    /// True if the name is that of a sampler: not if it is only reserved.
    pub fn is_sampler(&self, name: u32) -> bool {
        self.shared.borrow().samplers.has_object(name)
    }

    /// Binds a sampler to a texture unit, whose textures are looked up with it in the place of their own parameters, or
    /// with 0 none.
    ///
    /// # Errors
    /// For names that were not generated, and units beyond the last (79).
    pub fn bind_sampler(&mut self, unit: u32, name: u32) -> Result<()> {
        const CALL: &str = "bind_sampler";
        if unit >= MAX_UNITS {
            return invalid_value(CALL, format_args!("unit {unit}; there are {MAX_UNITS}"));
        }
        if name == 0 {
            self.samplers.remove(&unit);
            return Ok(());
        }
        let object = self.shared.borrow_mut().samplers.first_use(name, CALL, new)?;
        self.samplers.insert(unit, object);
        Ok(())
    }

    /// Sets a parameter of a sampler.
    ///
    /// # Errors
    /// For names without objects, levels, which belong to textures, and values that are no numbers.
    pub fn sampler_parameter(&self, sampler: u32, parameter: TextureParameter) -> Result<()> {
        const CALL: &str = "sampler_parameter";
        let sampler = self.shared.borrow().samplers.object(sampler, CALL)?;
        set_sampling(&mut *written(&sampler, CALL)?, parameter, CALL)
    }
}
