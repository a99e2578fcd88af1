//! Reads directives and carries them out.

use super::{
    camera,
    dict::Dict,
    film,
    lexer::{Fault, Kind, Lexer, Token},
    light, param, sampling,
    scene::Scene,
    state::{self, Active, MaterialRef, NameRef, State, TARGETS, Target},
    texture::Values,
};
use crate::{Options, files, files::SearchPath};
use std::{
    collections::HashMap,
    path::{Path, PathBuf},
    sync::Arc,
};
use steradian_math::DVec3;
use steradian_scene::{Span, Transform, names};

/// Directives that must come before `WorldBegin`.
const BEFORE_WORLD: [&str; 8] =
    ["Accelerator", "Camera", "Film", "Integrator", "PixelFilter", "Sampler", "TransformTimes", "WorldBegin"];

/// Directives that must come after `WorldBegin`.
const IN_WORLD: [&str; 17] = [
    "AreaLightSource",
    "AttributeBegin",
    "AttributeEnd",
    "Import",
    "LightSource",
    "MakeNamedMaterial",
    "Material",
    "NamedMaterial",
    "ObjectBegin",
    "ObjectEnd",
    "ObjectInstance",
    "ReverseOrientation",
    "Shape",
    "Texture",
    "TransformBegin",
    "TransformEnd",
    "WorldEnd",
];

/// Directives that may stand anywhere.
const ANYWHERE: [&str; 16] = [
    "ActiveTransform",
    "Attribute",
    "ColorSpace",
    "ConcatTransform",
    "CoordinateSystem",
    "CoordSysTransform",
    "Identity",
    "Include",
    "LookAt",
    "MakeNamedMedium",
    "MediumInterface",
    "Option",
    "Rotate",
    "Scale",
    "Transform",
    "Translate",
];

/// Parameters that one target of `Attribute` may collect.
const MAX_ATTRIBUTES: usize = 1000;

/// An open block.
struct Block {
    is_object: bool,
    span: Span,
    saved: State,
}

/// A file being read.
struct Frame {
    lexer: Lexer,
    path: PathBuf,
    /// For imports: what holds again when the file ends.
    import: Option<Import>,
}

/// What an import must not touch.
struct Import {
    saved: State,
    blocks: usize,
}

/// A directive that sets something for the whole picture.
#[derive(Default)]
struct Globals {
    camera: Option<(Dict, State)>,
    film: Option<Dict>,
    filter: Option<Dict>,
    sampler: Option<Dict>,
    integrator: Option<Dict>,
    accelerator: Option<Dict>,
    seed: Option<i64>,
}

/// Carries out the directives of a scene.
pub(super) struct Reader<'o> {
    pub scene: Scene<'o>,
    state: State,
    blocks: Vec<Block>,
    frames: Vec<Frame>,
    globals: Globals,
    coordinate_systems: HashMap<String, [Transform; 2]>,
    /// The object being defined, and how many imports were open when it began.
    object: Option<(usize, usize)>,
    in_world: bool,
    includes: usize,
}

/// A fault that ends a directive; already reported.
struct Given;

type Done = Result<(), Given>;

impl<'o> Reader<'o> {
    pub fn new(options: &'o Options, search: SearchPath) -> Self {
        Self {
            scene: Scene::new(options, search),
            state: State::default(),
            blocks: Vec::new(),
            frames: Vec::new(),
            globals: Globals::default(),
            coordinate_systems: HashMap::new(),
            object: None,
            in_world: false,
            includes: 0,
        }
    }

    /// Reads a scene from its text and all files that it includes.
    pub fn read(&mut self, path: &Path, text: Vec<u8>) {
        self.open(path.into(), text, None);
        while let Some(frame) = self.frames.last_mut() {
            if self.scene.report.is_full() {
                return;
            }
            match frame.lexer.next() {
                Err(fault) => self.fault(fault),
                Ok(t) if t.kind == Kind::End => self.close(),
                Ok(t) => {
                    if self.directive(t).is_err() {
                        self.resynchronise();
                    }
                }
            }
        }
        self.finish();
    }

