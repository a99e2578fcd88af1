//! A render in chunks that machines compute apart: `plan` writes a job, `chunk` computes a part of it, and `merge` puts
//! the parts together to the bits of one run.

pub mod chunk;
pub mod job_file;
pub mod merge;
pub mod plan;
