//! Composition: the layers of a stage, and what they say together about a prim.
//!
//! A prim is indexed as a tree of sites, each a path in a stack of layers: the root's own, and below each site those
//! that its arcs lead to, by strength: inherits, variants, references, payloads, specializes (LIVERPS without
//! relocates); arcs of the prim itself before those of its ancestors. In depth-first order the tree gives opinions from
//! strong to weak, those of specializes last. Left out: classes of the referencing stage that an inherit inside of a
//! referenced file implies, relocates, and value clips.

use super::{
    archive,
    layer::{Fault, Layer, MOST_NESTED, Spec, Specifier, absolute, is_below, join, plain, property},
    mtlx,
    value::{Item, ListOp, Retime, Value, is_continuous},
};
use crate::{
    Import, Options,
    files::{self, SearchPath},
    limits::{MOST_OF_TEXT, unpacked},
};
use std::{
    collections::HashMap,
    ops::Range,
    path::{Path, PathBuf},
    rc::Rc,
    sync::Arc,
};
use steradian_scene::Span;

/// Most sites of a prim.
const MOST_SITES: usize = 1000;
/// Most layers that are nested by sublayers.
const MOST_SUBLAYERS: usize = 32;

/// Strength of arcs, strongest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Strength {
    Root,
    Inherit,
    Variant,
    Reference,
    Payload,
    Specialize,
}

/// A file, or a member of an archive.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Place {
    pub file: PathBuf,
    pub member: Option<String>,
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match &self.member {
            Some(member) => write!(f, "{}[{member}]", self.file.display()),
            None => write!(f, "{}", self.file.display()),
        }
    }
}

struct Archive {
    bytes: Arc<[u8]>,
    members: archive::Members,
}

/// A layer and where it is from.
struct Loaded {
    layer: Layer,
    place: Place,
}

/// Layers in order of strength, with the change of their times.
struct Stack {
    layers: Vec<(usize, Retime)>,
}

/// From the namespace of a site to that of the site that leads to it.
#[derive(Clone, Debug)]
struct Map {
    from: String,
    to: String,
    /// True if paths beside `from` stay what they are.
    others: bool,
}

#[derive(Clone, Debug)]
struct Site {
    stack: usize,
    path: String,
    parent: Option<usize>,
    arc: Strength,
    /// Depth in the namespace at which the arc is: that of the prim, or of an ancestor.
    depth: usize,
    map: Option<Map>,
    retime: Retime,
    has_arcs: bool,
    below: Vec<usize>,
}

/// A composed prim.
#[derive(Debug)]
pub(super) struct Prim {
    /// Path on the stage.
    pub path: String,
    sites: Vec<Site>,
    /// Indices of the sites with opinions, from strong to weak.
    order: Vec<usize>,
    depth: usize,
}

impl Prim {
    /// Identity of what the prim is made of: prims with the same one say the same, but for their place and children.
    pub fn key(&self) -> String {
        let parts = self.order.iter().filter_map(|k| self.sites.get(*k));
        parts.map(|s| format!("{}:{}:{}:{};", s.stack, s.path, s.retime.offset, s.retime.scale)).collect()
    }

    /// The last part of its path.
    pub fn name(&self) -> &str {
        self.path.rsplit('/').next().unwrap_or_default()
    }
}

/// A stage on its way into a description.
pub(super) struct Stage<'a> {
    pub import: Import,
    pub options: &'a Options,
    layers: Vec<Loaded>,
    stacks: Vec<Stack>,
    /// Stacks by the file of their strongest layer; `None` where it cannot be read.
    by_place: HashMap<Place, Option<usize>>,
    loaded: HashMap<Place, Option<usize>>,
    archives: HashMap<PathBuf, Option<Rc<Archive>>>,
    /// Bytes of files of the stage's own that are in memory.
    given: HashMap<Place, Arc<[u8]>>,
    /// Prims that were looked up by path.
    found: HashMap<String, Option<Rc<Prim>>>,
    /// The time code that values are of.
    pub time: f64,
    /// Number of attributes with several samples, and the first and last time code of these.
    pub moving: (usize, [f64; 2]),
}

