//! Compiling lenses of several elements.

use super::Compiler;
use std::{path::Path, sync::Arc};
use steradian_core::camera::{DOUBLE_GAUSS, LensElement, LensSystem, Stop};
use steradian_image::{read_regular, read_texels, read_texels_bytes};
use steradian_scene::Node;

/// Most bytes of a lens table.
const MAX_BYTES: u64 = 1 << 20;

/// Most texels of a picture of the stop.
const MAX_TEXELS: usize = 1 << 22;

impl Compiler<'_> {
    /// The lens of a camera before its film; errors are reported.
    pub(super) fn lens_system(&mut self, node: &Node) -> Option<Arc<LensSystem>> {
        let rows = self.lens_rows(node)?;
        let stop = self.lens_stop(node)?;
        let aperture = node.get("aperture_diameter").map(|_| self.positive_or(node, "aperture_diameter", 1.0));
        let focus = self.positive(node, "focus_distance");
        let diagonal = self.film_diagonal(node);
        match LensSystem::new(&rows, stop, aperture.map(f64::from), f64::from(focus), f64::from(diagonal)) {
            Ok(lens) => Some(Arc::new(lens)),
            Err(e) => {
                self.error(node.span, e);
                None
            }
        }
    }

    /// Corner to corner of the film, mm.
    pub(super) fn film_diagonal(&mut self, node: &Node) -> f32 {
        self.positive(node, "film_diagonal")
    }

    /// The table of a lens: a file, a list, or a double Gauss.
    fn lens_rows(&mut self, node: &Node) -> Option<Vec<LensElement>> {
        if let Some(path) = self.typed(node, "file", "a file", |n| n.path("file")) {
            let rows = self.file_bytes(path).and_then(|bytes| table(&String::from_utf8_lossy(&bytes)));
            return self.of_file(node, "file", path, rows);
        }
        let abbe = self.list(node, "abbe").unwrap_or_default();
        let Some(list) = self.typed_floats(node, "elements") else {
            return node.get("elements").is_none().then(|| DOUBLE_GAUSS.map(LensElement::from).to_vec());
        };
        let (rows, rest) = list.as_chunks::<4>();
        if !rest.is_empty() || !(abbe.is_empty() || abbe.len() == rows.len()) {
            let what = "'elements' of a lens has four numbers for each surface, and 'abbe' one";
            self.error(node.param("elements").and_then(|p| p.span).or(node.span), what);
            return None;
        }
        let abbe = |k: usize| abbe.get(k).map_or(0.0, |v| f64::from(*v));
        Some(rows.iter().enumerate().map(|(k, [r, t, n, d])| [*r, *t, *n, *d, abbe(k)].into()).collect())
    }

    /// The shape of the stop: a picture, or a built-in one.
    fn lens_stop(&mut self, node: &Node) -> Option<Stop> {
        let Some(path) = self.typed(node, "aperture_file", "a file", |n| n.path("aperture_file")) else {
            let name = self.word(node, "aperture");
            let stop = Stop::named(name);
            if stop.is_none() {
                let what = format!("'{name}' is not an aperture; known are circle, square, pentagon, star, gaussian");
                self.error(node.param("aperture").and_then(|p| p.span).or(node.span), what);
            }
            return stop;
        };
        let limits = self.options.image_limits;
        let read = match self.desc.embedded.get(path) {
            Some(bytes) => read_texels_bytes(bytes, Some(path), &limits),
            None => read_texels(path, &limits),
        };
        let mask = read.map_err(|e| e.to_string()).and_then(|texels| {
            let (w, h) = (texels.width, texels.height);
            if w.saturating_mul(h) > MAX_TEXELS {
                return Err(format!("{w} x {h} texels are more than the {MAX_TEXELS} of an aperture"));
            }
            let colors = if texels.channels >= 3 { 3 } else { 1 };
            let value = |i: usize| (0..colors).map(|c| texels.linear(i % w, i / w, c)).sum::<f32>() / colors as f32;
            let values = (0..w * h).map(value).collect();
            Stop::mask(w, values).ok_or_else(|| "an aperture has values of at least 0, and some above".to_owned())
        });
        self.of_file(node, "aperture_file", path, mask)
    }

    /// Value read from a file; a failure is reported.
    fn of_file<T>(&mut self, node: &Node, name: &str, path: &Path, read: Result<T, String>) -> Option<T> {
        let span = node.param(name).and_then(|p| p.span).or(node.span);
        read.map_err(|e| self.error(span, format!("cannot use '{}': {e}", path.display()))).ok()
    }

    fn file_bytes(&self, path: &Path) -> Result<Vec<u8>, String> {
        match self.desc.embedded.get(path) {
            Some(bytes) => Ok(bytes.to_vec()),
            None => read_regular(path, MAX_BYTES).map_err(|e| e.to_string()),
        }
    }

    /// A list of numbers as they are, if it is there.
    fn typed_floats(&mut self, node: &Node, name: &str) -> Option<Vec<f64>> {
        self.list(node, name)?;
        node.floats(name).map(<[f64]>::to_vec)
    }
}

/// Reads a table of pbrt: rows of radius, thickness, index, diameter and, by choice, Abbe number; `#` begins a remark.
fn table(text: &str) -> Result<Vec<LensElement>, String> {
    let mut rows = Vec::new();
    for (k, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default();
        let numbers: Result<Vec<f64>, _> = line.split_whitespace().map(str::parse).collect();
        match numbers.as_deref() {
            Ok([]) => {}
            Ok(&[radius, thickness, eta, diameter]) => rows.push([radius, thickness, eta, diameter, 0.0].into()),
            Ok(&[radius, thickness, eta, diameter, abbe]) => rows.push([radius, thickness, eta, diameter, abbe].into()),
            _ => {
                let what = "radius, thickness, index of refraction, diameter (and Abbe number) of a surface";
                return Err(format!("line {} is not {what}", k + 1));
            }
        }
    }
    Ok(rows)
}
