//! Compiling masks to textures of distances.

use super::Compiler;
use std::sync::Arc;
use steradian_image::Encoding;
use steradian_scene::Node;
use steradian_texture::{
    DistanceField, Filter, ImageTexture, Texture, Wrap,
    distance_field::{FieldRecipe, MAX_SIZE, MAX_SPREAD},
    wrap::BLACK,
};

impl Compiler<'_> {
    /// The texture of a mask. Its values are numbers, as they are stored.
    pub(super) fn distance_field(&mut self, node: &Node) -> Option<Texture> {
        let mask = self.texture_level(node)?.with_encoding(Encoding::Linear);
        let span = |name: &str| node.param(name).and_then(|p| p.span).or(node.span);
        let size = self.int(node, "size");
        let Some(size) = usize::try_from(size).ok().filter(|n| (1..=MAX_SIZE).contains(n)) else {
            self.error(span("size"), format!("'size' is from 1 to {MAX_SIZE} texels, not {size}"));
            return None;
        };
        let spread = self.float(node, "spread");
        if !(0.5..=MAX_SPREAD).contains(&spread) {
            self.error(span("spread"), format!("'spread' is from 0.5 to {MAX_SPREAD} texels, not {spread}"));
            return None;
        }
        let channels = mask.channels();
        let channel =
            match self.choice(node, "channel", &[("alpha", None), ("r", Some(0)), ("g", Some(1)), ("b", Some(2))]) {
                None => mask.alpha(),
                Some(c) => Some(if channels < 3 { 0 } else { c }),
            };
        let wraps = [("repeat", Wrap::Repeat), ("mirror", Wrap::Mirror), ("clamp", Wrap::Clamp)];
        let wrap = ["wrap_u", "wrap_v"].map(|name| self.choice(node, name, &wraps));
        let recipe = FieldRecipe { size, spread, cut: self.share(node, "cut"), channel, wrap };
        let levels = match recipe.levels(&mask, self.assets.pages.as_ref()) {
            Ok(levels) => levels,
            Err(e) => {
                self.error(node.span, format!("cannot keep the levels of this distance field: {e}"));
                return None;
            }
        };
        let image = ImageTexture {
            levels: Arc::new(levels),
            sums: None,
            filter: Filter::Trilinear,
            stochastic: false,
            wrap,
            borders: BLACK,
            channel: None,
            origin_bottom: self.choice(node, "origin", &[("bottom", true), ("top", false)]),
            scale: 1.0,
            invert: self.bool(node, "invert"),
            mapping: self.mapping(node),
        };
        Some(Texture::DistanceField(Arc::new(DistanceField { image, spread })))
    }
}
