//! A pipeline: shaders and state that fit each other and a framebuffer's formats.
//!
//! A draw goes in batches of jobs of 1024 primitives. A thread runs the stages of a job (`front`), clips and projects
//! the result (`primitive`) and lists it by tile. Then each tile of 64² pixels is drawn by one thread, its primitives
//! in order (`tile`), so that bits do not depend on threads.

use std::ops::Range;

use rayon::prelude::*;

use crate::{
    counters::Counters,
    draw::Draw,
    error::{Result, refuse},
    front::{Capture, Front, Sink, Source},
    output::{Class, DepthOutput, FragmentOutput},
    primitive::{Chunk, Setup, Window},
    render_target::{Extent, Framebuffer, Layout, Tile},
    stages::{FragmentShader, GeometryShader, Program, Tessellation, Vertex, VertexShader},
    state::{Compare, Multisample, PolygonMode, State, Topology},
    tile::{ColorPlan, DepthPlan, HiddenBy, Plan, TileDrawer},
    varyings::{Mode, Varyings, any_per_sample},
};

/// The most clip and cull distances.
const MAX_DISTANCES: usize = 8;
/// Primitives of a job: a job is worked on by one thread.
const JOB: u64 = 1024;
/// Jobs whose primitives are kept before tiles are drawn.
const BATCH: u64 = 16;

/// Shaders and state, checked. What can be wrong with them is found when it is made; a draw only checks that the
/// framebuffer fits.
#[derive(Clone, Debug)]
pub struct Pipeline<V, T, G, F> {
    /// The shaders. Their fields (uniforms, textures) may be changed between draws.
    pub program: Program<V, T, G, F>,
    state: State,
    layout: Layout,
    plan: Plan,
}

impl<V, T, G, F> Pipeline<V, T, G, F>
where
    V: VertexShader,
    T: Tessellation<Input = V::Varyings>,
    G: GeometryShader<Input = T::Output>,
    F: FragmentShader<Varyings = G::Output>,
{
    /// A pipeline that draws to framebuffers of this layout.
    ///
    /// # Errors
    /// Where the state breaks a rule, or shaders, state and layout do not fit; the message names which.
    pub fn new(program: Program<V, T, G, F>, state: State, layout: Layout) -> Result<Self> {
        // Validate once, here, so that a draw has nothing left to refuse but the framebuffer.
        state.check()?;
        check_stages::<T, G, F>(&state)?;
        let state = checked_targets::<F>(state, &layout)?;
        let plan = plan::<F>(&state, &layout);
        Ok(Self { program, state, layout, plan })
    }

    /// Its state.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Draws. The result does not depend on the number of threads (those of the rayon pool it is called in).
    ///
    /// # Errors
    /// Where the framebuffer does not have the layout of the pipeline.
    pub fn draw(&self, framebuffer: &mut Framebuffer, draw: &Draw) -> Result<Counters> {
        check_layout(framebuffer, &self.layout, "Pipeline::draw")?;
        let source = self.source(draw);
        let window = Window::new(&self.state, framebuffer.extent(), self.layout.depth);
        let total = source.primitives();
        let job = self.job_size();
        let mut tiles = framebuffer.tiles();
        let mut counters = Counters::default();
        // Sort-middle (Molnar et al., "A Sorting Classification of Parallel Rendering", 1994): batches of jobs are set
        // up in parallel, then tiles are drawn in parallel.
        let mut start = 0;
        while start < total {
            // A batch bounds the memory of primitives that wait for tiles.
            let end = start.saturating_add(job * BATCH).min(total);
            let jobs = (end - start).div_ceil(job);
            // Jobs keep their order in the list, whichever thread runs them.
            let run = |i: u64| self.job(&source, &window, start + i * job..(start + (i + 1) * job).min(end));
            let chunks: Vec<Chunk> =
                if jobs == 1 { vec![run(0)] } else { (0..jobs).into_par_iter().map(run).collect() };
            chunks.iter().for_each(|chunk| counters += chunk.counters);
            counters += draw_tiles(&self.program.fragment, &self.state, &self.plan, &window, &mut tiles, &chunks);
            start = end;
        }
        Ok(counters)
    }

    /// Number of primitives that each tile of 64² pixels of a framebuffer of this size would list, layer by layer and
    /// row by row. Nothing is drawn.
    pub fn tile_counts(&self, extent: Extent, draw: &Draw) -> Vec<u64> {
        let source = self.source(draw);
        let window = Window::new(&self.state, extent, self.layout.depth);
        let (total, job) = (source.primitives(), self.job_size());
        // Set up and bin all jobs, and count the entries of each tile.
        let of_job = |i: u64| {
            let chunk = self.job(&source, &window, i * job..((i + 1) * job).min(total));
            chunk.starts.windows(2).map(|w| u64::from(w[1]) - u64::from(w[0])).collect::<Vec<_>>()
        };
        let add = |mut a: Vec<u64>, b: Vec<u64>| {
            a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
            a
        };
        (0..total.div_ceil(job)).into_par_iter().map(of_job).reduce(|| vec![0; extent.tiles()], add)
    }

    /// Draws several, one after the other; [`VertexInput::draw`](crate::VertexInput::draw) counts them.
    ///
    /// # Errors
    /// As [`draw`](Self::draw).
    pub fn draw_many(&self, framebuffer: &mut Framebuffer, draws: &[Draw]) -> Result<Counters> {
        let mut counters = Counters::default();
        for (number, draw) in draws.iter().enumerate() {
            counters += self.draw(framebuffer, &draw.numbered(number as u32))?;
        }
        Ok(counters)
    }

    /// Transform feedback: the vertices that the last stage before the rasteriser gives, one after the other for each
    /// primitive, strips taken apart. Nothing is drawn.
    pub fn capture(&self, draw: &Draw) -> (Vec<Vertex<G::Output>>, Counters) {
        let source = self.source(draw);
        let total = source.primitives();
        let job = self.job_size();
        // Run the front end of every job into a buffer of its own, then join them in order.
        let run = |i: u64| {
            let mut sink = Capture::default();
            let mut counters = Counters::default();
            self.front().run(&source, i * job..((i + 1) * job).min(total), &mut counters, &mut sink);
            counters.primitives = sink.primitives;
            (sink.vertices, counters)
        };
        // Join the captured vertices in the order of jobs.
        let parts: Vec<_> = (0..total.div_ceil(job)).into_par_iter().map(run).collect();
        let mut all = Vec::with_capacity(parts.iter().map(|(vertices, _)| vertices.len()).sum());
        let mut counters = Counters::default();
        for (vertices, part) in parts {
            all.extend(vertices);
            counters += part;
        }
        (all, counters)
    }

    fn job_size(&self) -> u64 {
        // Jobs of stages that multiply primitives take fewer of them.
        match self.state.topology {
            Topology::Patches(_) => 16,
            _ if G::ACTIVE => 256,
            _ => JOB,
        }
    }

    fn source<'d>(&self, draw: &Draw<'d>) -> Source<'d> {
        Source::new(draw.stream, self.state.topology, self.state.restart, draw.instances.clone(), draw.number)
    }

    fn front(&self) -> Front<'_, V, T, G> {
        Front {
            vertex: &self.program.vertex,
            tessellation: &self.program.tessellation,
            geometry: &self.program.geometry,
            topology: self.state.topology,
            provoking: self.state.provoking,
        }
    }

    fn job(&self, source: &Source, window: &Window, numbers: Range<u64>) -> Chunk {
        let mut setup = Setup::<G::Output>::new(window);
        let mut counters = Counters::default();
        // Vertices, patches and geometry shaders run here; primitives go straight to set-up.
        self.front().run(source, numbers, &mut counters, &mut setup);
        let mut chunk = setup.finish();
        chunk.counters += counters;
        chunk
    }
}

