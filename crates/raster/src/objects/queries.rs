//! Queries: counts of what draws did, times, and rendering on condition of them (OpenGL 4.6 core, sections 4.2, 4.3,
//! 10.9, 13.4 and 17.3.5).
//!
//! Commands are complete when their calls return, so results are there as soon as a query has ended.

use std::{collections::BTreeMap, time::Instant};

use super::{
    context::{BufferRef, Context},
    error::{invalid_enum, invalid_operation, invalid_value},
    names::{Names, Object, written},
};
use crate::{counters::Counters, error::Result};

/// Quantities that queries measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum QueryTarget {
    /// Samples that passed all tests.
    SamplesPassed,
    /// 1 if any sample passed, else 0.
    AnySamplesPassed,
    /// As `AnySamplesPassed`; OpenGL allows 1 where no sample passed, which does not happen here.
    AnySamplesPassedConservative,
    /// Primitives that the last stage before the rasteriser gave.
    PrimitivesGenerated,
    /// Primitives that transform feedback wrote: those that found room in the buffer.
    TransformFeedbackPrimitivesWritten,
    /// Nanoseconds between begin and end.
    TimeElapsed,
    /// Nanoseconds since the context was made; see `query_counter`.
    Timestamp,
}

/// Mode of conditional rendering. Results are always there, so modes differ only in whether they are inverted; regions
/// are the whole picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConditionalMode {
    /// Draws if the result is not 0, and waits for it.
    Wait,
    /// Draws if the result is not 0 or not there yet.
    NoWait,
    /// As `Wait`, by regions of the framebuffer.
    ByRegionWait,
    /// As `NoWait`, by regions of the framebuffer.
    ByRegionNoWait,
    /// Draws if the result is 0, and waits for it.
    WaitInverted,
    /// Draws if the result is 0 or not there yet.
    NoWaitInverted,
    /// As `WaitInverted`, by regions of the framebuffer.
    ByRegionWaitInverted,
    /// As `NoWaitInverted`, by regions of the framebuffer.
    ByRegionNoWaitInverted,
}

/// A query: its target, and the result so far.
#[derive(Debug)]
pub(super) struct Query {
    target: QueryTarget,
    is_active: bool,
    result: u64,
}

impl Query {
    pub fn new(target: QueryTarget) -> Self {
        Self { target, is_active: false, result: 0 }
    }
}

/// Queries of a context.
#[derive(Debug)]
pub(super) struct Queries {
    pub names: Names<Query>,
    /// The active query of each target.
    active: BTreeMap<QueryTarget, Object<Query>>,
    /// Within conditional rendering: true if commands are dropped.
    condition: Option<bool>,
    /// Zero of the timestamps.
    start: Instant,
}

impl Queries {
    pub fn new() -> Self {
        Self { names: Names::new("query"), active: BTreeMap::new(), condition: None, start: Instant::now() }
    }

    /// True if conditional rendering drops commands.
    pub fn drops(&self) -> bool {
        self.condition == Some(true)
    }

    /// Adds what a draw did to the active queries.
    pub fn count(&self, counters: &Counters, written: u64) {
        for query in self.active.values() {
            let mut query = query.borrow_mut();
            let passed = counters.samples_passed;
            match query.target {
                QueryTarget::SamplesPassed => query.result += passed,
                QueryTarget::AnySamplesPassed | QueryTarget::AnySamplesPassedConservative => {
                    query.result |= u64::from(passed > 0);
                }
                QueryTarget::PrimitivesGenerated => query.result += counters.primitives,
                QueryTarget::TransformFeedbackPrimitivesWritten => query.result += written,
                QueryTarget::TimeElapsed | QueryTarget::Timestamp => {}
            }
        }
    }

    /// Nanoseconds since the context was made.
    fn now(&self) -> u64 {
        u64::try_from(self.start.elapsed().as_nanos()).unwrap_or(u64::MAX)
    }

    /// The query of a name that begins or takes a timestamp; it gets its object and its target at the first time.
    fn first_use(&mut self, target: QueryTarget, name: u32, call: &'static str) -> Result<Object<Query>> {
        let query = self.names.first_use(name, call, || Query::new(target))?;
        let Query { target: own, is_active, .. } = *query.borrow();
        if is_active {
            return invalid_operation(call, format_args!("query {name} is active"));
        }
        if own != target {
            return invalid_operation(call, format_args!("query {name} is of {own:?}, not of {target:?}"));
        }
        Ok(query)
    }
}

