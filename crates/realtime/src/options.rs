//! The options of the integrator: `raster:shadows=map,size=1024`.

use crate::{
    Error,
    culling::{BOUNDS, BoundsKind, CULLINGS, Culling},
    shading_model::{MODELS, ShadingModel},
};
use steradian_request::MethodRequest;

/// Shadow technique.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shadows {
    /// It always is.
    None,
    /// By rays: exact.
    Ray,
    /// By shadow maps: pictures of depths as the light sees them (Williams 1978). Lights that are not points or
    /// parallel use rays.
    Map,
    /// As maps; those of points are drawn in one pass, in which a geometry shader hands each triangle to the faces of a
    /// cube.
    Cube,
    /// As maps; those of parallel light are bent by a trapezoid around what is seen (Martin, Tan 2004).
    Trapezoid,
    /// As maps; those of parallel light are bent by a perspective along the view (Wimmer, Scherzer, Purgathofer 2004).
    Perspective,
    /// As maps; parallel light has several, one behind the other along the view.
    Cascades,
    /// By mean and variance of filtered depths (Donnelly, Lauritzen 2006).
    Variance,
    /// By four moments of filtered depths (Peters, Klein 2015).
    Moments,
    /// Soft shadows of area lights by maps, filtered as far as blockers are off (Fernando 2005).
    Pcss,
    /// By shadow volumes and the stencil buffer, counted behind what is seen (Crow 1977; Everitt, Kilgard 2002).
    Volume,
    /// By shadow volumes, counted before what is seen.
    VolumePass,
    /// By meshes projected to the planes of what is flat (Blinn 1988); nothing else has shadows.
    Planar,
}

/// Depth bias of shadow maps, against self-shadowing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BiasBy {
    /// The surface is moved towards the light in proportion to its slope.
    Slope,
    /// By the same distance everywhere.
    Constant,
    /// Its points are moved along the normal.
    Normal,
    /// Each texel is compared with the plane of the surface in it (Isidoro 2006).
    Plane,
}

/// The kinds of bias by name.
const BIASES: [(&str, BiasBy); 4] =
    [("slope", BiasBy::Slope), ("constant", BiasBy::Constant), ("normal", BiasBy::Normal), ("plane", BiasBy::Plane)];

/// The ways to tell shadows by name, and what they are.
pub const SHADOWS: &[(&str, Shadows, &str)] = &[
    ("ray", Shadows::Ray, "by rays through the hierarchy: exact"),
    ("map", Shadows::Map, "by shadow maps for points and parallel light (size, bias, pcf); by rays for others"),
    ("cube", Shadows::Cube, "as map; the six faces around a point are drawn in one pass by a geometry shader"),
    ("trapezoid", Shadows::Trapezoid, "as map; maps of parallel light are bent to a trapezoid around what is seen"),
    ("perspective", Shadows::Perspective, "as map; maps of parallel light are bent by a perspective along the view"),
    ("cascades", Shadows::Cascades, "as map; parallel light has several maps along the view (cascades)"),
    ("variance", Shadows::Variance, "by mean and variance of depths over pcf texels"),
    ("moments", Shadows::Moments, "by four moments of depths over pcf texels"),
    ("pcss", Shadows::Pcss, "soft shadows of area lights by maps, filtered as far as blockers are off"),
    (
        "volume",
        Shadows::Volume,
        "by shadow volumes of meshes in the stencil buffer, counted behind what is seen (z-fail)",
    ),
    (
        "volume-pass",
        Shadows::VolumePass,
        "by shadow volumes, counted before what is seen (z-pass): wrong where the eye is in shadow",
    ),
    ("planar", Shadows::Planar, "by meshes projected to what is flat; nothing else has shadows"),
    ("none", Shadows::None, "nothing casts a shadow"),
];

impl Shadows {
    /// True if the result holds for the pixels of one picture alone.
    pub(crate) fn is_of_pixels(self) -> bool {
        matches!(self, Self::Volume | Self::VolumePass | Self::Planar)
    }
}

/// Hidden-surface algorithm for triangles of meshes. All give one picture, but for pixels whose centres are within
/// rounding of an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// By depths of pixels (Catmull 1974).
    ZBuffer,
    /// By drawing sorted triangles; pixels that this gets wrong are counted.
    Painter,
    /// By drawing in the order of a tree of planes.
    Bsp,
    /// By Newell's sort, which cuts what has no order.
    Newell,
    /// By dividing the picture (Warnock 1969).
    Warnock,
}

/// The methods by name.
const METHODS: [(&str, Method); 5] = [
    ("zbuffer", Method::ZBuffer),
    ("painter", Method::Painter),
    ("bsp", Method::Bsp),
    ("newell", Method::Newell),
    ("warnock", Method::Warnock),
];