    fn finish(&mut self) {
        if let Some(block) = self.blocks.last() {
            let what = if block.is_object { "object" } else { "attribute block" };
            self.scene
                .report
                .error(block.span, format!("this {what} is not closed (and {} more)", self.blocks.len() - 1));
        }
        if !self.in_world {
            self.scene.report.error_nowhere("the scene has no WorldBegin");
        }
        self.scene.finish();
        let Globals { camera, film, filter, sampler, integrator, accelerator, seed } =
            std::mem::take(&mut self.globals);
        let scene = &mut self.scene;
        // What the file leaves out is pbrt's default.
        let anywhere = Span::new(steradian_scene::FileId(0), 0, 0);
        let or = |dict: Option<Dict>, kind: &str| dict.unwrap_or_else(|| Dict::absent(kind, anywhere));
        let (dict, state) = camera.unwrap_or_else(|| (Dict::absent("perspective", anywhere), State::default()));
        let camera = camera::translate(scene, &dict, state.transform(), state.exterior.as_ref());
        scene.settle_media();
        let shutter = |name| camera.and_then(|id| scene.desc.node(id).float(name));
        let exposure = shutter("shutter_close").unwrap_or(1.0) - shutter("shutter_open").unwrap_or(0.0);
        scene.desc.cameras.extend(camera);
        scene.desc.film = film::film(scene, &or(film, "rgb"), exposure);
        scene.desc.filter = film::filter(scene, &or(filter, "gaussian"));
        scene.desc.sampler = sampling::sampler(scene, &or(sampler, "zsobol"), seed);
        scene.desc.integrator = sampling::integrator(scene, &or(integrator, "volpath"));
        if let Some(dict) = accelerator {
            sampling::accelerator(scene, &dict);
        }
    }

    // --- files ---

    fn open(&mut self, path: PathBuf, text: Vec<u8>, import: Option<Import>) {
        let text: Arc<[u8]> = text.into();
        let file = self.scene.report.sources.add(path.clone(), text.clone());
        if text.starts_with(&[0xff, 0xfe]) || text.starts_with(&[0xfe, 0xff]) {
            let span = Span::new(file, 0, 2);
            self.scene.report.error(span, "the file is UTF-16; scenes are read as UTF-8");
            return;
        }
        self.frames.push(Frame { lexer: Lexer::new(file, text), path, import });
    }

    /// Leaves a file that is read to its end.
    fn close(&mut self) {
        let Some(Frame { import: Some(import), .. }) = self.frames.pop() else { return };
        if self.blocks.len() > import.blocks
            && let Some(open) = self.blocks.last()
        {
            self.scene.report.error(open.span, "this block is not closed in the imported file");
            self.blocks.truncate(import.blocks);
        }
        self.state = import.saved;
    }

    /// `Include` and `Import`.
    fn include(&mut self, is_import: bool) -> Done {
        let (name, span) = self.quoted()?;
        let limits = &self.scene.options.limits;
        if self.frames.len() > limits.include_depth {
            let message = format!("files are included more than {} deep", limits.include_depth);
            return self.refuse(span, message);
        }
        self.includes += 1;
        if self.includes > limits.includes {
            return self.refuse(span, format!("more than {} files are included", limits.includes));
        }
        let path = match self.scene.search.find(&name) {
            Ok(path) => path,
            Err(fault) => return self.refuse(span, fault.to_string()),
        };
        let real = |p: &Path| p.canonicalize().unwrap_or_else(|_| p.into());
        let target = real(&path);
        if self.frames.iter().any(|f| real(&f.path) == target) {
            return self.refuse(span, format!("'{name}' includes itself"));
        }
        match files::read(&path, limits) {
            Ok(text) => {
                let import = is_import.then(|| Import { saved: self.state.clone(), blocks: self.blocks.len() });
                // Files that an included file names are looked for beside it too.
                if let Some(folder) = path.parent()
                    && !self.scene.search.folders.iter().any(|f| f == folder)
                {
                    self.scene.search.folders.push(folder.into());
                }
                self.open(path, text, import);
                Ok(())
            }
            Err(fault) => self.refuse(span, fault.to_string()),
        }
    }

