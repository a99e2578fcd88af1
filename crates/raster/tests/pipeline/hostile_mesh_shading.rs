//! Task and mesh shaders that put out anything: what breaks a rule is refused, all else is drawn, with the same bits
//! for any number of threads.

use std::sync::atomic::{AtomicU64, Ordering};

use steradian_raster::{
    Fragment, Invocation, State, fragment,
    glam::Vec4,
    mesh_shading::{
        Corners, MeshOutput, MeshPipeline, MeshPrimitive, MeshProgram, MeshShader, MeshVertex, TaskOutput, TaskShader,
    },
};

use crate::stage::{Color, Random, fingerprint, framebuffer};

#[derive(Clone, Copy)]
struct Bytes<const N: usize>([u8; N]);

impl<const N: usize> Default for Bytes<N> {
    fn default() -> Self {
        Self([0; N])
    }
}

/// Shaders of a seed: task groups of `SIZE` invocations, payloads of `N` bytes.
struct Wild<'a, C, const SIZE: u32, const N: usize> {
    seed: u64,
    /// One in so many groups breaks a rule.
    good: usize,
    /// Counts broken rules.
    faults: &'a AtomicU64,
    corners: fn(u8, u8, u8) -> C,
}

impl<C, const SIZE: u32, const N: usize> Wild<'_, C, SIZE, N> {
    fn random(&self, stage: u64, [x, y, z]: [u32; 3]) -> Random {
        let mix = [x, y, z].iter().fold(self.seed * 2 + stage, |mix, &i| mix * 0x1_0001 + u64::from(i));
        Random(Random(mix).bits())
    }

    fn fault(&self) {
        self.faults.fetch_add(1, Ordering::Relaxed);
    }
}

impl<C: Corners, const SIZE: u32, const N: usize> TaskShader for Wild<'_, C, SIZE, N> {
    type Payload = Bytes<N>;
    type Shared = ();
    type Private = u8;
    const LOCAL_SIZE: [u32; 3] = [1, SIZE, 1];
    fn shade(&self, _: u32, at: Invocation, _: &mut u8, (): &mut (), out: &mut TaskOutput<Bytes<N>>) {
        let mut random = self.random(0, at.group);
        out.payload.0.fill(random.bits() as u8);
        if random.below(self.good) > 0 {
            // All invocations emit the same, or none does.
            let groups = [(); 3].map(|()| random.below(4) as u32);
            return if random.below(9) > 0 {
                out.emit(groups)
            };
        }
        if at.index > 0 {
            return;
        }
        self.fault();
        match random.below(4) {
            0 => out.emit([1, 65536 + random.below(1 << 31) as u32, random.below(2) as u32]),
            1 => out.emit([2049 + random.below(60_000) as u32, 2048, 1 + random.below(60_000) as u32]),
            2 => out.emit([u32::MAX; 3]),
            _ => (0..2).for_each(|n| out.emit([n, 1, 1])),
        }
    }
}

impl<C: Corners, const SIZE: u32, const N: usize> MeshShader for Wild<'_, C, SIZE, N> {
    type Payload = Bytes<N>;
    type Shared = ();
    type Private = ();
    type Vertex = Vec4;
    type Primitive = f32;
    type Corners = C;
    type Varyings = Color;
    const LOCAL_SIZE: [u32; 3] = [1; 3];
    const MAX_VERTICES: usize = 256;
    const MAX_PRIMITIVES: usize = 200;
    fn shade(
        &self,
        _: u32,
        at: Invocation,
        payload: &Bytes<N>,
        (): &mut (),
        (): &mut (),
        out: &mut MeshOutput<Vec4, f32, C>,
    ) {
        let first = payload.0.first().copied().unwrap_or_default();
        assert!(payload.0.iter().all(|&byte| byte == first));
        let mut random = self.random(u64::from(first) + 1, at.group);
        let vertices = random.below(257);
        let primitives = if vertices == 0 { 0 } else { random.below(201) };
        if random.below(16) == 0 {
            return;
        }
        out.set_counts(vertices, primitives);
        let bad = random.below(self.good) == 0;
        if bad && vertices > 0 && random.below(4) == 0 {
            // What is counted is not all written.
            self.fault();
            return (1..vertices).for_each(|i| out.vertex(i, vertex(&mut random)));
        }
        for i in 0..vertices {
            out.vertex(i, vertex(&mut random));
        }
        for i in 0..primitives {
            let [a, b, c] = [(); 3].map(|()| random.below(vertices) as u8);
            out.primitive(i, primitive((self.corners)(a, b, c), &mut random));
        }
        if bad {
            self.fault();
            self.break_a_rule([vertices, primitives], &mut random, out);
        }
    }

    fn varyings(vertex: &Vec4, primitive: &f32) -> Color {
        Color { color: *vertex * *primitive }
    }
}