/// Blending method of transparent surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transparency {
    /// By the stochastic alpha test: a pixel shows one surface.
    Dither,
    /// In the order of the distances of primitives' centres.
    Sorted,
    /// In the order of a tree of planes, which cuts triangles (Fuchs, Kedem, Naylor 1980).
    Bsp,
    /// By depth peeling, a picture for each layer (Everitt 2001).
    Peel,
    /// By sums with weights that fall with distance, in any order (McGuire, Bavoil 2013).
    Weighted,
    /// By lists of all fragments of each pixel, sorted by depth (Carpenter 1984).
    ABuffer,
}

/// The blending methods by name.
const TRANSPARENCIES: [(&str, Transparency); 6] = [
    ("a-buffer", Transparency::ABuffer),
    ("peel", Transparency::Peel),
    ("bsp", Transparency::Bsp),
    ("sorted", Transparency::Sorted),
    ("weighted", Transparency::Weighted),
    ("dither", Transparency::Dither),
];

/// Choice among the lights of a scene, for each point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightChoice {
    /// All of up to sixteen; of more as many as a light has points, by chance and the light tree.
    Chosen,
    /// All.
    All,
    /// All that matter in the cell of the view.
    Clustered,
}

/// The choices among lights by name.
const LIGHTS: [(&str, LightChoice); 3] =
    [("chosen", LightChoice::Chosen), ("all", LightChoice::All), ("clustered", LightChoice::Clustered)];

/// Light of environments.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EnvironmentKind {
    /// By directions that light and surface draw, with shadows.
    #[default]
    Sampled,
    /// On diffuse surfaces by nine coefficients of each environment, without shadows.
    Harmonics,
    /// As harmonics, and on rough metals and glTF's surface by prefiltered maps and the albedo of the facets.
    Prefiltered,
}

/// The kinds of light of environments by name.
const ENVIRONMENTS: [(&str, EnvironmentKind); 3] = [
    ("sampled", EnvironmentKind::Sampled),
    ("harmonics", EnvironmentKind::Harmonics),
    ("prefiltered", EnvironmentKind::Prefiltered),
];

/// View that is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Show {
    /// The shaded picture.
    Picture,
    /// The depth along the camera's axis, near white and far black.
    Depth,
    /// A colour for each primitive.
    Primitives,
    /// The shading normal, each axis from −1…1 to 0…1.
    Normal,
    /// Number of mesh triangles that cover a pixel: black 0, red 4, yellow 8, white 12.
    Overdraw,
    /// The edges of triangles.
    Wireframe,
    /// Triangles that reach beyond the view: red the near plane, green the sides, yellow both.
    Clip,
    /// Number of triangles that each tile of the pipeline lists, on a logarithmic scale up to 2¹⁴.
    Tiles,
    /// Verdicts of the culling method: white what is rightly drawn, magenta what is wrongly left out, half red what is
    /// drawn and not seen.
    Culling,
    /// Number of shadow volumes of the first light that a pixel is in: black 0, white 8.
    Stencil,
    /// The shadow maps of the first light that has some.
    ShadowMap,
    /// Term of hybrid frames: emission of surfaces, and the background.
    Emission,
    /// Term of hybrid frames: direct light over albedo.
    Direct,
    /// Term of hybrid frames: light after one diffuse bounce over albedo.
    Indirect,
    /// Term of hybrid frames: glossy and mirror reflections.
    Reflections,
    /// Term of hybrid frames: transmitted light.
    Transparency,
    /// Term of hybrid frames: the part of the hemisphere that is open nearby.
    Occlusion,
    /// The passes of hybrid frames, drawn as a graph.
    Graph,
}

impl Show {
    /// True for a pass of hybrid frames.
    pub(crate) fn is_of_hybrid(self) -> bool {
        use Show::{Direct, Emission, Graph, Indirect, Occlusion, Reflections, Transparency};
        matches!(self, Emission | Direct | Indirect | Reflections | Transparency | Occlusion | Graph)
    }
}

/// Kind of frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameKind {
    /// Forward shading of visible surfaces.
    Forward,
    /// Visibility by rasterisation, light by rays, pass by pass.
    Hybrid,
    /// Forward shading of visible surfaces, with light after bounces by few paths, denoised.
    Preview,
}

const FRAMES: [(&str, FrameKind); 3] =
    [("forward", FrameKind::Forward), ("hybrid", FrameKind::Hybrid), ("preview", FrameKind::Preview)];