    // --- arguments ---

    /// The file being read. There is always one while a directive is carried out.
    fn lexer(&mut self) -> &mut Lexer {
        let last = self.frames.len() - 1;
        &mut self.frames[last].lexer
    }

    fn fault(&mut self, fault: Fault) {
        let span = self.lexer().span(fault.range);
        self.scene.report.error(span, fault.message);
    }

    fn refuse<T>(&mut self, span: Span, message: impl Into<String>) -> Result<T, Given> {
        self.scene.report.error(span, message);
        Err(Given)
    }

    /// Reports a fault of the lexer.
    fn or_fault<T>(&mut self, result: Result<T, Fault>) -> Result<T, Given> {
        result.map_err(|fault| {
            self.fault(fault);
            Given
        })
    }

    fn token(&mut self) -> Result<Token, Given> {
        let token = self.lexer().next();
        self.or_fault(token)
    }

    fn peek(&mut self) -> Result<Token, Given> {
        let token = self.lexer().peek();
        self.or_fault(token)
    }

    /// A quoted string.
    fn quoted(&mut self) -> Result<(String, Span), Given> {
        let token = self.token()?;
        let lexer = self.lexer();
        let span = lexer.token_span(token);
        match token.kind {
            Kind::Quoted => {
                let text = lexer.unquote(token).map(std::borrow::Cow::into_owned);
                Ok((self.or_fault(text)?, span))
            }
            Kind::End => self.refuse(span, "the file ends where a quoted string is expected"),
            _ => {
                let found = lexer.excerpt(token);
                if lexer.starts_statement(token) {
                    lexer.back(token);
                }
                self.refuse(span, format!("expected a quoted string, found '{found}'"))
            }
        }
    }

    fn numbers<const N: usize>(&mut self) -> Result<[f64; N], Given> {
        let mut values = [0.0; N];
        for v in &mut values {
            let number = self.lexer().next_number();
            *v = self.or_fault(number)?;
        }
        Ok(values)
    }

    /// Sixteen numbers in brackets.
    fn matrix(&mut self, directive: Span) -> Result<Transform, Given> {
        let open = self.peek()?;
        if open.kind != Kind::Open {
            return self.refuse(directive, "expected sixteen numbers in brackets");
        }
        let list = self.lexer().numbers();
        let list = self.or_fault(list)?;
        match <[f64; 16]>::try_from(list) {
            Ok(m) => Ok(Transform::from_columns(m)),
            Err(list) => self.refuse(directive, format!("expected sixteen numbers, found {}", list.len())),
        }
    }

    /// The name of a model and parameters.
    fn dict(&mut self, target: Option<Target>) -> Result<Dict, Given> {
        let (kind, span) = self.quoted()?;
        let inherited = target.map(|t| self.state.inherited(t)).unwrap_or_default();
        let space = self.state.space;
        let last = self.frames.len() - 1;
        let params = param::read(&mut self.frames[last].lexer, space, &mut self.scene.report);
        Ok(Dict::new(kind, span, params, inherited, space))
    }

    fn name_ref(&mut self) -> Result<NameRef, Given> {
        let (name, span) = self.quoted()?;
        Ok(NameRef { name: name.into(), span })
    }

    /// Moves to the next directive after a fault.
    fn resynchronise(&mut self) {
        while let Some(frame) = self.frames.last_mut() {
            match frame.lexer.next() {
                Ok(t) if t.kind == Kind::End || frame.lexer.starts_statement(t) => return frame.lexer.back(t),
                _ => {}
            }
        }
    }

