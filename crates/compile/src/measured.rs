//! Compiling measured materials: their files are read here.

use super::Compiler;
use std::{path::Path, sync::Arc};
use steradian_bsdf::measured::{Btf, MeasuredData, Wanted, btf};
use steradian_core::material::Model;
use steradian_image::read_regular;
use steradian_math::{
    Vec3,
    spectra::{ColorMode, role::Color},
};
use steradian_scene::{Node, Value};
use steradian_texture::SpectrumTexture;

/// Largest file of measurements.
const MAX_BYTES: u64 = 1 << 31;

impl Compiler<'_> {
    /// A measured material; where its file cannot be used, an error is reported and grey stands in.
    pub(super) fn measured(&mut self, node: &Node) -> Model {
        let grey = Model::Diffuse(SpectrumTexture::Constant(Color::constant(0.5)));
        let span = node.param("file").and_then(|p| p.span).or(node.span);
        let degree = self.int(node, "harmonics").clamp(0, 12) as usize;
        let Some(Value::Path(path)) = node.get("file") else {
            self.error(span, format!("material '{}' needs a file as 'file'", node.kind));
            return grey;
        };
        let wanted = if self.mode == ColorMode::Spectral { Wanted::Spectral } else { Wanted::Rgb };
        match self.read_measured(path, wanted) {
            Ok(data) if degree > 0 => Model::Measured(Arc::new(data.projected(degree))),
            Ok(data) => Model::Measured(Arc::new(data)),
            Err(e) => {
                self.error(span, format!("cannot use the measurements in '{}': {e}", path.display()));
                grey
            }
        }
    }

    fn read_measured(&mut self, path: &Path, wanted: Wanted) -> Result<MeasuredData, String> {
        let bytes = read_regular(path, MAX_BYTES).map_err(|e| e.to_string())?;
        if let Some(text) = std::str::from_utf8(&bytes).ok().filter(|t| is_btf_index(t)) {
            let lines = btf::index(text).map_err(|e| e.to_string())?;
            let folder = path.parent().unwrap_or(Path::new(""));
            self.files.extend(lines.iter().map(|line| folder.join(&line.2)));
            let limits = self.options.image_limits;
            let open = |file: &std::path::PathBuf| {
                let texels = steradian_image::read_texels(&folder.join(file), &limits).map_err(|e| e.to_string())?;
                let (w, h) = (texels.width, texels.height);
                let colours = if texels.channels >= 3 { 3 } else { 1 };
                let texel = |i: usize| Vec3::from([0, 1, 2].map(|c| texels.linear(i % w, i / w, c.min(colours - 1))));
                Ok(btf::Slice { size: [w, h], texels: (0..w * h).map(texel).collect() })
            };
            return Btf::new(&lines, open).map(MeasuredData::from_btf).map_err(|e| e.to_string());
        }
        MeasuredData::read(&bytes, wanted).map_err(|e| e.to_string())
    }
}

/// True if the first row of a text holds four numbers and then something else: an index of a BTF.
fn is_btf_index(text: &str) -> bool {
    let first = text.lines().map(str::trim).find(|l| !l.is_empty() && !l.starts_with('#'));
    let cells: Vec<&str> = first.map(|l| l.split_whitespace().collect()).unwrap_or_default();
    cells.len() >= 5 && cells[..4].iter().all(|c| c.parse::<f32>().is_ok()) && cells[4].parse::<f32>().is_err()
}