impl<V: Varyings> Sink<V> for Setup<'_, V> {
    #[inline]
    fn point(&mut self, vertex: &Vertex<V>, id: u32) {
        Setup::point(self, vertex, id);
    }
    #[inline]
    fn line(&mut self, ends: [&Vertex<V>; 2], provoking: usize, id: u32) {
        Setup::line(self, ends, provoking, id);
    }
    #[inline]
    fn triangle(&mut self, corners: [&Vertex<V>; 3], provoking: usize, id: u32) {
        Setup::triangle(self, corners, provoking, id);
    }
}

/// Draws the primitives of all chunks, in their order, into the tiles that they touch.
pub(crate) fn draw_tiles<F: FragmentShader>(
    fragment: &F,
    state: &State,
    plan: &Plan,
    window: &Window,
    tiles: &mut [Tile],
    chunks: &[Chunk],
) -> Counters {
    // Tiles that nothing touches are not visited.
    let touched = |number: usize| chunks.iter().any(|c| c.starts[number] != c.starts[number + 1]);
    let draw_tile = |(number, tile): (usize, &mut Tile)| {
        let mut drawer = TileDrawer::new(fragment, state, plan, &window.pattern);
        if touched(number) {
            drawer.draw(tile, number, chunks);
        }
        drawer.counters
    };
    // Each tile belongs to one thread: its pixels need no locks.
    let drawn: Vec<Counters> = tiles.par_iter_mut().enumerate().map(draw_tile).collect();
    drawn.into_iter().fold(Counters::default(), |mut all, of_tile| {
        all += of_tile;
        all
    })
}

/// Checks that a framebuffer has the layout that a pipeline was made for.
pub(crate) fn check_layout(framebuffer: &Framebuffer, want: &Layout, call: &'static str) -> Result<()> {
    let have = framebuffer.layout();
    if have != *want {
        return refuse(call, format!("the framebuffer has {have:?}, the pipeline was made for {want:?}"));
    }
    Ok(())
}