impl<C: Corners, const SIZE: u32, const N: usize> Wild<'_, C, SIZE, N> {
    fn break_a_rule(&self, counts: [usize; 2], random: &mut Random, out: &mut MeshOutput<Vec4, f32, C>) {
        let [vertices, primitives] = counts;
        let beyond = [1, 1000, usize::MAX - 256][random.below(3)];
        match random.below(5) {
            0 if primitives > 0 && vertices < 256 => {
                let wrong = vertices as u8;
                out.primitive(random.below(primitives), MeshPrimitive::new((self.corners)(wrong, wrong, wrong), 1.0));
            }
            1 => out.vertex(vertices + beyond - 1, vertex(random)),
            2 => out.primitive(primitives + beyond - 1, primitive((self.corners)(0, 0, 0), random)),
            3 => out.set_counts(vertices + beyond, primitives),
            _ => out.set_counts(vertices, primitives + beyond),
        }
    }
}

fn vertex(random: &mut Random) -> MeshVertex<Vec4> {
    let mut number = || match random.below(24) {
        0 => f32::from_bits(random.bits() as u32),
        1 => [f32::NAN, f32::INFINITY, -f32::INFINITY, f32::MAX, f32::MIN_POSITIVE][random.below(5)],
        _ => random.between(-1.5, 1.5),
    };
    let position = Vec4::from_array([(); 4].map(|()| number()));
    MeshVertex { point_size: number() * 4.0, ..MeshVertex::new(position, Vec4::splat(number())) }
}

fn primitive<C>(corners: C, random: &mut Random) -> MeshPrimitive<f32, C> {
    let few = |random: &mut Random| if random.below(8) == 0 { random.bits() as u32 } else { 0 };
    MeshPrimitive {
        layer: few(random),
        viewport: few(random),
        culled: random.below(5) == 0,
        ..MeshPrimitive::new(corners, random.unit())
    }
}

/// Draws with random shaders on one and three threads; gives how many draws were refused.
fn hunt<C: Corners, const SIZE: u32, const N: usize>(seeds: std::ops::Range<u64>, corners: fn(u8, u8, u8) -> C) -> u64 {
    let mut refused = 0;
    for seed in seeds {
        // Half of the draws break no rule.
        let good = if seed % 2 == 0 { usize::MAX } else { 30 };
        let groups = [0, 1, 2].map(|axis| Random(seed * 3 + axis).below(8).div_ceil(3) as u32);
        let draw = |threads| {
            let faults = AtomicU64::new(0);
            let wild = || Wild::<C, SIZE, N> { seed, good, faults: &faults, corners };
            let mut target = framebuffer(64, 1);
            target.clear(Vec4::ZERO, 1.0, 0);
            let program = MeshProgram::new(wild(), fragment(|f: &Fragment<Color>| f.varyings().color)).task(wild());
            let pipeline = MeshPipeline::new(program, State::default(), target.layout()).unwrap();
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let result = pool.install(|| pipeline.draw(&mut target, groups)).map_err(|error| error.to_string());
            let faults = faults.into_inner();
            assert_eq!(result.is_err(), faults > 0, "seed {seed}: {result:?} after {faults} faults");
            (result, fingerprint(target.color(0)))
        };
        let one = draw(1);
        assert!(one == draw(3), "seed {seed}");
        refused += u64::from(one.0.is_err());
    }
    refused
}

#[test]
fn wild_task_and_mesh_shaders_are_drawn_or_refused() {
    let refused = hunt::<_, 1, 0>(0..60, |a, b, c| [a, b, c])
        + hunt::<_, 7, 5>(100..160, |a, b, c| [a, b, c])
        + hunt::<_, 128, 1000>(200..230, |a, b, _| [a, b])
        + hunt::<_, 3, 16384>(300..330, |a, _, _| [a]);
    assert!((20..90).contains(&refused), "{refused} of 180 draws were refused");
}