    // --- directives ---

    fn directive(&mut self, token: Token) -> Done {
        let lexer = self.lexer();
        let span = lexer.token_span(token);
        let word = if token.kind == Kind::Word { String::from_utf8_lossy(lexer.bytes(token)) } else { "".into() };
        let word = word.into_owned();
        self.check_place(&word, span);
        match word.as_str() {
            "Shape" => self.shape(),
            "AttributeBegin" | "TransformBegin" => self.begin(span, false),
            "AttributeEnd" | "TransformEnd" => {
                self.end(&word, span, false);
                Ok(())
            }
            "Material" => {
                let dict = self.dict(Some(Target::Material))?;
                self.state.material = MaterialRef::Index(self.scene.add_material(dict));
                Ok(())
            }
            "NamedMaterial" => {
                self.state.material = MaterialRef::Named(self.name_ref()?);
                Ok(())
            }
            "MakeNamedMaterial" => {
                let dict = self.dict(Some(Target::Material))?;
                let (name, span) = (dict.kind.clone(), dict.span);
                self.scene.add_named_material(name, dict, span);
                Ok(())
            }
            "Texture" => self.texture(),
            "LightSource" => {
                let dict = self.dict(Some(Target::Light))?;
                self.warn_if_animated(dict.span);
                let (ctm, medium) = (self.state.transform(), self.state.exterior.as_ref());
                self.scene.add_light(&dict, ctm, medium);
                Ok(())
            }
            "AreaLightSource" => {
                let dict = self.dict(Some(Target::Light))?;
                self.state.area_light = light::area(&mut self.scene, &dict);
                Ok(())
            }
            "MakeNamedMedium" => {
                let dict = self.dict(Some(Target::Medium))?;
                self.warn_if_animated(dict.span);
                let (name, span) = (dict.kind.clone(), dict.span);
                self.scene.add_medium(&name, &dict, self.state.transform(), span);
                Ok(())
            }
            "MediumInterface" => self.medium_interface(),
            "ReverseOrientation" => {
                self.state.reverse_orientation ^= true;
                Ok(())
            }
            "ObjectBegin" => self.object_begin(span),
            "ObjectEnd" => {
                self.object_end(span);
                Ok(())
            }
            "ObjectInstance" => self.object_instance(span),
            "Identity" => {
                self.state.change(|_| Transform::IDENTITY);
                Ok(())
            }
            "Translate" => {
                let v = self.numbers::<3>()?;
                self.state.concat(Transform::translate(v.into()));
                Ok(())
            }
            "Scale" => {
                let v = self.numbers::<3>()?;
                self.state.concat(Transform::scale(v.into()));
                Ok(())
            }
            "Rotate" => {
                let [angle, x, y, z] = self.numbers::<4>()?;
                let axis = DVec3::new(x, y, z);
                if axis.try_normalize().is_none() {
                    return self.refuse(span, "the axis of the rotation has no length");
                }
                self.state.concat(Transform::rotate(axis, angle.to_radians()));
                Ok(())
            }
            "LookAt" => {
                let [ex, ey, ez, lx, ly, lz, ux, uy, uz] = self.numbers::<9>()?;
                let (eye, look, up) = (DVec3::new(ex, ey, ez), DVec3::new(lx, ly, lz), DVec3::new(ux, uy, uz));
                let camera = Transform::look_at(eye, look, up).and_then(|t| t.inverse());
                let Some(camera_from_world) = camera else {
                    return self
                        .refuse(span, "LookAt needs two different points and an up vector that is not along the view");
                };
                self.state.concat(camera_from_world);
                Ok(())
            }
            "Transform" => {
                let m = self.matrix(span)?;
                self.state.change(|_| m);
                Ok(())
            }
            "ConcatTransform" => {
                let m = self.matrix(span)?;
                self.state.concat(m);
                Ok(())
            }
            "CoordinateSystem" => {
                let (name, _) = self.quoted()?;
                self.coordinate_systems.insert(name, self.state.ctm);
                Ok(())
            }
            "CoordSysTransform" => {
                let (name, span) = self.quoted()?;
                match self.coordinate_systems.get(&name) {
                    Some(&ctm) => self.state.ctm = ctm,
                    None => {
                        let help = names::did_you_mean(&name, self.coordinate_systems.keys().map(String::as_str));
                        let message = format!("there is no coordinate system '{name}'");
                        self.scene.report.error_help(span, message, help);
                    }
                }
                Ok(())
            }
            "ActiveTransform" => self.active_transform(),
            "TransformTimes" => self.numbers::<2>().map(|_| ()),
            "Attribute" => self.attribute(),
            "ColorSpace" => {
                let (name, span) = self.quoted()?;
                match state::color_space(&name) {
                    Some(space) => self.state.space = space,
                    None => {
                        let help = names::did_you_mean(&name, state::COLOR_SPACES.iter().map(|c| c.0));
                        self.scene.report.error_help(span, format!("unknown colour space '{name}'"), help);
                    }
                }
                Ok(())
            }
            "Option" => self.option(),
            "Include" => self.include(false),
            "Import" => self.include(true),
            "WorldBegin" => {
                self.in_world = true;
                self.state.ctm = [Transform::IDENTITY; 2];
                self.state.active = Active::All;
                self.coordinate_systems.insert("world".into(), self.state.ctm);
                Ok(())
            }
            "WorldEnd" => {
                self.scene.report.note(span, "WorldEnd is of pbrt-v3 and has no effect");
                Ok(())
            }
            "Camera" => {
                let dict = self.dict(None)?;
                self.warn_if_animated(dict.span);
                if let Some(inverse) = self.state.ctm[0].inverse() {
                    let end = self.state.ctm[1].inverse().unwrap_or(inverse);
                    self.coordinate_systems.insert("camera".into(), [inverse, end]);
                }
                self.warn_if_replaced("Camera", self.globals.camera.is_some(), span);
                self.globals.camera = Some((dict, self.state.clone()));
                Ok(())
            }
            "Film" | "PixelFilter" | "Sampler" | "Integrator" | "Accelerator" => {
                let dict = self.dict(None)?;
                let g = &mut self.globals;
                let slot = match word.as_str() {
                    "Film" => &mut g.film,
                    "PixelFilter" => &mut g.filter,
                    "Sampler" => &mut g.sampler,
                    "Integrator" => &mut g.integrator,
                    _ => &mut g.accelerator,
                };
                let replaced = slot.replace(dict).is_some();
                self.warn_if_replaced(&word, replaced, span);
                Ok(())
            }
            _ => {
                let found = self.lexer().excerpt(token);
                let known = BEFORE_WORLD.iter().chain(&IN_WORLD).chain(&ANYWHERE).copied();
                let (message, help) = match token.kind {
                    Kind::Word if found.starts_with(|c: char| c.is_ascii_alphabetic()) => {
                        (format!("unknown directive '{found}'"), names::did_you_mean(&found, known))
                    }
                    _ => (format!("expected a directive, found '{found}'"), None),
                };
                self.scene.report.error_help(span, message, help);
                Err(Given)
            }
        }
    }

