//! A render request in words, as command lines, pages and Python have it.

use crate::{
    Error, Layer, Render,
    auto::{AUTO, choose},
    method::check_options,
};
use steradian_core::Scene;
use steradian_request::{MethodRequest, Request, SamplerRequest};
use steradian_scene::{Family, names::did_you_mean};

/// Most samples per pixel.
pub const MAX_SPP: u32 = 1 << 24;
/// Most threads.
pub const MAX_THREADS: usize = 1024;

/// A [`Request`] in words: names of integrator and sampler are text. Fields that are `None` follow the scene.
#[derive(Clone, Debug, Default)]
pub struct Quality {
    /// `NAME` or `NAME:key=value,…`, with the options of `docs/integrators.md`, or [`AUTO`] for one that a trial
    /// chooses.
    pub integrator: Option<String>,
    /// Samples per pixel, up to [`MAX_SPP`]; their mean with `adaptive`.
    pub spp: Option<u32>,
    /// True to spend more samples on parts of the picture with larger errors.
    pub adaptive: bool,
    /// Relative error of the picture ([`steradian_engine::Session::error`]) at which sampling ends.
    pub error: Option<f64>,
    /// Random seed.
    pub seed: Option<u64>,
    /// Threads, up to [`MAX_THREADS`]; 0 for one per processor.
    pub threads: usize,
    /// Most scattering events on a path.
    pub max_depth: Option<u32>,
    /// Sampler by name, or `scene` for the one that the scene's file names.
    pub sampler: Option<String>,
    /// Auxiliary layers.
    pub layers: Vec<Layer>,
    /// True to leave the background behind all surfaces out of the picture, for [`Layer::ALPHA`].
    pub transparent: bool,
    /// True for pixels with independent errors, which denoisers need: `reuse` is 1 unless an option says otherwise.
    pub independent: bool,
}

impl Quality {
    /// Quality of an integrator, `NAME` or `NAME:key=value,…`; the rest follows the scene.
    pub fn of(integrator: &str) -> Self {
        Self { integrator: Some(integrator.into()), ..Self::default() }
    }

    /// Sets the number of samples per pixel.
    #[must_use]
    pub fn spp(self, spp: u32) -> Self {
        Self { spp: Some(spp), ..self }
    }

    /// The typed request, checked by the schema; without a method where a trial is to choose it.
    ///
    /// # Errors
    /// [`Error`] for unknown names and options, values outside their range, and numbers that no render can have.
    pub fn request(&self) -> Result<Request, Error> {
        within("samples per pixel", 1, MAX_SPP as usize, self.spp.unwrap_or(1) as usize)?;
        within("threads", 0, MAX_THREADS, self.threads)?;
        let named = self.integrator.as_deref().filter(|name| *name != AUTO);
        let method = named.map(MethodRequest::parse).transpose()?;
        method.as_ref().map(|method| check_options(&[], method)).transpose()?;
        Ok(Request {
            method,
            sampler: self.sampler.as_deref().map(sampler).transpose()?,
            spp: self.spp,
            adaptive: self.adaptive,
            error: self.error,
            seed: self.seed,
            threads: self.threads,
            max_depth: self.max_depth,
            layers: self.layers.clone(),
            transparent: self.transparent,
            independent: self.independent,
        })
    }

    /// The method and plan of this request for a scene.
    ///
    /// # Errors
    /// Errors of [`Self::request`] and [`Render::new`].
    pub fn render(&self, scene: &Scene) -> Result<Render, Error> {
        match self.integrator.as_deref() {
            Some(AUTO) => choose(&self.request()?, scene),
            _ => Render::new(&self.request()?, scene),
        }
    }
}

/// Refuses a number outside its range.
fn within(what: &'static str, least: usize, most: usize, asked: usize) -> Result<(), Error> {
    match (least..=most).contains(&asked) {
        true => Ok(()),
        false => Err(Error::OutOfRange { what, least, most, asked }),
    }
}