impl<'a> Stage<'a> {
    /// Opens a stage; `None`, with errors, where its root cannot be read.
    pub fn open(path: &Path, bytes: Vec<u8>, options: &'a Options) -> (Self, bool) {
        let mut stage = Self {
            import: Import::default(),
            options,
            layers: Vec::new(),
            stacks: Vec::new(),
            by_place: HashMap::new(),
            loaded: HashMap::new(),
            archives: HashMap::new(),
            given: HashMap::new(),
            found: HashMap::new(),
            time: 0.0,
            moving: (0, [f64::INFINITY, f64::NEG_INFINITY]),
        };
        let mut place = Place { file: path.into(), member: None };
        let bytes: Arc<[u8]> = bytes.into();
        if bytes.starts_with(archive::MAGIC) {
            match archive::members(&bytes) {
                Ok(members) => {
                    place.member = Some(members.first.clone());
                    stage.archives.insert(path.into(), Some(Rc::new(Archive { bytes, members })));
                }
                Err(why) => {
                    stage.error(None, format!("cannot read '{}': {why}", path.display()));
                    return (stage, false);
                }
            }
        } else {
            stage.given.insert(place.clone(), bytes);
        }
        let is_read = stage.stack(&place) == Some(0);
        (stage, is_read)
    }

    pub fn error(&mut self, span: Option<Span>, message: impl Into<String>) {
        self.import.diagnostics.error(&self.import.desc.sources, span, message);
    }

    pub fn dropped(&mut self, span: Option<Span>, message: impl Into<String>) {
        self.import.diagnostics.dropped(&self.import.desc.sources, span, message);
    }

    pub fn approximated(&mut self, span: Option<Span>, message: impl Into<String>) {
        self.import.diagnostics.approximated(&self.import.desc.sources, span, message);
    }

    pub fn note(&mut self, span: Option<Span>, message: impl Into<String>) {
        self.import.diagnostics.note(&self.import.desc.sources, span, message);
    }

    // Layers.

    /// The bytes of a file or member.
    fn bytes(&mut self, place: &Place) -> Result<Arc<[u8]>, String> {
        if let Some(bytes) = self.given.get(place) {
            return Ok(bytes.clone());
        }
        match &place.member {
            None => files::read(&place.file, &self.options.limits).map(Into::into).map_err(|e| e.to_string()),
            Some(member) => {
                let archive = self.archive(&place.file).ok_or_else(|| format!("cannot read '{place}'"))?;
                let range = archive.members.ranges.get(member).cloned();
                let bytes = range.and_then(|range: Range<usize>| archive.bytes.get(range));
                bytes.map(Into::into).ok_or_else(|| format!("'{}' has no member '{member}'", place.file.display()))
            }
        }
    }

    fn archive(&mut self, file: &Path) -> Option<Rc<Archive>> {
        if let Some(known) = self.archives.get(file) {
            return known.clone();
        }
        let read = files::read(file, &self.options.limits).map_err(|e| e.to_string());
        let made = read.and_then(|bytes| {
            let bytes: Arc<[u8]> = bytes.into();
            archive::members(&bytes).map(|members| Rc::new(Archive { bytes, members }))
        });
        let made = made.map_err(|why| self.error(None, format!("cannot read '{}': {why}", file.display()))).ok();
        self.archives.insert(file.into(), made.clone());
        made
    }

