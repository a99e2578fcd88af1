//! Parts of a scene.

use crate::{
    camera::Camera,
    film::FilmSpec,
    light::{LightGroups, Lights},
    material::{Material, Needs},
    medium::Medium,
    sampler::SamplerKind,
    shape::Shape,
};
use std::{collections::BTreeMap, sync::Arc};
use steradian_accel::Accel;
use steradian_math::{DVec3, Motion, spectra::ColorMode, transform::Affine};
use steradian_request::MethodRequest;
use steradian_texture::{FloatTexture, Textures, pages::Pages};

/// A shape with what is attached to it.
#[derive(Clone, Debug)]
pub struct Geometry {
    /// Shape of the surface.
    pub shape: Shape,
    /// Index of its material.
    pub material: u32,
    /// Opacity that lets rays through by chance.
    pub alpha: Option<FloatTexture>,
    /// True if rays pass that meet it from behind, against the geometric normal.
    pub is_single_sided: bool,
    /// True if pictures show of it only the shadows that it receives.
    pub catches_shadows: bool,
    /// Index of what it emits.
    pub emitter: Option<u32>,
    /// For emitting shapes the light of each primitive; one entry when all belong to the same. In groups they count
    /// from [`Placement::first_light`].
    pub lights: Box<[u32]>,
    /// The media on the side against the normal and on the side of it, where the shape separates media.
    pub media: Option<(Option<u32>, Option<u32>)>,
    /// True if it scatters nothing.
    pub is_interface: bool,
    /// Data needed at its points for scattering and emission; set by [`Scene::new`](super::Scene::new).
    pub needs: Needs,
    /// From the space of the object to the shape's group, where a normal map of the material asks for it.
    pub group_from_object: Option<Arc<Affine>>,
    /// Number of the shape in the description, from one.
    pub id: u32,
}

impl Geometry {
    /// True if rays pass some of its points.
    #[inline]
    pub fn is_masked(&self) -> bool {
        self.alpha.is_some() || self.is_single_sided
    }

    /// The light that a primitive belongs to.
    #[inline]
    pub fn light(&self, prim: u32) -> Option<u32> {
        match &*self.lights {
            [] => None,
            [one] => Some(*one),
            many => many.get(prim as usize).copied(),
        }
    }
}

/// A placed group.
#[derive(Clone, Debug)]
pub struct Placement {
    /// Transform as the shutter opens.
    pub world_from_group: Affine,
    /// Motion while the shutter is open.
    pub motion: Option<Arc<Motion>>,
    /// First geometry of the group in [`Parts::geometries`].
    pub base: u32,
    /// Number of geometries in the group.
    pub count: u32,
    /// The first of its lights.
    pub first_light: u32,
}

impl Placement {
    /// Transform at a moment of the exposure.
    #[inline]
    pub fn at(&self, time: f32) -> Affine {
        match &self.motion {
            None => self.world_from_group,
            Some(motion) => motion.at(time).unwrap_or(self.world_from_group),
        }
    }
}

/// Settings that a scene asks of the renderer; the user's own take precedence.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Most scattering events on a path; `u32::MAX` for no limit.
    pub max_depth: u32,
    /// Scattering events before Russian roulette.
    pub rr_depth: u32,
    /// Hides lights from the camera.
    pub hide_emitters: bool,
    /// Makes hidden lights block camera rays all the same, as black surfaces. Methods are compared so: the region
    /// behind a lamp close to a ceiling differs by the radius of photons, which tells nothing.
    pub hidden_emitters_block: bool,
    /// Samples per pixel.
    pub spp: u32,
    /// The point set.
    pub sampler: SamplerKind,
    /// The one that the file names, which is another one than `sampler` where files of other programs name theirs.
    pub named_sampler: SamplerKind,
    /// Random seed.
    pub seed: u64,
}

/// Parts of a [`Scene`](super::Scene); all else follows from them.
#[derive(Clone, Debug)]
pub struct Parts {
    /// Meaning of the spectral lanes.
    pub mode: ColorMode,
    /// World geometry first, then that of each group.
    pub geometries: Vec<Geometry>,
    /// The structure that rays go through: the hierarchy, unless another one was asked for.
    pub accel: Arc<Accel>,
    /// Placed groups, by the hierarchy's instance index.
    pub placements: Vec<Placement>,
    /// Number of geometries of the world itself; those of groups follow.
    pub world_count: u32,
    /// Materials.
    pub materials: Vec<Material>,
    /// Textures.
    pub textures: Textures,
    /// Lights.
    pub lights: Lights,
    /// Media.
    pub media: Vec<Medium>,
    /// Camera.
    pub camera: Camera,
    /// Film.
    pub film: FilmSpec,
    /// The method that the scene's file names, with its options.
    pub method: Option<MethodRequest>,
    /// Settings of the scene.
    pub settings: Settings,
    /// Groups of lights.
    pub light_groups: LightGroups,
    /// Names of objects, by [`Geometry::id`]; those that the file gives none are numbered.
    pub object_names: BTreeMap<u32, String>,
    /// Names of materials, by index, for reports.
    pub material_names: Vec<String>,
    /// Page store of the textures that are not in memory, if texture memory is limited.
    pub texture_pages: Option<Arc<Pages>>,
    /// The point of the file's world that is the scene's origin: single precision has no room for details far away.
    pub origin: DVec3,
    /// Samples per pixel by which footprints are as wide as they are.
    pub spp: u32,
}

impl Parts {
    /// True if light is absorbed or scattered between surfaces.
    pub fn has_media(&self) -> bool {
        self.camera.medium.is_some() || self.geometries.iter().any(|g| g.media.is_some_and(|m| m != (None, None)))
    }
}
