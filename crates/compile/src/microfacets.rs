//! Compiling facets of any reflectance, and metals with more than an index.

use super::Compiler;
use steradian_bsdf::{Compensation, DiffuseCoupling};
use steradian_core::material::{FacetReflectance, Facets, Film, Metal, Model, Roughness};
use steradian_math::spectra::{
    Curve, Spd,
    dispersion::complex_index,
    role::{Color, Role},
};
use steradian_scene::{Node, SpectrumValue};
use steradian_texture::{FloatTexture, SpectrumTexture};

const ONE: SpectrumValue = SpectrumValue::Constant(1.0);

impl Compiler<'_> {
    /// `cook_torrance`.
    pub(super) fn cook_torrance(&mut self, node: &Node) -> Facets {
        let roughness = self.roughness(node, "alpha_u", "alpha_v");
        let kinds = [("dielectric", 0), ("conductor", 1), ("large_k", 2), ("schlick", 3)];
        let reflectance = match self.choice(node, "fresnel", &kinds) {
            0 => FacetReflectance::Dielectric(self.index(node, "eta")),
            3 => FacetReflectance::Schlick(
                self.spectrum(node, "f0", Role::Albedo),
                self.spectrum(node, "f90", Role::Albedo),
            ),
            kind => {
                let [eta, k] = self.complex_index(node);
                FacetReflectance::Conductor(eta, k, kind == 2)
            }
        };
        let film = self.thin_film(node);
        if film.is_some() && matches!(reflectance, FacetReflectance::Schlick(..)) {
            self.approximated(
                node.span,
                "a film needs a base with an index of refraction; on Schlick's form there is none",
            );
        }
        let couplings = [
            ("sum", DiffuseCoupling::Sum),
            ("ashikhmin_shirley", DiffuseCoupling::AshikhminShirley),
            ("fresnel", DiffuseCoupling::Fresnel),
        ];
        Facets {
            diffuse: self.spectrum(node, "diffuse_reflectance", Role::Albedo),
            specular: self.spectrum(node, "specular_reflectance", Role::Albedo),
            reflectance,
            film,
            coupling: self.choice(node, "coupling", &couplings),
            roughness,
        }
    }

    /// An index of refraction as a number or texture.
    fn index(&mut self, node: &Node, name: &str) -> FloatTexture {
        match node.get(name) {
            Some(steradian_scene::Value::Node(_)) => self.float_texture(node, name),
            _ => FloatTexture::Constant(self.at_sodium_line(node, name)),
        }
    }

    fn thin_film(&mut self, node: &Node) -> Option<Film> {
        node.param("film_thickness")?;
        let thickness = self.float_texture_or(node, "film_thickness", 0.0);
        let eta = self.float_texture(node, "film_eta");
        Some(Film { thickness, eta, mode: self.mode })
    }

    /// A conductor that is asked for more than an index and a roughness: compensation, a film, an approximation, or an
    /// index from electrical constants.
    pub(super) fn special_metal(&mut self, node: &Node, roughness: &Roughness) -> Option<Model> {
        use Compensation::{KullaConty, Turquin};
        let kinds = [("none", None), ("kulla_conty", Some(KullaConty)), ("turquin", Some(Turquin))];
        let compensation = self.choice(node, "compensation", &kinds);
        let large_k = self.choice(node, "fresnel", &[("exact", false), ("large_k", true)]);
        let electrical = ["permittivity", "permeability", "conductivity"].iter().any(|n| node.get(n).is_some());
        let film = self.thin_film(node);
        if compensation.is_none() && !large_k && !electrical && film.is_none() {
            return None;
        }
        let [eta, k] = self.complex_index(node);
        let metal = match (node.get("reflectance").is_some(), node.get("eta").or(node.get("k")).is_some()) {
            (true, _) => {
                if film.is_some() || large_k || electrical || !self.is_constant(node, "reflectance") {
                    self.approximated(
                        node.span,
                        "a metal given by a reflectance has no film, approximation or texture with compensation",
                    );
                }
                let r = self.constant_color_or(node, "reflectance", Role::Albedo, ONE);
                Metal {
                    eta: constant(1.0),
                    k: SpectrumTexture::Constant(k_of_reflectance(&r)),
                    tint: constant(1.0),
                    roughness: *roughness,
                }
            }
            // A mirror has a purely imaginary index.
            (false, false) if !electrical => {
                let tint = self.spectrum(node, "specular_reflectance", Role::Albedo);
                Metal { eta: constant(0.0), k: constant(1.0), tint, roughness: *roughness }
            }
            _ => {
                let tint = self.spectrum(node, "specular_reflectance", Role::Albedo);
                Metal { eta, k, tint, roughness: *roughness }
            }
        };
        if let (Some(kind), false, false) = (compensation, film.is_some(), large_k) {
            if roughness.is_anisotropic() {
                self.approximated(
                    node.span,
                    "light between facets is given back where roughness is the same in all directions; here it differs",
                );
            }
            let table = self.coats.energy(roughness.distribution, roughness.shadowing);
            return Some(Model::Compensated { metal, kind, table });
        }
        if compensation.is_some() {
            self.approximated(
                node.span,
                "compensation takes neither a film nor the approximation; single scattering is rendered",
            );
        }
        Some(Model::Facets(Facets {
            diffuse: constant(0.0),
            specular: metal.tint,
            reflectance: FacetReflectance::Conductor(metal.eta, metal.k, large_k),
            film,
            coupling: DiffuseCoupling::Sum,
            roughness: *roughness,
        }))
    }

    fn is_constant(&mut self, node: &Node, name: &str) -> bool {
        !matches!(node.get(name), Some(steradian_scene::Value::Node(_)))
    }

    /// A complex index, by itself or from permittivity, permeability (relative) and conductivity (S/m).
    fn complex_index(&mut self, node: &Node) -> [SpectrumTexture; 2] {
        if node.get("permittivity").is_none() && node.get("conductivity").is_none() {
            return ["eta", "k"].map(|name| self.spectrum(node, name, Role::Index));
        }
        let [epsilon, mu, sigma] = [("permittivity", 1.0), ("permeability", 1.0), ("conductivity", 0.0)]
            .map(|(name, default)| f64::from(self.float_or(node, name, default)));
        let lambdas: Vec<f32> = (36..=83).map(|l| l as f32 * 10.0).collect();
        [0, 1].map(|part| {
            let of = |l: &f32| {
                let (eta, k) = complex_index(epsilon, mu, sigma, f64::from(*l));
                [eta, k][part] as f32
            };
            let values: Vec<f32> = lambdas.iter().map(of).collect();
            match Curve::new(lambdas.clone(), values) {
                Ok(curve) => SpectrumTexture::Constant(Color::curve(&Spd::Curve(curve.into()), Role::Index, self.mode)),
                Err(e) => {
                    self.error(node.span, format!("the index of refraction: {e}"));
                    constant(1.0)
                }
            }
        })
    }
}