    /// Reports directives on the wrong side of `WorldBegin`, each kind once, and lets them be carried out all the same.
    fn check_place(&mut self, word: &str, span: Span) {
        if self.in_world && BEFORE_WORLD.contains(&word) {
            if self.scene.report.first_time(word) {
                self.scene.report.error(span, format!("{word} must come before WorldBegin"));
            }
        } else if !self.in_world && IN_WORLD.contains(&word) && self.scene.report.first_time(word) {
            self.scene.report.error(span, format!("{word} must come after WorldBegin"));
        }
    }

    fn warn_if_replaced(&mut self, word: &str, replaced: bool, span: Span) {
        if replaced {
            self.scene.report.warn(span, format!("{word} is given twice; the last one counts"));
        }
    }

    fn warn_if_animated(&mut self, span: Span) {
        if self.state.is_animated() {
            self.scene.report.approximated(span, "moving things are rendered as they stand at the start");
        }
    }

    fn shape(&mut self) -> Done {
        let dict = self.dict(Some(Target::Shape))?;
        self.warn_if_animated(dict.span);
        self.scene.add_shape(&dict, &self.state, self.object.map(|(index, _)| index));
        Ok(())
    }

    fn texture(&mut self) -> Done {
        let (name, span) = self.quoted()?;
        let (ty, ty_span) = self.quoted()?;
        let dict = self.dict(Some(Target::Texture))?;
        self.warn_if_animated(dict.span);
        let values = match ty.as_str() {
            "float" => Values::Float,
            // The word of pbrt-v3.
            "spectrum" | "color" => Values::Spectrum,
            _ => {
                let help = names::did_you_mean(&ty, ["float", "spectrum"]);
                self.scene.report.error_help(ty_span, format!("unknown texture type '{ty}'"), help);
                return Ok(());
            }
        };
        self.scene.add_texture(name, values, dict, self.state.transform(), span);
        Ok(())
    }