    /// The place that a name in a layer means.
    fn resolve(&mut self, layer: usize, name: &str) -> Result<Place, String> {
        let from = self.layers.get(layer).map(|l| l.place.clone()).ok_or("the layer is missing")?;
        // A member of an archive by name.
        if let Some((file, member)) = name.strip_suffix(']').and_then(|n| n.split_once('[')) {
            let outer = self.resolve(layer, file)?;
            return Ok(Place { file: outer.file, member: Some(member.into()) });
        }
        if let Some(member) = &from.member
            && let Some(archive) = self.archive(&from.file)
        {
            let inside = archive::beside(member, name).filter(|name| archive.members.ranges.contains_key(name));
            return match inside {
                Some(name) => Ok(Place { file: from.file, member: Some(name) }),
                None => Err(format!("the archive '{}' has no member '{name}'", from.file.display())),
            };
        }
        let search = SearchPath::new(from.file.parent(), self.options);
        Ok(Place { file: search.find(name).map_err(|e| e.to_string())?, member: None })
    }

    /// The file of an asset that an attribute of a prim names, as nodes name it.
    pub fn asset(&mut self, prim: &Prim, attribute: &str) -> Option<Result<PathBuf, String>> {
        let (layer, _, _) = self.opinion(prim, attribute, |spec| spec.fields.contains_key("default"))?;
        let name = self.value(prim, attribute)?.text()?.to_owned();
        if name.is_empty() {
            return None;
        }
        Some(self.resolve(layer, &name).and_then(|place| match &place.member {
            None => Ok(place.file.clone()),
            Some(member) => {
                let path = PathBuf::from(format!("{}#/{member}", place.file.display()));
                if !self.import.desc.embedded.contains_key(&path) {
                    let bytes = self.bytes(&place)?;
                    self.import.desc.embedded.insert(path.clone(), bytes);
                }
                Ok(path)
            }
        }))
    }

    /// Reads a layer, once.
    fn layer(&mut self, place: &Place) -> Option<usize> {
        if let Some(known) = self.loaded.get(place) {
            return *known;
        }
        self.loaded.insert(place.clone(), None);
        if self.layers.len() >= self.options.limits.includes {
            self.error(None, format!("the scene is of more than {} layers", self.options.limits.includes));
            return None;
        }
        let mut bytes = self.bytes(place).map_err(|why| self.error(None, why)).ok()?;
        let mut place = place.clone();
        if bytes.starts_with(archive::MAGIC) && place.member.is_none() {
            // An archive that is named as a whole is its first member.
            let first = self.archive(&place.file)?.members.first.clone();
            place.member = Some(first);
            bytes = self.bytes(&place).map_err(|why| self.error(None, why)).ok()?;
        }
        let memory = unpacked(bytes.len(), MOST_OF_TEXT);
        let read = Layer::read(&bytes, memory);
        let is_text =
            bytes.starts_with(b"#usda") || mtlx::looks_like(&bytes) || read.is_err() && !bytes.starts_with(b"PXR-USDC");
        let text = if is_text { bytes } else { Arc::default() };
        let source = self.import.desc.sources.add(place.to_string(), text);
        match read {
            Ok(mut layer) => {
                layer.source = is_text.then_some(source);
                if layer.head().is_some_and(|head| head.fields.contains_key("relocates")) {
                    self.dropped(None, format!("'{place}': relocates are not followed"));
                }
                if !layer.unknown_types.is_empty() {
                    let kinds: Vec<_> = layer.unknown_types.iter().map(u8::to_string).collect();
                    self.dropped(None, format!("'{place}': values of types {} are left out", kinds.join(", ")));
                }
                self.layers.push(Loaded { layer, place: place.clone() });
                let number = self.layers.len() - 1;
                self.loaded.insert(place, Some(number));
                Some(number)
            }
            Err(Fault { at: Some(at), message }) => {
                self.error(Some(Span::new(source, at, at + 1)), message);
                None
            }
            Err(Fault { message, .. }) => {
                self.error(None, format!("cannot read '{place}': {message}"));
                None
            }
        }
    }

    /// The stack of a layer and its sublayers.
    fn stack(&mut self, place: &Place) -> Option<usize> {
        if let Some(known) = self.by_place.get(place) {
            return *known;
        }
        self.by_place.insert(place.clone(), None);
        let root = self.layer(place)?;
        let mut layers = Vec::new();
        self.add_layers(root, Retime::default(), &mut Vec::new(), &mut layers);
        self.stacks.push(Stack { layers });
        let number = self.stacks.len() - 1;
        self.by_place.insert(place.clone(), Some(number));
        Some(number)
    }