fn constant(v: f32) -> SpectrumTexture {
    SpectrumTexture::Constant(Color::constant(v))
}

/// `k = 2√(r/(1−r))`, which with `η = 1` has the reflectance `r` at normal incidence.
fn k_of_reflectance(r: &Color) -> Color {
    super::materials::combine(r, r, |r, _| 2.0 * (r.clamp(0.0, 0.9999) / (1.0 - r.clamp(0.0, 0.9999))).sqrt())
}

#[cfg(test)]
mod tests {
    use super::super::{Options, compile};
    use steradian_bsdf::{Bsdf, TransportMode};
    use steradian_core::{Scene, material::scattering};
    use steradian_math::{
        Spectrum, Vec2, Vec3,
        spectra::{ColorMode, Wavelengths},
    };
    use steradian_scene::{Family, Mesh, Node, SceneDesc, Shape, SpectrumValue, Value};
    use steradian_texture::TextureContext;

    fn material(kind: &str) -> Node {
        Node::new(Family::Material, kind, None)
    }

    /// A triangle of the material, and what the compiler said of it.
    fn scene(mode: ColorMode, make: impl FnOnce(&mut SceneDesc) -> Node) -> (Option<Scene>, String) {
        let mut desc = SceneDesc::default();
        let node = make(&mut desc);
        let (material, node) = (desc.add(node), desc.add(Node::new(Family::Shape, "mesh", None)));
        let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let mesh = desc.add_mesh(Mesh { positions, triangles: vec![[0, 1, 2]].into(), ..Mesh::default() });
        desc.shapes.push(Shape { mesh: Some(mesh), material: Some(material), ..Shape::new(node) });
        let camera = desc.add(Node::new(Family::Camera, "perspective", None));
        desc.cameras.push(camera);
        let compiled = compile(&desc, &Options { mode: Some(mode), ..Options::default() });
        let said: Vec<String> = compiled.diagnostics.iter().map(|d| d.message.clone()).collect();
        (compiled.scene, said.join("\n"))
    }

