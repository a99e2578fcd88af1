//! Answers that several methods have in common ([`crate::Method::supports`]).

use steradian_engine::{
    Feature,
    Support::{self, Approximates, Exact, LeavesOut, Refuses},
};

/// The answer of methods to which all light is unpolarised.
const UNPOLARIZED: Support = Approximates("filters act as on unpolarised light");

/// Answers of methods that follow rays from the camera, one sample of a pixel after the other.
pub(crate) fn of_camera_rays(feature: Feature) -> Support {
    match feature {
        Feature::AmbientLight => LeavesOut("the light from all sides that they stand for is no radiance of the scene"),
        Feature::Polarization => UNPOLARIZED,
        // What media add to a pixel has no coverage.
        Feature::TransparencyBehindMedia => Refuses(""),
        Feature::LightGroups => Refuses("'path', 'volpath' and 'raster' can"),
        Feature::Bounces => Refuses("'path', 'volpath' and 'direct' can"),
        _ => Exact,
    }
}

/// Answers of methods that scatter light at the point where it arrives, without a shift in wavelength or time.
pub(crate) fn of_local_scattering(feature: Feature) -> Support {
    match feature {
        Feature::Subsurface | Feature::Fluorescence | Feature::Schedules => Refuses(""),
        _ => of_camera_rays(feature),
    }
}

/// Answers of methods by passes.
pub(crate) fn of_passes(feature: Feature) -> Support {
    match feature {
        Feature::MovingCamera | Feature::Transparency | Feature::TransparencyBehindMedia => Refuses(""),
        Feature::ShadowCatchers => LeavesOut("they are shown as surfaces"),
        Feature::RealisticLens => Refuses("what it sees has no inverse"),
        Feature::Adaptivity => Refuses("it makes whole pictures pass by pass"),
        Feature::Bands => LeavesOut("it adds its light to R, G and B; 'path', 'volpath' and 'whitted' have bands"),
        Feature::Denoising => Refuses(
            "neighbouring pixels share photons or light paths, so that their errors are alike; \
             'path', 'volpath' and 'bdpt' can",
        ),
        _ => of_local_scattering(feature),
    }
}

/// Answers of methods that gather photons.
pub(crate) fn of_photons(feature: Feature) -> Support {
    match feature {
        Feature::GlowingMedia => Refuses("photons do not start in them"),
        Feature::InfinitePlanes => Refuses(""),
        Feature::UnsampledEmitters => LeavesOut(""),
        _ => of_passes(feature),
    }
}
