//! Compiling textures and loading images.

use super::{
    Compiler,
    assets::{Assets, Image, Loaded, Source},
};
use rayon::prelude::*;
use std::{
    cmp::Reverse,
    collections::{BTreeSet, HashMap},
    path::{Path, PathBuf},
    sync::Arc,
};
use steradian_image::{Encoding, TexelData, Texels};
use steradian_math::{
    DVec3, Transform,
    spectra::role::{Color, Role},
};
use steradian_scene::{Family, Format, Node, NodeId, Value};
use steradian_texture as texture;
use steradian_texture::{
    Domain, Filter, FormulaTexture, GridTexture, ImageTexture, Mapping, SpectrumTexture, Texture, Wrap,
    filter::FILTERS,
    formula::{self, Components},
    grid::Interpolation,
    kernel::MIP_KERNELS,
    levels::{Levels, Recipe, Shape},
    store::{Level, Pages},
    summed::SummedArea,
    wrap::Borders,
};

/// Names of single channels.
const CHANNELS: [(&str, Option<usize>); 5] =
    [("color", None), ("r", Some(0)), ("g", Some(1)), ("b", Some(2)), ("a", Some(3))];

/// Most texels that the filter `sinc`, which looks at all of them, takes.
const MOST_OF_SINC: usize = 1 << 14;

