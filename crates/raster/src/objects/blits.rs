//! Blits: rectangles of pixels from one framebuffer to another, scaled, mirrored and resolved (OpenGL 4.6 core, section
//! 18.3.1).

use glam::Vec4;

use super::{
    attached::{incomplete, load, store},
    context::Context,
    error::invalid_operation,
};
use crate::{
    error::Result,
    output::Class,
    render_target::{ColorTarget, Extent, Framebuffer},
    texture::Filter,
};

/// Buffers of a framebuffer that a blit copies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BlitMask {
    /// The read buffer, to all draw buffers.
    pub color: bool,
    /// Depths.
    pub depth: bool,
    /// Stencil values.
    pub stencil: bool,
}

/// Place of the centre of a target's pixel on one axis of the source.
#[derive(Clone, Copy)]
struct Tap {
    /// The pixel that it is in.
    nearest: u32,
    /// The two pixels whose centres it is between, at the border twice the outermost.
    pair: [u32; 2],
    /// Weight of the second of them.
    weight: f32,
}

/// Places of the pixels of a target on one axis; `None` for pixels that stay, since they are not in the rectangle or
/// their place is not in the source.
fn taps(source: [i32; 2], target: [i32; 2], [source_size, target_size]: [u32; 2]) -> Vec<Option<Tap>> {
    let [s0, s1, t0, t1] = [source[0], source[1], target[0], target[1]].map(i128::from);
    let last = i128::from(source_size) - 1;
    let tap = |x: u32| {
        let x = i128::from(x);
        if s0 == s1 || !(t0.min(t1)..t0.max(t1)).contains(&x) {
            return None;
        }
        // s0 + (x + ½ − t0) (s1 − s0) / (t1 − t0), as a fraction of exact integers.
        let sign = (t1 - t0).signum();
        let unit = 4 * (t1 - t0) * sign;
        let center = s0 * unit + 2 * (2 * x + 1 - 2 * t0) * (s1 - s0) * sign;
        let nearest = center.div_euclid(unit);
        let before = center - unit / 2;
        let pixel = |number: i128| number.clamp(0, last) as u32;
        let pair = [0, 1].map(|next| pixel(before.div_euclid(unit) + next));
        let weight = (before.rem_euclid(unit) as f64 / unit as f64) as f32;
        (0..=last).contains(&nearest).then(|| Tap { nearest: pixel(nearest), pair, weight })
    };
    (0..target_size).map(tap).collect()
}

/// Copies colours to layer 0 of a target.
fn blit_color(source: &ColorTarget, target: &mut ColorTarget, [across, down]: &[Vec<Option<Tap>>; 2], filter: Filter) {
    let (format, extent) = (target.format(), target.extent());
    let pixel = format.bytes() * extent.samples as usize;
    let mut row = vec![0; pixel * extent.width as usize];
    for (y, down) in (0..).zip(down).filter_map(|(y, tap)| Some((y, (*tap)?))) {
        target.store(y, 0, &mut row);
        for (across, texels) in across.iter().zip(row.chunks_exact_mut(pixel)) {
            let Some(across) = across else { continue };
            for (sample, texel) in (0..).zip(texels.chunks_exact_mut(format.bytes())) {
                let sample = source.extent().samples.min(sample + 1) - 1;
                let color = |x, y| source.sample([x, y], 0, sample).unwrap_or_default();
                let row = |y| color(across.pair[0], y).lerp(color(across.pair[1], y), across.weight);
                let value: Vec4 = match filter {
                    Filter::Nearest => color(across.nearest, down.nearest),
                    Filter::Linear => row(down.pair[0]).lerp(row(down.pair[1]), down.weight),
                };
                format.write(value, texel);
            }
        }
        target.load(y, 0, &row);
    }
}