    fn add_layers(&mut self, layer: usize, retime: Retime, open: &mut Vec<usize>, out: &mut Vec<(usize, Retime)>) {
        if out.iter().any(|known| known.0 == layer) {
            return;
        }
        if open.len() >= MOST_SUBLAYERS {
            return self.error(None, format!("sublayers are nested deeper than {MOST_SUBLAYERS}"));
        }
        out.push((layer, retime));
        open.push(layer);
        for item in self.sublayers(layer) {
            match self.resolve(layer, &item.asset) {
                Ok(place) => {
                    if let Some(sublayer) = self.layer(&place) {
                        self.add_layers(sublayer, retime.after(item.retime), open, out);
                    }
                }
                Err(why) => self.dropped(None, format!("{why}: this sublayer is left out")),
            }
        }
        open.pop();
    }

    fn sublayers(&self, layer: usize) -> Vec<Item> {
        let head = self.layers.get(layer).and_then(|l| l.layer.head());
        match head.and_then(|head| head.fields.get("subLayers")) {
            Some(Value::List(list)) => list.explicit.clone().unwrap_or_default(),
            _ => Vec::new(),
        }
    }

    /// True for a stage whose root layer is a MaterialX document.
    pub fn is_materialx(&self) -> bool {
        self.layers.first().is_some_and(|l| l.layer.specs.contains_key(mtlx::ROOT))
    }

    /// A field of the stage: of its root layer.
    pub fn head(&self, field: &str) -> Option<Value> {
        self.layers.first()?.layer.head()?.fields.get(field).cloned()
    }

    // Prims.

    /// The pseudo-root, whose children are the prims of the stage.
    pub fn root(&self) -> Prim {
        let site = Site {
            stack: 0,
            path: "/".into(),
            parent: None,
            arc: Strength::Root,
            depth: 0,
            map: None,
            retime: Retime::default(),
            has_arcs: true,
            below: Vec::new(),
        };
        Prim { path: "/".into(), sites: vec![site], order: vec![0], depth: 0 }
    }

