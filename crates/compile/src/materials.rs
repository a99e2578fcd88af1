//! Compiling materials and media.

use super::{Compiler, ResolvedMaterial};
use std::sync::Arc;
use steradian_bsdf::{CoatSeries, NormalDistribution, Shadowing, Tail, recipes};
use steradian_core::material::{
    CoatNormals, Eta, Facing, FilteredNormals, Material, Model, NormalFilter, NormalMap, NormalSpace, Parametric,
    Roughness, SurfaceDetail,
    normal_code::{NORMAL_CODES, NormalCode},
    normal_map::NORMAL_SPACES,
};
use steradian_math::spectra::{
    ColorMode,
    role::{Color, Role},
};
use steradian_scene::{Family, Format, Node, NodeId, SpectrumValue, Value};
use steradian_texture::{FloatTexture, SpectrumTexture, Texture, TextureId};

const ONE: SpectrumValue = SpectrumValue::Constant(1.0);
const HALF: SpectrumValue = SpectrumValue::Constant(0.5);
/// Deepest nesting of materials in materials.
const MAX_DEPTH: usize = 32;

impl Compiler<'_> {
    /// The compiled form of a material node; the default material for none.
    pub(super) fn material(&mut self, id: Option<NodeId>) -> ResolvedMaterial {
        id.map_or(ResolvedMaterial { id: 0, alpha: None }, |id| self.material_at(id, 0))
    }

    fn material_at(&mut self, id: NodeId, depth: usize) -> ResolvedMaterial {
        if let Some(&m) = self.material_ids.get(&id) {
            return m;
        }
        let node = self.node(id);
        let failed = ResolvedMaterial { id: 0, alpha: None };
        if node.family != Family::Material {
            self.error(node.span, format!("a material is needed here, but this is a {}", node.family.noun()));
            return failed;
        }
        if depth > MAX_DEPTH {
            self.error(node.span, format!("materials are nested more than {MAX_DEPTH} deep"));
            return failed;
        }
        if !self.open.insert(id) {
            self.error(node.span, "this material contains itself");
            return failed;
        }
        let before = self.materials.len();
        let node = &*self.within_ranges(node);
        let mut resolved = self.new_material(node, depth);
        let ambient = node.get("ambient").is_some().then(|| self.spectrum_or(node, "ambient", Role::Albedo, HALF));
        let detail = self.surface_detail(node);
        if detail.is_some() || ambient.is_some() {
            // What stands for this node alone is changed, what others share is copied.
            if (resolved.id as usize) < before {
                let inner = self.materials[resolved.id as usize].clone();
                self.materials.push(inner);
                self.material_names.push(node.name.clone().unwrap_or_else(|| node.kind.clone()));
                resolved.id = self.materials.len() as u32 - 1;
            }
            let material = &mut self.materials[resolved.id as usize];
            material.detail = detail.or(material.detail.take());
            material.ambient = ambient;
        }
        self.open.remove(&id);
        self.material_ids.insert(id, resolved);
        resolved
    }

    pub(super) fn add(&mut self, node: &Node, model: Model) -> ResolvedMaterial {
        let is_sheet = matches!(&model, Model::Principled(p) if p.thin.is_some());
        let two_sided = is_sheet || self.desc.format != Format::Mitsuba;
        self.materials.push(Material::new(model, two_sided));
        self.material_names.push(node.name.clone().unwrap_or_else(|| node.kind.clone()));
        ResolvedMaterial { id: self.materials.len() as u32 - 1, alpha: None }
    }

    /// Modification of the shading normal of a material. pbrt's displacement is a bump map, and does not count beside a
    /// normal map.
    fn surface_detail(&mut self, node: &Node) -> Option<SurfaceDetail> {
        let facings = [
            ("bent", Facing::Bent),
            ("leaking", Facing::Leaking),
            ("turned", Facing::Turned),
            ("as_it_is", Facing::AsItIs),
        ];
        let mut detail = SurfaceDetail {
            facing: self.choice(node, "detail_facing", &facings),
            shadows: self.bool(node, "detail_shadowing"),
            ..SurfaceDetail::default()
        };
        if let Some(id) = self.reference(node, "normal_map") {
            let texture = self.texture(id, Role::Unbounded);
            let mut map = NormalMap {
                texture: self.as_texture(texture),
                code: self.choice(node, "normal_map_code", &NORMAL_CODES),
                space: self.choice(node, "normal_map_space", &NORMAL_SPACES),
                mirrors: self.normal_maps_mirror(node),
                strength: self.float(node, "normal_map_strength"),
                filtered: None,
                over: None,
            };
            if map.space == NormalSpace::Object {
                self.has_object_normals = true;
                if map.code == NormalCode::Xy {
                    let what = "normals of the object point anywhere: 'normal_map_code' is xyz or octahedral, not xy";
                    self.error(node.param("normal_map_code").and_then(|p| p.span).or(node.span), what);
                }
            }
            map.filtered = self.filtered_normals(node, &map);
            map.over = self.detail_normal_map(node, &map);
            detail.normal_map = Some(map);
        }
        for name in ["bump", "displacement"] {
            let shadowed = self.desc.format == Format::Pbrt && detail.normal_map.is_some();
            if node.get(name).is_some() && !shadowed {
                let height = self.float_texture_or(node, name, 0.0);
                // The same height everywhere changes nothing.
                if let FloatTexture::Texture(_) = height {
                    detail.bump = Some(height);
                }
            }
        }
        if node.get("anisotropy_rotation").is_some() {
            let rotation = self.float_texture_or(node, "anisotropy_rotation", 0.0);
            detail.rotation = (!matches!(rotation, FloatTexture::Constant(0.0))).then_some(rotation);
        }
        if let Some(id) = self.reference(node, "anisotropy_direction") {
            let texture = self.texture(id, Role::Unbounded);
            detail.direction = Some(self.as_texture(texture));
        }
        detail.coat = self.coat_normals(node);
        let SurfaceDetail { normal_map, bump, rotation, direction, coat, .. } = &detail;
        let turns = rotation.is_some() || direction.is_some();
        (normal_map.is_some() || bump.is_some() || turns || coat.is_some()).then_some(detail)
    }

    /// True if y of normal maps points along ∂p/∂v also where the parametrisation is mirrored.
    fn normal_maps_mirror(&mut self, node: &Node) -> bool {
        let usual = !matches!(self.desc.format, Format::Pbrt | Format::Mitsuba);
        self.bool_or(node, "normal_map_mirrors", usual)
    }

    /// Normals that a clear coat has of its own.
    fn coat_normals(&mut self, node: &Node) -> Option<CoatNormals> {
        let is_own =
            node.get("coat_normals").is_some() && self.choice(node, "coat_normals", &[("base", false), ("own", true)]);
        let Some(id) = self.reference(node, "coat_normal_map") else { return is_own.then_some(CoatNormals::Surface) };
        if node.get("coat_normals").is_some() && !is_own {
            let what = "'coat_normal_map' gives the coat normals of its own: 'coat_normals' is \"own\", not \"base\"";
            self.error(node.param("coat_normals").and_then(|p| p.span).or(node.span), what);
        }
        let texture = self.texture(id, Role::Unbounded);
        Some(CoatNormals::Mapped(Box::new(NormalMap {
            texture: self.as_texture(texture),
            code: NormalCode::Xyz,
            space: NormalSpace::Tangent,
            mirrors: self.normal_maps_mirror(node),
            strength: self.float(node, "coat_normal_map_strength"),
            filtered: None,
            over: None,
        })))
    }

    /// The map on top of a normal map.
    fn detail_normal_map(&mut self, node: &Node, below: &NormalMap) -> Option<Box<NormalMap>> {
        let id = self.reference(node, "detail_normal_map")?;
        let texture = self.texture(id, Role::Unbounded);
        Some(Box::new(NormalMap {
            texture: self.as_texture(texture),
            code: self.choice(node, "detail_normal_map_code", &NORMAL_CODES),
            space: NormalSpace::Tangent,
            strength: self.float(node, "detail_normal_map_strength"),
            filtered: None,
            over: None,
            ..*below
        }))
    }

    /// A normal map whose spread counts as roughness, where the node asks for it.
    fn filtered_normals(&mut self, node: &Node, map: &NormalMap) -> Option<Arc<FilteredNormals>> {
        let kinds = [("none", None), ("toksvig", Some(NormalFilter::Toksvig)), ("lean", Some(NormalFilter::Lean))];
        let kind = self.choice(node, "normal_map_filter", &kinds)?;
        if map.space == NormalSpace::Object {
            self.error(node.span, "'normal_map_filter' needs a normal map in the tangent frame");
            return None;
        }
        let Texture::Image(image) = self.textures.get(map.texture) else {
            self.error(node.span, "'normal_map_filter' needs a normal map that is a picture");
            return None;
        };
        match FilteredNormals::new(image, kind, |v| map.decode(v), self.assets.pages.as_ref()) {
            Ok(filtered) => Some(Arc::new(filtered)),
            Err(e) => {
                self.error(node.span, format!("cannot keep the levels of this normal map: {e}"));
                None
            }
        }
    }

    fn nested(&mut self, node: &Node, name: &str, depth: usize) -> ResolvedMaterial {
        match node.get(name) {
            Some(Value::Node(id)) => self.material_at(*id, depth + 1),
            _ => {
                self.error(node.span, format!("material '{}' needs a material as '{name}'", node.kind));
                ResolvedMaterial { id: 0, alpha: None }
            }
        }
    }

    fn new_material(&mut self, node: &Node, depth: usize) -> ResolvedMaterial {
        let model = match node.kind.as_str() {
            "diffuse" => Model::Diffuse(self.spectrum(node, "reflectance", Role::Albedo)),
            "diffuse_transmission" => Model::DiffuseTransmission(
                self.spectrum(node, "reflectance", Role::Albedo),
                self.spectrum(node, "transmittance", Role::Albedo),
            ),
            "conductor" => self.conductor(node),
            "dielectric" => Model::Dielectric {
                eta: self.eta(node),
                reflectance: self.spectrum(node, "specular_reflectance", Role::Albedo),
                transmittance: self.spectrum(node, "specular_transmittance", Role::Albedo),
                roughness: self.roughness(node, "alpha_u", "alpha_v"),
            },
            "thin_dielectric" => Model::ThinDielectric {
                eta: self.eta(node),
                reflectance: self.spectrum(node, "specular_reflectance", Role::Albedo),
                transmittance: self.spectrum(node, "specular_transmittance", Role::Albedo),
            },
            "coated_diffuse" => {
                // They count for random walks alone, but are checked for both.
                self.float_texture(node, "g");
                self.int(node, "samples");
                let is_textured = matches!(node.get("thickness"), Some(Value::Node(_)));
                if Self::coat_scatters(node) || is_textured {
                    self.layered_diffuse(node)
                } else {
                    let thickness = self.float(node, "thickness");
                    let max_depth = u32::try_from(self.int(node, "max_depth")).unwrap_or(10);
                    self.coated(node, "reflectance", CoatSeries::Layered { thickness, max_depth })
                }
            }
            "coated_conductor" => self.coated_conductor(node),
            "plastic" => {
                let nonlinear = self.bool(node, "nonlinear");
                self.coated(node, "diffuse_reflectance", CoatSeries::Plastic { nonlinear })
            }
            "cook_torrance" => Model::Facets(self.cook_torrance(node)),
            "measured" => self.measured(node),
            "fluorescent" => self.fluorescent(node),
            "grating" => self.grating(node),
            "hair" => self.hair(node),
            "metallic_roughness" => self.metallic_roughness(node),
            "openpbr" => self.openpbr(node),
            "sheen" => self.sheen(node),
            "subsurface" => self.subsurface(node),
            "principled" => self.principled(node, false),
            "principledthin" => self.principled(node, true),
            "interface" => Model::Interface,
            "mask" => {
                let inner = self.nested(node, "material", depth);
                let opacity = self.float_texture(node, "opacity");
                return ResolvedMaterial { id: inner.id, alpha: Some(self.product(node, inner.alpha, opacity)) };
            }
            "two_sided" => {
                let front = self.nested(node, "front", depth);
                let back = if node.get("back").is_some() { self.nested(node, "back", depth) } else { front };
                if back.alpha.is_some() && back.id != front.id {
                    self.approximated(node.span, "the mask of the back side counts for the front side's mask");
                }
                let mut m = self.add(node, Model::TwoSided(front.id, back.id));
                m.alpha = front.alpha;
                return m;
            }
            "mix" => match node.get("materials") {
                Some(Value::Nodes(parts)) if parts.len() == 2 => {
                    let [a, b] = [parts[0], parts[1]].map(|p| self.material_at(p, depth + 1));
                    if a.alpha.is_some() || b.alpha.is_some() {
                        self.approximated(node.span, "masks of the parts of a mix are ignored");
                    }
                    let amount = self.float_texture(node, "amount");
                    match (&self.materials[a.id as usize].model, &self.materials[b.id as usize].model) {
                        // Lambertian parts mix exactly: their reflectances do.
                        (Model::Diffuse(a), Model::Diffuse(b)) => {
                            let parts = [a.clone(), b.clone()].map(|t| self.as_texture(t));
                            let amount = match amount {
                                FloatTexture::Texture(id) => id,
                                FloatTexture::Constant(v) => self.textures.add(Texture::Constant(Color::constant(v))),
                            };
                            let mixed = self.add_texture(node, Texture::Mix(parts[0], parts[1], amount));
                            Model::Diffuse(SpectrumTexture::Texture(mixed, Role::Albedo))
                        }
                        _ => Model::Mix(a.id, b.id, amount),
                    }
                }
                _ => {
                    self.error(node.span, "material 'mix' needs two materials");
                    Model::Interface
                }
            },
            kind => match (recipes().find(|r| r.kind == kind), Family::Material.model(kind)) {
                (Some(recipe), Some(model)) => {
                    Model::Parametric(Box::new(Parametric { recipe, inputs: self.input_textures(node, model) }))
                }
                _ => match self.own_material(node) {
                    Some(own) => Model::Own(Box::new(own)),
                    None => return self.nearest_material(node, depth),
                },
            },
        };
        self.add(node, model)
    }

    pub(super) fn as_texture(&mut self, t: SpectrumTexture) -> TextureId {
        match t {
            SpectrumTexture::Texture(id, _) => id,
            SpectrumTexture::Constant(c) => self.textures.add(Texture::Constant(c)),
        }
    }

    /// Opacities multiply.
    fn product(&mut self, node: &Node, a: Option<FloatTexture>, b: FloatTexture) -> FloatTexture {
        match (a, b) {
            (None, b) => b,
            (Some(FloatTexture::Constant(a)), FloatTexture::Constant(b)) => FloatTexture::Constant(a * b),
            (Some(a), b) => {
                let [a, b] = [a, b].map(|t| match t {
                    FloatTexture::Texture(id) => id,
                    FloatTexture::Constant(v) => self.textures.add(Texture::Constant(Color::constant(v))),
                });
                FloatTexture::Texture(self.add_texture(node, Texture::Scale(a, b)))
            }
        }
    }

    /// Materials that are not implemented: the nearest one that is, reported.
    fn nearest_material(&mut self, node: &Node, depth: usize) -> ResolvedMaterial {
        // Wrappers (bump and normal maps, layers of unknown kinds) leave what they wrap.
        let inner = node.params.iter().find_map(|p| match &p.value {
            Value::Node(id) if self.node(*id).family == Family::Material => Some(*id),
            Value::Nodes(ids) => ids.iter().copied().find(|id| self.node(*id).family == Family::Material),
            _ => None,
        });
        let say = |c: &mut Self, stand_in: &str| {
            let what = format!("material '{}' is not implemented; {stand_in} stands in", node.kind);
            let help = c.nearest_kind(node).filter(|_| node.span.is_none());
            c.diagnostics.approximated_help(&c.desc.sources, node.span, what, help);
        };
        if let Some(inner) = inner {
            say(self, "the material inside it");
            return self.material_at(inner, depth + 1);
        }
        let color = |c: &mut Self, names: &[&str]| {
            let name = names.iter().find(|n| node.get(n).is_some()).copied().unwrap_or("reflectance");
            c.spectrum_or(node, name, Role::Albedo, HALF)
        };
        let model = match node.kind.as_str() {
            "diffusetransmission" => {
                say(self, "diffuse reflection and transmission");
                let quarter = SpectrumValue::Constant(0.25);
                Model::DiffuseTransmission(
                    self.spectrum_or(node, "reflectance", Role::Albedo, quarter.clone()),
                    self.spectrum_or(node, "transmittance", Role::Albedo, quarter),
                )
            }
            _ => {
                say(self, "a diffuse surface");
                Model::Diffuse(color(self, &["reflectance", "base_color", "diffuse_reflectance", "color"]))
            }
        };
        self.add(node, model)
    }

    /// Roughness of a material by the names of its two α.
    pub(super) fn roughness(&mut self, node: &Node, u: &str, v: &str) -> Roughness {
        use NormalDistribution::{Beckmann, Blinn, Gaussian, Ggx, StudentT};
        let [u, v] = self.alphas(node, [u, v]);
        let tail = Tail::new(self.float(node, "gamma"));
        let distributions = [
            ("ggx", Ggx),
            ("beckmann", Beckmann),
            ("student_t", StudentT(tail)),
            ("blinn", Blinn),
            ("gaussian", Gaussian),
        ];
        let shadowings = [
            ("height_correlated", Shadowing::HeightCorrelated),
            ("separable", Shadowing::Separable),
            ("v_groove", Shadowing::VGroove),
        ];
        let shadowing = if self.desc.format == Format::Mitsuba && node.kind != "cook_torrance" {
            self.choice_or(node, "shadowing", Shadowing::Separable, &shadowings)
        } else {
            self.choice(node, "shadowing", &shadowings)
        };
        Roughness {
            u,
            v,
            remap: self.bool(node, "remap_roughness"),
            distribution: self.choice(node, "distribution", &distributions),
            shadowing,
        }
    }

    /// Both α of a roughness; the second one is the first where it is absent.
    pub(super) fn alphas(&mut self, node: &Node, [u, v]: [&str; 2]) -> [FloatTexture; 2] {
        let alpha_u = self.float_texture(node, u);
        // What one word of a file gave to both is looked at once.
        let own = |n: &str| node.param(n).map(|p| (&p.value, p.span));
        let is_same = own(v).is_none() || own(v) == own(u);
        if is_same {
            return [alpha_u, alpha_u];
        }
        let default = self.default_number(node, u);
        [alpha_u, self.float_texture_or(node, v, default)]
    }

    /// A metal, smooth or rough.
    fn conductor(&mut self, node: &Node) -> Model {
        let roughness = self.roughness(node, "alpha_u", "alpha_v");
        match self.special_metal(node, &roughness) {
            Some(model) => model,
            None => self.metal(node, roughness),
        }
    }

    /// A metal by its index or its reflectance; a perfect mirror without either.
    pub(super) fn metal(&mut self, node: &Node, roughness: Roughness) -> Model {
        if node.get("reflectance").is_some() {
            let r = self.spectrum_or(node, "reflectance", Role::Albedo, ONE);
            return Model::ConductorReflectance(r, roughness);
        }
        let tint = self.spectrum(node, "specular_reflectance", Role::Albedo);
        if node.get("eta").is_none() && node.get("k").is_none() {
            return Model::Mirror(tint, roughness);
        }
        let exceeds = |name: &str| match node.get(name) {
            Some(Value::Spectrum(SpectrumValue::Rgb(v, _))) => v.iter().any(|v| *v > 1.0),
            _ => false,
        };
        if self.mode == ColorMode::Spectral && self.desc.format == Format::Mitsuba && (exceeds("eta") || exceeds("k")) {
            let what = "RGB values of 'eta' and 'k' above one are spectra as they stand; Mitsuba's spectral mode \
                        holds them at one";
            self.diagnostics.note(&self.desc.sources, node.span, what);
        }
        Model::Conductor {
            eta: self.spectrum(node, "eta", Role::Index),
            k: self.spectrum(node, "k", Role::Index),
            tint,
            roughness,
        }
    }

    fn eta(&mut self, node: &Node) -> Eta {
        if let Some(eta) = self.dispersion(node) {
            return eta;
        }
        if let Some(Value::Node(_)) = node.get("eta") {
            return match self.float_texture(node, "eta") {
                FloatTexture::Constant(v) if v > 0.0 => Eta::Constant(v),
                varying => Eta::Varying(varying),
            };
        }
        self.eta_named(node, "eta")
    }

    pub(super) fn eta_named(&mut self, node: &Node, name: &str) -> Eta {
        let sodium = self.at_sodium_line(node, name);
        if self.mode == ColorMode::Spectral {
            let color = self.constant_color(node, name, Role::Index);
            if let Color::Spectral(_) = color {
                return Eta::Dispersive(color);
            }
        }
        Eta::Constant(sodium)
    }

    fn coated(&mut self, node: &Node, base: &str, series: CoatSeries) -> Model {
        let roughness = self.roughness(node, "alpha_u", "alpha_v");
        let base = self.spectrum(node, base, Role::Albedo);
        self.coat_over(node, base, roughness, series)
    }

    fn coat_over(&mut self, node: &Node, base: SpectrumTexture, roughness: Roughness, series: CoatSeries) -> Model {
        let range = |t: FloatTexture| match t {
            FloatTexture::Constant(v) if roughness.remap => (v.max(0.0).sqrt(), v.max(0.0).sqrt()),
            FloatTexture::Constant(v) => (v, v),
            FloatTexture::Texture(_) => (0.0, 1.0),
        };
        let (u, v) = (range(roughness.u), range(roughness.v));
        let eta = self.at_sodium_line(node, "eta");
        let alpha = (u.0.min(v.0), u.1.max(v.1));
        Model::Coated {
            reflectance: base,
            tint: self.spectrum(node, "specular_reflectance", Role::Albedo),
            table: self.coats.table(roughness.distribution, roughness.shadowing, eta, alpha, series),
            roughness,
        }
    }

    /// The albedo of a deep medium as diffuse light inside sees it (van de Hulst 1980, Multiple Light Scattering, a
    /// fit): `(1 − s)(1 − 0.139 s)/(1 + 1.17 s)` with `s = √((1 − a)/(1 − a g))`; a `reflectance` where the file gives
    /// one.
    pub(super) fn subsurface_albedo(&mut self, node: &Node) -> SpectrumTexture {
        if node.get("reflectance").is_some() || node.get("sigma_s").is_none() {
            return self.spectrum(node, "reflectance", Role::Albedo);
        }
        let a = self.constant_color_or(node, "sigma_a", Role::Unbounded, ONE);
        let s = self.constant_color_or(node, "sigma_s", Role::Unbounded, ONE);
        let g = self.float(node, "g").clamp(-0.99, 0.99);
        SpectrumTexture::Constant(combine(&a, &s, move |a, s| {
            let albedo = if a + s > 0.0 { (s / (a + s)).clamp(0.0, 1.0) } else { 0.0 };
            let s = ((1.0 - albedo) / (1.0 - albedo * g)).sqrt();
            (1.0 - s) * (1.0 - 0.139 * s) / (1.0 + 1.17 * s)
        }))
    }
}

/// A function of two colours, lane by lane or wavelength by wavelength.
pub(super) fn combine(a: &Color, b: &Color, f: impl Fn(f32, f32) -> f32) -> Color {
    use std::sync::Arc;
    use steradian_math::{
        Spectrum,
        spectra::{Dense, Spd, Wavelengths},
    };
    match (a, b) {
        (Color::Lanes(a), Color::Lanes(b)) => {
            let (a, b) = (a.to_array(), b.to_array());
            Color::Lanes(Spectrum::new(std::array::from_fn(|i| f(a[i], b[i]))))
        }
        _ => Color::Spectral(Spd::Dense(Arc::new(Dense::new(|l| {
            let w = Wavelengths::at([l; 4]);
            f(a.eval(&w)[0], b.eval(&w)[0])
        })))),
    }
}