impl Context {
    /// Copies a rectangle of the framebuffer that is read from to one of the framebuffer that is drawn to, each as
    /// x and y of a corner and of the one opposite: rectangles of other sizes scale the picture, corners in another
    /// order mirror it. Buffers that are not in both framebuffers are left out. Samples are averaged into pixels
    /// without them, of integers, depths and stencil values the first is taken; pixels without samples fill all
    /// samples. Of layers the first is read and written. Texels that are both read and written are read first.
    ///
    /// # Errors
    /// For framebuffers that are not complete, linear filters of depths, stencil values and integers, colours of
    /// integers and of floats mixed, depths of different formats, numbers of samples that differ, and rectangles of
    /// different sizes where one framebuffer has samples.
    pub fn blit_framebuffer(
        &mut self,
        source: [i32; 4],
        target: [i32; 4],
        mask: BlitMask,
        filter: Filter,
    ) -> Result<()> {
        const CALL: &str = "blit_framebuffer";
        let (color, depth, stencil) = self.read_parts(CALL)?;
        let object = self.draw_framebuffer.clone();
        let (drawn, has_color) = match &object {
            None => (self.default.clone(), true),
            Some(object) => {
                let object = object.borrow();
                (load(&object, CALL)?, object.draw_buffers.iter().any(Option::is_some))
            }
        };
        let extents = color.as_ref().map(ColorTarget::extent).into_iter();
        let extents = extents.chain(depth.as_ref().map(|target| target.extent()));
        let Some(read) = extents.chain(stencil.as_ref().map(|target| target.extent())).next() else { return Ok(()) };
        let extent = drawn.extent();
        let (mut colors, mut depths, mut stencils) = drawn.into_parts();
        let color = color.filter(|_| mask.color && has_color && !colors.is_empty());
        let depth = depth.filter(|_| mask.depth && depths.is_some());
        let stencil = stencil.filter(|_| mask.stencil && stencils.is_some());

        if filter == Filter::Linear && (mask.depth || mask.stencil) {
            return invalid_operation(CALL, "depths and stencil values take the filter Nearest");
        }
        if let Some(color) = &color {
            let (from, class) = (color.format(), color.format().class());
            if let Some(to) = colors.iter().map(ColorTarget::format).find(|format| format.class() != class) {
                return invalid_operation(CALL, format_args!("{to:?} does not take colours of {from:?}"));
            }
            if filter == Filter::Linear && class != Class::Float {
                return invalid_operation(
                    CALL,
                    format_args!("{from:?} cannot be averaged; the filter must be Nearest"),
                );
            }
        }
        if let (Some(from), Some(to)) = (&depth, &depths)
            && from.format() != to.format()
        {
            return invalid_operation(CALL, format_args!("depths of {:?} to {:?}", from.format(), to.format()));
        }
        let has_samples = [read, extent].iter().any(|extent| extent.samples > 1);
        check_samples([read, extent], [source, target])?;
        if self.queries.drops() {
            return Ok(());
        }

        let axis =
            |first: usize, sizes| taps([source[first], source[first + 2]], [target[first], target[first + 2]], sizes);
        let taps = [axis(0, [read.width, extent.width]), axis(1, [read.height, extent.height])];
        if let Some(color) = color {
            let color = if extent.samples == 1 { color.resolve() } else { color };
            // Between rectangles of one size the filter changes nothing.
            let filter = if has_samples { Filter::Nearest } else { filter };
            colors.iter_mut().for_each(|target| blit_color(&color, target, &taps, filter));
        }
        // Pixel and sample of the source.
        let place = |[x, y]: [u32; 2], layer: u32, sample: u32| {
            let (x, y) = (taps[0][x as usize]?.nearest, taps[1][y as usize]?.nearest);
            (layer == 0).then_some(([x, y], sample.min(read.samples - 1)))
        };
        if let (Some(from), Some(to)) = (depth, &mut depths) {
            let old = to.clone();
            to.load(|at, layer, sample| {
                let moved = place(at, layer, sample).and_then(|(at, sample)| from.sample(at, 0, sample));
                moved.or_else(|| old.sample(at, layer, sample)).unwrap_or(0.0)
            });
        }
        if let (Some(from), Some(to)) = (stencil, &mut stencils) {
            let old = to.clone();
            to.load(|at, layer, sample| {
                let moved = place(at, layer, sample).and_then(|(at, sample)| from.sample(at, 0, sample));
                moved.or_else(|| old.sample(at, layer, sample)).unwrap_or(0)
            });
        }
        let drawn = Framebuffer::new(colors, depths, stencils).or_else(|error| incomplete(CALL, error.rule))?;
        match object {
            None => self.default = drawn,
            Some(object) => store(&object.borrow(), drawn, CALL)?,
        }
        Ok(())
    }
}

/// The rules of framebuffers with samples.
fn check_samples([read, drawn]: [Extent; 2], rectangles: [[i32; 4]; 2]) -> Result<()> {
    const CALL: &str = "blit_framebuffer";
    if read.samples > 1 && drawn.samples > 1 && read.samples != drawn.samples {
        return invalid_operation(CALL, format_args!("{} samples to {}", read.samples, drawn.samples));
    }
    let [from, to] = rectangles.map(|[x0, y0, x1, y1]| [x0.abs_diff(x1), y0.abs_diff(y1)]);
    if read.samples.max(drawn.samples) > 1 && from != to {
        return invalid_operation(CALL, format_args!("{from:?} pixels with samples to {to:?}"));
    }
    Ok(())
}
