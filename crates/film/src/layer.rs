//! From the sums on a film to a picture with layers.

use crate::{Film, FirstHit, cryptomatte, plane::push};
use std::collections::BTreeMap;
use steradian_image::Image;

/// An auxiliary layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    /// Reflectance of the first surface.
    Albedo,
    /// Shading normal.
    Normal,
    /// Albedo of what mirrors and smooth glass show.
    DenoiseAlbedo,
    /// Shading normal of what mirrors and smooth glass show.
    DenoiseNormal,
    /// Geometric normal.
    GeometricNormal,
    /// World position.
    Position,
    /// Distance along the camera's axis.
    Depth,
    /// How what is seen has moved on the screen since the frame before.
    Motion,
    /// Surface parameters.
    Uv,
    /// Shape and material numbers.
    Ids,
    /// Variance of the pixel's mean.
    Variance,
    /// Samples taken.
    Samples,
    /// Part of the pixel that surfaces cover.
    Alpha,
    /// Named objects and materials, and the part of the pixel that each covers.
    Cryptomatte,
    /// The picture by the light of each group of lights alone.
    LightGroups,
    /// The picture by each half of the samples, which err independently of each other.
    Halves,
}

impl Layer {
    /// All layers.
    pub const ALL: [Self; 16] = [
        Self::Albedo,
        Self::Normal,
        Self::DenoiseAlbedo,
        Self::DenoiseNormal,
        Self::GeometricNormal,
        Self::Position,
        Self::Depth,
        Self::Motion,
        Self::Uv,
        Self::Ids,
        Self::Variance,
        Self::Samples,
        Self::Alpha,
        Self::Cryptomatte,
        Self::LightGroups,
        Self::Halves,
    ];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Albedo => "albedo",
            Self::Normal => "normal",
            Self::DenoiseAlbedo => "denoise_albedo",
            Self::DenoiseNormal => "denoise_normal",
            Self::GeometricNormal => "geometric_normal",
            Self::Position => "position",
            Self::Depth => "depth",
            Self::Motion => "motion",
            Self::Uv => "uv",
            Self::Ids => "ids",
            Self::Variance => "variance",
            Self::Samples => "samples",
            Self::Alpha => "alpha",
            Self::Cryptomatte => "cryptomatte",
            Self::LightGroups => "light_groups",
            Self::Halves => "halves",
        }
    }

    /// What its channels in a file begin with; of several the first.
    pub fn prefix(self) -> &'static str {
        match self {
            Self::Albedo => "albedo",
            Self::Normal => "N",
            Self::DenoiseAlbedo => "denoise_albedo",
            Self::DenoiseNormal => "denoise_normal",
            Self::GeometricNormal => "Ng",
            Self::Position => "P",
            Self::Depth => "Z",
            Self::Motion => "motion",
            Self::Uv => "uv",
            Self::Ids => "object_id",
            Self::Variance => "variance",
            Self::Samples => "samples",
            Self::Alpha => "A",
            Self::Cryptomatte => "crypto_object00",
            Self::LightGroups => "RGBA",
            Self::Halves => "half_a",
        }
    }

    /// What it holds, and the channels it has in a file.
    pub fn doc(self) -> &'static str {
        match self {
            Self::Albedo => "reflectance of the first surface, linear Rec.709 in [0, 1]: albedo.R albedo.G albedo.B",
            Self::Normal => "shading normal in the world, zero where nothing is hit: N.X N.Y N.Z",
            Self::DenoiseAlbedo => {
                "albedo of what is seen in mirrors and through smooth glass: denoise_albedo.R .G .B; not among 'all'"
            }
            Self::DenoiseNormal => {
                "shading normal of what mirrors and smooth glass show: denoise_normal.X .Y .Z; not among 'all'"
            }
            Self::GeometricNormal => "geometric normal in the world, towards the camera: Ng.X Ng.Y Ng.Z",
            Self::Position => "world position of the first surface: P.X P.Y P.Z",
            Self::Depth => {
                "distance along the camera's axis (Z) and along the ray (depth.Z); infinite where nothing is hit"
            }
            Self::Motion => {
                "pixels it has moved since the frame before, right and down, and how much away: motion.X .Y .Z; with \
                 --frames; not among 'all'"
            }
            Self::Uv => "surface parameters: uv.U uv.V",
            Self::Ids => "numbers of shape and material from one, zero for nothing: object_id.Y material_id.Y",
            Self::Variance => "estimated variance of the pixel's mean: variance.R variance.G variance.B",
            Self::Samples => "samples taken: samples.Y",
            Self::Alpha => "part of the pixel that surfaces cover: A; --transparent leaves out the background",
            Self::LightGroups => {
                "the light of each light or named group of them, whose sum is the picture: RGBA_NAME.R .G .B; not among 'all'"
            }
            Self::Halves => "the picture by each half of its samples: half_a.R .G .B half_b.R .G .B; not among 'all'",
            Self::Cryptomatte => {
                "Cryptomatte 1.2, six ranks: crypto_object00..02.rgba crypto_material00..02.rgba, with manifests"
            }
        }
    }

    /// By name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|l| l.name() == name)
    }

    /// Whether it is of what is seen in mirrors and through smooth glass.
    pub fn sees_through(self) -> bool {
        matches!(self, Self::DenoiseAlbedo | Self::DenoiseNormal)
    }

    /// Whether it comes from the first hits of camera rays.
    pub fn needs_features(self) -> bool {
        !matches!(self, Self::Variance | Self::Samples | Self::Cryptomatte | Self::LightGroups | Self::Halves)
    }
}