    /// Looks at the material of a scene at a place on it.
    fn with_bsdf<T>(scene: &Scene, uv: Vec2, lambda: &mut Wavelengths, look: impl FnOnce(&Bsdf<'_>) -> T) -> T {
        let at = TextureContext::new(Vec3::ZERO, uv);
        let id = scene.materials().len() as u32 - 1;
        look(&scattering(scene.materials(), scene.textures(), id, &at, true, 0.5, lambda).unwrap().bsdf)
    }

    fn value(scene: &Scene, uv: Vec2) -> Spectrum {
        let w = Vec3::new(0.6, 0.0, 0.8);
        let mut lambda = Wavelengths::sample_visible(0.3);
        with_bsdf(scene, uv, &mut lambda, |b| {
            b.eval(w, Vec3::new(-0.5, 0.2, 0.8).normalize(), TransportMode::Radiance).value
        })
    }

    /// A checkerboard of two numbers.
    fn varying(desc: &mut SceneDesc, a: f64, b: f64) -> Value {
        Value::Node(desc.add(Node::new(Family::Texture, "checkerboard", None).with("a", a).with("b", b)))
    }

    /// M99: each part of a texture has its own albedo.
    #[test]
    fn the_albedo_is_that_of_the_place() {
        let (scene, said) = scene(ColorMode::Rgb, |d| {
            let squares = varying(d, 0.2, 0.7);
            material("diffuse").with("reflectance", squares)
        });
        let scene = scene.expect(&said);
        for (uv, albedo) in [([0.25, 0.25], 0.2), ([1.25, 0.25], 0.7), ([1.75, 1.5], 0.2)] {
            let seen = with_bsdf(&scene, Vec2::from(uv), &mut Wavelengths::RGB.clone(), |b| {
                let value = |wi| f64::from(b.eval(Vec3::Z, wi, TransportMode::Radiance).value[0]);
                steradian_testkit::integrate_sphere(value, 1e-5)
            });
            assert!((seen - albedo).abs() < 1e-4, "{uv:?}: {seen}");
        }
    }

    /// M102: each wavelength is scattered by its own parameters, a reflectance and a complex index alike.
    #[test]
    fn the_albedo_is_that_of_the_wavelength() {
        let sampled = |lambdas: &[f32], values: &[f32]| {
            Value::Spectrum(SpectrumValue::Sampled { lambdas: lambdas.into(), values: values.into() })
        };
        let (ramp, _) = scene(ColorMode::Spectral, |_| {
            material("diffuse").with("reflectance", sampled(&[360.0, 830.0], &[0.1, 0.9]))
        });
        let named = |s: &str| Value::Spectrum(SpectrumValue::Named(s.into()));
        let (gold, _) = scene(ColorMode::Spectral, |_| {
            material("conductor").with("eta", named("metal-Au-eta")).with("k", named("metal-Au-k"))
        });
        let curve = |name| steradian_math::spectra::named(name).expect("a spectrum");
        let (eta, k) = (curve("metal-Au-eta"), curve("metal-Au-k"));
        for u in [0.05, 0.4, 0.8] {
            let mut lambda = Wavelengths::sample_visible(u);
            let furnace = with_bsdf(ramp.as_ref().unwrap(), Vec2::ZERO, &mut lambda, |b| {
                let of = |lane: usize| {
                    let value = |wi| f64::from(b.eval(Vec3::Z, wi, TransportMode::Radiance).value[lane]);
                    steradian_testkit::integrate_sphere(value, 1e-4)
                };
                [0, 1, 2, 3].map(of)
            });
            let wo = Vec3::new(0.6, 0.0, 0.8);
            let mirrored = with_bsdf(gold.as_ref().unwrap(), Vec2::ZERO, &mut lambda, |b| {
                b.sample(wo, 0.5, Vec2::splat(0.5), TransportMode::Radiance).expect("a mirror").weight
            });
            for (lane, l) in lambda.lambda.into_iter().enumerate() {
                let reflectance = f64::from(0.1 + 0.8 * (l - 360.0) / 470.0);
                assert!((furnace[lane] - reflectance).abs() < 2e-3, "{l} nm: {} is not {reflectance}", furnace[lane]);
                let exact =
                    steradian_bsdf::fresnel::conductor(wo.z, Spectrum::splat(eta.eval(l)), Spectrum::splat(k.eval(l)))
                        [0];
                assert!((mirrored[lane] - exact).abs() < 5e-3, "{l} nm: {} is not {exact}", mirrored[lane]);
            }
        }
    }

    #[test]
    fn every_number_varies_over_the_surface() {
        for (kind, name, range) in [
            ("oren_nayar", "roughness", (0.0, 0.9)),
            ("minnaert", "k", (1.0, 2.0)),
            ("phong", "exponent", (5.0, 50.0)),
            ("blinn_phong", "exponent", (5.0, 50.0)),
            ("lafortune", "exponent", (5.0, 50.0)),
            ("ward", "alpha_u", (0.1, 0.4)),
            ("cook_torrance", "eta", (1.2, 2.0)),
            ("cook_torrance", "film_thickness", (100.0, 500.0)),
            ("cook_torrance", "film_eta", (1.2, 2.0)),
            ("conductor", "film_thickness", (100.0, 500.0)),
            ("dielectric", "eta", (1.2, 2.0)),
        ] {
            let make = |desc: &mut SceneDesc| {
                let texture = varying(desc, range.0, range.1);
                let mut node = material(kind).with(name, texture);
                if kind == "conductor" {
                    node = node.with("eta", 0.4).with("k", 2.4);
                }
                if matches!(kind, "conductor" | "dielectric") {
                    node = node.with("alpha_u", 0.3);
                }
                if name == "film_eta" { node.with("film_thickness", 300.0) } else { node }
            };
            let (scene, said) = scene(ColorMode::Rgb, make);
            let scene = scene.unwrap_or_else(|| panic!("{kind}, {name}: {said}"));
            let (here, there) = (value(&scene, Vec2::splat(0.25)), value(&scene, Vec2::new(1.25, 0.25)));
            assert!(
                here.is_finite() && there.is_finite() && (here[0] - there[0]).abs() > 1e-4,
                "{kind}, {name}: {here:?}"
            );
        }
    }

    #[test]
    fn what_is_not_possible_is_said() {
        let bad = |node: Node, expected: &str| {
            let (_, said) = scene(ColorMode::Rgb, |_| node);
            assert!(said.contains(expected), "'{said}' does not say '{expected}'");
        };
        bad(
            material("phong").with("exponent", -1.0),
            "parameter 'exponent' of material 'phong' is -1; it must be in [0, 1000000]",
        );
        bad(material("oren_nayar").with("roughness", 2.0), "it must be in [0, 1]");
        bad(material("oren_nayar").with("form", "rough"), "'rough' is not a form; known are energy_preserving, fujii");
        bad(material("ward").with("alpha_u", "much"), "must be a number");
        bad(
            material("conductor").with("alpha_u", -1.0),
            "parameter 'alpha_u' of material 'conductor' is -1; it must be in [0, 16]",
        );
        bad(material("dielectric").with("eta", 0.0), "'eta' of material 'dielectric' is 0; it must be in [0.05, 20]");
        bad(material("cook_torrance").with("eta", -2.0), "'eta' of material 'cook_torrance' is -2");
        bad(material("cook_torrance").with("film_thickness", -5.0), "it must be in [0, 100000]");
        bad(material("dielectric").with("cauchy", Value::Floats(vec![1.5])), "two or three constants, not 1");
        bad(material("dielectric").with("sellmeier", Value::Floats(vec![1.5; 5])), "six constants, not 5");
        bad(
            material("dielectric").with("abbe_number", -3.0),
            "'abbe_number' of material 'dielectric' is -3; it must be",
        );
        bad(
            material("conductor").with("conductivity", -3.0),
            "'conductivity' of material 'conductor' is -3; it must be",
        );
        bad(material("lafortune").with("coefficients", Value::Vec3([2.0, 0.0, 0.0])), "it must be in [-1, 1]");
    }

    /// A prism of Abbe number 30 bends blue more than red; in RGB it has the index of the sodium line.
    #[test]
    fn dispersion_follows_the_abbe_number() {
        let glass = || material("dielectric").with("eta", 1.6).with("abbe_number", 30.0);
        let index = |scene: &Scene, u: f32| {
            let mut lambda = Wavelengths::sample_visible(u);
            with_bsdf(scene, Vec2::ZERO, &mut lambda, |b| match b {
                Bsdf::Dielectric(d) => d.eta,
                other => panic!("{other:?}"),
            })
        };
        let (spectral, _) = scene(ColorMode::Spectral, |_| glass());
        let spectral = spectral.unwrap();
        let (blue, red) = (index(&spectral, 0.02), index(&spectral, 0.98));
        assert!(blue > 1.61 && red < 1.595, "{blue}, {red}");
        let (rgb, _) = scene(ColorMode::Rgb, |_| glass());
        assert!((index(&rgb.unwrap(), 0.02) - 1.6).abs() < 1e-3);
    }

    /// Electrical constants make the metal that its index makes: at one wavelength `n² = ε` for an insulator.
    #[test]
    fn electrical_constants_make_an_index() {
        let film = |n: Node| n.with("alpha_u", 0.3).with("film_thickness", 0.0);
        let (by_constants, said) = scene(ColorMode::Rgb, |_| film(material("conductor").with("permittivity", 4.0)));
        let by_constants = by_constants.unwrap_or_else(|| panic!("{said}"));
        let (by_index, _) = scene(ColorMode::Rgb, |_| film(material("conductor").with("eta", 2.0).with("k", 0.0)));
        let (a, b) = (value(&by_constants, Vec2::ZERO), value(&by_index.unwrap(), Vec2::ZERO));
        assert!((0..3).all(|i| (a[i] - b[i]).abs() < 1e-5 * b[i]), "{a:?} is not {b:?}");
        let named = |s: &str| Value::Spectrum(SpectrumValue::Named(s.into()));
        let (tungsten, said) = scene(ColorMode::Spectral, |_| {
            material("conductor").with("eta", named("metal-W-eta")).with("k", named("metal-W-k")).with("alpha_u", 0.2)
        });
        assert!(tungsten.is_some() && !said.contains("spectrum"), "{said}");
    }
}
