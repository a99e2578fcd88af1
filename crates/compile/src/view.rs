//! Compiling camera, film, filter, sampler and integrator.

use super::Compiler;
use steradian_core::{
    camera::{Camera, FovAxis, Patch, Projection},
    film::{Crop, FilmSpec, Filter, FilterKind},
    sampler::SamplerKind,
    scene::Settings,
};
use steradian_math::Vec2;
use steradian_request::MethodRequest;
use steradian_scene::{Family, Format, Node, NodeId, Value, names};

/// Distance of what is in focus, also of cameras in which everything is.
const FOCAL_DISTANCE: f64 = 1e6;

impl Compiler<'_> {
    /// The frame: the user's size or the film's.
    fn frame(&mut self) -> (i64, i64) {
        let default = if self.desc.format == Format::Mitsuba { (768, 576) } else { (1280, 720) };
        match (self.options.size, self.desc.film.map(|f| self.node(f))) {
            (Some((w, h)), _) => (i64::from(w), i64::from(h)),
            (None, None) => default,
            (None, Some(film)) => (
                self.given_int(film, "width").unwrap_or(default.0),
                self.given_int(film, "height").unwrap_or(default.1),
            ),
        }
    }

    /// The camera that renders: the one asked for, or the first.
    pub(super) fn chosen_camera(&self) -> Option<NodeId> {
        self.desc.camera(self.options.camera.as_deref())
    }

    /// The medium around the chosen camera.
    pub(super) fn camera_medium(&mut self) -> Option<u32> {
        let medium = self.chosen_camera().and_then(|id| self.reference(self.node(id), "medium"));
        self.medium(medium)
    }

    /// Compiles the chosen camera, but for the medium around it.
    pub(super) fn camera(&mut self) -> Option<Camera> {
        let Some(id) = self.chosen_camera() else {
            self.error(
                None,
                match &self.options.camera {
                    Some(want) => format!("the scene has no camera '{want}'; it has {}", self.desc.cameras.len()),
                    None => "the scene has no camera".into(),
                },
            );
            return None;
        };
        let node = self.node(id);
        let Some(place) = self.transform(node, "to_world").affine() else {
            self.error(node.span, "the camera's transform is singular or not finite");
            return None;
        };
        let motion = self.camera_motion(node);
        let place = motion.as_ref().and_then(|motion| motion.at(0.0)).unwrap_or(place);
        let motion = motion.filter(|motion| !motion.is_still());
        let (w, h) = self.frame();
        let aspect = match node.get("frame_aspect") {
            Some(_) => self.positive_or(node, "frame_aspect", 1.0),
            None => (w.max(1) as f32) / (h.max(1) as f32),
        };
        let unit = if aspect >= 1.0 { Vec2::new(aspect, 1.0) } else { Vec2::new(1.0, 1.0 / aspect) };
        let (projection, half) = match node.kind.as_str() {
            "perspective" => {
                let fov = self.positive(node, "fov");
                if fov >= 180.0 {
                    self.error(node.span, format!("a perspective camera cannot have a field of view of {fov} degrees"));
                    return None;
                }
                let axis_name = self.word(node, "fov_axis");
                let Some(axis) = FovAxis::named(axis_name) else {
                    self.error(
                        node.span,
                        format!("'{axis_name}' is not an axis of view; known are x, y, smaller, larger, diagonal"),
                    );
                    return None;
                };
                (Projection::Perspective, axis.half_window(fov.to_radians(), aspect))
            }
            "orthographic" => {
                let half = if self.desc.format == Format::Mitsuba { Vec2::new(1.0, 1.0 / aspect) } else { unit };
                (Projection::Orthographic, half)
            }
            "spherical" => (self.sphere_map(node), Vec2::ONE),
            "realistic" => {
                let lens = self.lens_system(node)?;
                let half = 0.5e-3 * self.film_diagonal(node) / lens.image_distance();
                (Projection::Realistic(lens), Vec2::new(aspect, 1.0) * (half / aspect.hypot(1.0)))
            }
            "radiance_meter" => (Projection::Ray, Vec2::ONE),
            "irradiance_meter" => (self.patch(node)?, Vec2::ONE),
            other => match self.own_projection(node) {
                Some(own) => (own?, Vec2::ONE),
                None => {
                    let help = self.nearest_kind(node);
                    self.error_help(node.span, format!("camera '{other}' is not implemented"), help);
                    return None;
                }
            },
        };
        let mut window = [-half.x, half.x, -half.y, half.y];
        if let Some(s) = self.list(node, "screen_window") {
            if s.len() != 4 || s[0] == s[1] || s[2] == s[3] {
                self.error(node.span, "a screen window is four numbers x0 x1 y0 y1 that span an area");
                return None;
            }
            // The window is in units of the shorter half axis.
            let k = match &projection {
                Projection::Perspective => half.x / unit.x,
                _ => 1.0,
            };
            window = [s[0], s[1], s[2], s[3]].map(|v| v * k);
        }
        if let Projection::Perspective | Projection::Orthographic = projection {
            let (dx, dy) = (self.float(node, "principal_x"), self.float(node, "principal_y"));
            let (ww, wh) = (window[1] - window[0], window[3] - window[2]);
            window = [window[0] - dx * ww, window[1] - dx * ww, window[2] + dy * wh, window[3] + dy * wh];
        }
        let lens_radius = match &projection {
            Projection::Realistic(lens) => lens.stop_radius(),
            Projection::Patch(..) => 1.0,
            _ => self.float_or(node, "lens_radius", 0.0).max(0.0),
        };
        let focal_distance = self.positive_or(node, "focal_distance", FOCAL_DISTANCE);
        let [near, far] = self.planes(node)?;
        Some(Camera {
            projection,
            world_from_camera: place,
            motion,
            window,
            lens_radius,
            focal_distance,
            near,
            far,
            medium: None,
        })
    }

    /// Near and far distances of rays along the axis.
    fn planes(&mut self, node: &Node) -> Option<[f32; 2]> {
        let near = if node.get("near").is_some() { self.float_or(node, "near", 0.0).max(0.0) } else { 0.0 };
        let far = if node.get("far").is_some() { self.positive_or(node, "far", f64::INFINITY) } else { f32::INFINITY };
        if far <= near {
            self.error(node.span, format!("'far', {far}, must be more than 'near', {near}"));
            return None;
        }
        Some([near, far])
    }

    /// Mapping of directions of a spherical camera.
    fn sphere_map(&mut self, node: &Node) -> Projection {
        match self.choice(node, "mapping", &[("equalarea", false), ("equirectangular", true)]) {
            true => Projection::SphericalEquirectangular,
            false => Projection::SphericalEqualArea,
        }
    }

    /// Receiving surface of an irradiance meter.
    fn patch(&mut self, node: &Node) -> Option<Projection> {
        let name = self.word(node, "surface");
        let Some(patch) = Patch::named(name) else {
            let known = "square, disk, sphere, cylinder";
            self.error(node.span, format!("'{name}' is no surface of a meter; known are {known}"));
            return None;
        };
        Some(Projection::Patch(patch, self.bool(node, "inward")))
    }

    /// Compiles film and filter.
    pub(super) fn film(&mut self) -> Option<FilmSpec> {
        let empty = Node::new(Family::Film, "rgb", None);
        let node = self.desc.film.map_or(&empty, |f| self.desc.node(f));
        let (w, h) = self.frame();
        let span = node.param("width").or(node.param("height")).and_then(|p| p.span).or(node.span);
        if w < 1 || h < 1 || w > FilmSpec::MAX_SIDE || h > FilmSpec::MAX_SIDE {
            let most = FilmSpec::MAX_SIDE;
            self.error(span, format!("a film of {w} x {h} pixels cannot be made; its sides are at most {most} pixels"));
            return None;
        }
        let (width, height) = (w as u32, h as u32);
        let whole = Crop { x0: 0, y0: 0, x1: width, y1: height };
        let crop = match (self.options.crop, node.get("crop")) {
            (Some(c), _) => Some(c.map(i64::from)),
            // A size of the user's own makes pixel numbers of the file meaningless.
            (None, Some(_)) if self.options.size.is_some() => None,
            // In the description the two bounds of an axis stand side by side: x0 x1 y0 y1.
            (None, Some(Value::Ints(c))) if c.len() == 4 => Some([c[0], c[2], c[1], c[3]]),
            (None, Some(_)) => {
                self.error(node.span, "a crop is four whole numbers x0 x1 y0 y1");
                None
            }
            (None, None) => None,
        };
        let crop = match crop {
            None => whole,
            Some([x0, y0, x1, y1]) => {
                let at = |v: i64, limit: u32| v.clamp(0, i64::from(limit)) as u32;
                let c = Crop { x0: at(x0, width), y0: at(y0, height), x1: at(x1, width), y1: at(y1, height) };
                if c.x0 >= c.x1 || c.y0 >= c.y1 {
                    self.error(
                        node.span,
                        format!("the crop {x0},{y0},{x1},{y1} leaves nothing of {width} x {height} pixels"),
                    );
                    return None;
                }
                c
            }
        };
        if u64::from(crop.width()) * u64::from(crop.height()) > FilmSpec::MAX_PIXELS {
            let (w, h, most) = (crop.width(), crop.height(), FilmSpec::MAX_PIXELS);
            let help = (crop == whole).then(|| "a crop renders a part of it".into());
            self.error_help(span, format!("a film of {w} x {h} pixels cannot be made; at most {most} pixels"), help);
            return None;
        }
        let is_irradiance = self.chosen_camera().is_some_and(|c| self.node(c).kind == "irradiance_meter");
        let receives = if is_irradiance { std::f32::consts::PI } else { 1.0 };
        let imaging_ratio = receives * self.positive(node, "exposure_time") * self.positive(node, "iso") / 100.0;
        let max_component = match node.float("max_component") {
            // pbrt's own default, and any other number beyond f32, clamp nothing.
            Some(v) if v > f64::from(f32::MAX) => f32::INFINITY,
            None if node.get("max_component").is_none() => f32::INFINITY,
            _ => self.positive_or(node, "max_component", 1.0),
        };
        let (response, sensor, bands) = (self.response(node), self.sensor(node), self.bands(node));
        let filter = self.filter()?;
        let unit_luminance = self.unit_luminance();
        Some(FilmSpec {
            width,
            height,
            crop,
            filter,
            imaging_ratio,
            unit_luminance,
            max_component,
            response,
            bands,
            layers: if node.kind == "gbuffer" { FilmSpec::GEOMETRY } else { &[] },
            sensor,
        })
    }

    fn filter(&mut self) -> Option<Filter> {
        let empty = Node::new(Family::Filter, "box", None);
        let node = self.desc.filter.map_or(&empty, |f| self.desc.node(f));
        let kind = match node.kind.as_str() {
            "box" => FilterKind::Box,
            "tent" => FilterKind::Tent,
            "gaussian" => FilterKind::Gaussian { sigma: self.positive(node, "sigma") },
            "mitchell" => FilterKind::Mitchell { b: self.float(node, "b"), c: self.float(node, "c") },
            "catmull_rom" => FilterKind::Mitchell { b: 0.0, c: 0.5 },
            "lanczos" => FilterKind::Lanczos { tau: self.positive(node, "tau") },
            "blackman_harris" => FilterKind::BlackmanHarris,
            other => {
                let help = names::did_you_mean(other, Family::Filter.kinds());
                self.error_help(node.span, format!("pixel filter '{other}' is not implemented"), help);
                return None;
            }
        };
        let radius = Vec2::new(self.positive(node, "radius_x"), self.positive(node, "radius_y"));
        let filter = Filter::new(kind, radius);
        if filter.is_none() {
            self.error(node.span, format!("pixel filter '{}' with these parameters has no volume", node.kind));
        }
        filter
    }

    /// The method that the file names, with the options that are the method's alone.
    pub(super) fn method(&mut self) -> Option<MethodRequest> {
        const OF_ALL: [&str; 4] = ["max_depth", "rr_depth", "hide_emitters", "samples"];
        let node = self.desc.node(self.desc.integrator?);
        let Some(model) = self.model_of(node) else {
            let known = || self.all_kinds(Family::Integrator);
            let help = self.nearest_kind(node).unwrap_or_else(|| format!("known are {}", known()));
            let what = format!("integrator '{}' is not implemented ({help}); a path tracer takes its place", node.kind);
            self.diagnostics.dropped(&self.desc.sources, node.span, what);
            return None;
        };
        let (method, faults) = MethodRequest::of_node(node, model, &OF_ALL);
        for fault in faults {
            self.error_help(fault.span, fault.message, fault.hint);
        }
        Some(method)
    }

    /// Render settings of the scene.
    pub(super) fn settings(&mut self) -> Settings {
        let mut settings = Settings {
            max_depth: u32::MAX,
            rr_depth: 2,
            hide_emitters: false,
            hidden_emitters_block: false,
            spp: 16,
            sampler: SamplerKind::default(),
            named_sampler: SamplerKind::default(),
            seed: 0,
        };
        if let Some(node) = self.desc.integrator.map(|i| self.desc.node(i)) {
            settings.max_depth = match self.given_int(node, "max_depth") {
                Some(d) if d >= 0 => d.min(i64::from(u32::MAX)) as u32,
                _ => u32::MAX,
            };
            settings.hide_emitters = self.bool_or(node, "hide_emitters", false);
            // As with samplers below: roulette changes the noise alone, and other programs' files have their defaults.
            if let (Format::Native, Some(depth)) = (self.desc.format, self.given_int(node, "rr_depth")) {
                settings.rr_depth = depth.clamp(0, i64::from(u32::MAX)) as u32;
            }
        }
        if let Some(node) = self.desc.sampler.map(|s| self.desc.node(s)) {
            match SamplerKind::named(&node.kind) {
                Some(kind) => settings.named_sampler = kind,
                None => {
                    let help = names::did_you_mean(&node.kind, Family::Sampler.kinds());
                    self.error_help(node.span, format!("sampler '{}' is not implemented", node.kind), help);
                }
            }
            // The point set changes the noise of a picture, not the picture: files of other programs name theirs, often
            // what was there by default, and none is better than ours.
            let named = settings.named_sampler;
            if self.desc.format == Format::Native {
                settings.sampler = named;
            }
            settings.seed = self.int(node, "seed") as u64;
            match self.given_int(node, "samples") {
                Some(n) if n >= 1 => settings.spp = n.min(1 << 24) as u32,
                Some(n) => {
                    let span = node.param("samples").and_then(|p| p.span).or(node.span);
                    self.error(span, format!("{n} samples per pixel make no picture"));
                }
                None => {}
            }
        }
        // Metropolis counts its own.
        if let Some(n) = self.desc.integrator.and_then(|i| self.desc.node(i).int("samples")) {
            settings.spp = n.clamp(1, 1 << 24) as u32;
        }
        settings
    }
}