    fn medium_interface(&mut self) -> Done {
        let interior = self.name_ref()?;
        let exterior = match self.peek()?.kind {
            Kind::Quoted => self.name_ref()?,
            _ => interior.clone(),
        };
        let named = |m: NameRef| (!m.name.is_empty()).then_some(m);
        self.state.interior = named(interior);
        self.state.exterior = named(exterior);
        Ok(())
    }

    fn active_transform(&mut self) -> Done {
        let token = self.token()?;
        let lexer = self.lexer();
        self.state.active = match lexer.bytes(token) {
            b"All" => Active::All,
            b"StartTime" => Active::Start,
            b"EndTime" => Active::End,
            _ => {
                let (span, found) = (lexer.token_span(token), lexer.excerpt(token));
                return self.refuse(span, format!("expected All, StartTime or EndTime, found '{found}'"));
            }
        };
        Ok(())
    }

    fn attribute(&mut self) -> Done {
        let dict = self.dict(None)?;
        let Some(target) = TARGETS.iter().position(|t| *t == dict.kind) else {
            let help = names::did_you_mean(&dict.kind, TARGETS);
            let message = format!("unknown target '{}'; known are {}", dict.kind, TARGETS.join(", "));
            self.scene.report.error_help(dict.span, message, help);
            return Ok(());
        };
        let span = dict.span;
        let list = Arc::make_mut(&mut self.state.attributes[target]);
        list.extend(dict.into_params().map(Arc::new));
        if list.len() > MAX_ATTRIBUTES {
            list.truncate(MAX_ATTRIBUTES);
            self.scene.report.error(span, format!("more than {MAX_ATTRIBUTES} attributes for one target"));
        }
        Ok(())
    }