/// The names of what can be shown.
const SHOWN: [(&str, Show); 18] = [
    ("picture", Show::Picture),
    ("depth", Show::Depth),
    ("primitives", Show::Primitives),
    ("normal", Show::Normal),
    ("overdraw", Show::Overdraw),
    ("wireframe", Show::Wireframe),
    ("clip", Show::Clip),
    ("tiles", Show::Tiles),
    ("culling", Show::Culling),
    ("stencil", Show::Stencil),
    ("shadow-map", Show::ShadowMap),
    ("emission", Show::Emission),
    ("direct", Show::Direct),
    ("indirect", Show::Indirect),
    ("reflections", Show::Reflections),
    ("transparency", Show::Transparency),
    ("occlusion", Show::Occlusion),
    ("graph", Show::Graph),
];

/// The options.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Kind of frame.
    pub frame: FrameKind,
    /// Enables denoising of the terms of hybrid frames.
    pub filter: bool,
    /// Shadow technique.
    pub shadows: Shadows,
    /// Side of a shadow map in texels.
    pub size: u32,
    /// Depth bias of shadow maps in texels: how far a surface is moved, times its slope for [`BiasBy::Slope`].
    pub bias: f32,
    /// Kind of the depth bias.
    pub bias_by: BiasBy,
    /// Maps of parallel light, one behind the other along the view.
    pub cascades: u32,
    /// Texels that are compared around a point, along each axis; 1 for one.
    pub pcf: u32,
    /// Number of texels of that square that are compared, spread evenly; 0 for all.
    pub pcf_samples: u32,
    /// Hidden-surface algorithm.
    pub visibility: Method,
    /// Culling method.
    pub culling: Culling,
    /// Bounding volumes of the chunks that culling tests.
    pub bounds: BoundsKind,
    /// Blending method of transparent surfaces; hybrid frames dither.
    pub transparency: Transparency,
    /// Most transparent layers of a pixel that are peeled.
    pub layers: u32,
    /// Choice among the lights of scenes with many.
    pub lights: LightChoice,
    /// Points on each light that has an extent, and directions of environments.
    pub points: u32,
    /// Largest number of mirrors and panes of glass that are looked through one after the other.
    pub bounces: u32,
    /// Shading model of triangles.
    pub shading: ShadingModel,
    /// Technique for the light of environments.
    pub environment: EnvironmentKind,
    /// View that is shown.
    pub show: Show,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            frame: FrameKind::Forward,
            filter: true,
            shadows: Shadows::Ray,
            size: 1024,
            bias: 1.5,
            bias_by: BiasBy::Slope,
            cascades: 4,
            pcf: 1,
            pcf_samples: 0,
            visibility: Method::ZBuffer,
            culling: Culling::Items,
            bounds: BoundsKind::Aabb,
            transparency: Transparency::ABuffer,
            layers: 8,
            lights: LightChoice::Chosen,
            points: 4,
            bounces: 8,
            shading: ShadingModel::Pixel,
            environment: EnvironmentKind::Sampled,
            show: Show::Picture,
        }
    }
}

impl Options {
    /// The options of a request.
    ///
    /// # Errors
    /// [`Error::Option`] for options that exclude each other.
    pub fn of(asked: &MethodRequest) -> Result<Self, Error> {
        let default = Self::default();
        let options = Self {
            frame: named(&FRAMES, asked.word("frame")).unwrap_or(default.frame),
            filter: asked.flag("filter"),
            shadows: SHADOWS.iter().find(|s| s.0 == asked.word("shadows")).map_or(default.shadows, |s| s.1),
            size: asked.count("size"),
            bias: asked.number("bias").map_or(default.bias, |b| b as f32),
            bias_by: named(&BIASES, asked.word("bias-by")).unwrap_or(default.bias_by),
            cascades: asked.count("cascades"),
            pcf: asked.count("pcf"),
            pcf_samples: asked.count("pcf-samples"),
            visibility: named(&METHODS, asked.word("visibility")).unwrap_or(default.visibility),
            culling: named(&CULLINGS, asked.word("culling")).unwrap_or(default.culling),
            bounds: named(&BOUNDS, asked.word("bounds")).unwrap_or(default.bounds),
            transparency: named(&TRANSPARENCIES, asked.word("transparency")).unwrap_or(default.transparency),
            layers: asked.count("layers"),
            lights: named(&LIGHTS, asked.word("lights")).unwrap_or(default.lights),
            points: asked.count("points"),
            bounces: asked.count("bounces"),
            environment: named(&ENVIRONMENTS, asked.word("environment")).unwrap_or(default.environment),
            shading: named(&MODELS, asked.word("shading")).unwrap_or(default.shading),
            show: named(&SHOWN, asked.word("show")).unwrap_or(default.show),
        };
        // Hybrid frames dither, and so do shading models of triangles and views unless they are asked for more.
        let blends = options.transparency != Transparency::Dither && asked.given("transparency").is_some();
        if blends && !options.checked()?.blends() {
            return Err(Error::Option(
                "raster: transparency other than dither is of frame=forward, and of frame=preview by a-buffer, with \
                 shading=pixel and show=picture"
                    .into(),
            ));
        }
        options.checked()
    }

