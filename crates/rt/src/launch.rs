//! Launches (DXR, "DispatchRays"; Vulkan, `vkCmdTraceRaysKHR`): a ray-generation shader for each launch id, on all
//! threads.

use crate::context::{Frame, LaunchValues, RayGenerationContext, Thread};
use crate::error::{Fault, LaunchError};
use crate::event::{Event, Stage};
use crate::group::HitGroup;
use crate::interface::Interface;
use crate::pipeline::{Export, Pipeline};
use crate::stages::{Callable, Miss, RayGeneration};
use crate::table::{Record, ShaderTables};
use crate::trace::Running;
use rayon::prelude::*;

/// Most launch ids (DXR, "DispatchRays": 2^30).
pub const MAX_LAUNCH_IDS: u64 = 1 << 30;
/// Width and height of a tile.
const TILE: usize = 8;

impl<I: Interface, R: RayGeneration<I>, H: HitGroup<I>, M: Miss<I>, C: Callable<I>> Pipeline<I, R, H, M, C> {
    /// Runs the ray-generation shader for each launch id below `size`, in tiles on all threads of rayon's current pool,
    /// and gives what they have made: x counts fastest, then y, then z. The result does not depend on the number of
    /// threads where shaders depend on their arguments alone.
    ///
    /// # Errors
    /// The fault of the smallest launch id that has one; a record with a handle of another pipeline; more than
    /// [`MAX_LAUNCH_IDS`], or than there is memory for.
    pub fn launch(&self, tables: &ShaderTables<I::Local>, size: [u32; 3]) -> Result<Vec<I::Output>, LaunchError> {
        self.check(tables)?;
        let count = size.iter().map(|&n| u128::from(n)).product::<u128>();
        let limit = MAX_LAUNCH_IDS;
        if count > limit.into() {
            return Err(LaunchError::TooLarge { size, count, limit });
        }
        let count = count as usize;
        let mut output = Vec::new();
        output.try_reserve_exact(count).map_err(|_| LaunchError::NoMemory { count: count as u64 })?;
        output.resize_with(count, I::Output::default);
        let Some(handle) = tables.ray_generation.handle.filter(|_| count > 0) else { return Ok(output) };
        let Some(export) = self.library.ray_generation.get(handle.index as usize) else { return Ok(output) };
        let [width, height, _] = size.map(|n| n as usize);
        let running = Running { pipeline: self, tables };
        // Layers by strips; a strip has rows of one layer.
        let first_fault = output
            .par_chunks_mut(width * height)
            .enumerate()
            .flat_map(|(z, layer)| {
                layer.par_chunks_mut(width * TILE).enumerate().map(move |(strip, rows)| (z, strip, rows))
            })
            .filter_map(|(z, strip, rows)| running.strip(export, size, [strip * TILE, z], rows).err())
            .min_by_key(|([x, y, z], _)| (*z, *y, *x));
        match first_fault {
            None => Ok(output),
            Some((launch_id, fault)) => Err(LaunchError::Fault { launch_id, fault }),
        }
    }

    /// Checks that all handles in the tables are of this pipeline.
    pub(crate) fn check(&self, tables: &ShaderTables<I::Local>) -> Result<(), LaunchError> {
        fn foreign<K, L>(pipeline: u64, records: &[Record<K, L>]) -> Option<usize> {
            records.iter().position(|record| record.handle.is_some_and(|handle| handle.pipeline != pipeline))
        }
        let ShaderTables { ray_generation, miss, hit_groups, callable } = tables;
        let found = [
            ("ray-generation", foreign(self.number, std::slice::from_ref(ray_generation))),
            ("miss", foreign(self.number, &miss.records)),
            ("hit-group", foreign(self.number, &hit_groups.records)),
            ("callable", foreign(self.number, &callable.records)),
        ];
        let found = found.into_iter().find_map(|(table, place)| Some((table, place?)));
        found.map_or(Ok(()), |(table, place)| Err(LaunchError::ForeignHandle { table, place }))
    }
}

impl<I: Interface, R, H, M, C> Running<'_, I, R, H, M, C>
where
    R: RayGeneration<I>,
    H: HitGroup<I>,
    M: Miss<I>,
    C: Callable<I>,
{
    /// Runs the shader for one launch id.
    #[inline]
    pub fn launch_id(&self, export: &Export<R>, thread: &Thread, launch: &LaunchValues) -> Result<I::Output, Fault> {
        let frame = Frame { machine: self, thread, launch, depth: 0, calls: 0, stack: 0 };
        let made = self.deeper(&frame, export.stack).and_then(|frame| {
            if let Some(journal) = &thread.journal {
                journal.note(0, Event::Shader { stage: Stage::RayGeneration, name: export.name.clone() });
            }
            let local = &self.tables.ray_generation.local;
            export.shader.run(&mut RayGenerationContext { frame, local })
        });
        thread.fault.replace(None).map_or(made, |fault| Err(*fault))
    }

    /// Runs the shader for some rows of a layer, tile by tile.
    fn strip(
        &self,
        export: &Export<R>,
        size: [u32; 3],
        [first_row, z]: [usize; 2],
        rows: &mut [I::Output],
    ) -> Result<(), ([u32; 3], Fault)> {
        let thread = Thread::default();
        let width = size[0] as usize;
        let mut first: Option<([u32; 3], Fault)> = None;
        for left in (0..width).step_by(TILE) {
            let columns = left..width.min(left + TILE);
            for (y, row) in rows.chunks_mut(width).enumerate() {
                for (x, output) in columns.clone().zip(&mut row[columns.clone()]) {
                    let id = [x as u32, (first_row + y) as u32, z as u32];
                    match self.launch_id(export, &thread, &LaunchValues { id, size }) {
                        Ok(made) => *output = made,
                        Err(fault) if first.as_ref().is_none_or(|([a, b, _], _)| (id[1], id[0]) < (*b, *a)) => {
                            first = Some((id, fault));
                        }
                        Err(_) => {}
                    }
                }
            }
        }
        first.map_or(Ok(()), Err)
    }
}