/// What the channels of [`Layer::Halves`] begin with.
pub const HALVES: [&str; 2] = ["half_a", "half_b"];

/// What layers call the things that they show.
#[derive(Clone, Debug, Default)]
pub struct Names {
    /// Objects by [`FirstHit::shape`].
    pub objects: BTreeMap<u32, String>,
    /// Materials by [`FirstHit::material`].
    pub materials: BTreeMap<u32, String>,
    /// Groups of lights, in the order of [`Film::by_light`].
    pub light_groups: Vec<String>,
    /// The point of the world that positions are told from.
    pub origin: [f64; 3],
}

/// A coordinate of a first hit in the world; zero where there is none.
fn placed(hit: &FirstHit, names: &Names, axis: usize) -> f32 {
    let origin = if hit.coverage > 0.0 { names.origin[axis] } else { 0.0 };
    (f64::from(hit.position[axis]) + origin) as f32
}

/// The picture: linear Rec.709 in `R G B`, premultiplied by [`Layer::Alpha`] where the background was left out, and the
/// layers asked for. Layers of first hits need a film on which they were gathered.
pub fn develop(film: &Film, layers: &[Layer], names: &Names) -> Image {
    let (w, h) = (film.crop.width() as usize, film.crop.height() as usize);
    let mut image = Image::new(w, h);
    let means: Vec<[f64; 3]> = film.pixels.iter().map(|p| p.mean()).collect();
    let plane = |c: usize| means.iter().map(|m| held(m[c])).collect::<Vec<_>>();
    push(&mut image, "R", plane(0));
    push(&mut image, "G", plane(1));
    push(&mut image, "B", plane(2));
    let hits: Vec<FirstHit> = film.features.iter().map(|f| f.mean()).collect();
    for layer in layers {
        if layer.needs_features() && hits.is_empty() {
            continue;
        }
        let of = |f: &dyn Fn(&FirstHit) -> f32| hits.iter().map(f).collect::<Vec<f32>>();
        match layer {
            Layer::Albedo => ["R", "G", "B"].iter().enumerate().for_each(|(c, n)| {
                push(&mut image, &format!("albedo.{n}"), of(&|h| h.albedo[c]));
            }),
            Layer::Normal => ["X", "Y", "Z"].iter().enumerate().for_each(|(c, n)| {
                push(&mut image, &format!("N.{n}"), of(&|h| h.normal[c]));
            }),
            Layer::DenoiseAlbedo => ["R", "G", "B"].iter().enumerate().for_each(|(c, n)| {
                push(&mut image, &format!("denoise_albedo.{n}"), of(&|h| h.seen_albedo[c]));
            }),
            Layer::DenoiseNormal => ["X", "Y", "Z"].iter().enumerate().for_each(|(c, n)| {
                push(&mut image, &format!("denoise_normal.{n}"), of(&|h| h.seen_normal[c]));
            }),
            Layer::GeometricNormal => ["X", "Y", "Z"].iter().enumerate().for_each(|(c, n)| {
                push(&mut image, &format!("Ng.{n}"), of(&|h| h.geometric_normal[c]));
            }),
            Layer::Position => ["X", "Y", "Z"].iter().enumerate().for_each(|(c, n)| {
                push(&mut image, &format!("P.{n}"), of(&|h| placed(h, names, c)));
            }),
            Layer::Depth => {
                push(&mut image, "Z", of(&|h| h.depth));
                push(&mut image, "depth.Z", of(&|h| h.distance));
            }
            Layer::Motion => ["X", "Y", "Z"].iter().enumerate().for_each(|(c, n)| {
                push(&mut image, &format!("motion.{n}"), of(&|h| h.motion[c]));
            }),
            Layer::Uv => ["U", "V"].iter().enumerate().for_each(|(c, n)| {
                push(&mut image, &format!("uv.{n}"), of(&|h| h.uv[c]));
            }),
            Layer::Ids => {
                push(&mut image, "object_id.Y", of(&|h| h.shape as f32));
                push(&mut image, "material_id.Y", of(&|h| h.material as f32));
            }
            Layer::Variance => ["R", "G", "B"].iter().enumerate().for_each(|(c, n)| {
                let v = film.pixels.iter().map(|p| held(p.variance_of_mean()[c])).collect();
                push(&mut image, &format!("variance.{n}"), v);
            }),
            Layer::Halves => halves(&mut image, film),
            Layer::LightGroups if film.bins > 0 => {}
            Layer::LightGroups => light_groups(&mut image, &names.light_groups, film),
            Layer::Cryptomatte if film.mattes.is_empty() => {}
            Layer::Cryptomatte => {
                cryptomatte::push(&mut image, "crypto_object", &names.objects, &film.mattes, |m| &m.objects);
                cryptomatte::push(&mut image, "crypto_material", &names.materials, &film.mattes, |m| &m.materials);
            }
            Layer::Alpha => push(&mut image, "A", of(&|h| h.coverage)),
            Layer::Samples => {
                push(&mut image, "samples.Y", film.pixels.iter().map(|p| p.samples as f32).collect());
            }
        }
    }
    let bins = film.bins as usize;
    for bin in 0..bins {
        push_part(&mut image, &format!("bin.{bin:03}"), film, (bin, bins));
    }
    image
}

