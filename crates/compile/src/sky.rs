//! Compiling skies, by tables and of simulated air: two lights each, the dome and the sun.

use super::Compiler;
use steradian_core::light::{
    Environment, Light,
    sky::{Air, AirDome, AirSun, Atmosphere, Celestial, Contents, Moment, SkyDome, SunDisc, SunLook},
};
use steradian_math::{
    DVec3, Vec3,
    color::space::REC709,
    spectra::{
        ColorMode,
        role::{Color, Role},
    },
    transform::Affine,
};
use steradian_scene::Node;

/// Parameters that `sun_direction` replaces.
const PLACE_AND_TIME: [&str; 9] =
    ["latitude", "longitude", "timezone", "year", "month", "day", "hour", "minute", "second"];

/// Height of the sun in degrees below which the sky has no light of its.
const NIGHT: f32 = -18.0;

/// Light of the sky's sources, unless its scale leaves nothing of it.
fn lit(mode: ColorMode, scale: f32, celestial: impl FnOnce() -> Option<Celestial>) -> Option<Light> {
    let celestial = (scale > 0.0).then(celestial).flatten()?;
    let (radiance, celestial) = (Color::BLACK, Some(celestial));
    Some(Light::Environment(Box::new(Environment { radiance, scale, image: None, celestial, portal: None, mode })))
}

impl Compiler<'_> {
    /// The clear sky by tables, and its sun.
    pub(super) fn sky(&mut self, node: &Node) -> Vec<Light> {
        let node = &*self.within_ranges(node);
        let Some([up, sun]) = self.up_and_sun(node) else { return Vec::new() };
        if sun.dot(up) < 0.0 {
            let message = "the sun is below the horizon at this place and time; this sky is black";
            self.diagnostics.warn(&self.desc.sources, node.span, message);
        }
        let albedo = self.constant_color(node, "albedo", Role::Albedo);
        let turbidity = self.float(node, "turbidity");
        let air = Atmosphere { turbidity, albedo, up, sun, mode: self.mode };
        let look = SunLook {
            aperture: self.float(node, "sun_aperture"),
            limb_darkening: self.bool(node, "limb_darkening"),
            coarse_rgb: self.choice(node, "sun_rgb", &[("exact", false), ("mitsuba", true)]),
        };
        let sky = || Some(Celestial::Sky(Box::new(SkyDome::new(&air))));
        self.dome_and_sun(node, sky, || Some(Celestial::Sun(Box::new(SunDisc::new(&air, &look)))))
    }

    /// The sky of simulated air, and its sun.
    pub(super) fn atmosphere(&mut self, node: &Node) -> Vec<Light> {
        let node = &*self.within_ranges(node);
        let Some([up, sun]) = self.up_and_sun(node) else { return Vec::new() };
        if sun.dot(up) < NIGHT.to_radians().sin() {
            let message =
                format!("the sun is lower than {NIGHT}° at this place and time; stars and airglow are not in this sky");
            self.diagnostics.warn(&self.desc.sources, node.span, message);
        }
        let albedo = self.constant_color(node, "albedo", Role::Albedo);
        let albedo = match (albedo, self.mode) {
            (Color::Lanes(lanes), ColorMode::Rgb) => {
                Color::rgb(Vec3::from(lanes.to_rgb()), &REC709, Role::Albedo, ColorMode::Spectral)
            }
            (albedo, _) => albedo,
        };
        let mut number = |name| f64::from(self.float(node, name));
        let contents = Contents {
            pressure: number("pressure"),
            ozone: number("ozone"),
            aerosol: number("aerosol"),
            angstrom: number("angstrom"),
            aerosol_albedo: number("aerosol_albedo") as f32,
            aerosol_height: number("aerosol_height"),
            g: number("g") as f32,
        };
        let altitude = self.float(node, "altitude");
        let multiple = self.choice(node, "scattering", &[("multiple", true), ("single", false)]);
        let air = Air { contents, albedo, altitude, multiple, up, sun, mode: self.mode };
        let (aperture, darkening) = (self.float(node, "sun_aperture"), self.bool(node, "limb_darkening"));
        let sky = || Some(Celestial::Air(Box::new(AirDome::new(&air))));
        let sun = || AirSun::new(&air, aperture, darkening).map(|sun| Celestial::AirSun(Box::new(sun)));
        self.dome_and_sun(node, sky, sun)
    }

    /// The unit vectors to the zenith and to the sun in the world; `None` after an error.
    fn up_and_sun(&mut self, node: &Node) -> Option<[Vec3; 2]> {
        let place = self.light_place(node)?;
        let sun = self.sun_direction(node, &place)?;
        Some([place.vector(Vec3::Z).try_normalize()?, sun])
    }

    /// The lights of a sky, each where its scale leaves something of it; none after an error, for they take long.
    fn dome_and_sun(
        &mut self,
        node: &Node,
        sky: impl FnOnce() -> Option<Celestial>,
        sun: impl FnOnce() -> Option<Celestial>,
    ) -> Vec<Light> {
        let scale = self.float(node, "scale");
        let (of_sky, of_sun) = (self.float(node, "sky_scale"), self.float(node, "sun_scale"));
        if self.diagnostics.has_errors() {
            return Vec::new();
        }
        let lights = [lit(self.mode, scale * of_sky, sky), lit(self.mode, scale * of_sun, sun)];
        lights.into_iter().flatten().collect()
    }

    /// The unit vector to the sun in the world; `None` after an error.
    fn sun_direction(&mut self, node: &Node, place: &Affine) -> Option<Vec3> {
        if node.get("sun_direction").is_some() {
            if let Some(other) = PLACE_AND_TIME.into_iter().find(|n| node.get(n).is_some()) {
                self.error(node.span, format!("'sun_direction' excludes '{other}'"));
                return None;
            }
            let direction = self.dvec3_or(node, "sun_direction", DVec3::Z).as_vec3().try_normalize();
            if direction.is_none() {
                self.error(node.span, "the direction of the sun is zero");
            }
            return direction;
        }
        let date = ["year", "month", "day"].map(|name| self.int(node, name));
        // In f64, where seconds of a day count.
        let mut number = |name| self.double(node, name);
        let hours = number("hour") + number("minute") / 60.0 + number("second") / 3600.0;
        let moment = Moment {
            latitude: number("latitude"),
            longitude: number("longitude"),
            timezone: number("timezone"),
            date,
            hours,
        };
        // East is on the right of who looks north in a left-handed world.
        place.vector(moment.sun().as_vec3() * Vec3::new(1.0, -1.0, 1.0)).try_normalize()
    }
}