impl Compiler<'_> {
    /// Loads every image that a node names, each once, in parallel. Failures are reported where the image is used.
    /// `film` is what the film takes, bytes.
    pub(super) fn load_images(&mut self, film: u64) {
        let names = |wanted: fn(&Node) -> bool| -> BTreeSet<&Path> {
            self.desc.nodes.iter().filter(|n| wanted(n)).filter_map(|n| n.path("file")).collect()
        };
        let mut textures =
            names(|n| n.family == Family::Texture && matches!(n.kind.as_str(), "image" | "distance_field"));
        let mut others = names(|n| n.family == Family::Light || n.kind == "height_field");
        // What an earlier compilation read is there already.
        let is_limited = self.options.texture_limit.is_some();
        let Assets { images, paged, .. } = &self.assets;
        textures.retain(|p| if is_limited { !paged.contains_key(*p) } else { !images.contains_key(*p) });
        others.retain(|p| !images.contains_key(*p));
        if !self.pictures_fit(&textures, &others, film) {
            return;
        }
        let (limits, desc) = (self.options.image_limits, self.desc);
        // Colours of files with primaries of their own are brought to ours; numbers, such as normals, stay as they are.
        let colors = names(|n| n.family == Family::Light || (n.kind == "image" && n.bool("raw") != Some(true)));
        let mend = |path: &Path, texels: &mut Texels| {
            if colors.contains(path) {
                texels.to_rec709();
            }
            blacken_non_finite(texels)
        };
        let load = |p: &Path| -> Image<Arc<Texels>> {
            let read = match desc.embedded.get(p) {
                Some(bytes) => steradian_image::read_texels_bytes(bytes, Some(p), &limits),
                None => steradian_image::read_texels(p, &limits),
            };
            let mut texels = read.map_err(|e| e.to_string())?;
            let faults = mend(p, &mut texels);
            let notes = std::mem::take(&mut texels.metadata.notes);
            Ok(Loaded { texels: Arc::new(texels), faults, notes })
        };
        match self.options.texture_limit {
            None => others.extend(&textures),
            Some(limit) => {
                let pages = match self.assets.pages.clone().map_or_else(|| Pages::new(limit), Ok) {
                    Ok(pages) => pages,
                    Err(e) => return self.error(None, format!("cannot make a temporary file for textures: {e}")),
                };
                let page = |p: &Path| -> Image<Level> {
                    let (mut faults, mut notes) = (0, Vec::new());
                    let texels = if desc.embedded.contains_key(p) {
                        let image = load(p)?;
                        (faults, notes) = (image.faults, image.notes);
                        Level::new(image.texels, Some(&pages)).map_err(|e| e.to_string())?
                    } else {
                        Level::read(p, &limits, &pages, |band| {
                            faults += mend(p, band);
                            notes.append(&mut band.metadata.notes);
                        })
                        .map_err(|e| e.to_string())?
                    };
                    Ok(Loaded { texels, faults, notes })
                };
                self.assets.sources_of(desc, &textures);
                self.assets.paged.extend(load_within(limit / 2, textures, page));
                self.assets.pages = Some(pages);
            }
        }
        self.assets.sources_of(desc, &others);
        let read: Vec<_> = others.par_iter().map(|p| (p.to_path_buf(), load(p))).collect();
        self.assets.images.extend(read);
    }

    /// True if there is memory for the film and for pictures with all their sizes; reported if not, before anything is
    /// loaded.
    fn pictures_fit(&mut self, textures: &BTreeSet<&Path>, others: &BTreeSet<&Path>, film: u64) -> bool {
        let Some(available) = self.options.memory else { return true };
        let bytes = |files: &BTreeSet<&Path>| files.iter().filter_map(|p| steradian_image::declared_bytes(p)).sum();
        let (textures, others): (u64, u64) = (bytes(textures), bytes(others));
        let textures = textures / 3 * 4;
        let held = self.options.texture_limit.map_or(textures, |limit| textures.min(limit as u64));
        let needed = held.saturating_add(others).saturating_add(film);
        if needed <= available {
            return true;
        }
        let gigabytes = |bytes: u64| bytes as f64 / f64::from(1 << 30);
        let what = format!(
            "the scene needs about {:.1} GiB of memory ({:.1} for textures, {:.1} for other pictures, {:.1} for the \
             film), and {:.1} are there",
            gigabytes(needed),
            gigabytes(held),
            gigabytes(others),
            gigabytes(film),
            gigabytes(available),
        );
        let help = (held > film.max(others))
            .then(|| "a limit on textures in memory (--texture-limit 1GiB) keeps the rest in a file".to_owned());
        self.error_help(None, what, help);
        false
    }

    /// The image a node names in its parameter `file`; a failure is reported.
    pub(super) fn image(&mut self, node: &Node) -> Option<Arc<Texels>> {
        match node.path("file").and_then(|p| self.assets.images.get(p)).cloned() {
            Some(image) => self.reported(node, image),
            None => {
                let span = node.param("file").and_then(|p| p.span).or(node.span);
                self.error(span, format!("{} '{}' needs a file", node.family.noun(), node.kind));
                None
            }
        }
    }

    /// Image that was read, after its faults are reported.
    fn reported<T>(&mut self, node: &Node, image: Result<Loaded<T>, String>) -> Option<T> {
        let span = node.param("file").and_then(|p| p.span).or(node.span);
        match image {
            Ok(Loaded { texels, faults, notes }) => {
                for note in notes {
                    self.diagnostics.warn(&self.desc.sources, span, note);
                }
                if faults > 0 {
                    let what = format!("{faults} values of this image are infinite or NaN; they count as black");
                    self.diagnostics.warn(&self.desc.sources, span, what);
                }
                Some(texels)
            }
            Err(e) => {
                self.error(span, e);
                None
            }
        }
    }

    /// The image of a texture, in memory or, where textures are limited, in pages.
    pub(super) fn texture_level(&mut self, node: &Node) -> Option<Level> {
        let file = node.path("file").unwrap_or(Path::new(""));
        if let Some(level) = self.assets.paged.get(file).cloned() {
            return self.reported(node, level);
        }
        let texels = self.image(node)?;
        Level::new(texels, None).ok()
    }

    /// Compiles a texture used in a role.
    pub(super) fn texture(&mut self, id: NodeId, role: Role) -> SpectrumTexture {
        self.texture_parts(id, role);
        self.known_texture(id, role)
    }

    /// Compiles a texture and all that it is made of, parts first: depth is the file's, so it is followed with a stack
    /// of our own.
    fn texture_parts(&mut self, root: NodeId, role: Role) {
        let mut stack = vec![(root, role, false)];
        while let Some((id, role, parts_are_done)) = stack.pop() {
            let node = self.node(id);
            if parts_are_done {
                if node.kind != "constant" {
                    let grey = Texture::Constant(Color::constant(0.5));
                    let t = self.new_texture(node, role).unwrap_or(grey);
                    let t = self.add_texture(node, t);
                    self.texture_ids.insert(id, t);
                }
                self.open.remove(&id);
                continue;
            }
            if node.family != Family::Texture || self.texture_ids.contains_key(&id) {
                continue;
            }
            if !self.open.insert(id) {
                // It is being compiled: by the caller, or further up, in which case it contains itself.
                if id != root || stack.iter().any(|s| s.2) {
                    self.error(node.span, "this texture contains itself");
                }
                continue;
            }
            stack.push((id, role, true));
            for p in &node.params {
                let part_role =
                    if matches!(p.name.as_str(), "amount" | "scale" | "input") { Role::Unbounded } else { role };
                if let Value::Node(part) = &p.value {
                    stack.push((*part, part_role, false));
                }
            }
        }
    }

    /// A texture whose parts are compiled; grey for one that is refused.
    fn known_texture(&mut self, mut id: NodeId, role: Role) -> SpectrumTexture {
        let grey = SpectrumTexture::Constant(Color::constant(0.5));
        // Constants depend on their role; other textures learn it when they are evaluated.
        for _ in 0..=self.desc.nodes.len() {
            let node = self.node(id);
            if node.family != Family::Texture {
                self.error(node.span, format!("a texture is needed here, but this is a {}", node.family.noun()));
                return grey;
            }
            match node.get("value") {
                _ if node.kind != "constant" => {
                    return self.texture_ids.get(&id).map_or(grey, |t| SpectrumTexture::Texture(*t, role));
                }
                Some(Value::Node(inner)) => id = *inner,
                _ => return self.spectrum(node, "value", role),
            }
        }
        grey
    }

    /// Adds a texture; one that takes too long to evaluate is an error.
    pub(super) fn add_texture(&mut self, node: &Node, texture: Texture) -> texture::TextureId {
        let id = self.textures.add(texture);
        if self.textures.effort(id).lookups > texture::MAX_LOOKUPS {
            let what = "to evaluate this takes more than";
            self.error(node.span, format!("{what} {} textures, counting shared ones each time", texture::MAX_LOOKUPS));
        }
        id
    }

    fn new_texture(&mut self, node: &Node, role: Role) -> Option<Texture> {
        if let Some(t) = self.procedural(node, role) {
            return Some(t);
        }
        match node.kind.as_str() {
            "image" => {
                let base = self.texture_level(node)?;
                let image = self.image_texture(node, &base);
                Some(self.image_or_opaque(node, &base, image))
            }
            "distance_field" => self.distance_field(node),
            "time" => Some(Texture::Time),
            "expression" => self.formula_texture(node),
            "mesh_attribute" => Some(Texture::MeshAttribute {
                name: self.given_word(node, "name").unwrap_or_default().into(),
                domain: self.choice_or(
                    node,
                    "domain",
                    None,
                    &[("vertex", Some(Domain::Vertex)), ("face", Some(Domain::Face))],
                ),
                scale: self.float(node, "scale"),
            }),
            "grid" => self.grid(node).map(|g| Texture::Grid(Arc::new(g))),
            "scale" | "add" | "mix" | "bilerp" | "triplanar" | "ramp" | "curve" | "channel" | "color_space" | "hsv" => {
                self.combined(node, role)
            }
            _ if self.options.registry.own_texture(&node.kind).is_some() => self.own_texture(node),
            other => {
                self.approximated(node.span, format!("texture '{other}' is not implemented; a constant stands in"));
                Some(Texture::Constant(Color::constant(0.5)))
            }
        }
    }

    /// A texture by one formula, or by three of a colour.
    fn formula_texture(&mut self, node: &Node) -> Option<Texture> {
        let colors = ["red", "green", "blue"];
        let has_colors = colors.iter().any(|name| node.get(name).is_some());
        if has_colors && node.get("expression").is_some() {
            self.error(node.span, "an expression has either one 'expression' or 'red', 'green' and 'blue'");
            return None;
        }
        let components = match has_colors {
            false => Components::Number(self.formula(node, "expression", &formula::VARIABLES)?),
            true => {
                let [r, g, b] = colors.map(|name| self.formula(node, name, &formula::VARIABLES));
                Components::Rgb(Box::new([r?, g?, b?]))
            }
        };
        Some(Texture::Formula(Arc::new(FormulaTexture { mapping: self.mapping(node), components })))
    }

    /// The texture of an image; where its alpha is asked for and it has none, the constant 1, as glTF rules it.
    /// Elsewhere a picture with alpha was probably meant, which is said.
    pub(super) fn image_or_opaque(&mut self, node: &Node, base: &Level, image: ImageTexture) -> Texture {
        if node.string("channel") != Some("a") || base.alpha().is_some() {
            return Texture::Image(Arc::new(image));
        }
        if self.desc.format != Format::Gltf {
            let span = node.param("channel").and_then(|p| p.span).or(node.span);
            let what = "this image has no alpha channel: its alpha is 1 everywhere";
            self.diagnostics.warn(&self.desc.sources, span, what);
        }
        Texture::Constant(Color::constant(image.finish(1.0)))
    }

    /// The voxel grid that a node names, read once. Values that are not finite count as zero.
    pub(super) fn voxel_grid(&mut self, node: &Node) -> Option<Arc<steradian_image::VoxelGrid>> {
        let span = node.param("file").and_then(|p| p.span).or(node.span);
        let Some(path) = node.path("file") else {
            self.error(span, format!("{} '{}' needs a file", node.family.noun(), node.kind));
            return None;
        };
        if let Some(grid) = self.assets.grids.get(path) {
            return Some(grid.clone());
        }
        let source = Source::of(self.desc, path);
        let mut grid = steradian_image::read_voxel_grid(path, &self.options.image_limits)
            .map_err(|e| self.error(span, e.to_string()))
            .ok()?;
        let faults = grid.data.iter_mut().filter(|v| !v.is_finite()).map(|v| *v = 0.0).count();
        if faults > 0 {
            let what = format!("{faults} values of this grid are infinite or NaN; they count as zero");
            self.diagnostics.warn(&self.desc.sources, span, what);
        }
        let grid = Arc::new(grid);
        // One with something to say about it is read anew each time.
        if faults == 0 {
            self.assets.sources.insert(path.to_path_buf(), source);
        }
        self.assets.grids.insert(path.to_path_buf(), grid.clone());
        Some(grid)
    }

    /// Numbers on a grid of space.
    pub(super) fn grid(&mut self, node: &Node) -> Option<GridTexture> {
        let span = node.param("file").and_then(|p| p.span).or(node.span);
        let grid = self.voxel_grid(node)?;
        let interpolations = [
            ("nearest", Interpolation::Nearest),
            ("trilinear", Interpolation::Trilinear),
            ("tetrahedral", Interpolation::Tetrahedral),
        ];
        let wraps =
            [("repeat", Wrap::Repeat), ("mirror", Wrap::Mirror), ("clamp", Wrap::Clamp), ("black", Wrap::Border)];
        let mut mapping = Mapping { local: self.texture_space(node), ..Mapping::default() };
        if self.bool(node, "use_grid_bounds") {
            let [min, max] = grid.bounds.map(|c| DVec3::from(c.map(f64::from)));
            let to_unit = Transform::scale((max - min).recip()) * Transform::translate(-min);
            match (to_unit * self.transform(node, "texture_from_world")).affine() {
                Some(local) => mapping.local = local,
                None => {
                    self.error(span, "the box that this grid gives is empty or not finite");
                    return None;
                }
            }
        }
        Some(GridTexture {
            grid,
            interpolation: self.choice(node, "filter", &interpolations),
            wrap: self.choice(node, "wrap", &wraps),
            mapping,
            scale: self.float(node, "scale"),
        })
    }

    /// An image with the lookup parameters of a node.
    pub(super) fn image_texture(&mut self, node: &Node, base: &Level) -> ImageTexture {
        let raw = self.bool(node, "raw");
        let encoding = match node.get("encoding") {
            None => base.encoding(),
            Some(Value::String(s)) => match s.as_str() {
                "auto" => base.encoding(),
                "srgb" => Encoding::Srgb,
                "linear" => Encoding::Linear,
                other => {
                    self.error(
                        node.span,
                        format!("'{other}' is not an encoding; known are auto, srgb, linear, or a gamma"),
                    );
                    base.encoding()
                }
            },
            Some(_) => Encoding::Gamma(self.positive_or(node, "encoding", 2.2)),
        };
        let encoding = if raw { Encoding::Linear } else { encoding };
        let filter = match self.choice(node, "filter", &FILTERS) {
            Filter::Ewa(_) => Filter::Ewa(self.float(node, "max_anisotropy").clamp(1.0, 64.0)),
            other => other,
        };
        let (wrap, borders) = self.wraps(node, base.channels());
        let filter = if wrap[0] == Wrap::Octahedral && filter == Filter::Box {
            self.approximated(node.span, "filter 'box' has no sums across octahedral edges; 'trilinear' stands in");
            Filter::Trilinear
        } else {
            filter
        };
        let size = (base.width(), base.height());
        let filter = if filter == Filter::Sinc && (wrap != [Wrap::Repeat; 2] || size.0 * size.1 > MOST_OF_SINC) {
            let what = format!(
                "filter 'sinc' is for pictures that repeat, of up to {MOST_OF_SINC} texels; 'spline' stands in"
            );
            self.approximated(node.span, what);
            Filter::Spline
        } else {
            filter
        };
        let recipe = Recipe {
            shape: match filter {
                Filter::Trilinear | Filter::Ewa(_) => Shape::Mip,
                Filter::Ripmap => Shape::Rip,
                _ => Shape::Flat,
            },
            kernel: self.choice(node, "mip_filter", &MIP_KERNELS),
            wrap,
            keep_coverage: node.get("keep_coverage").map(|_| self.float_or(node, "keep_coverage", 0.5)),
            bleed: self.bool(node, "bleed"),
        };
        let channels = base.channels();
        let channel = match self.choice(node, "channel", &CHANNELS) {
            // Grey pictures have their grey in any colour.
            Some(c @ 0..3) => Some(if channels < 3 { 0 } else { c }),
            Some(_) => base.alpha(),
            None => None,
        };
        let levels = self.levels(node, base.with_encoding(encoding), &recipe);
        ImageTexture {
            sums: (filter == Filter::Box).then(|| Arc::new(SummedArea::new(levels.base()))),
            levels,
            filter,
            stochastic: self.bool(node, "stochastic") || self.options.stochastic_textures,
            wrap,
            borders,
            channel,
            origin_bottom: self.choice(node, "origin", &[("bottom", true), ("top", false)]),
            scale: self.float(node, "scale"),
            invert: self.bool(node, "invert"),
            mapping: self.mapping(node),
        }
    }

    /// Wrap modes beyond the sides and beyond top and bottom of a picture.
    fn wraps(&mut self, node: &Node, channels: usize) -> ([Wrap; 2], Borders) {
        let border = self.vec3(node, "border");
        let border = match channels {
            1 => [border.element_sum() / 3.0, 0.0, 0.0, 0.0],
            2 => [border.element_sum() / 3.0, 1.0, 0.0, 0.0],
            _ => border.extend(1.0).to_array(),
        };
        let known = [
            ("repeat", (Wrap::Repeat, [0.0; 4])),
            ("mirror", (Wrap::Mirror, [0.0; 4])),
            ("clamp", (Wrap::Clamp, [0.0; 4])),
            ("octahedral", (Wrap::Octahedral, [0.0; 4])),
            ("border", (Wrap::Border, border)),
            ("black", (Wrap::Border, [0.0; 4])),
            ("one", (Wrap::Border, [1.0; 4])),
        ];
        let [(u, beyond_u), (v, beyond_v)] = ["wrap_u", "wrap_v"].map(|name| self.choice(node, name, &known));
        if (u == Wrap::Octahedral) != (v == Wrap::Octahedral) {
            self.error(node.span, "an octahedral map has wrap 'octahedral' on both axes");
        }
        ([u, v], [beyond_u, beyond_v])
    }

    /// The sizes of a picture, made once for all textures that need the same.
    fn levels(&mut self, node: &Node, base: Level, recipe: &Recipe) -> Arc<Levels> {
        // Images of lights, which were changed after they were read, are looked at point by point.
        if recipe.shape == Shape::Flat && !recipe.bleed || node.family != Family::Texture {
            return Arc::new(Levels::flat(base));
        }
        let file = node.path("file").map(Path::to_path_buf).unwrap_or_default();
        let known = self.assets.levels.iter().find(|l| l.0 == file && l.1 == base.encoding() && l.2 == *recipe);
        if let Some((.., levels)) = known {
            return levels.clone();
        }
        let encoding = base.encoding();
        match Levels::new(base.clone(), recipe, self.assets.pages.as_ref()) {
            Ok(levels) => {
                let levels = Arc::new(levels);
                self.assets.levels.push((file, encoding, *recipe, levels.clone()));
                levels
            }
            Err(e) => {
                self.error(node.span, format!("cannot keep the levels of this image: {e}"));
                Arc::new(Levels::flat(base))
            }
        }
    }
}

