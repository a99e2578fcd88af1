//! Compiling lights that are not attached to shapes.

use super::{Compiler, cube, schedule::Lamp};
use steradian_core::light::{
    Ambient, Environment, Goniometric, Isotropic, Light, Projection, Spot,
    environment::{EnvironmentImage, Parametrization},
    punctual::{Falloff, Slide},
};
use steradian_image::Texels;
use steradian_math::{
    Vec2, Vec3,
    color::luminance,
    spectra::{
        photometry::photometric_from_y,
        role::{Color, Role},
    },
    transform::Affine,
};
use steradian_scene::{ColorSpace, Family, Format, Node, NodeId, SpectrumValue, Value};
use steradian_texture::SpectrumTexture;

/// Mean luminance of an image.
pub(super) fn mean_luminance(t: &Texels) -> f32 {
    let mut sum = 0.0_f64;
    for y in 0..t.height {
        for x in 0..t.width {
            sum += f64::from(texel_luminance(t, x, y));
        }
    }
    (sum / (t.width * t.height).max(1) as f64) as f32
}

fn texel_luminance(t: &Texels, x: usize, y: usize) -> f32 {
    match t.channels {
        1 | 2 => t.linear(x, y, 0),
        _ => luminance(Vec3::new(t.linear(x, y, 0), t.linear(x, y, 1), t.linear(x, y, 2))),
    }
}

fn exceeds_one(t: &Texels) -> bool {
    let colors = t.channels.min(3);
    (0..t.height).any(|y| (0..t.width).any(|x| (0..colors).any(|c| t.linear(x, y, c) > 1.0)))
}