impl Context {
    /// Begins to count into a query (section 4.2.2). Queries of several targets may be active together, one of each.
    ///
    /// # Errors
    /// For names that were not generated, a query that is active or of another target, a target that has an active
    /// query, and `Timestamp`.
    pub fn begin_query(&mut self, target: QueryTarget, name: u32) -> Result<()> {
        const CALL: &str = "begin_query";
        if target == QueryTarget::Timestamp {
            return invalid_enum(CALL, "timestamps are taken by query_counter");
        }
        if self.queries.active.contains_key(&target) {
            return invalid_operation(CALL, format_args!("a query of {target:?} is active"));
        }
        let query = self.queries.first_use(target, name, CALL)?;
        // A timer holds the time of its begin until its end.
        let result = if target == QueryTarget::TimeElapsed { self.queries.now() } else { 0 };
        *query.borrow_mut() = Query { target, is_active: true, result };
        self.queries.active.insert(target, query);
        Ok(())
    }

    /// Ends the active query of a target.
    ///
    /// # Errors
    /// An error without an active query of the target.
    pub fn end_query(&mut self, target: QueryTarget) -> Result<()> {
        let Some(query) = self.queries.active.remove(&target) else {
            return invalid_operation("end_query", format_args!("no query of {target:?} is active"));
        };
        let mut query = query.borrow_mut();
        query.is_active = false;
        if target == QueryTarget::TimeElapsed {
            query.result = self.queries.now().saturating_sub(query.result);
        }
        Ok(())
    }

    /// Takes the time into a query of `Timestamp` (section 4.3): nanoseconds since the context was made. Times never
    /// decrease.
    ///
    /// # Errors
    /// For names that were not generated, and queries of other targets.
    pub fn query_counter(&mut self, name: u32) -> Result<()> {
        let query = self.queries.first_use(QueryTarget::Timestamp, name, "query_counter")?;
        query.borrow_mut().result = self.queries.now();
        Ok(())
    }

    /// Result of a query (section 4.2.3); it is always available.
    ///
    /// # Errors
    /// For names without objects, and queries that are active.
    pub fn get_query_object(&self, name: u32) -> Result<u64> {
        self.query_result(name, "get_query_object")
    }

    /// Writes the result of a query to a buffer, as 64 bits from the lowest byte on.
    ///
    /// # Errors
    /// For names without objects, queries that are active, offsets beyond the end or not multiples of 8, and a buffer
    /// that is mapped but not persistently.
    pub fn get_query_buffer_object(&self, name: u32, buffer: impl Into<BufferRef>, offset: usize) -> Result<()> {
        const CALL: &str = "get_query_buffer_object";
        let result = self.query_result(name, CALL)?;
        let buffer = self.buffer(buffer, CALL)?;
        if !offset.is_multiple_of(8) {
            return invalid_value(CALL, format_args!("offset {offset} is no multiple of 8"));
        }
        written(&buffer, CALL)?.write(offset, 8, CALL)?.copy_from_slice(&result.to_le_bytes());
        Ok(())
    }

    fn query_result(&self, name: u32, call: &'static str) -> Result<u64> {
        let query = self.queries.names.object(name, call)?;
        let query = query.borrow();
        if query.is_active {
            return invalid_operation(call, format_args!("query {name} is active"));
        }
        Ok(query.result)
    }

    /// Begins to draw and clear only on condition of a query of samples (section 10.9).
    ///
    /// # Errors
    /// Within conditional rendering, for names without objects, queries that are active, and those of other targets.
    pub fn begin_conditional_render(&mut self, name: u32, mode: ConditionalMode) -> Result<()> {
        const CALL: &str = "begin_conditional_render";
        if self.queries.condition.is_some() {
            return invalid_operation(CALL, "conditional rendering has begun already");
        }
        let Ok(query) = self.queries.names.object(name, CALL) else {
            return invalid_value(CALL, format_args!("{name} is not a name of a query"));
        };
        let Query { target, is_active, result } = *query.borrow();
        let counts_samples = matches!(
            target,
            QueryTarget::SamplesPassed | QueryTarget::AnySamplesPassed | QueryTarget::AnySamplesPassedConservative
        );
        if is_active || !counts_samples {
            let state = if is_active { "active" } else { "not of samples" };
            return invalid_operation(CALL, format_args!("query {name} of {target:?} is {state}"));
        }
        let is_inverted = matches!(
            mode,
            ConditionalMode::WaitInverted
                | ConditionalMode::NoWaitInverted
                | ConditionalMode::ByRegionWaitInverted
                | ConditionalMode::ByRegionNoWaitInverted
        );
        self.queries.condition = Some((result == 0) != is_inverted);
        Ok(())
    }

    /// Ends conditional rendering.
    ///
    /// # Errors
    /// Outside of conditional rendering.
    pub fn end_conditional_render(&mut self) -> Result<()> {
        match self.queries.condition.take() {
            Some(_) => Ok(()),
            None => invalid_operation("end_conditional_render", "conditional rendering has not begun"),
        }
    }
}