    /// Opinions of a site's layers, strongest first.
    fn specs<'s>(
        &'s self,
        site: &Site,
        property_name: Option<&str>,
    ) -> impl Iterator<Item = (usize, Retime, &'s Spec)> + use<'s, 'a> {
        let layers = self.stacks.get(site.stack).map(|s| s.layers.as_slice()).unwrap_or_default();
        let path = property_name.map_or_else(|| site.path.clone(), |name| property(&site.path, name));
        let outer = site.retime;
        layers.iter().filter_map(move |&(layer, retime)| {
            let spec = self.layers.get(layer)?.layer.specs.get(&path)?;
            Some((layer, outer.after(retime), spec))
        })
    }

    fn has_specs(&self, site: &Site) -> bool {
        self.specs(site, None).next().is_some()
    }

    /// The child of a prim.
    pub fn child(&mut self, parent: &Prim, name: &str) -> Prim {
        let depth = parent.depth + 1;
        let path = join(&parent.path, name);
        let sites =
            parent.sites.iter().map(|site| Site { path: join(&site.path, name), has_arcs: false, ..site.clone() });
        let mut prim = Prim { path, sites: sites.collect(), order: Vec::new(), depth };
        self.prune(&mut prim);
        loop {
            while let Some(next) = prim.sites.iter().position(|site| !site.has_arcs) {
                if let Some(site) = prim.sites.get_mut(next) {
                    site.has_arcs = true;
                }
                self.add_arcs(&mut prim, next);
            }
            self.sort(&mut prim);
            if !self.add_variant(&mut prim) {
                break;
            }
        }
        prim
    }

    /// Removes sites that say nothing, and lead to none that does.
    fn prune(&self, prim: &mut Prim) {
        let mut kept: Vec<bool> = prim.sites.iter().map(|site| site.parent.is_none() || self.has_specs(site)).collect();
        // Sites come after those that lead to them.
        for k in (0..prim.sites.len()).rev() {
            if let Some(parent) = prim.sites.get(k).and_then(|s| s.parent)
                && kept.get(k) == Some(&true)
                && let Some(flag) = kept.get_mut(parent)
            {
                *flag = true;
            }
        }
        let mut number = 0;
        let numbers: Vec<Option<usize>> = kept
            .iter()
            .map(|kept| {
                number += usize::from(*kept);
                kept.then(|| number - 1)
            })
            .collect();
        let renumber = |k: usize| numbers.get(k).copied().flatten();
        let sites = std::mem::take(&mut prim.sites);
        prim.sites = sites
            .into_iter()
            .zip(&kept)
            .filter(|(_, kept)| **kept)
            .map(|(site, _)| Site {
                parent: site.parent.and_then(renumber),
                below: site.below.iter().filter_map(|k| renumber(*k)).collect(),
                ..site
            })
            .collect();
    }

    /// Fills the order of strength.
    fn sort(&self, prim: &mut Prim) {
        let keys: Vec<_> = prim.sites.iter().map(|s| (s.arc, std::cmp::Reverse(s.depth))).collect();
        for site in &mut prim.sites {
            site.below.sort_by_key(|k| keys.get(*k).copied());
        }
        let (mut order, mut late) = (Vec::new(), Vec::new());
        let mut open = vec![(0, false)];
        while let Some((k, is_late)) = open.pop() {
            let Some(site) = prim.sites.get(k) else { continue };
            let is_late = is_late || site.arc == Strength::Specialize;
            if self.has_specs(site) {
                if is_late { late.push(k) } else { order.push(k) }
            }
            open.extend(site.below.iter().rev().map(|below| (*below, is_late)));
        }
        order.extend(late);
        prim.order = order;
    }

    /// The items of a list of a site's layers, with the layer that each is from.
    fn list(&self, site: &Site, field: &str) -> Vec<(usize, Retime, Item)> {
        let mut opinions: Vec<(usize, Retime, Arc<ListOp>)> = Vec::new();
        for (layer, retime, spec) in self.specs(site, None) {
            if let Some(Value::List(list)) = spec.fields.get(field) {
                opinions.push((layer, retime, list.clone()));
            }
        }
        let mut items: Vec<Item> = Vec::new();
        for (_, _, list) in opinions.iter().rev() {
            list.edit(&mut items);
        }
        let says = |list: &ListOp, item: &Item| {
            let lists = [list.explicit.as_deref().unwrap_or_default(), &list.prepended, &list.appended];
            lists.iter().any(|l| l.contains(item))
        };
        let of = |item: &Item| {
            opinions.iter().find(|(_, _, list)| says(list, item)).map_or((0, Retime::default()), |o| (o.0, o.1))
        };
        items
            .into_iter()
            .map(|item| {
                let (layer, retime) = of(&item);
                (layer, retime, item)
            })
            .collect()
    }

    fn span_of(&self, site: &Site) -> Option<Span> {
        let (layer, _, spec) = self.specs(site, None).next()?;
        self.layers.get(layer)?.layer.span(spec)
    }

    fn add_arcs(&mut self, prim: &mut Prim, number: usize) {
        let Some(site) = prim.sites.get(number).cloned() else { return };
        let kinds = [
            ("inherits", Strength::Inherit),
            ("references", Strength::Reference),
            ("payload", Strength::Payload),
            ("specializes", Strength::Specialize),
        ];
        for (field, arc) in kinds {
            for (layer, retime, item) in self.list(&site, field) {
                let target = absolute(&item.path, &site.path);
                let is_inner = matches!(arc, Strength::Inherit | Strength::Specialize);
                let (stack, retime) = if is_inner {
                    (Some(site.stack), site.retime)
                } else if item.asset.is_empty() {
                    (Some(site.stack), retime.after(item.retime))
                } else {
                    (self.referenced(&site, layer, &item), retime.after(item.retime))
                };
                let Some(stack) = stack else { continue };
                let target = if target.is_empty() {
                    match self.default_prim(stack) {
                        Some(name) => join("/", &name),
                        None => {
                            let what =
                                format!("{}: '{}' has no default prim, so nothing is there", prim.path, item.asset);
                            self.dropped(self.span_of(&site), what);
                            continue;
                        }
                    }
                } else {
                    target
                };
                let map =
                    Map { from: plain(&target), to: plain(&site.path), others: is_inner || item.asset.is_empty() };
                let new = Site {
                    stack,
                    path: target,
                    parent: Some(number),
                    arc,
                    depth: prim.depth,
                    map: Some(map),
                    retime,
                    has_arcs: false,
                    below: Vec::new(),
                };
                self.add_site(prim, new);
            }
        }
    }

    fn referenced(&mut self, site: &Site, layer: usize, item: &Item) -> Option<usize> {
        match self.resolve(layer, &item.asset) {
            Ok(place) => self.stack(&place),
            Err(why) => {
                self.dropped(self.span_of(site), format!("{}: {why}: this reference is left out", plain(&site.path)));
                None
            }
        }
    }

    fn default_prim(&self, stack: usize) -> Option<String> {
        let (layer, _) = self.stacks.get(stack)?.layers.first()?;
        let name = self.layers.get(*layer)?.layer.head()?.text("defaultPrim")?;
        Some(name.trim_start_matches('/').to_owned()).filter(|name| !name.is_empty())
    }

    fn add_site(&mut self, prim: &mut Prim, site: Site) {
        let mut above = site.parent;
        while let Some(k) = above {
            let Some(known) = prim.sites.get(k) else { break };
            let is_circle = known.stack == site.stack
                && site.arc != Strength::Variant
                && (is_below(&plain(&known.path), &plain(&site.path))
                    || is_below(&plain(&site.path), &plain(&known.path)));
            if is_circle {
                let what = format!("{}: its references lead in a circle, by {}", prim.path, site.path);
                return self.error(self.span_of(known), what);
            }
            above = known.parent;
        }
        if prim.sites.len() >= MOST_SITES {
            if prim.sites.len() == MOST_SITES {
                self.error(None, format!("{}: it is composed of more than {MOST_SITES} places", prim.path));
            }
            return;
        }
        let number = prim.sites.len();
        if let Some(parent) = site.parent.and_then(|k| prim.sites.get_mut(k)) {
            parent.below.push(number);
        }
        prim.sites.push(site);
    }

    /// Adds the chosen variant of the first set that has none yet; false where all have.
    fn add_variant(&mut self, prim: &mut Prim) -> bool {
        for &number in &prim.order {
            let Some(site) = prim.sites.get(number) else { continue };
            for (_, _, item) in self.list(site, "variantSets") {
                let Some(variant) = self.selection(prim, &item.path) else { continue };
                let path = format!("{}{{{}={variant}}}", site.path, item.path);
                let is_there = |k: &usize| prim.sites.get(*k).is_some_and(|below| below.path == path);
                let new = Site {
                    path: path.clone(),
                    parent: Some(number),
                    arc: Strength::Variant,
                    depth: prim.depth,
                    map: None,
                    has_arcs: false,
                    below: Vec::new(),
                    ..site.clone()
                };
                if site.below.iter().any(is_there) || !self.has_specs(&new) {
                    continue;
                }
                let before = prim.sites.len();
                self.add_site(prim, new);
                return prim.sites.len() > before;
            }
        }
        false
    }

    /// The variant of a set that the strongest opinion selects.
    fn selection(&self, prim: &Prim, set: &str) -> Option<String> {
        let sites = prim.order.iter().filter_map(|k| prim.sites.get(*k));
        let mut specs = sites.flat_map(|site| self.specs(site, None));
        let chosen = specs.find_map(|(_, _, spec)| match spec.fields.get("variants")? {
            Value::Dictionary(choices) => choices.get(set)?.text().map(str::to_owned),
            _ => None,
        });
        chosen.filter(|variant| !variant.is_empty())
    }

    /// The prim of a path.
    pub fn prim(&mut self, path: &str) -> Option<Rc<Prim>> {
        if let Some(known) = self.found.get(path) {
            return known.clone();
        }
        let mut prim = Rc::new(self.root());
        for name in path.strip_prefix('/')?.split('/').take(MOST_NESTED) {
            let below = join(&prim.path, name);
            prim = match self.found.get(&below) {
                Some(known) => known.clone()?,
                None => {
                    let child = self.child(&prim, name);
                    let child = (!child.order.is_empty()).then(|| Rc::new(child));
                    self.found.insert(below, child.clone());
                    child?
                }
            };
        }
        Some(prim)
    }

    // Values.

    /// All opinions about a prim, or about a property, strongest first.
    fn opinions(&self, prim: &Prim, name: Option<&str>) -> std::vec::IntoIter<(usize, Retime, &Spec)> {
        let sites = prim.order.iter().filter_map(|k| prim.sites.get(*k));
        sites.flat_map(|site| self.specs(site, name)).collect::<Vec<_>>().into_iter()
    }

    fn opinion(&self, prim: &Prim, name: &str, holds: impl Fn(&Spec) -> bool) -> Option<(usize, Retime, &Spec)> {
        self.opinions(prim, Some(name)).find(|opinion| holds(opinion.2))
    }

    /// Names of the children, without those that are not defined.
    pub fn children(&self, prim: &Prim) -> Vec<String> {
        let opinions: Vec<_> = self.opinions(prim, None).collect();
        let (mut names, mut known) = (Vec::new(), std::collections::HashSet::new());
        // Weaker layers come first in the order of children.
        for (_, _, spec) in opinions.iter().rev() {
            names.extend(spec.children.iter().filter(|name| known.insert(name.as_str())).cloned());
        }
        names
    }

    /// Names of the properties.
    pub fn properties(&self, prim: &Prim) -> Vec<String> {
        let mut names: Vec<String> = self.opinions(prim, None).flat_map(|o| o.2.properties.iter().cloned()).collect();
        names.sort_unstable();
        names.dedup();
        names
    }

    /// Metadata of a prim.
    pub fn field(&self, prim: &Prim, field: &str) -> Option<&Value> {
        self.opinions(prim, None).find_map(|(_, _, spec)| spec.fields.get(field))
    }

    /// Metadata of a property.
    pub fn property_field(&self, prim: &Prim, name: &str, field: &str) -> Option<&Value> {
        self.opinions(prim, Some(name)).find_map(|(_, _, spec)| spec.fields.get(field))
    }

    /// The prim's type, such as `Mesh`.
    pub fn type_name(&self, prim: &Prim) -> String {
        self.field(prim, "typeName").and_then(Value::text).unwrap_or_default().to_owned()
    }

    /// Names of a list that all layers edit, such as the schemas that are applied.
    pub fn names(&self, prim: &Prim, field: &str) -> Vec<String> {
        let lists: Vec<_> = self
            .opinions(prim, None)
            .filter_map(|(_, _, spec)| match spec.fields.get(field)? {
                Value::List(list) => Some(list.clone()),
                _ => None,
            })
            .collect();
        let mut items = Vec::new();
        lists.iter().rev().for_each(|list| list.edit(&mut items));
        items.into_iter().map(|item| item.path).collect()
    }

    /// Specifier of a prim: that of the strongest opinion which is not `over`.
    pub fn specifier(&self, prim: &Prim) -> Specifier {
        let mut all = self.opinions(prim, None).map(|(_, _, spec)| spec.specifier);
        all.find(|s| *s != Specifier::Over).unwrap_or_default()
    }

    /// Source span of a prim, or of a property.
    pub fn span(&self, prim: &Prim, name: Option<&str>) -> Option<Span> {
        let (layer, _, spec) = self.opinions(prim, name).next()?;
        self.layers.get(layer)?.layer.span(spec)
    }

    /// True if an attribute moves along a spline.
    pub fn has_spline(&self, prim: &Prim, name: &str) -> bool {
        self.property_field(prim, name, "spline").is_some()
    }

    /// The value of an attribute at the time of the stage.
    pub fn value(&mut self, prim: &Prim, name: &str) -> Option<Value> {
        self.value_at(prim, name, self.time)
    }

    fn value_at(&mut self, prim: &Prim, name: &str, time: f64) -> Option<Value> {
        let has_value = |spec: &Spec| spec.fields.contains_key("samples") || spec.fields.contains_key("default");
        let (_, retime, spec) = self.opinion(prim, name, has_value)?;
        let value = match spec.fields.get("samples") {
            Some(Value::Samples(samples)) if !samples.is_empty() => {
                let is_smooth = is_continuous(spec.text("typeName").unwrap_or_default());
                let samples = samples.clone();
                if let ([first, .., last], true) = (&*samples, samples.len() > 1) {
                    let outer = |t: f64| retime.offset + retime.scale * t;
                    let (number, [low, high]) = &mut self.moving;
                    *number += 1;
                    (*low, *high) = (low.min(outer(first.0)), high.max(outer(last.0)));
                }
                sampled(&samples, retime.inward(time), is_smooth)
            }
            _ => spec.fields.get("default").cloned(),
        };
        value.filter(|value| *value != Value::Block)
    }

    /// Absolute paths that a relationship leads to, or that an attribute is connected to.
    pub fn targets(&self, prim: &Prim, name: &str, field: &str) -> Vec<String> {
        let mut lists = Vec::new();
        for site in prim.order.iter().filter_map(|k| prim.sites.get(*k)) {
            for (_, _, spec) in self.specs(site, Some(name)) {
                if let Some(Value::List(list)) = spec.fields.get(field) {
                    let is_whole = list.explicit.is_some();
                    lists.push((site, list.clone()));
                    if is_whole {
                        break;
                    }
                }
            }
        }
        let mut items: Vec<Item> = Vec::new();
        for (site, list) in lists.iter().rev() {
            let mapped = |items: &[Item]| -> Vec<Item> {
                let path = |item: &Item| self.outward(prim, site, &absolute(&item.path, &site.path));
                items.iter().filter_map(|item| Some(Item { path: path(item)?, ..Item::default() })).collect()
            };
            let list = ListOp {
                explicit: list.explicit.as_deref().map(mapped),
                prepended: mapped(&list.prepended),
                appended: mapped(&list.appended),
                deleted: mapped(&list.deleted),
            };
            list.edit(&mut items);
        }
        items.into_iter().map(|item| item.path).collect()
    }

    /// A path in the namespace of a site as one on the stage.
    fn outward(&self, prim: &Prim, site: &Site, path: &str) -> Option<String> {
        let mut path = plain(path);
        let mut site = Some(site);
        while let Some(current) = site {
            if let Some(map) = &current.map {
                path = match path.strip_prefix(&map.from).filter(|_| is_below(&path, &map.from)) {
                    Some(rest) => format!("{}{rest}", map.to),
                    None if map.others => path,
                    None => return None,
                };
            }
            site = current.parent.and_then(|k| prim.sites.get(k));
        }
        Some(path)
    }
}

/// The value of samples at a time: that of the nearest beyond their ends.
fn sampled(samples: &[(f64, Value)], time: f64, is_smooth: bool) -> Option<Value> {
    let next = samples.partition_point(|s| s.0 <= time);
    let before = next.checked_sub(1).and_then(|k| samples.get(k));
    match (before, samples.get(next)) {
        (Some((t0, a)), Some((t1, b))) if is_smooth && t1 > t0 => Some(a.between(b, (time - t0) / (t1 - t0))),
        (Some((_, a)), _) => Some(a.clone()),
        (None, first) => first.map(|first| first.1.clone()),
    }
}