/// Loads pictures, as many at once as take about so many bytes while they are decoded. The largest files come first,
/// and show how much the others may take.
fn load_within(
    bytes: usize,
    files: BTreeSet<&Path>,
    load: impl Fn(&Path) -> Image<Level> + Sync,
) -> HashMap<PathBuf, Image<Level>> {
    let size = |p: &Path| std::fs::metadata(p).map_or(0, |m| m.len());
    let mut files: Vec<&Path> = files.into_iter().collect();
    files.sort_by_key(|p| Reverse(size(p)));
    let mut loaded = HashMap::new();
    let (mut rest, mut at_once) = (&files[..], 1);
    while !rest.is_empty() {
        let (now, later) = rest.split_at(at_once.min(rest.len()));
        let levels: Vec<_> = now.par_iter().map(|p| load(p)).collect();
        let taken =
            |(p, level): (&&Path, &Image<Level>)| size(p) as usize + level.as_ref().map_or(0, |l| l.texels.byte_size());
        let most = now.iter().zip(&levels).map(taken).max().unwrap_or(0);
        at_once = (bytes / most.max(1)).clamp(1, rayon::current_num_threads());
        loaded.extend(now.iter().map(|p| p.to_path_buf()).zip(levels));
        rest = later;
    }
    loaded
}

/// Infinite and NaN values become black; gives how many there were.
fn blacken_non_finite(texels: &mut Texels) -> usize {
    let mut faults = 0;
    match &mut texels.data {
        TexelData::F32(data) => data.iter_mut().filter(|v| !v.is_finite()).for_each(|v| {
            *v = 0.0;
            faults += 1;
        }),
        TexelData::F16(data) => data.iter_mut().filter(|v| !v.is_finite()).for_each(|v| {
            *v = Default::default();
            faults += 1;
        }),
        TexelData::U8(_) | TexelData::U16(_) => {}
    }
    faults
}
