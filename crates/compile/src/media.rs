//! Compiling participating media.

use super::{Compiler, materials::combine};
use std::sync::Arc;
use steradian_core::medium::{
    Cloud, Draine, Field, Glow, GlowSource, Grid, Heat, Lobe, Medium, Phase, Table, Variation,
};
use steradian_math::{
    Bounds3, Transform, Vec3,
    spectra::{
        Blackbody, Spd,
        role::{Color, Role},
    },
    transform::Affine,
};
use steradian_scene::{Family, Node, NodeId, SpectrumValue, Value};
use steradian_texture::{Wrap, grid::Interpolation};

const ONE: SpectrumValue = SpectrumValue::Constant(1.0);

/// Blends of phase functions are nested at most this deep, which bounds their lobes to 64.
const DEEPEST_BLEND: u32 = 6;

impl Compiler<'_> {
    /// The index of a compiled medium; `None` for none, and for media that are not implemented (reported).
    pub(super) fn medium(&mut self, id: Option<NodeId>) -> Option<u32> {
        let id = id?;
        if let Some(&m) = self.medium_ids.get(&id) {
            return m;
        }
        let node = self.node(id);
        let compiled = match node.kind.as_str() {
            "homogeneous" => Some(self.homogeneous(node)),
            "uniformgrid" | "rgbgrid" | "cloud" | "heterogeneous" => self.varying(node),
            "vdb" => self.volume_file(node),
            other => self.own_medium(node).unwrap_or_else(|| {
                let known = self.all_kinds(Family::Medium);
                let what = format!("medium '{other}' is not implemented (there is {known}); it is left out");
                self.diagnostics.dropped(&self.desc.sources, node.span, what);
                None
            }),
        };
        let compiled = compiled.map(|medium| {
            self.media.push(medium);
            self.media.len() as u32 - 1
        });
        self.medium_ids.insert(id, compiled);
        compiled
    }

    pub(super) fn homogeneous(&mut self, node: &Node) -> Medium {
        let (sigma_a, sigma_s) = if node.get("sigma_t").is_some() || node.get("albedo").is_some() {
            let t = self.constant_color_or(node, "sigma_t", Role::Unbounded, ONE);
            let albedo = self.constant_color_or(node, "albedo", Role::Albedo, SpectrumValue::Constant(0.75));
            (combine(&t, &albedo, |t, a| t * (1.0 - a)), combine(&t, &albedo, |t, a| t * a))
        } else {
            (
                self.constant_color(node, "sigma_a", Role::Unbounded),
                self.constant_color(node, "sigma_s", Role::Unbounded),
            )
        };
        let phase = match self.reference(node, "phase") {
            Some(phase) => self.phase(phase, 0),
            None => {
                let g = self.float(node, "g");
                self.henyey_greenstein(node, g)
            }
        };
        let scale = self.float(node, "scale");
        if scale < 0.0 {
            self.error(node.span, format!("a medium's scale of {scale} is negative"));
        }
        let glow = self.glow(node);
        Medium { field: None, glow, sigma_a, sigma_s, scale: scale.max(0.0), phase }
    }

    /// A number of a phase function, refused outside of its range.
    fn held(&mut self, node: &Node, name: &str, (least, most): (f64, f64)) -> f64 {
        let v = f64::from(self.float(node, name));
        // Numbers are read in 32 bits, which moves the ends.
        if !(least - 1e-6..=most * (1.0 + 1e-6)).contains(&v) {
            self.error(node.span, format!("'{name}' lies between {least} and {most}, not at {v}"));
        }
        v.clamp(least, most)
    }

    /// A phase function; a sum flattens the sums in it, which are nested to a bounded depth.
    fn phase(&mut self, id: NodeId, depth: u32) -> Phase {
        let node = self.node(id);
        match node.kind.as_str() {
            "isotropic" => Phase::ISOTROPIC,
            "hg" => {
                let g = self.float(node, "g");
                self.henyey_greenstein(node, g)
            }
            "rayleigh" => Phase::of(Lobe::Rayleigh),
            "draine" => {
                let g = self.held(node, "g", (-0.999, 0.999));
                Phase::of(Lobe::Draine(Draine::new(g, self.held(node, "alpha", (0.0, 1e6)))))
            }
            "droplets" => Phase::droplets(self.held(node, "diameter", (5.0, 50.0))),
            "tabulated" => {
                let table = match node.get("values") {
                    Some(Value::Floats(values)) => Table::new(values),
                    _ => None,
                };
                if table.is_none() {
                    let what = "a tabulated phase function needs two or more 'values', none negative and not all zero";
                    self.error(node.span, what);
                }
                table.map_or(Phase::ISOTROPIC, |table| Phase::of(Lobe::Table(table)))
            }
            "blend" => {
                let weight = self.float(node, "weight");
                if !(0.0..=1.0).contains(&weight) {
                    self.error(node.span, format!("the weight of a blend lies between 0 and 1, not at {weight}"));
                }
                if depth >= DEEPEST_BLEND {
                    self.error(node.span, format!("phase functions are nested more than {DEEPEST_BLEND} deep"));
                    return Phase::ISOTROPIC;
                }
                let weight = weight.clamp(0.0, 1.0);
                let parts = [("first", 1.0 - weight), ("second", weight)].map(|(name, weight)| {
                    let part = self.reference(node, name);
                    if part.is_none() {
                        self.error(node.span, format!("a blend of phase functions needs '{name}'"));
                    }
                    (weight, part.map_or(Phase::ISOTROPIC, |part| self.phase(part, depth + 1)))
                });
                Phase::sum(&parts)
            }
            other => {
                let what = format!("phase function '{other}' is not implemented; Henyey–Greenstein stands in");
                self.approximated(node.span, what);
                let g = self.float_or(node, "g", 0.0);
                self.henyey_greenstein(node, g)
            }
        }
    }

    /// Henyey and Greenstein's phase function of a mean cosine; the isotropic one, reported, where that is none.
    fn henyey_greenstein(&mut self, node: &Node, g: f32) -> Phase {
        if g.abs() >= 1.0 {
            self.error(node.span, format!("the mean cosine g of a phase function lies between -1 and 1, not at {g}"));
            return Phase::ISOTROPIC;
        }
        Phase::HenyeyGreenstein(g)
    }

    /// Emission of a medium: `Le`, as bright as `Lescale` says. Lists are grids, which media that vary look at.
    fn glow(&mut self, node: &Node) -> Option<Glow> {
        let value = &node.param("Le")?.value;
        if matches!(value, Value::Floats(_)) && node.kind != "homogeneous" {
            return None;
        }
        let color = self.constant_color_or(node, "Le", Role::Illuminant, ONE);
        // As pbrt has it, other spectra than colours are of luminance one first; plain numbers are grey.
        let is_color = matches!(value, Value::Spectrum(SpectrumValue::Rgb(..)) | Value::Float(_) | Value::Int(_));
        let luminance = if is_color { 1.0 } else { color.luminance(self.mode) };
        let scale = self.glow_scale(node);
        let color = color.scaled(if luminance > 0.0 { scale / luminance } else { 0.0 });
        (!color.is_black()).then_some(Glow { source: GlowSource::Even(color), scale: None })
    }

    /// `Lescale` where it is a number, not below zero; one where it is a grid or absent.
    fn glow_scale(&mut self, node: &Node) -> f32 {
        match node.get("Lescale") {
            Some(Value::Floats(_)) => 1.0,
            _ => self.float(node, "Lescale").max(0.0),
        }
    }

    /// Emission of black bodies by a grid of temperatures, times a factor.
    pub(super) fn black_bodies(&mut self, node: &Node, temperatures: Grid, factor: f32) -> GlowSource {
        let (offset, scale) = (self.float(node, "temperatureoffset"), self.float(node, "temperaturescale"));
        let color = |kelvin: f32| {
            let body = Spd::Blackbody(Blackbody::normalized(kelvin.into()));
            Color::curve(&body, Role::Illuminant, self.mode).scaled(factor)
        };
        GlowSource::Heat(Box::new(Heat::new(temperatures, (offset, scale), color)))
    }

    /// Emission of the grids of a medium: black bodies by `temperature`, or the colours `Le`.
    fn varying_glow(&mut self, node: &Node) -> Option<GlowSource> {
        let factor = self.glow_scale(node);
        if let Some(kelvin) = self.list(node, "temperature") {
            let temperatures = self.grid_of(node, "temperature", kelvin, 1)?.pop()?;
            return Some(self.black_bodies(node, temperatures, factor));
        }
        // What is no grid is the same everywhere, which media with coefficients of their own know.
        if matches!(node.kind.as_str(), "uniformgrid" | "cloud") && !matches!(node.get("Le"), Some(Value::Floats(_))) {
            return None;
        }
        let colors = self.list(node, "Le")?.into_iter().map(|v| v * factor).collect();
        let channels = self.grid_of(node, "Le", colors, 3)?.try_into().ok()?;
        Some(GlowSource::Rgb(Box::new(channels), self.mode))
    }

    /// A medium in a box whose coefficients vary.
    fn varying(&mut self, node: &Node) -> Option<Medium> {
        let (variation, bounds, place) = match node.kind.as_str() {
            "heterogeneous" => {
                let (variation, bounds) = self.heterogeneous(node)?;
                (variation, bounds, Affine::IDENTITY)
            }
            _ => {
                let variation = self.grids(node)?;
                let [p0, p1] = ["p0", "p1"].map(|name| self.vec3(node, name));
                (variation, Bounds3::from_points([p0, p1]), self.place(node)?)
            }
        };
        let Some(field) = Field::new(&bounds, &place, variation, self.mode) else {
            self.error(node.span, "the box of this medium has no volume");
            return None;
        };
        let mut base = if matches!(node.kind.as_str(), "uniformgrid" | "cloud") {
            self.homogeneous(node)
        } else {
            // The grids have the coefficients.
            let mut plain = Node::new(node.family, "homogeneous", node.span);
            for name in ["scale", "phase", "g", "albedo", "sigma_t"] {
                let is_grid = self.grid_reference(node, name).is_some();
                if let Some(p) = node.param(name).filter(|_| !is_grid) {
                    plain.set(name, p.value.clone(), p.span);
                }
            }
            if node.kind == "rgbgrid" {
                plain.set("sigma_a", ONE, None);
                plain.set("sigma_s", ONE, None);
            } else {
                for name in ["sigma_t", "albedo"].into_iter().filter(|name| self.grid_reference(node, name).is_some()) {
                    plain.set(name, ONE, None);
                }
                if plain.get("sigma_t").is_none() {
                    plain.set("sigma_t", ONE, None);
                }
            }
            self.homogeneous(&plain)
        };
        if let Some(source) = self.varying_glow(node) {
            base.glow = Some(Glow { source, scale: None });
        }
        if let (Some(glow), Some(Value::Floats(_))) = (&mut base.glow, node.get("Lescale")) {
            let values = self.list(node, "Lescale")?;
            glow.scale = self.grid_of(node, "Lescale", values, 1)?.pop();
        }
        Some(Medium { field: Some(Arc::new(field)), ..base })
    }

    pub(super) fn place(&mut self, node: &Node) -> Option<Affine> {
        let place = self.transform(node, "to_world").affine();
        if place.is_none() {
            self.error(node.span, "the transform of this medium is singular or not finite");
        }
        place
    }

    /// The grids of pbrt's media.
    fn grids(&mut self, node: &Node) -> Option<Variation> {
        if node.kind == "cloud" {
            let mut value = |name| self.float(node, name);
            let (density, wispiness) = (value("density"), value("wispiness"));
            return Some(Variation::Cloud(Cloud { density, wispiness, frequency: value("frequency") }));
        }
        if node.kind == "uniformgrid" {
            if node.get("density").is_none() {
                self.error(
                    node.span,
                    "medium 'uniformgrid' needs the parameter 'density', a grid of nx × ny × nz numbers",
                );
            }
            let density = self.list(node, "density")?;
            return self.grid_of(node, "density", density, 1)?.pop().map(Variation::Density);
        }
        let mut channels = |name: &str| -> Option<[Grid; 3]> {
            let values = match self.list(node, name) {
                Some(values) => values,
                // Absent coefficients are one in pbrt.
                None => vec![1.0; self.cells(node)?.iter().product::<usize>() * 3],
            };
            self.grid_of(node, name, values, 3)?.try_into().ok()
        };
        Some(Variation::Rgb(Box::new([channels("sigma_a")?, channels("sigma_s")?])))
    }

    /// Resolution of a medium's grids along each axis.
    fn cells(&mut self, node: &Node) -> Option<[usize; 3]> {
        let mut size = [1; 3];
        for (n, name) in size.iter_mut().zip(["nx", "ny", "nz"]) {
            let count = self.int(node, name);
            let usable = usize::try_from(count).ok().filter(|n| (1..=1 << 20).contains(n));
            if usable.is_none() {
                let span = node.param(name).and_then(|p| p.span).or(node.span);
                self.error(
                    span,
                    format!("parameter '{name}' of medium '{}' is {count}; it must be in [1, 1048576]", node.kind),
                );
            }
            *n = usable?;
        }
        let count = size.iter().try_fold(1_usize, |n, s| n.checked_mul(*s));
        if count.is_none_or(|n| n > 1 << 28) {
            self.error(node.span, format!("a grid of {} × {} × {} numbers is too large", size[0], size[1], size[2]));
            return None;
        }
        Some(size)
    }

    /// Grids of the channels of a list of numbers.
    fn grid_of(&mut self, node: &Node, name: &str, values: Vec<f32>, channels: usize) -> Option<Vec<Grid>> {
        let size = self.cells(node)?;
        let channel = |c: usize| values.iter().skip(c).step_by(channels).copied().collect::<Vec<f32>>();
        let grids = (0..channels).map(|c| Grid::new(size, channel(c), Wrap::Border)).collect::<Option<Vec<_>>>();
        if grids.is_none() {
            let span = node.param(name).and_then(|p| p.span).or(node.span);
            self.error(span, format!("'{name}' has {} numbers, which are no grid of nx × ny × nz", values.len()));
        }
        grids
    }

    /// Mitsuba's `heterogeneous`: extinction, and albedo where that is a grid, in the box around the extinction's unit
    /// cube, which is parallel to the axes of the world.
    fn heterogeneous(&mut self, node: &Node) -> Option<(Variation, Bounds3)> {
        let (mut density, unit, place) = match node.get("sigma_t") {
            Some(Value::Node(id)) => self.volume(*id, "extinction")?,
            _ => {
                let unit = Bounds3 { min: Vec3::ZERO, max: Vec3::ONE };
                (vec![Grid::new([1; 3], vec![1.0], Wrap::Clamp)?], unit, self.place(node)?)
            }
        };
        if density.len() > 1 {
            self.approximated(node.span, "the extinction of a medium has one channel; the first is used");
        }
        let bounds = place.bounds(&unit);
        let world_from_cube =
            Transform::translate(bounds.min.as_dvec3()) * Transform::scale(bounds.diagonal().as_dvec3());
        let Some(world_from_cube) = world_from_cube.affine() else {
            self.error(node.span, "the box of this medium has no volume");
            return None;
        };
        let placed = |mut grid: Grid, (unit, place): (&Bounds3, &Affine)| {
            let unit_from_box =
                Transform::scale((Vec3::ONE / unit.diagonal()).as_dvec3()) * Transform::translate(-unit.min.as_dvec3());
            let (unit_from_box, into) = (unit_from_box.affine()?, place.inverse());
            let m = unit_from_box.m * into.m * world_from_cube.m;
            let inv = world_from_cube.inv * into.inv * unit_from_box.inv;
            grid.from_cube = Some(Affine { m, inv });
            Some(grid)
        };
        let density = placed(density.swap_remove(0), (&unit, &place))?;
        let Some(albedo) = self.grid_reference(node, "albedo") else {
            return Some((Variation::Density(density), bounds));
        };
        let (albedo, unit, place) = self.volume(albedo, "albedo")?;
        let albedo = albedo.into_iter().map(|grid| placed(grid, (&unit, &place))).collect::<Option<_>>()?;
        Some((Variation::Albedo(density, albedo), bounds))
    }

    /// The node of a parameter that is a `grid`.
    fn grid_reference(&self, node: &Node, name: &str) -> Option<NodeId> {
        node.node(name).filter(|id| self.node(*id).kind == "grid")
    }

    /// The channels of a grid of space, its box, and where that is in the world.
    fn volume(&mut self, id: NodeId, what: &str) -> Option<(Vec<Grid>, Bounds3, Affine)> {
        let volume = self.node(id);
        if volume.kind != "grid" {
            let what = format!("the {what} of a medium is a grid, not '{}'; this medium is left out", volume.kind);
            self.diagnostics.dropped(&self.desc.sources, volume.span, what);
            return None;
        }
        let texture = self.grid(volume)?;
        let voxels = &texture.grid;
        let channels = if voxels.channels >= 3 { 3 } else { 1 };
        let grids: Option<Vec<Grid>> = (0..channels)
            .map(|c| {
                let values = voxels.data.iter().skip(c).step_by(voxels.channels.max(1)).map(|v| v * texture.scale);
                let mut grid = Grid::new(voxels.size, values.collect(), texture.wrap)?;
                grid.is_nearest = texture.interpolation == Interpolation::Nearest;
                Some(grid)
            })
            .collect();
        let Some(place) = self.transform(volume, "texture_from_world").inverse().and_then(|t| t.affine()) else {
            self.error(volume.span, "the transform of this grid is singular or not finite");
            return None;
        };
        let unit = [[0.0; 3], [1.0; 3]];
        let bounds = if self.bool(volume, "use_grid_bounds") { voxels.bounds } else { unit };
        Some((grids?, Bounds3::from_points(bounds.map(Vec3::from_array)), place))
    }
}