/// A sampler by name.
fn sampler(name: &str) -> Result<SamplerRequest, Error> {
    if name == "scene" {
        return Ok(SamplerRequest::OfFile);
    }
    Family::Sampler.model(name).map(SamplerRequest::Row).ok_or_else(|| Error::UnknownSampler {
        name: name.into(),
        hint: did_you_mean(name, Family::Sampler.kinds()),
        known: Family::Sampler.kinds().collect::<Vec<_>>().join(", "),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_compile::{Options, compile};
    use steradian_scene::{Node, SceneDesc};
    use steradian_schema::{Condition, Type, integrator::INTEGRATORS};

    fn scene(integrator: Node) -> Scene {
        let mut desc = SceneDesc::default();
        desc.cameras = vec![desc.add(Node::new(Family::Camera, "perspective", None))];
        desc.integrator = Some(desc.add(integrator));
        compile(&desc, &Options::default()).scene.unwrap_or_else(|| panic!("no scene"))
    }

    fn plan(scene: &Scene, integrator: Option<&str>, adaptive: bool) -> Result<String, String> {
        let quality = Quality { integrator: integrator.map(Into::into), adaptive, ..Quality::default() };
        quality.render(scene).map(|r| format!("{:?} {}", r.method, r.plan.sampler.spp)).map_err(|e| e.to_string())
    }

    #[test]
    fn options_of_files_are_used_and_can_be_overridden() {
        let of_file = scene(
            Node::new(Family::Integrator, "sppm", None)
                .with("photons", 700i64)
                .with("radius", 0.5)
                .with("samples", 9i64),
        );
        let said = plan(&of_file, None, false).unwrap();
        assert!(said.contains("photons: 700") && said.contains("Fixed(0.5)") && said.ends_with(" 9"), "{said}");
        let said = plan(&of_file, Some("sppm:radius=0.25"), false).unwrap();
        assert!(said.contains("photons: 700") && said.contains("Fixed(0.25)"), "{said}");
        assert!(plan(&of_file, Some("vcm"), false).unwrap().contains("Pixels"));
    }

    #[test]
    fn the_distance_of_a_file_is_that_of_its_occlusion() {
        let of_file = scene(Node::new(Family::Integrator, "ao", None).with("distance", 2.5));
        assert!(plan(&of_file, None, false).unwrap().contains("distance: 2.5"));
        assert!(plan(&of_file, Some("ao"), false).unwrap().contains("distance: 2.5"));
        assert!(plan(&of_file, Some("ao:distance=7"), false).unwrap().contains("distance: 7"));
        let another = scene(Node::new(Family::Integrator, "path", None));
        assert!(plan(&another, Some("ao"), false).unwrap().contains("distance: inf"));
    }

    /// A path tracer takes the place of a file's integrator that is unknown, or whose options do not go together;
    /// another one can be asked for all the same.
    #[test]
    fn files_with_unusable_integrators_are_rendered() {
        let unknown = Node::new(Family::Integrator, "foo", None);
        let unusable = Node::new(Family::Integrator, "raster", None).with("show", "direct");
        let inverted = Node::new(Family::Integrator, "transient", None).with("from", 5.0).with("to", 1.0);
        for (node, replaced) in [(unknown, None), (unusable, Some("raster")), (inverted, Some("transient"))] {
            let scene = scene(node);
            let render = Quality::default().render(&scene).unwrap();
            assert_eq!((render.name, render.replaced.map(|r| r.0)), ("path", replaced));
            assert_eq!(Quality::of("bdpt").render(&scene).unwrap().name, "bdpt");
        }
    }

    /// Methods compute in single precision: lengths beyond it are infinite there, or zero.
    #[test]
    fn numbers_beyond_single_precision_are_refused() {
        let plain = scene(Node::new(Family::Integrator, "path", None));
        for text in ["vcm:radius=1e39", "sppm:pixels=1e-50", "photon:radius=1e-60", "pssmlt:large_step=1e-50"] {
            let said = plan(&plain, Some(text), false).unwrap_err();
            assert!(
                said.contains("beyond single precision") && text.split(':').all(|part| said.contains(part)),
                "{said}"
            );
        }
        let of_file = scene(Node::new(Family::Integrator, "sppm", None).with("radius", 1e39));
        assert_eq!(Quality::default().render(&of_file).unwrap().replaced.unwrap().0, "sppm");
        assert!(plan(&of_file, Some("sppm"), false).is_err());
    }

    #[test]
    fn numbers_that_no_render_can_have_are_refused() {
        let scene = scene(Node::new(Family::Integrator, "path", None));
        let said = |quality: Quality| quality.render(&scene).unwrap_err().to_string();
        let threads = said(Quality { threads: 1 << 31, ..Quality::default() });
        assert_eq!(threads, "threads are whole numbers from 0 to 1024, not 2147483648");
        for (spp, integrator) in [(0, None), (u32::MAX, None), (u32::MAX, Some("vcm".into()))] {
            let said = said(Quality { spp: Some(spp), integrator, ..Quality::default() });
            assert!(said.starts_with("samples per pixel are whole numbers from 1 to 16777216"), "{said}");
        }
        let raster = Quality { spp: Some(u32::MAX), integrator: Some("raster".into()), ..Quality::default() };
        assert!(matches!(raster.render(&scene), Err(Error::OutOfRange { .. })));
    }

    #[test]
    fn options_that_an_integrator_lacks_are_refused() {
        let scene = scene(Node::new(Family::Integrator, "path", None));
        for wrong in
            ["bdpt:reuse=4", "whitted:caustics=true", "sppm:nearest=3", "pssmlt:large_step=2", "stokes:effort=auto"]
        {
            let said = plan(&scene, Some(wrong), false).unwrap_err();
            let (name, option) = wrong.split_once(':').unwrap();
            assert!(said.contains(name) && said.contains(option) && said.contains("max_depth"), "{said}");
        }
        assert!(plan(&scene, Some("vcm"), true).unwrap_err().contains("--adaptive"));
        assert!(plan(&scene, Some("path:reuse=4"), true).is_ok());
    }

    /// Every option that is listed is understood by its integrator, with a value of those that are listed and with the
    /// stated default, and every other one is refused with their names.
    #[test]
    fn options_are_those_that_are_listed() {
        let scene = compile(&crate::cornell::luminous_ceiling(), &Options::default()).scene.expect("a sound scene");
        let render = |text: &str| Quality { integrator: Some(text.into()), ..Quality::default() }.render(&scene);
        let all: Vec<_> = INTEGRATORS.iter().flat_map(|i| i.parameters).map(|o| o.name).chain(["speed"]).collect();
        for info in INTEGRATORS {
            for p in info.parameters {
                let values: Vec<String> = match p.kind {
                    Type::Word(_) => p.words().map(Into::into).collect(),
                    Type::Flag => vec!["true".into(), "false".into()],
                    Type::File => vec!["light".into()],
                    _ => ["1", "0.5", p.usual_default()].map(Into::into).to_vec(),
                };
                let values: Vec<_> = values.iter().filter(|value| p.takes(value)).collect();
                assert!(!values.is_empty(), "{}", p.name);
                for value in values {
                    // Views of hybrid frames are of those.
                    let of_hybrid = info.kind == "raster"
                        && p.name == "show"
                        && ["emission", "direct", "indirect", "reflections", "transparency", "occlusion", "graph"]
                            .contains(&value.as_str());
                    let frame = if of_hybrid { "frame=hybrid," } else { "" };
                    // Options of a view count with it.
                    let with = match p.condition {
                        Condition::Is(name, word) => format!("{name}={word},"),
                        _ => String::new(),
                    };
                    let text = format!("{}:{frame}{with}{}={value}", info.kind, p.name);
                    assert!(render(&text).is_ok(), "{text}: {:?}", render(&text));
                }
                let text = format!("{}:{}=§", info.kind, p.name);
                assert!(p.kind == Type::File || render(&text).is_err(), "{text}");
            }
            for other in all.iter().filter(|name| info.parameters.iter().all(|o| o.name != **name)) {
                let refusal = render(&format!("{}:{other}=1", info.kind)).expect_err(other).to_string();
                let has_all = info.parameters.iter().all(|o| refusal.contains(o.name));
                assert!(refusal.contains(other) && has_all, "{}: {refusal}", info.kind);
            }
        }
    }

    /// Every integrator that has the option leaves out lights that the camera sees: here nothing else shines.
    #[test]
    fn hidden_lights_are_not_seen() {
        let text = r#"Film "rgb" "integer xresolution" 4 "integer yresolution" 4
            LookAt 0 0 -3  0 0 0  0 1 0 Camera "perspective" "float fov" 30 WorldBegin
            Material "diffuse" "rgb reflectance" [0 0 0] AreaLightSource "diffuse" "rgb L" [4 4 4]
            Shape "trianglemesh" "point3 P" [-9 -9 0  -9 9 0  9 9 0  9 -9 0] "integer indices" [0 1 2 0 2 3]"#;
        let loaded = crate::load_bytes("lamp.pbrt", text.as_bytes().to_vec(), Some("pbrt"), &Default::default());
        let mode = Some(steradian_core::ColorMode::Rgb);
        let scene = compile(&loaded.desc, &Options { mode, ..Options::default() }).scene.expect("a sound scene");
        let scene = std::sync::Arc::new(scene);
        let seen = |name: &str, is_hidden: bool| {
            let quality = Quality::of(&format!("{name}:hide_emitters={is_hidden}")).spp(4);
            let picture = crate::render(&scene, &quality).expect(name);
            picture.channel("G").expect("green").iter().sum::<f32>() / 16.0
        };
        for info in INTEGRATORS.iter().filter(|i| i.parameter("hide_emitters").is_some()) {
            assert_eq!(seen(info.kind, true), 0.0, "{} sees a hidden light", info.kind);
            // S1 to S3 of light that is not polarised are black.
            let is_black = info.kind.starts_with("stokes-");
            assert!(is_black || seen(info.kind, false) > 3.0, "{}: {}", info.kind, seen(info.kind, false));
        }
    }

    /// Camera rays of every integrator that sees lights see the backdrop behind everything; what is lit by the
    /// environment or mirrors it is as without.
    #[test]
    fn backdrops_are_seen_and_give_no_light() {
        let scene = |lights: &str, place: f32, material: &str| {
            let text = format!(
                "steradian: 1\nfilm: {{film: rgb, width: 4, height: 4}}\ncamera: {{camera: perspective, fov: 5}}\n\
                 lights: [{{light: environment, radiance: 4}}{lights}]\n\
                 shapes: [{{shape: sphere, radius: 2, to_world: {{translate: [0, 0, {place}]}}, material: {material}}}]"
            );
            let loaded = crate::load_bytes(
                "a.steradian",
                text.into_bytes(),
                Some("steradian"),
                &crate::formats::Options::default(),
            );
            let mode = Some(steradian_core::ColorMode::Rgb);
            let compiled = compile(&loaded.desc, &Options { mode, ..Options::default() });
            std::sync::Arc::new(compiled.scene.expect("a sound scene"))
        };
        let seen = |scene: &std::sync::Arc<Scene>, name: &str| {
            let picture = crate::render(scene, &Quality { seed: Some(1), ..Quality::of(name).spp(4) }).expect(name);
            picture.channel("G").expect("green").to_vec()
        };
        let backdrop = ", {light: backdrop, radiance: 0.25}";
        let (diffuse, mirror) = ("{material: diffuse, reflectance: 0.5}", "{material: conductor}");
        let (empty, lit) = (scene(backdrop, -8.0, diffuse), scene("", -8.0, diffuse));
        for info in INTEGRATORS.iter().filter(|i| i.parameter("hide_emitters").is_some()) {
            // S1 to S3 of light that is not polarised are black.
            let is_black = info.kind.starts_with("stokes-");
            for (scene, value) in [(&empty, 0.25), (&lit, 4.0)] {
                // Metropolis methods spread the light over the pixels by chance.
                let mean = seen(scene, info.kind).iter().sum::<f32>() / 16.0;
                let right = if is_black { mean == 0.0 } else { (mean / value - 1.0).abs() < 1e-3 };
                assert!(right, "{}: {mean}, not {value}", info.kind);
            }
        }
        for name in ["path", "bdpt", "whitted", "raster", "raster:frame=hybrid", "raster:frame=preview"] {
            for material in [diffuse, mirror] {
                let [with, without] = [backdrop, ""].map(|lights| seen(&scene(lights, 8.0, material), name));
                assert!(with == without && with.iter().all(|v| *v > 0.5), "{name} {material}: {with:?} {without:?}");
            }
        }
        for frame in ["hybrid", "preview"] {
            let found = seen(&empty, &format!("raster:frame={frame}"));
            assert!(found.iter().all(|v| (v / 0.25 - 1.0).abs() < 1e-3), "{frame}: {found:?}");
        }
    }

    /// Camera rays pass hidden lights, of any shape and from either side, to what is behind them: a wall lit by a
    /// spherical lamp of radius r at distance d, whose radiance there is ρ L r²/d². Four seeds tell the noise; beyond
    /// four standard errors of it, methods with patches and photons may be off by 5 %.
    #[test]
    fn what_is_behind_hidden_lights_is_seen() {
        let text = |wall: &str| {
            format!(
                r#"Film "rgb" "integer xresolution" 4 "integer yresolution" 4
                LookAt 0 0 -30  0 0 0  0 1 0 Camera "perspective" "float fov" 0.5 WorldBegin
                AttributeBegin Material "diffuse" "rgb reflectance" [0 0 0] AreaLightSource "diffuse" "rgb L" [40 40 40]
                Shape "sphere" "float radius" 0.5 AttributeEnd
                AttributeBegin Material "diffuse" "rgb reflectance" [0 0 0]
                AreaLightSource "diffuse" "rgb L" [1e-4 1e-4 1e-4]
                Shape "trianglemesh" "point3 P" [-9 -9 -1  -9 9 -1  9 9 -1  9 -9 -1] "integer indices" [0 1 2 0 2 3]
                AttributeEnd
                Material "diffuse" "rgb reflectance" [0.5 0.5 0.5] {wall}"#
            )
        };
        let scene = |wall: &str| {
            let loaded = crate::load_bytes("lamp.pbrt", text(wall).into_bytes(), Some("pbrt"), &Default::default());
            let mode = Some(steradian_core::ColorMode::Rgb);
            let options = Options { mode, ..Options::default() };
            let mut scene = compile(&loaded.desc, &options).scene.expect("a sound scene");
            scene.change(|parts| parts.settings.hide_emitters = true);
            std::sync::Arc::new(scene)
        };
        let wall = scene(
            r#"Shape "trianglemesh" "point3 P" [-9 -9 2  -9 9 2  9 9 2  9 -9 2] "integer indices" [0 1 2 0 2 3]"#,
        );
        let mean = |name: &str, seed: u64| {
            let quality = Quality::of(name).spp(if name == "light" { 8192 } else { 8 });
            let picture = crate::render(&wall, &Quality { seed: Some(seed), ..quality }).expect(name);
            f64::from(picture.channel("G").expect("green").iter().sum::<f32>()) / 16.0
        };
        for info in INTEGRATORS.iter().filter(|i| i.parameter("hide_emitters").is_some()) {
            let right = match info.kind {
                "raycast" => 0.5,
                name if name.starts_with("stokes-") => 0.0,
                _ => 0.5 * 40.0 * 0.25 / 4.0,
            };
            let means: Vec<_> = (1..=4).map(|seed| mean(info.kind, seed)).collect();
            let found = means.iter().sum::<f64>() / 4.0;
            let error = (means.iter().map(|m| (m - found).powi(2)).sum::<f64>() / 12.0).sqrt();
            assert!(
                (found - right).abs() <= 4.0 * error + 0.05 * right,
                "{}: {found} ± {error}, not {right}",
                info.kind
            );
        }
        let (lamps, layers) = (scene(""), vec![Layer::ALPHA, Layer::DEPTH]);
        for name in ["path", "raster"] {
            let quality = Quality { layers: layers.clone(), ..Quality::of(name).spp(2) };
            let of = |scene, channel: &str| {
                let quality = Quality { transparent: true, ..quality.clone() };
                crate::render(scene, &quality).expect(name).channel(channel).expect(channel).to_vec()
            };
            assert!(of(&lamps, "A").iter().all(|a| *a == 0.0), "{name}: hidden lights cover nothing");
            assert!(of(&wall, "Z").iter().all(|z| (z - 32.0).abs() < 0.01), "{name}: the depth is the wall's");
        }
    }
}
