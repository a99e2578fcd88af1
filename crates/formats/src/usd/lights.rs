//! Lights: UsdLux.
//!
//! Radiance is `color · intensity · 2^exposure`, times the colour of `colorTemperature` where that is enabled; with
//! `normalize` it is divided by the light's size in the world: an area, or of distant lights the projected solid angle.

use super::{
    Loss, Reader,
    nodes::{Drawn, Form},
    solids::{rectangle, solid},
    stage::Prim,
};
use glam::DQuat;
use std::f64::consts::PI;
use steradian_math::{DMat4, DVec3, Transform};
use steradian_scene::{ColorSpace, Family, Node, SpectrumValue};

/// Largest intensity or size.
const MOST: f64 = 1e30;

impl Reader<'_> {
    pub(super) fn light(&mut self, prim: &Prim, kind: &str, place: DMat4) {
        self.tell_lost(prim);
        let stretch = [place.x_axis, place.y_axis, place.z_axis].map(|axis| axis.truncate().length());
        let [sx, sy, sz] = stretch;
        let size = |reader: &mut Self, name: &str, default: f64| reader.number(prim, name, default, (0.0, MOST));
        self.uses_lights = true;
        match kind {
            "DistantLight" => {
                let angle = size(self, "inputs:angle", 0.53).min(180.0);
                // Half the angle, which the disc of the light has around its middle.
                let projected = PI * (0.5 * angle).to_radians().sin().powi(2);
                let is_normalized = self.flag(prim, "inputs:normalize", false);
                let factor = if is_normalized || angle == 0.0 { 1.0 } else { projected };
                let irradiance = self.radiance(prim, factor, 50_000.0);
                if angle > 0.0 {
                    let what = format!("light of {angle}° becomes parallel, of the same irradiance: shadows are sharp");
                    self.count(Loss::Approximated(what), prim, None);
                }
                let forward = place.transform_vector3(DVec3::NEG_Z).normalize_or(DVec3::NEG_Z);
                let node = Node::new(Family::Light, "distant", self.stage.span(prim, None));
                self.add_light(prim, node.with("radiance", irradiance).with("direction", forward.to_array()));
            }
            "DomeLight" | "DomeLight_1" => self.dome(prim, kind, place),
            "SphereLight" => {
                let radius = size(self, "inputs:radius", 0.5);
                let world = radius * (sx + sy + sz) / 3.0;
                if !self.flag(prim, "treatAsPoint", false) && radius > 0.0 && !self.has_cone(prim) {
                    let radiance = self.area_radiance(prim, 4.0 * PI * world * world);
                    return self.surface(prim, Form::Solid(solid("sphere").with("radius", radius)), place, radiance);
                }
                self.point(prim, world, place);
            }
            "DiskLight" => {
                let radius = size(self, "inputs:radius", 0.5);
                let radiance = self.area_radiance(prim, PI * radius * radius * sx * sy);
                let form = solid("disk").with("radius", radius);
                self.surface(prim, Form::Solid(form), place * DMat4::from_rotation_y(PI), radiance);
            }
            "RectLight" => {
                let (width, height) = (size(self, "inputs:width", 1.0), size(self, "inputs:height", 1.0));
                let radiance = self.area_radiance(prim, width * sx * height * sy);
                if self.word(prim, "inputs:texture:file").is_some_and(|f| !f.is_empty()) {
                    self.count(Loss::Dropped("textures of rectangular lights are left out".into()), prim, None);
                }
                let form = self.form(rectangle(width, height));
                self.surface(prim, form, place * DMat4::from_rotation_y(PI), radiance);
            }
            "CylinderLight" => {
                let (radius, length) = (size(self, "inputs:radius", 0.5), size(self, "inputs:length", 1.0));
                let area = 2.0 * PI * radius * 0.5 * (sy + sz) * length * sx;
                let radiance = self.area_radiance(prim, area);
                let half = 0.5 * length;
                let form = solid("cylinder").with("radius", radius).with("z_min", -half).with("z_max", half);
                self.surface(prim, Form::Solid(form), place * DMat4::from_rotation_y(0.5 * PI), radiance);
            }
            kind => self.count(Loss::Dropped(format!("lights of type '{kind}' are left out")), prim, None),
        }
    }

    /// Tells what of a light has no counterpart.
    fn tell_lost(&mut self, prim: &Prim) {
        let names = self.stage.properties(prim);
        let links = [
            "collection:lightLink:includes",
            "collection:lightLink:excludes",
            "collection:shadowLink:includes",
            "collection:shadowLink:excludes",
        ];
        if names.iter().any(|n| links.contains(&n.as_str())) {
            self.count(
                Loss::Dropped("links between lights and surfaces are left out: lights light everything".into()),
                prim,
                None,
            );
        }
        if self.word(prim, "inputs:shaping:ies:file").is_some_and(|f| !f.is_empty()) {
            self.count(Loss::Dropped("photometric profiles (IES) of lights are left out".into()), prim, None);
        }
        let is_spot = self.stage.type_name(prim) == "SphereLight";
        let focus = self.number(prim, "inputs:shaping:focus", 0.0, (0.0, MOST));
        if focus > 0.0 || self.has_cone(prim) && !is_spot {
            self.count(Loss::Dropped("the shaping of this light is left out: it shines all around".into()), prim, None);
        }
    }

    fn has_cone(&mut self, prim: &Prim) -> bool {
        self.number(prim, "inputs:shaping:cone:angle", 90.0, (0.0, 180.0)) < 90.0
    }

    /// The radiance of a surface of such an area in the world.
    fn area_radiance(&mut self, prim: &Prim, area: f64) -> SpectrumValue {
        let is_normalized = self.flag(prim, "inputs:normalize", false);
        self.radiance(prim, if is_normalized && area > 0.0 { 1.0 / area } else { 1.0 }, 1.0)
    }

    fn radiance(&mut self, prim: &Prim, factor: f64, usual: f64) -> SpectrumValue {
        let color = self.tuple(prim, "inputs:color", [1.0; 3]);
        let intensity = self.number(prim, "inputs:intensity", usual, (0.0, MOST));
        let exposure = self.number(prim, "inputs:exposure", 0.0, (-100.0, 100.0));
        let warmth = match self.flag(prim, "inputs:enableColorTemperature", false) {
            true => blackbody(self.number(prim, "inputs:colorTemperature", 6500.0, (1000.0, 1e6))),
            false => [1.0; 3],
        };
        let strength = intensity * exposure.exp2() * factor;
        SpectrumValue::Rgb(std::array::from_fn(|k| color[k].max(0.0) * warmth[k] * strength), ColorSpace::Srgb)
    }

    /// A sphere as a point, where its cone cuts it or it is asked for: of the intensity that it has from afar.
    fn point(&mut self, prim: &Prim, radius: f64, place: DMat4) {
        let is_normalized = self.flag(prim, "inputs:normalize", false);
        // Seen as a disc; normalised, that is a quarter of the sphere's surface.
        let factor = if is_normalized { 0.25 } else { PI * radius * radius };
        let intensity = self.radiance(prim, factor, 1.0);
        let angle = self.number(prim, "inputs:shaping:cone:angle", 90.0, (0.0, 180.0));
        let span = self.stage.span(prim, None);
        if !self.flag(prim, "treatAsPoint", false) && radius > 0.0 {
            self.count(
                Loss::Approximated("a sphere with a cone shines from its middle: shadows are sharp".into()),
                prim,
                None,
            );
        }
        let node = if angle < 90.0 {
            let softness = self.number(prim, "inputs:shaping:cone:softness", 0.0, (0.0, 1.0));
            let (_, rotation, translation) = place.to_scale_rotation_translation();
            let rotation = if rotation.is_finite() { rotation.normalize() } else { DQuat::IDENTITY };
            let matrix = DMat4::from_rotation_translation(rotation, translation) * DMat4::from_rotation_y(PI);
            Node::new(Family::Light, "spot", span)
                .with("intensity", intensity)
                .with("cone_angle", angle.max(1e-2))
                .with("falloff_start", angle * (1.0 - softness))
                .with("to_world", Transform { matrix })
        } else {
            let position = place.w_axis.truncate().to_array();
            Node::new(Family::Light, "point", span).with("intensity", intensity).with("position", position)
        };
        self.add_light(prim, node);
    }

    fn dome(&mut self, prim: &Prim, kind: &str, place: DMat4) {
        let radiance = self.radiance(prim, 1.0, 1.0);
        let (_, rotation, _) = place.to_scale_rotation_translation();
        let mut rotation = if rotation.is_finite() { rotation.normalize() } else { DQuat::IDENTITY };
        if kind == "DomeLight_1" {
            let axis = self.word(prim, "poleAxis").filter(|a| a != "scene");
            let up = self.stage.head("upAxis").and_then(|v| v.text().map(str::to_owned));
            if axis.or(up).as_deref() == Some("Z") {
                rotation *= DQuat::from_rotation_x(0.5 * PI);
            }
        }
        let mut node = Node::new(Family::Light, "environment", self.stage.span(prim, None))
            .with("radiance", radiance)
            .with("to_world", Transform { matrix: DMat4::from_quat(rotation) });
        match self.stage.asset(prim, "inputs:texture:file") {
            Some(Ok(file)) => {
                let format = self.word(prim, "inputs:texture:format");
                if !matches!(format.as_deref(), None | Some("automatic" | "latlong")) {
                    let what = format!(
                        "a dome's picture of the format '{}' is taken as one by latitude and longitude",
                        format.unwrap_or_default()
                    );
                    self.count(Loss::Approximated(what), prim, Some("inputs:texture:format"));
                }
                node.set("file", file, None).set("parametrization", "latlong", None);
            }
            Some(Err(why)) => {
                let span = self.stage.span(prim, Some("inputs:texture:file"));
                self.stage.dropped(span, format!("{}: {why}: the dome has one colour", prim.path));
            }
            None => {}
        }
        self.add_light(prim, node);
    }

    /// A shape that shines on its front.
    fn surface(&mut self, prim: &Prim, form: Form, place: DMat4, radiance: SpectrumValue) {
        let is_empty = matches!(&form, Form::Solid(node) if node.float("radius") == Some(0.0));
        if is_empty {
            return self.count(Loss::Dropped("lights without a size are left out".into()), prim, None);
        }
        let desc = &mut self.stage.import.desc;
        let black = SpectrumValue::Rgb([0.0; 3], ColorSpace::Srgb);
        let material = desc.add(Node::new(Family::Material, "diffuse", None).with("reflectance", black));
        let light = Node { name: Some(prim.name().into()), ..Node::new(Family::Light, "area", None) };
        let light = desc.add(light.with("radiance", radiance));
        let name = prim.name().to_owned();
        self.draw(Drawn { name, form, place, material: Some(material), emission: Some(light) });
    }

    fn add_light(&mut self, prim: &Prim, mut node: Node) {
        node.name = Some(prim.name().to_owned());
        let desc = &mut self.stage.import.desc;
        let id = desc.add(node);
        desc.lights.push(id);
    }
}

