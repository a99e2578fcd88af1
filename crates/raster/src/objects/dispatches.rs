//! Dispatches of compute shaders over what is bound (OpenGL 4.6 core, chapter 19).

use super::{
    context::{BufferTarget, Context},
    error::{as_operation, invalid_value},
    inputs::Inputs,
};
use crate::{
    compute::{ComputeShader, dispatch},
    error::{Error, Result},
};

/// Work groups of a dispatch.
#[derive(Clone, Copy, Debug)]
pub struct Groups([u32; 3]);

impl Groups {
    /// Runs a kernel in the groups.
    ///
    /// # Errors
    /// Too many groups or invocations.
    pub fn dispatch<S: ComputeShader>(&self, shader: &S) -> Result<()> {
        dispatch(shader, self.0).or_else(|Error { rule, .. }| invalid_value("Groups::dispatch", rule))
    }
}

impl Context {
    /// Runs a compute shader in so many groups. The closure makes the kernel over what is bound and dispatches it.
    ///
    /// # Errors
    /// For buffers of blocks that are mapped but not persistently, and what the closure returns.
    pub fn dispatch_compute<P>(&mut self, groups: [u32; 3], program: P) -> Result<()>
    where
        P: FnOnce(&Inputs, &Groups) -> Result<()>,
    {
        self.run_groups(groups, "dispatch_compute", program)
    }

    /// Runs a compute shader in as many groups as three words say, from a byte on of the buffer that is bound to
    /// `DispatchIndirect`.
    ///
    /// # Errors
    /// As [`dispatch_compute`](Self::dispatch_compute), without the buffer, for an offset that is no multiple of 4, and
    /// for words beyond the buffer's end.
    pub fn dispatch_compute_indirect<P>(&mut self, offset: usize, program: P) -> Result<()>
    where
        P: FnOnce(&Inputs, &Groups) -> Result<()>,
    {
        const CALL: &str = "dispatch_compute_indirect";
        if !offset.is_multiple_of(4) {
            return invalid_value(CALL, format_args!("offset {offset} is no multiple of 4"));
        }
        let buffer = self.buffer(BufferTarget::DispatchIndirect, CALL)?;
        let bytes = as_operation(buffer.borrow().read(offset, 12, CALL).map(<[u8]>::to_vec))?;
        let word = |i: usize| bytes[4 * i..][..4].iter().rev().fold(0, |word, byte| word << 8 | u32::from(*byte));
        self.run_groups([0, 1, 2].map(word), CALL, program)
    }

    fn run_groups<P>(&mut self, groups: [u32; 3], call: &'static str, program: P) -> Result<()>
    where
        P: FnOnce(&Inputs, &Groups) -> Result<()>,
    {
        if self.queries.drops() {
            return Ok(());
        }
        let gathered = self.gather(false);
        let (done, changes) =
            gathered.with(call, |resources| program(&Inputs::of_dispatch(resources), &Groups(groups)));
        gathered.write_back(changes, call)?;
        done
    }
}
