//! Nanoseconds that texture lookups take: the median over batches of random places, for a picture of 1024² that is in
//! the caches for the most part. `cargo bench -p steradian-texture --bench lookups [-- FILTER… KIND…]`.
#![expect(clippy::print_stdout, reason = "it is what benchmarks are for")]

use std::{hint::black_box, sync::Arc, time::Instant};
use steradian_image::{Encoding, TexelData, Texels};
use steradian_math::Vec2;
use steradian_texture::{
    Filter, Wrap,
    filter::{FILTERS, Source},
    kernel::MipKernel,
    levels::{Levels, Recipe, Shape},
    mapping::Coordinates2,
    pages::Pages,
    store::Level,
    summed::SummedArea,
    wrap::BLACK,
};

const SIZE: usize = 1024;
const BATCH: usize = 2000;
const BATCHES: usize = 101;

fn texels(kind: &str) -> Texels {
    let n = SIZE * SIZE * 3;
    let code = |i: usize| (i as u32).wrapping_mul(2_654_435_761) >> 16;
    let (data, encoding) = match kind {
        "8-bit" => (TexelData::U8((0..n).map(|i| code(i) as u8).collect()), Encoding::Srgb),
        "half" => {
            let half = |i| half::f16::from_f32(code(i) as f32 / 65536.0);
            (TexelData::F16((0..n).map(half).collect()), Encoding::Linear)
        }
        _ => (TexelData::F32((0..n).map(|i| code(i) as f32 / 65536.0).collect()), Encoding::Linear),
    };
    Texels { width: SIZE, height: SIZE, channels: 3, data, encoding, metadata: Default::default() }
}

/// Places along a slow walk with footprints of one to eight texels by one to three, as neighbouring pixels have them.
fn places() -> Vec<Coordinates2> {
    let texel = 1.0 / SIZE as f32;
    (0..BATCH)
        .map(|i| {
            let t = i as f32 * 0.618_034;
            let (sin, cos) = (t * 7.3).sin_cos();
            let (short, long) = (1.0 + 2.0 * t.fract(), 1.0 + 7.0 * (t * 3.1).fract());
            Coordinates2 {
                uv: Vec2::new((i as f32 * 0.001_7).fract(), (i as f32 * 0.000_9).fract()),
                dx: Vec2::new(cos, sin) * long * texel,
                dy: Vec2::new(-sin, cos) * short * texel,
            }
        })
        .collect()
}

fn main() {
    let places = places();
    // What is named on the command line, or everything.
    let wanted: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    const KINDS: [&str; 4] = ["8-bit", "half", "float", "8-bit in pages"];
    let is_kind = |w: &String| KINDS.contains(&w.as_str());
    let (kinds, filters): (Vec<String>, Vec<String>) = wanted.into_iter().partition(is_kind);
    let is_wanted = |name: &str| filters.is_empty() || filters.iter().any(|w| w == name);
    for kind in KINDS.into_iter().filter(|k| kinds.is_empty() || kinds.iter().any(|w| w == k)) {
        let pages = kind.ends_with("pages").then(|| Pages::new(64 << 20).expect("a temporary file"));
        let texels = Arc::new(texels(kind.trim_end_matches(" in pages")));
        for (name, filter) in FILTERS.into_iter().filter(|f| is_wanted(f.0)) {
            let shape = match filter {
                Filter::Trilinear | Filter::Ewa(_) => Shape::Mip,
                Filter::Ripmap => Shape::Rip,
                _ => Shape::Flat,
            };
            let wrap = [Wrap::Repeat; 2];
            let recipe = Recipe { shape, kernel: MipKernel::Box, wrap, keep_coverage: None, bleed: false };
            let base = Level::new(texels.clone(), pages.as_ref()).expect("room on disk");
            let levels = Levels::new(base, &recipe, pages.as_ref()).expect("room on disk");
            let sums = (filter == Filter::Box).then(|| SummedArea::new(levels.base()));
            let source = Source { levels: &levels, sums: sums.as_ref(), wrap, borders: &BLACK };
            let mut times: Vec<f64> = (0..BATCHES)
                .map(|_| {
                    let start = Instant::now();
                    for at in &places {
                        black_box(source.lookup::<3>(filter, black_box(at), 0));
                    }
                    start.elapsed().as_secs_f64() * 1e9 / BATCH as f64
                })
                .collect();
            times.sort_by(f64::total_cmp);
            println!("{kind:>15} {name:>12} {:8.1} ns (least {:.1})", times[BATCHES / 2], times[0]);
        }
    }
}