impl Compiler<'_> {
    /// The factor that brings a spectrum to luminance one where the light asks for it (`normalize`). RGB values are
    /// relative to a white of luminance one already.
    pub(super) fn normalization(&mut self, light: &Node, name: &str) -> f32 {
        if !self.bool(light, "normalize") {
            return 1.0;
        }
        match light.get(name) {
            Some(Value::Spectrum(SpectrumValue::Rgb(..)) | Value::Node(_)) | None => 1.0,
            _ => {
                let y = self.constant_color(light, name, Role::Illuminant).luminance(self.mode);
                if y > 0.0 { 1.0 / y } else { 1.0 }
            }
        }
    }

    /// A guess at the mean luminance of a textured parameter.
    pub(super) fn texture_luminance(&mut self, light: &Node, name: &str) -> f32 {
        let image = light
            .node(name)
            .map(|id| self.node(id))
            .filter(|n| (n.family, n.kind.as_str()) == (Family::Texture, "image"));
        match image.and_then(|n| self.image(n).map(|t| (n, t))) {
            Some((n, t)) => (mean_luminance(&t) * self.float(n, "scale")).max(1e-6),
            None => 1.0,
        }
    }

    /// A parameter that is emitted. RGB values are colours under D65, so that white means D65; but the colours of a
    /// Mitsuba texture become spectra as if they were reflectances, as they do in Mitsuba.
    pub(super) fn emitted(&mut self, light: &Node, name: &str) -> SpectrumTexture {
        let texture = light.node(name).map(|id| self.node(id)).filter(|n| n.kind != "constant");
        let role = match texture.filter(|_| self.desc.format == Format::Mitsuba) {
            None => Role::Illuminant,
            Some(n) if n.kind == "image" && self.image(n).is_some_and(|t| exceeds_one(&t)) => Role::Unbounded,
            Some(_) => Role::Albedo,
        };
        let default = self.default_spectrum(light, "radiance");
        self.spectrum_or(light, name, role, default)
    }

    /// A constant emission spectrum with scale and normalisation applied.
    pub(super) fn emission_color(&mut self, light: &Node, name: &str) -> (Color, f32) {
        let color = self.constant_color(light, name, Role::Illuminant);
        let scale = self.float(light, "scale") * self.normalization(light, name);
        (color, scale)
    }

    pub(super) fn light_place(&mut self, node: &Node) -> Option<Affine> {
        let place = self.transform(node, "to_world").affine();
        if place.is_none() {
            self.error(node.span, format!("the transform of light '{}' is singular or not finite", node.kind));
        }
        place
    }

    /// Ratio of the flux or illuminance `name` of a light (lm or lx, converted to units of the scene's radiance) to
    /// that of one unit of its spectrum, of a luminance. With `normalize` it is that of a white light, as in pbrt: a
    /// colour then takes its part away.
    pub(super) fn luminous_target(&mut self, node: &Node, name: &str, luminance: f32) -> Option<f32> {
        let units = f64::from(self.if_positive(node, name)?) / self.unit_luminance();
        let of = if self.bool(node, "normalize") { 1.0 } else { f64::from(luminance) };
        (of > 0.0).then_some((units / of) as f32)
    }

    /// The luminance of radiance of Y = 1, cd/m²: radiances are in W/(m² sr nm), but numbers of glTF files in cd/m².
    pub(super) fn unit_luminance(&self) -> f64 {
        match self.desc.format {
            Format::Gltf => 1.0,
            _ => photometric_from_y(1.0),
        }
    }

    /// Compiles a light and adds it.
    pub(super) fn light(&mut self, id: NodeId) {
        let node = self.node(id);
        let light = match node.kind.as_str() {
            "sky" | "atmosphere" => {
                let lights = if node.kind == "sky" { self.sky(node) } else { self.atmosphere(node) };
                lights.into_iter().for_each(|light| self.add_light(node, id, light));
                return;
            }
            "ambient" => {
                let (radiance, scale) = self.emission_color(node, "radiance");
                let group = self.light_group(node.name.as_deref(), id);
                self.ambient.push(Ambient { radiance, scale, group });
                return;
            }
            "point" => self.point(node),
            "spot" => self.spot(node),
            "distant" => self.distant(node),
            "environment" => self.environment(node).map(|e| Light::Environment(Box::new(e))),
            "backdrop" => {
                if self.backdrop.is_some() {
                    self.error(node.span, "a scene has one backdrop, and this is another");
                }
                self.backdrop = self.environment(node).map(Box::new);
                return;
            }
            "goniometric" => self.goniometric(node),
            "projection" => self.projection(node),
            other => self.own_light(node).unwrap_or_else(|| {
                let help = self.nearest_kind(node);
                self.error_help(node.span, format!("light '{other}' is not implemented"), help);
                None
            }),
        };
        if let Some(light) = light {
            self.add_light(node, id, light);
        }
    }

    fn add_light(&mut self, node: &Node, id: NodeId, light: Light) {
        let group = self.light_group(node.name.as_deref(), id);
        self.grouped.push((self.lights.len() as u32, group));
        self.schedule(node, Lamp::Light(self.lights.len() as u32));
        self.lights.push(light);
    }

    /// The group of a light by its name, or one of its own where it has none, called after its kind.
    pub(super) fn light_group(&mut self, name: Option<&str>, light: NodeId) -> u32 {
        if let Some(name) = name {
            return self.light_groups.number(name);
        }
        let count = self.unnamed_lights.len() + 1;
        let number = *self.unnamed_lights.entry(light).or_insert(count);
        self.light_groups.number(&format!("{}_{number}", self.node(light).kind))
    }

    fn point(&mut self, node: &Node) -> Option<Light> {
        use std::f32::consts::PI;
        let place = self.light_place(node)?;
        let (color, mut scale) = self.emission_color(node, "intensity");
        if let Some(power) = self.luminous_target(node, "power", color.luminance(self.mode)) {
            scale *= power / (4.0 * PI);
        }
        let p = self.vec3(node, "position");
        let p = place.point(p);
        if !p.is_finite() {
            self.error(node.span, "the position of this light is not finite");
            return None;
        }
        Some(Isotropic { position: p, intensity: color.scaled(scale) }.into())
    }

    fn spot(&mut self, node: &Node) -> Option<Light> {
        let place = self.light_place(node)?;
        let (color, mut scale) = self.emission_color(node, "intensity");
        let total = self.positive(node, "cone_angle").clamp(1e-3, 180.0).to_radians();
        let start = self.float(node, "falloff_start").clamp(0.0, 180.0).to_radians().min(total);
        let falloff = self.choice(
            node,
            "falloff",
            &[("smoothstep", Falloff::Smoothstep), ("linear", Falloff::Linear), ("quadratic", Falloff::Quadratic)],
        );
        let texture = self.reference(node, "texture").map(|id| self.texture(id, Role::Albedo));
        let mut spot = Spot {
            position: place.point(Vec3::ZERO),
            world_from_light: place,
            intensity: Color::BLACK,
            total,
            start,
            falloff,
            texture,
        };
        if let Some(power) = self.luminous_target(node, "power", color.luminance(self.mode)) {
            scale *= power / spot.flux_share();
        }
        spot.intensity = color.scaled(scale);
        Some(spot.into())
    }

    fn distant(&mut self, node: &Node) -> Option<Light> {
        let (color, mut scale) = self.emission_color(node, "radiance");
        if let Some(e) = self.luminous_target(node, "illuminance", color.luminance(self.mode)) {
            scale *= e;
        }
        let d = self.vec3(node, "direction");
        match (-d).try_normalize() {
            Some(wi) => Some(Light::Distant(wi, color.scaled(scale))),
            None => {
                self.error(node.span, "the direction of this light is zero or not finite");
                None
            }
        }
    }

    /// An environment, or a backdrop, which gives no light.
    fn environment(&mut self, node: &Node) -> Option<Environment> {
        use std::f32::consts::PI;
        let is_light = node.kind == "environment";
        let place = self.light_place(node)?;
        let portal = if is_light { self.portal(node) } else { None };
        let (radiance, mut scale) = self.emission_color(node, "radiance");
        let luminance = radiance.luminance(self.mode);
        let illuminance = if is_light { self.luminous_target(node, "illuminance", luminance) } else { None };
        let image = if node.get("file").is_some() {
            let texels = cube::strip((*self.image(node)?).clone());
            let octahedral = texels.width == texels.height;
            let poles = self.choice(node, "rows", &[("centers", false), ("poles", true)]);
            let latlong = match self.desc.format {
                Format::Pbrt => Parametrization::LatLongZ,
                _ => Parametrization::LatLongY { poles },
            };
            let is_cube = texels.height == 6 * texels.width;
            let auto = match octahedral {
                true => Parametrization::Octahedral,
                false if is_cube => Parametrization::Cube,
                false => latlong,
            };
            let parametrization = self.choice_or(
                node,
                "parametrization",
                auto,
                &[
                    ("auto", auto),
                    ("latlong", latlong),
                    ("octahedral", Parametrization::Octahedral),
                    ("cube", Parametrization::Cube),
                ],
            );
            if parametrization == Parametrization::Cube && !is_cube {
                self.error(
                    node.span,
                    "this picture has no six faces: a cross of 4 x 3 or 3 x 4, or a row or column of 6",
                );
                return None;
            }
            let texels = self.emitted_texels(node, texels);
            let texels = self.tinted(node, texels);
            if let Some(e) = illuminance {
                scale *= e / upper_illuminance(&texels, parametrization).max(1e-20);
            }
            Some(EnvironmentImage::new(texels, parametrization, place))
        } else {
            if let Some(e) = illuminance {
                scale *= e / PI;
            }
            None
        };
        Some(Environment { radiance, scale, image, celestial: None, portal, mode: self.mode })
    }

    /// Images that light the scene must not be negative. Infinite values and NaN are gone when an image was loaded.
    pub(super) fn emitted_texels(&mut self, node: &Node, mut texels: Texels) -> Texels {
        use steradian_image::TexelData;
        let mut faults = 0_usize;
        match &mut texels.data {
            TexelData::F32(data) => data.iter_mut().filter(|v| **v < 0.0).for_each(|v| {
                *v = 0.0;
                faults += 1;
            }),
            TexelData::F16(data) => data.iter_mut().filter(|v| v.to_f32() < 0.0).for_each(|v| {
                *v = Default::default();
                faults += 1;
            }),
            TexelData::U8(_) | TexelData::U16(_) => {}
        }
        if faults > 0 {
            let what = format!("{faults} values of this image are negative; they count as black");
            self.diagnostics.warn(&self.desc.sources, node.param("file").and_then(|p| p.span), what);
        }
        texels
    }

    /// The picture of an environment times its `radiance`, where that is given.
    fn tinted(&mut self, node: &Node, texels: Texels) -> Texels {
        let factor = match node.get("radiance") {
            None => return texels,
            Some(Value::Spectrum(SpectrumValue::Rgb(rgb, ColorSpace::Srgb))) => rgb.map(|v| v as f32),
            Some(Value::Spectrum(SpectrumValue::Constant(v))) => [*v as f32; 3],
            Some(_) => {
                let span = node.param("radiance").and_then(|p| p.span).or(node.span);
                self.approximated(span, "a spectrum as factor on a picture counts by its luminance");
                [self.constant_color(node, "radiance", Role::Unbounded).luminance(self.mode); 3]
            }
        };
        match factor {
            [1.0, 1.0, 1.0] => texels,
            _ => texels.tinted(factor),
        }
    }

    fn portal(&mut self, node: &Node) -> Option<[Vec3; 3]> {
        let p = self.list(node, "portal")?;
        if p.is_empty() {
            return None;
        }
        if p.len() != 12 {
            self.error(node.span, "a portal needs four corners (12 numbers)");
            return None;
        }
        let corners = [0, 1, 2, 3].map(|i| Vec3::from_slice(&p[3 * i..]));
        // In f64, where the squares of all corners are in range.
        let [a, b, c, d] = corners.map(|c| c.as_dvec3());
        let (ex, ey) = (b - a, d - a);
        let (width, height) = (ex.length(), ey.length());
        let closes = (a + ex + ey - c).length() <= 1e-3 * (width + height);
        let is_right = ex.dot(ey).abs() <= 1e-3 * width * height;
        let (ex, ey) = (ex.as_vec3(), ey.as_vec3());
        let area = ex.cross(ey).length();
        if !(closes && is_right && area > 0.0 && area.is_finite()) {
            self.error(node.span, "a portal must be a rectangle with an area");
            return None;
        }
        let a = corners[0];
        Some([a, ex, ey])
    }

    fn goniometric(&mut self, node: &Node) -> Option<Light> {
        use std::f32::consts::PI;
        let place = self.light_place(node)?;
        let (color, mut scale) = self.emission_color(node, "intensity");
        let texels = (*self.image(node)?).clone();
        let image = self.emitted_texels(node, texels);
        let mut light =
            Goniometric { position: place.point(Vec3::ZERO), world_from_light: place, intensity: Color::BLACK, image };
        if let Some(power) = self.luminous_target(node, "power", color.luminance(self.mode)) {
            scale *= power / (4.0 * PI * light.mean()).max(1e-20);
        }
        light.intensity = color.scaled(scale);
        Some(light.into())
    }

    fn projection(&mut self, node: &Node) -> Option<Light> {
        let place = self.light_place(node)?;
        let scale = self.float(node, "scale");
        let fov = self.positive(node, "fov").clamp(1e-3, 179.9).to_radians();
        let axis_name = self.word(node, "fov_axis");
        let Some(axis) = steradian_core::camera::FovAxis::named(axis_name) else {
            self.error(node.span, format!("'{axis_name}' is not an axis of view"));
            return None;
        };
        let is_irradiance = self.desc.format == Format::Mitsuba;
        let (slide, aspect) = if node.get("file").is_some() {
            let texels = (*self.image(node)?).clone();
            let image = self.emitted_texels(node, texels);
            let aspect = image.width as f32 / image.height.max(1) as f32;
            (Slide::Image(image), aspect)
        } else {
            let name = if node.get("texture").is_some() { "texture" } else { "radiance" };
            let slide = self.emitted(node, name);
            let image = node.node(name).map(|id| self.node(id)).filter(|n| n.kind == "image");
            let size = image.and_then(|n| self.image(n)).map_or((1, 1), |t| (t.width, t.height));
            (Slide::Texture(slide), size.0 as f32 / size.1.max(1) as f32)
        };
        let half: Vec2 = axis.half_window(fov, aspect);
        let mut light = Projection { world_from_light: place, slide, half, scale, is_irradiance };
        if is_irradiance {
            light.scale *= std::f32::consts::PI;
        }
        // The flux of the picture has its colours in it.
        if let (Some(power), Slide::Image(image)) = (self.luminous_target(node, "power", 1.0), &light.slide) {
            light.scale *= power / light.flux_of(image).max(1e-20);
        }
        Some(light.into())
    }
}

/// Illuminance on a surface that faces the environment's upper pole, for the image as it is.
fn upper_illuminance(t: &Texels, parametrization: Parametrization) -> f32 {
    use std::f32::consts::PI;
    let mut sum = 0.0_f64;
    for y in 0..t.height {
        for x in 0..t.width {
            let uv = Vec2::new((x as f32 + 0.5) / t.width as f32, (y as f32 + 0.5) / t.height as f32);
            let (cos, solid_angle) = match parametrization {
                Parametrization::Octahedral => (steradian_math::warp::equal_area_square_to_sphere(uv).z, 4.0 * PI),
                Parametrization::Cube => {
                    let (d, solid_angle) = steradian_core::light::cube::direction(uv);
                    (d.y, solid_angle)
                }
                _ => ((uv.y * PI).cos(), 2.0 * PI * PI * (uv.y * PI).sin()),
            };
            sum += f64::from(texel_luminance(t, x, y) * cos.max(0.0) * solid_angle);
        }
    }
    (sum / (t.width * t.height).max(1) as f64) as f32
}