/// Checks that shaders and topology agree.
fn check_stages<T: Tessellation, G: GeometryShader, F: FragmentShader>(state: &State) -> Result<()> {
    const CALL: &str = "Pipeline::new";
    let patches = matches!(state.topology, Topology::Patches(_));
    if T::ACTIVE && !patches {
        return refuse(CALL, format!("tessellation needs patches, not {:?}", state.topology));
    }
    if !T::ACTIVE && patches {
        return refuse(CALL, "patches need tessellation");
    }
    if G::ACTIVE && (G::MAX_VERTICES == 0 || G::MAX_VERTICES > 4096) {
        return refuse(CALL, format!("MAX_VERTICES of the geometry shader is {}; from 1 to 4096", G::MAX_VERTICES));
    }
    if G::ACTIVE && (G::INVOCATIONS == 0 || G::INVOCATIONS > 128) {
        return refuse(CALL, format!("INVOCATIONS of the geometry shader is {}; from 1 to 128", G::INVOCATIONS));
    }
    check_distances::<F::Varyings>()
}

/// Checks the number of clip and cull distances.
pub(crate) fn check_distances<V: Varyings>() -> Result<()> {
    let distances = V::MODES.iter().filter(|mode| matches!(mode, Mode::Clip | Mode::Cull)).count();
    if distances > MAX_DISTANCES {
        return refuse("Pipeline::new", format!("{distances} clip and cull distances; at most {MAX_DISTANCES}"));
    }
    Ok(())
}

/// Checks that state and framebuffer agree; returns the state with its samples and colour states filled in.
pub(crate) fn checked_targets<F: FragmentShader>(mut state: State, layout: &Layout) -> Result<State> {
    const CALL: &str = "Pipeline::new";
    Multisample::check(layout.samples, CALL)?;
    if state.multisample.count != layout.samples {
        let (state, layout) = (state.multisample.count, layout.samples);
        return refuse(CALL, format!("{state} samples in the state, {layout} in the framebuffer"));
    }
    if state.depth.is_some() && layout.depth.is_none() {
        return refuse(CALL, "the depth test needs a depth target");
    }
    if state.stencil.is_some() && !layout.stencil {
        return refuse(CALL, "the stencil test needs a stencil target");
    }
    if F::Output::COLORS > layout.colors.len() {
        let (colors, targets) = (F::Output::COLORS, layout.colors.len());
        return refuse(CALL, format!("the fragment shader writes {colors} colours, the framebuffer has {targets}"));
    }
    // Without colour state of their own, targets take the default.
    state.color.resize(layout.colors.len().max(state.color.len()), Default::default());
    for (i, format) in layout.colors.iter().enumerate().take(F::Output::COLORS) {
        // The class of the output must be the target's: integers are never converted.
        if format.class() != F::Output::CLASS {
            let class = F::Output::CLASS;
            return refuse(CALL, format!("the fragment shader writes {class:?}, target {i} is {format:?}"));
        }
        let Some(blend) = state.color[i].blend else { continue };
        if !format.is_blendable() {
            return refuse(CALL, format!("target {i} is {format:?}, which cannot be blended"));
        }
        if blend.is_dual() && !F::Output::DUAL {
            return refuse(
                CALL,
                format!("the blend factors of target {i} ask for a second colour, and the shader has none"),
            );
        }
    }
    if state.multisample.alpha_to_coverage && (F::Output::COLORS == 0 || F::Output::CLASS != Class::Float) {
        return refuse(CALL, "alpha to coverage needs a colour with alpha");
    }
    if state.raster.conservative != crate::state::Conservative::Off && state.raster.polygon_mode != PolygonMode::Fill {
        return refuse(CALL, "conservative rasterisation is for filled triangles");
    }
    Ok(state)
}

/// Plan of the tests and writes between the fragment shader and the targets.
pub(crate) fn plan<F: FragmentShader>(state: &State, layout: &Layout) -> Plan {
    let shader_depth = F::Output::DEPTH != DepthOutput::None && !F::EARLY_TESTS;
    let may_vanish = F::Output::DISCARDS || F::Output::MASK || state.multisample.alpha_to_coverage;
    // Tests may precede the shader only if it neither sets depth nor drops samples.
    let early = F::EARLY_TESTS || (!shader_depth && !may_vanish);
    // Hierarchical depth holds as long as the shader cannot move depths to the visible side.
    let hidden_by = match state.depth {
        Some(depth) if state.stencil.is_none() => {
            // Declared conservative depth keeps that order.
            let keeps_order = match depth.compare {
                Compare::Less | Compare::LessEqual => F::Output::DEPTH == DepthOutput::Greater,
                Compare::Greater | Compare::GreaterEqual => F::Output::DEPTH == DepthOutput::Less,
                _ => false,
            };
            if !shader_depth || keeps_order { HiddenBy::Depth(depth.compare) } else { HiddenBy::Nothing }
        }
        _ => HiddenBy::Nothing,
    };
    let mut colors = std::array::from_fn(|_| None);
    for (i, format) in layout.colors.iter().enumerate() {
        colors[i] = Some(ColorPlan::new(*format, state.color[i], state.logic_op, state.blend_constant));
    }
    Plan {
        early,
        hidden_by,
        per_sample: layout.samples > 1 && (F::PER_SAMPLE || any_per_sample(F::Varyings::MODES)),
        shader_depth,
        depth: state.depth.zip(layout.depth).map(|(depth, format)| DepthPlan::new(depth, format)),
        colors,
    }
}