    fn option(&mut self) -> Done {
        let (name, span) = self.quoted()?;
        let token = self.token()?;
        let lexer = self.lexer();
        let value_span = lexer.token_span(token);
        let value = String::from_utf8_lossy(lexer.bytes(token)).trim_matches('"').to_string();
        // pbrt reads the names of options without regard to case, dashes and underscores.
        let plain: String = name.chars().filter(|c| !"-_".contains(*c)).flat_map(char::to_lowercase).collect();
        let report = &mut self.scene.report;
        let is_bool = matches!(
            plain.as_str(),
            "disablepixeljitter"
                | "disabletexturefiltering"
                | "disablewavelengthjitter"
                | "forcediffuse"
                | "pixelstats"
                | "wavefront"
        );
        match plain.as_str() {
            "seed" => match value.parse() {
                Ok(seed) => self.globals.seed = Some(seed),
                Err(_) => report.error(value_span, format!("expected an integer, found '{value}'")),
            },
            _ if is_bool && value != "true" && value != "false" => {
                report.error(value_span, format!("expected true or false, found '{value}'"));
            }
            "disablepixeljitter" | "disabletexturefiltering" | "disablewavelengthjitter" | "forcediffuse" => {
                if value == "true" {
                    report.approximated(span, format!("option '{name}' has no effect"));
                }
            }
            // These do not change the picture.
            "pixelstats"
            | "wavefront"
            | "rendercoordsys"
            | "msereferenceimage"
            | "msereferenceout"
            | "displacementedgescale" => {}
            _ => {
                const KNOWN: [&str; 11] = [
                    "disablepixeljitter",
                    "disabletexturefiltering",
                    "disablewavelengthjitter",
                    "displacementedgescale",
                    "forcediffuse",
                    "msereferenceimage",
                    "msereferenceout",
                    "pixelstats",
                    "rendercoordsys",
                    "seed",
                    "wavefront",
                ];
                let help = names::did_you_mean(&plain, KNOWN);
                report.error_help(span, format!("unknown option '{name}'"), help);
            }
        }
        Ok(())
    }

    // --- blocks ---

    fn begin(&mut self, span: Span, is_object: bool) -> Done {
        let limit = self.scene.options.limits.nesting;
        if self.blocks.len() >= limit {
            if self.scene.report.first_time("nesting") {
                self.scene.report.error(span, format!("blocks are nested more than {limit} deep"));
            }
            // Nothing sensible can follow.
            self.frames.clear();
            return Ok(());
        }
        self.blocks.push(Block { is_object, span, saved: self.state.clone() });
        Ok(())
    }

    /// Closes the innermost block. Returns whether it was of the right kind.
    fn end(&mut self, word: &str, span: Span, is_object: bool) -> bool {
        let floor = self.frames.iter().rev().find_map(|f| f.import.as_ref()).map_or(0, |i| i.blocks);
        match self.blocks.last() {
            Some(block) if self.blocks.len() > floor && block.is_object == is_object => {
                if let Some(block) = self.blocks.pop() {
                    self.state = block.saved;
                }
                true
            }
            Some(block) if self.blocks.len() > floor => {
                let open = if block.is_object { "ObjectBegin" } else { "AttributeBegin" };
                self.scene
                    .report
                    .error(span, format!("{word} closes nothing: the innermost block was opened by {open}"));
                false
            }
            _ => {
                self.scene.report.error(span, format!("{word} closes nothing: no block is open"));
                false
            }
        }
    }

    fn object_begin(&mut self, span: Span) -> Done {
        let (name, name_span) = self.quoted()?;
        if self.object.is_some() {
            return self.refuse(span, "an object cannot be defined inside another");
        }
        self.begin(span, true)?;
        // A second definition is read over: its shapes belong nowhere.
        let imports = self.frames.iter().filter(|f| f.import.is_some()).count();
        let index = match self.scene.add_object(name, name_span) {
            Some(index) => index,
            None => self.scene.add_hidden_object(),
        };
        self.object = Some((index, imports));
        Ok(())
    }

    fn object_end(&mut self, span: Span) {
        let imports = self.frames.iter().filter(|f| f.import.is_some()).count();
        match self.object {
            None => self.scene.report.error(span, "ObjectEnd closes nothing: no object is being defined"),
            Some((_, at)) if at != imports => {
                self.scene.report.error(span, "an object must be closed in the file that opened it");
            }
            Some(_) => {
                if self.end("ObjectEnd", span, true) {
                    self.object = None;
                }
            }
        }
    }

    fn object_instance(&mut self, span: Span) -> Done {
        let name = self.name_ref()?;
        if self.object.is_some() {
            return self.refuse(span, "an object cannot contain an instance");
        }
        self.warn_if_animated(span);
        let transform = self.state.transform();
        self.scene.add_instance(name, transform);
        Ok(())
    }
}
