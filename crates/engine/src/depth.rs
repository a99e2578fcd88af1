//! Limits on the length of paths.

use steradian_core::Scene;

/// Path depth.
#[derive(Clone, Copy, Debug)]
pub struct Depth {
    /// Most scattering events; `u32::MAX` for no limit.
    pub max: u32,
    /// Scattering events before Russian roulette.
    pub roulette_after: u32,
    /// Makes lights invisible to the camera.
    pub hide_emitters: bool,
}

impl Depth {
    /// True if a path passes a surface straight after so many scattering events: camera rays pass all that emits where
    /// lights are hidden from the camera, as in Mitsuba 3.9.
    #[inline]
    pub fn hides(&self, scene: &Scene, geometry: u32, events: u32) -> bool {
        self.hide_emitters && events == 0 && scene.is_passed_when_hidden(geometry)
    }
}