    /// True if transparent surfaces are blended.
    pub(crate) fn blends(&self) -> bool {
        let is_picture = self.shading == ShadingModel::Pixel && self.show == Show::Picture;
        match self.frame {
            FrameKind::Forward => self.transparency != Transparency::Dither && is_picture,
            FrameKind::Preview => self.transparency == Transparency::ABuffer,
            FrameKind::Hybrid => false,
        }
    }

    /// These, where they go together.
    fn checked(mut self) -> Result<Self, Error> {
        let refused = |why: &str| Err(Error::Option(format!("raster: {why}")));
        // The graph is of hybrid frames, whatever kind was asked for.
        if self.show == Show::Graph {
            self.frame = FrameKind::Hybrid;
        }
        // Refuse views and shadow techniques that the kind of frame has not.
        match self.frame {
            FrameKind::Forward if self.show.is_of_hybrid() => refused("this view is a pass of frame=hybrid"),
            FrameKind::Hybrid if self.show != Show::Picture && !self.show.is_of_hybrid() => {
                refused("this view is of frame=forward")
            }
            FrameKind::Preview if self.show != Show::Picture || self.shadows != Shadows::Ray => {
                refused("frame=preview has no views, and shadows by rays")
            }
            FrameKind::Hybrid | FrameKind::Preview if self.lights == LightChoice::Clustered => {
                refused("lights=clustered is of frame=forward")
            }
            FrameKind::Hybrid | FrameKind::Preview if self.environment != EnvironmentKind::Sampled => {
                refused("environment=harmonics and prefiltered are of frame=forward")
            }
            FrameKind::Hybrid | FrameKind::Preview if self.shading != ShadingModel::Pixel => {
                refused("shading models are of frame=forward")
            }
            FrameKind::Hybrid | FrameKind::Preview if self.culling != Culling::Items => {
                refused("culling other than of items is of frame=forward")
            }
            FrameKind::Hybrid if self.shadows != Shadows::Ray => refused("frame=hybrid has shadows by rays"),
            _ => Ok(self),
        }
    }
}

/// Value of a name.
fn named<T: Copy>(list: &[(&str, T)], name: &str) -> Option<T> {
    list.iter().find(|(n, _)| *n == name).map(|(_, value)| *value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_schema::integrator::INTEGRATORS;

    fn options(text: &str) -> Result<Options, Error> {
        Options::of(&MethodRequest::parse(&format!("raster:{text}")).expect("a request"))
    }

    #[test]
    fn options_follow_requests() {
        let asked = options("shadows=map, size=64,bias=-2.5,show=depth").unwrap();
        assert_eq!((asked.shadows, asked.size, asked.bias, asked.show), (Shadows::Map, 64, -2.5, Show::Depth));
        assert_eq!(options("").unwrap(), Options::default());
        for (text, part) in [
            ("show=direct", "of frame=hybrid"),
            ("frame=hybrid,show=depth", "of frame=forward"),
            ("frame=hybrid,shadows=map", "by rays"),
            ("frame=hybrid,culling=hiz", "of frame=forward"),
        ] {
            assert!(options(text).unwrap_err().to_string().contains(part), "{text}");
        }
    }

    /// Words of the schema are those that are known here.
    #[test]
    fn words_are_known() {
        let model = INTEGRATORS.iter().find(|m| m.kind == "raster").expect("a row");
        let words = |name: &str| model.parameter(name).expect(name).words().collect::<Vec<_>>();
        let all_known = |name: &str, known: &[&str]| {
            let mut known = known.to_vec();
            let mut words = words(name);
            known.sort_unstable();
            words.sort_unstable();
            assert_eq!(words, known, "{name}");
        };
        all_known("frame", &FRAMES.map(|f| f.0));
        all_known("bias-by", &BIASES.map(|f| f.0));
        all_known("culling", &CULLINGS.map(|f| f.0));
        all_known("bounds", &BOUNDS.map(|f| f.0));
        all_known("transparency", &TRANSPARENCIES.map(|f| f.0));
        all_known("environment", &ENVIRONMENTS.map(|f| f.0));
        all_known("lights", &LIGHTS.map(|f| f.0));
        all_known("visibility", &METHODS.map(|f| f.0));
        all_known("shading", &MODELS.map(|f| f.0));
        all_known("show", &SHOWN.map(|f| f.0));
        all_known("shadows", &SHADOWS.iter().map(|f| f.0).collect::<Vec<_>>());
    }
}