#[cfg(test)]
mod tests {
    use crate::{Options, compile};
    use steradian_core::film::Crop;
    use steradian_scene::{Family, Node, SceneDesc, Value};

    fn crop(options: Options) -> Option<Crop> {
        let mut desc = SceneDesc::default();
        let camera = desc.add(Node::new(Family::Camera, "perspective", None));
        desc.cameras.push(camera);
        let film = Node::new(Family::Film, "rgb", None)
            .with("width", 64_i64)
            .with("height", 32_i64)
            .with("crop", Value::Ints(vec![8, 40, 4, 12]));
        desc.film = Some(desc.add(film));
        compile(&desc, &options).scene.map(|s| s.film().crop)
    }

    #[test]
    fn the_crop_of_a_film_is_two_columns_then_two_rows() {
        assert_eq!(crop(Options::default()), Some(Crop { x0: 8, y0: 4, x1: 40, y1: 12 }));
    }

    #[test]
    fn the_user_goes_before_the_film() {
        let own = Options { crop: Some([1, 2, 3, 4]), ..Options::default() };
        assert_eq!(crop(own), Some(Crop { x0: 1, y0: 2, x1: 3, y1: 4 }));
        // A frame of another size has other pixels.
        let resized = Options { size: Some((16, 8)), ..Options::default() };
        assert_eq!(crop(resized), Some(Crop { x0: 0, y0: 0, x1: 16, y1: 8 }));
    }
}