/// The colour of a blackbody in linear sRGB, of luminance 1 (chromaticity: Kim et al. 2002, held to its range).
fn blackbody(kelvin: f64) -> [f64; 3] {
    let t = 1e3 / kelvin.clamp(1667.0, 25_000.0);
    let x = if t >= 0.25 {
        ((-0.266_123_9 * t - 0.234_358_9) * t + 0.877_695_6) * t + 0.179_910
    } else {
        ((-3.025_846_9 * t + 2.107_037_9) * t + 0.222_634_7) * t + 0.240_390
    };
    let y = if t >= 1e3 / 2222.0 {
        ((-1.106_381_4 * x - 1.348_110_20) * x + 2.185_558_32) * x - 0.202_196_83
    } else if t >= 0.25 {
        ((-0.954_947_6 * x - 1.374_185_93) * x + 2.091_370_15) * x - 0.167_488_67
    } else {
        ((3.081_758_0 * x - 5.873_386_70) * x + 3.751_129_97) * x - 0.370_014_83
    };
    let (big_x, big_z) = (x / y, (1.0 - x - y) / y);
    let rgb = [
        3.240_454_2 * big_x - 1.537_138_5 - 0.498_531_4 * big_z,
        -0.969_266 * big_x + 1.876_010_8 + 0.041_556 * big_z,
        0.055_643_4 * big_x - 0.204_025_9 + 1.057_225_2 * big_z,
    ]
    .map(|v| v.max(0.0));
    let luminance = 0.212_672_9 * rgb[0] + 0.715_152_2 * rgb[1] + 0.072_175 * rgb[2];
    rgb.map(|v| v / luminance.max(1e-9))
}