/// Adds a layer of one part of the light out of so many.
fn push_part(image: &mut Image, name: &str, film: &Film, (part, count): (usize, usize)) {
    for (c, n) in ["R", "G", "B"].iter().enumerate() {
        let sums = film.by_light.iter().skip(part).step_by(count).zip(&film.pixels);
        let plane = sums.map(|(sum, p)| held(sum[c] / f64::from(p.samples.max(1)))).collect();
        push(image, &format!("{name}.{n}"), plane);
    }
}

/// Adds the light of each group of lights. Dots part layers in names of channels, so that groups lose theirs.
fn light_groups(image: &mut Image, names: &[String], film: &Film) {
    if film.by_light.is_empty() {
        return;
    }
    for (group, name) in names.iter().enumerate() {
        let mut name = format!("RGBA_{}", name.replace(['.', '\0'], "_"));
        name.truncate(name.floor_char_boundary(200));
        while image.channel(&format!("{name}.R")).is_some() {
            name.push('_');
        }
        push_part(image, &name, film, (group, names.len()));
    }
}

/// Adds both halves of the samples, where every pixel has both.
fn halves(image: &mut Image, film: &Film) {
    let means: Option<Vec<_>> = film.halves.iter().zip(&film.pixels).map(|(half, p)| half.means(p)).collect();
    let Some(means) = means.filter(|means| !means.is_empty()) else { return };
    for (half, name) in HALVES.into_iter().enumerate() {
        for (c, n) in ["R", "G", "B"].iter().enumerate() {
            push(image, &format!("{name}.{n}"), means.iter().map(|m| held(m[half][c])).collect());
        }
    }
}

/// A number as `f32`, held at the ends of its range: the squares of large radiances are beyond it.
fn held(v: f64) -> f32 {
    v.clamp(f64::from(f32::MIN), f64::from(f32::MAX)) as f32
}
