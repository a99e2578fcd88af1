//! Compiling procedural textures, and those that change or combine others.

use super::Compiler;
use std::sync::Arc;
use steradian_math::{
    Mat3, Vec2, Vec3,
    spectra::role::{Color, Role},
};
use steradian_scene::{ColorSpace, Node, Value};
use steradian_texture::{
    Adjust, Mapping, Pattern, PatternTexture, Texture, TextureId, Triplanar,
    adjust::Channel,
    noise::{Basis, Cellular, Fractal, Metric, fractal::MAX_OCTAVES},
    pattern::{Bricks, Wood},
    ramp::{Interpolation, Ramp},
};

const TWO_SHADES: [(&str, f64); 2] = [("a", 0.0), ("b", 1.0)];

impl Compiler<'_> {
    /// The pattern that a node names; `None` where it names none.
    fn pattern(&mut self, node: &Node) -> Option<Pattern> {
        Some(match node.kind.as_str() {
            "checkerboard" if self.int(node, "dimension") == 3 => Pattern::Checker3,
            "checkerboard" => Pattern::Checker2,
            "bricks" | "tiles" => Pattern::Bricks(self.bricks(node)),
            "brick_shade" => {
                let bricks = self.bricks(node);
                Pattern::BrickShade(bricks, self.seed(node))
            }
            "stripes" => Pattern::Stripes(self.share(node, "duty")),
            "dots" => Pattern::Dots,
            "gradient" => self.choice(
                node,
                "type",
                &[
                    ("u", Pattern::Coordinate(false)),
                    ("v", Pattern::Coordinate(true)),
                    ("radial", Pattern::Radial),
                    ("angular", Pattern::Angular),
                ],
            ),
            "noise" => Pattern::Fbm(Fractal { basis: self.basis(node), seed: self.seed(node), ..Fractal::new(1, 0.5) }),
            "fbm" => Pattern::Fbm(self.fractal(node)),
            "wrinkled" => Pattern::Turbulence(self.fractal(node)),
            "ridged" => Pattern::Ridged(self.fractal(node)),
            "windy" => Pattern::Windy,
            "worley" => {
                let cells = self.cellular(node);
                self.choice(
                    node,
                    "feature",
                    &[
                        ("f1", Pattern::WorleyF1(cells)),
                        ("f2", Pattern::WorleyF2(cells)),
                        ("border", Pattern::WorleyBorder(cells)),
                    ],
                )
            }
            "voronoi" => Pattern::Voronoi(self.cellular(node)),
            "wood" => Pattern::Wood(Wood {
                ring: self.positive(node, "ring"),
                light: self.share(node, "light"),
                wobble: self.float(node, "wobble"),
                lobes: self.float(node, "lobes").round(),
                twist: self.float(node, "twist"),
                grain: self.float(node, "grain"),
                noise: self.fractal(node),
            }),
            "marble" => Pattern::Marble(self.fractal(node), self.float(node, "variation")),
            "facing" | "direction_mix" => {
                let d = self.vec3(node, "dir");
                let to_texture = self.transform(node, "texture_from_world").affine();
                // The direction is given in texture space, normals are in the world.
                let d = to_texture.map_or(d, |t| t.inverse().vector(d));
                match d.try_normalize() {
                    Some(d) => Pattern::Facing(d),
                    None => {
                        self.error(node.span, "the direction 'dir' has no length");
                        Pattern::Facing(Vec3::Y)
                    }
                }
            }
            _ => return None,
        })
    }

    /// A procedural texture: the pattern's number, or what lies between two textures by it. `None` where the node's
    /// kind is none.
    pub(super) fn procedural(&mut self, node: &Node, role: Role) -> Option<Texture> {
        let pattern = self.pattern(node)?;
        // What depends on the direction alone has no coordinates.
        let mapping = match node.kind.as_str() {
            "facing" | "direction_mix" => Mapping { local: self.texture_space(node), ..Mapping::default() },
            _ => self.mapping(node),
        };
        let mut t = PatternTexture::new(pattern, mapping);
        t.over_surface = !pattern.is_flat() && self.given_int(node, "dimension") == Some(2);
        t.antialias = self.bool(node, "antialias");
        t.width = self.float(node, "width_filter").max(0.0);
        t.gain = self.float(node, "gain");
        t.offset = self.float(node, "offset");
        t.frequency = match pattern {
            Pattern::Marble(..) => self.float(node, "scale"),
            _ => self.float(node, "frequency"),
        };
        // The two ends where the number is 0 and 1.
        let ends = match node.kind.as_str() {
            "checkerboard" => Some(["a", "b"].map(|name| self.part(node, name, role))),
            "direction_mix" => Some(["b", "a"].map(|name| self.part(node, name, role))),
            _ => {
                let is_either_given = TWO_SHADES.iter().any(|end| node.get(end.0).is_some());
                let mut shade = |(name, default)| self.part_or(node, name, role, default);
                is_either_given.then(|| TWO_SHADES.map(&mut shade))
            }
        };
        let pattern = Texture::Pattern(Arc::new(t));
        Some(match (ends, node.kind.as_str()) {
            (Some([a, b]), _) => {
                let amount = self.textures.add(pattern);
                Texture::Mix(a, b, amount)
            }
            (None, "marble") => {
                let veins = self.textures.add(pattern);
                Texture::Adjust(veins, Box::new(Adjust::Ramp(Arc::new(Ramp::marble()))))
            }
            (None, _) => pattern,
        })
    }

    /// A texture that changes or combines others. `None` where the node's kind is none.
    pub(super) fn combined(&mut self, node: &Node, role: Role) -> Option<Texture> {
        Some(match node.kind.as_str() {
            "scale" => Texture::Scale(self.part(node, "texture", role), self.part(node, "scale", Role::Unbounded)),
            "add" => Texture::Add(self.part(node, "a", role), self.part(node, "b", role)),
            "mix" => Texture::Mix(
                self.part(node, "a", role),
                self.part(node, "b", role),
                self.part(node, "amount", Role::Unbounded),
            ),
            "bilerp" => self.bilerp(node, role),
            "triplanar" => {
                let local = self.texture_space(node);
                let sharpness = self.int(node, "sharpness").clamp(1, 64) as u32;
                let all = node.get("texture").is_some();
                let parts = ["x", "y", "z"].map(|axis| {
                    let name = if all && node.get(axis).is_none() { "texture" } else { axis };
                    let part = self.part_or(node, name, role, 1.0);
                    if name == "texture" { self.projected(part, axis, &local) } else { part }
                });
                Texture::Triplanar(parts, Box::new(Triplanar { local, sharpness }))
            }
            "ramp" | "curve" => {
                let ramp = Arc::new(self.ramp(node)?);
                let adjust = if node.kind == "ramp" { Adjust::Ramp(ramp) } else { Adjust::Curve(ramp) };
                Texture::Adjust(self.part(node, "input", Role::Unbounded), Box::new(adjust))
            }
            "channel" => {
                let channels = [
                    ("r", Channel::R),
                    ("g", Channel::G),
                    ("b", Channel::B),
                    ("luminance", Channel::Luminance),
                    ("mean", Channel::Mean),
                    ("max", Channel::Max),
                ];
                let channel = self.choice(node, "channel", &channels);
                Texture::Adjust(self.part(node, "input", role), Box::new(Adjust::Channel(channel)))
            }
            "color_space" => {
                let matrix = self.color_matrix(node);
                Texture::Adjust(self.part(node, "input", role), Box::new(Adjust::Matrix(Box::new(matrix))))
            }
            "hsv" => {
                let adjust = Adjust::Hsv {
                    hue: self.float(node, "hue") / 360.0,
                    saturation: self.float(node, "saturation").max(0.0),
                    value: self.float(node, "value"),
                };
                Texture::Adjust(self.part(node, "input", role), Box::new(adjust))
            }
            _ => return None,
        })
    }

    /// Four values at the corners of the unit square.
    fn bilerp(&mut self, node: &Node, role: Role) -> Texture {
        let mapping = self.mapping(node);
        let coordinate = |v| Texture::Pattern(Arc::new(PatternTexture::new(Pattern::Coordinate(v), mapping.clone())));
        let (u, v) = (coordinate(false), coordinate(true));
        let (u, v) = (self.textures.add(u), self.textures.add(v));
        let [v00, v10, v01, v11] = ["v00", "v10", "v01", "v11"].map(|name| self.part(node, name, role));
        let [low, high] = [(v00, v10), (v01, v11)].map(|(a, b)| self.textures.add(Texture::Mix(a, b, u)));
        Texture::Mix(low, high, v)
    }

    /// A copy of a texture whose images and flat patterns are projected along an axis.
    fn projected(&mut self, part: TextureId, axis: &str, local: &steradian_math::transform::Affine) -> TextureId {
        use steradian_texture::mapping::Projector::Planar;
        let projector = match axis {
            "x" => Planar(Vec3::Y, Vec3::Z, Vec2::ZERO),
            "y" => Planar(Vec3::NEG_X, Vec3::Z, Vec2::ZERO),
            _ => Planar(Vec3::X, Vec3::Y, Vec2::ZERO),
        };
        let mapped = |m: &mut Mapping| {
            m.projector = projector.clone();
            m.local = *local;
        };
        self.textures.rewritten(part, |t| match t {
            Texture::Image(image) => mapped(&mut Arc::make_mut(image).mapping),
            Texture::DistanceField(field) => mapped(&mut Arc::make_mut(field).image.mapping),
            Texture::Pattern(pattern) if pattern.pattern.is_flat() => mapped(&mut Arc::make_mut(pattern).mapping),
            _ => {}
        })
    }

    fn seed(&mut self, node: &Node) -> u32 {
        self.int(node, "seed") as u32
    }

    fn basis(&mut self, node: &Node) -> Basis {
        self.choice(node, "basis", &[("gradient", Basis::Gradient), ("value", Basis::Value)])
    }

    pub(super) fn share(&mut self, node: &Node, name: &str) -> f32 {
        let v = self.float(node, name);
        if !(0.0..=1.0).contains(&v) {
            let span = node.param(name).and_then(|p| p.span).or(node.span);
            self.error(span, format!("'{name}' is a share: it lies between 0 and 1, not at {v}"));
        }
        v.clamp(0.0, 1.0)
    }

    fn fractal(&mut self, node: &Node) -> Fractal {
        let octaves = self.int(node, "octaves");
        if octaves < 0 {
            let span = node.param("octaves").and_then(|p| p.span).or(node.span);
            self.error(span, format!("there cannot be {octaves} octaves"));
        }
        let roughness = self.float(node, "roughness");
        if roughness.abs() > 1e3 {
            let span = node.param("roughness").and_then(|p| p.span).or(node.span);
            self.error(span, "a 'roughness' of noise above 1000 leads beyond the range of numbers");
        }
        Fractal {
            basis: self.basis(node),
            octaves: octaves.clamp(0, MAX_OCTAVES.into()) as u32,
            roughness: roughness.clamp(-1e3, 1e3),
            lacunarity: self.positive(node, "lacunarity").min(1e3),
            seed: self.seed(node),
        }
    }

    fn cellular(&mut self, node: &Node) -> Cellular {
        Cellular {
            metric: self.choice(
                node,
                "metric",
                &[("euclidean", Metric::Euclidean), ("manhattan", Metric::Manhattan), ("chebyshev", Metric::Chebyshev)],
            ),
            jitter: self.share(node, "jitter"),
            seed: self.seed(node),
            flat: self.int(node, "dimension") == 2,
        }
    }

    fn bricks(&mut self, node: &Node) -> Bricks {
        let size = Vec2::new(self.positive(node, "width"), self.positive(node, "height"));
        let mortar = self.float(node, "mortar").max(0.0);
        Bricks { size, mortar: Vec2::splat(mortar), shift: self.float(node, "shift") }
    }

    fn ramp(&mut self, node: &Node) -> Option<Ramp> {
        let what = if node.kind == "ramp" { "colors" } else { "values" };
        let numbers = self.list(node, what).unwrap_or_default();
        let grey = node.kind == "curve";
        let values: Vec<Vec3> = if grey {
            numbers.iter().map(|v| Vec3::splat(*v)).collect()
        } else {
            numbers.chunks_exact(3).map(Vec3::from_slice).collect()
        };
        let places = self.list(node, "places").unwrap_or_else(|| {
            let last = values.len().saturating_sub(1).max(1) as f32;
            (0..values.len()).map(|i| i as f32 / last).collect()
        });
        let kinds = [
            ("step", Interpolation::Step),
            ("linear", Interpolation::Linear),
            ("smooth", Interpolation::Smooth),
            ("catmull_rom", Interpolation::CatmullRom),
            ("bezier", Interpolation::SlidingBezier),
        ];
        let interpolation = self.choice(node, "interpolation", &kinds);
        let whole = grey || numbers.len().is_multiple_of(3);
        match Ramp::new(places, values, interpolation) {
            Ok(ramp) if whole => Some(ramp),
            Ok(_) => {
                self.error(node.span, "the 'colors' of a ramp are three numbers each");
                None
            }
            Err(e) => {
                let span = node.param(what).and_then(|p| p.span).or(node.span);
                self.error(span, format!("{e} ('places' and '{what}')"));
                None
            }
        }
    }

    /// The matrix between two linear colour spaces, by way of Rec.709; or the one given.
    fn color_matrix(&mut self, node: &Node) -> Mat3 {
        if let Some(m) = self.list(node, "matrix") {
            if m.len() == 9 {
                // Rows, as matrices are written.
                return Mat3::from_cols_slice(&m).transpose();
            }
            self.error(node.span, format!("a colour matrix has 9 numbers, not {}", m.len()));
            return Mat3::IDENTITY;
        }
        let spaces = [
            ("srgb", ColorSpace::Srgb),
            ("dci-p3", ColorSpace::DciP3),
            ("rec2020", ColorSpace::Rec2020),
            ("aces", ColorSpace::Aces),
        ];
        let to_rec709 = |c: &mut Self, name: &str| {
            let space = super::params::rgb_space(c.choice(node, name, &spaces));
            Mat3::from_cols(space.to_rec709(Vec3::X), space.to_rec709(Vec3::Y), space.to_rec709(Vec3::Z))
        };
        let (from, to) = (to_rec709(self, "from"), to_rec709(self, "to"));
        to.inverse() * from
    }

    /// A part of a texture, as an index.
    fn part(&mut self, node: &Node, name: &str, role: Role) -> TextureId {
        let default = self.default_number(node, name);
        self.part_or(node, name, role, default)
    }

    /// A part of a texture, as an index, with a default of the caller's.
    fn part_or(&mut self, node: &Node, name: &str, role: Role, default: f64) -> TextureId {
        use steradian_scene::SpectrumValue;
        use steradian_texture::SpectrumTexture;
        // A number may be negative here: whether it must not be is known where the texture is used.
        let number = match node.get(name) {
            Some(Value::Float(v)) => Some(*v as f32),
            Some(Value::Int(v)) => Some(*v as f32),
            None => Some(default as f32),
            _ => None,
        };
        if let Some(v) = number.filter(|v| v.is_finite()) {
            return self.textures.add(Texture::Constant(Color::constant(v)));
        }
        match self.spectrum_or(node, name, role, SpectrumValue::Constant(default)) {
            SpectrumTexture::Constant(c) => self.textures.add(Texture::Constant(c)),
            SpectrumTexture::Texture(id, _) => id,
        }
    }
}
