//! Opening a model (OBJ, PLY, STL, Bézier patches) as a scene: its shapes and materials as they are, seen by a camera
//! that frames them, under a sky.

mod background;
mod finish;
mod material;
mod sky;
mod smooth;
pub(crate) mod stage;
mod studio;
mod upright;

use super::{MeshError, Place, bpt, mtl, obj, ply, stl, text};
use crate::{
    Import, Options,
    files::{self, SearchPath},
};
pub use stage::leave_out_ground;
use std::{
    collections::{HashMap, HashSet},
    path::Path,
};
use steradian_scene::{Attribute, Domain, Family, FileId, Format, Mesh, Node, NodeId, Shape, Span};

/// Opens an OBJ, PLY, STL or BPT file. What is needed to see it is added: a camera, a studio, and a ground, unless
/// [`Options::defines`] has `ground=false`. Meshes without normals get those of
/// smooth surfaces. Up is y, or z where the model clearly lies on its side otherwise ([`Options::defines`] `up`), and a
/// note says so. A file that starts as PLY is PLY, whatever it is called.
///
/// Each object, group and material of an OBJ file becomes a shape; the material libraries it names are looked for
/// beside it and in [`Options::search`]. Libraries and textures that cannot be found are reported, and something plain
/// stands in. Anything malformed in the model itself is an error.
pub fn import(path: &Path, options: &Options) -> Import {
    match files::read(path, &options.limits) {
        Ok(bytes) => import_bytes(path, bytes, options),
        Err(e) => {
            let mut import = Import::default();
            import.desc.format = Format::Model;
            import.diagnostics.error(&import.desc.sources, None, e.to_string());
            import
        }
    }
}

/// Reads a model in memory. `path` stands for the file, in messages and for the files that it names.
pub fn import_bytes(path: &Path, bytes: Vec<u8>, options: &Options) -> Import {
    let mut import = Import::default();
    import.desc.format = Format::Model;
    import.desc.path = Some(path.into());
    let search = SearchPath::new(path.parent(), options);
    let mut opener = Opener {
        import,
        path,
        options,
        search,
        materials: HashMap::new(),
        size: 1.0,
        crease: smooth::CREASE,
        losses: 0,
        undefined: HashSet::new(),
        knows_up: false,
    };
    if let Some(text) = options.defines.get("crease") {
        match text.parse().ok().filter(|v: &f32| (0.0..=180.0).contains(v)) {
            Some(angle) => opener.crease = angle,
            None => {
                let what = format!("'crease' is an angle in degrees from 0 to 180, not '{text}'");
                opener.import.diagnostics.error(&opener.import.desc.sources, None, what);
            }
        }
    }
    let is_named = |name: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(name));
    if bytes.starts_with(b"ply") || is_named("ply") {
        opener.ply(&bytes);
    } else if is_named("stl") || (!is_named("obj") && stl::looks_like(&bytes)) {
        opener.stl(&bytes);
    } else if is_named("bpt") || (!is_named("obj") && bytes.trim_ascii_start().first().is_some_and(u8::is_ascii_digit))
    {
        opener.bpt(&bytes);
    } else {
        opener.obj(text::to_utf8(bytes));
    }
    opener.finish()
}

/// A material, and the light its surfaces give off.
#[derive(Clone, Copy, Default)]
struct Look {
    material: Option<NodeId>,
    emission: Option<NodeId>,
}

struct Opener<'a> {
    import: Import,
    path: &'a Path,
    options: &'a Options,
    search: SearchPath,
    /// By name.
    materials: HashMap<String, mtl::Material>,
    /// Length of the diagonal of the bounding box.
    size: f64,
    /// Least angle in degrees of an edge that is seen, where there are no normals.
    crease: f32,
    /// Losses that were reported.
    losses: usize,
    /// Materials that no library defines.
    undefined: HashSet<String>,
    /// True if the format says which axis is up.
    knows_up: bool,
}

/// Losses that are shown with their place; further ones are only counted, for to find a line takes reading up to it.
const MOST_SHOWN: usize = 100;

impl Opener<'_> {
    fn approximated(&mut self, span: Option<Span>, message: impl Into<String>) {
        self.losses += 1;
        if self.losses <= MOST_SHOWN {
            self.import.diagnostics.approximated(&self.import.desc.sources, span, message);
        }
    }

    fn dropped(&mut self, span: Option<Span>, message: impl Into<String>) {
        self.losses += 1;
        if self.losses <= MOST_SHOWN {
            self.import.diagnostics.dropped(&self.import.desc.sources, span, message);
        }
    }

    /// Reports a fault with the line it is on; binary data has no lines to show.
    fn fault(&mut self, error: &MeshError, bytes: &[u8]) {
        let Import { desc, diagnostics } = &mut self.import;
        match error.place {
            Place::Line(_) => {
                let file = desc.sources.add(self.path, bytes);
                let end = bytes[error.offset..].iter().position(|&b| matches!(b, b'\n' | b'\r'));
                let end = error.offset + end.unwrap_or(bytes.len() - error.offset);
                diagnostics.error(&desc.sources, Some(Span::new(file, error.offset, end)), &error.message);
            }
            Place::Byte(_) => {
                desc.sources.add(self.path, Vec::new());
                diagnostics.error(&desc.sources, None, format!("cannot read '{}': {error}", self.path.display()));
            }
        }
    }

    fn ply(&mut self, bytes: &[u8]) {
        let options = ply::PlyOptions { corner_uvs: true, recentre: true, ..ply::PlyOptions::default() };
        let file = match ply::read(bytes, &options) {
            Ok(file) => file,
            Err(e) => return self.fault(&e, bytes),
        };
        self.import.desc.sources.add(self.path, Vec::new());
        if let Some(warning) = file.warning() {
            let Import { desc, diagnostics, .. } = &mut self.import;
            diagnostics.warn(&desc.sources, None, warning);
        }
        self.report_move(file.origin);
        let mut mesh = file.mesh;
        let look = match self.pictured(&file.pictures, &mesh) {
            Some(look) => look,
            None => self.painted(&mut mesh),
        };
        self.shape(mesh, look, None);
    }

    /// The look of a mesh that names a picture, which goes before its own colours; `None` where it cannot be had.
    fn pictured(&mut self, pictures: &[String], mesh: &Mesh) -> Option<Look> {
        let (first, others) = pictures.split_first()?;
        if mesh.uvs.is_empty() {
            self.dropped(None, format!("the picture '{first}' is left out: the mesh has no texture coordinates"));
            return None;
        }
        if !others.is_empty() {
            let message =
                format!("{} further pictures of this mesh are left out; '{first}' is on all faces", others.len());
            self.dropped(None, message);
        }
        let reflectance = self.picture(first)?;
        let desc = &mut self.import.desc;
        let diffuse = desc.add(Node::new(Family::Material, "diffuse", None).with("reflectance", reflectance));
        let both = desc.add(Node::new(Family::Material, "two_sided", None).with("front", diffuse));
        Some(Look { material: Some(both), emission: None })
    }

    /// Says so where a model was moved.
    fn report_move(&mut self, origin: [f64; 3]) {
        if origin == [0.0; 3] {
            return;
        }
        let [x, y, z] = origin.map(|v| 0.0 - v);
        let message = format!(
            "the model is moved by ({x}, {y}, {z}) to the origin, since single precision has no room for its \
             coordinates"
        );
        let Import { desc, diagnostics, .. } = &mut self.import;
        diagnostics.note(&desc.sources, None, message);
    }

    /// By custom z is up in such files, which `up` may say otherwise; here it is y.
    fn stl(&mut self, bytes: &[u8]) {
        let mut file = match stl::read(bytes) {
            Ok(file) => file,
            Err(e) => return self.fault(&e, bytes),
        };
        self.import.desc.sources.add(self.path, Vec::new());
        if file.colored > 0 {
            self.dropped(
                None,
                format!("the colours of {} triangles are left out: STL has no standard for them", file.colored),
            );
        }
        if !self.options.defines.contains_key("up") {
            self.knows_up = true;
            file.mesh.positions.iter_mut().for_each(|p| *p = [p[0], p[2], -p[1]]);
        }
        self.shape(file.mesh, Look::default(), None);
    }

    fn bpt(&mut self, bytes: &[u8]) {
        self.knows_up = true;
        match bpt::read(bytes) {
            Ok(mesh) => {
                self.import.desc.sources.add(self.path, Vec::new());
                self.shape(mesh, Look::default(), None);
            }
            Err(e) => self.fault(&e, bytes),
        }
    }

    fn obj(&mut self, bytes: Vec<u8>) {
        let mut file = match obj::read(&bytes, &obj::ObjOptions { recentre: true, ..obj::ObjOptions::default() }) {
            Ok(file) => file,
            Err(e) => return self.fault(&e, &bytes),
        };
        // The text is kept for excerpts.
        let source = self.import.desc.sources.add(self.path, bytes);
        self.report_skipped(&file.skipped, source);
        self.report_move(file.origin);
        for library in &file.libraries {
            let end = library.offset + "mtllib ".len() + library.name.len();
            self.library(&library.name, Span::new(source, library.offset, end));
        }
        self.unnamed_materials(&file, source);
        self.size = stage::diagonal(file.meshes.iter().map(|m| &m.mesh));
        let mut looks: HashMap<Option<String>, Look> = HashMap::new();
        for part in &mut file.meshes {
            let mut mesh = std::mem::take(&mut part.mesh);
            let known = part.material.as_ref().is_some_and(|name| self.materials.contains_key(name));
            let look = match looks.get(&part.material) {
                Some(look) => *look,
                None if known => {
                    let material = part.material.as_ref().and_then(|name| self.materials.get(name)).cloned();
                    let look = material.map(|m| self.look(&m)).unwrap_or_default();
                    *looks.entry(part.material.clone()).or_insert(look)
                }
                None => {
                    if let Some(name) = &part.material {
                        let end = part.material_offset + "usemtl ".len() + name.len();
                        let span = Span::new(source, part.material_offset, end);
                        let message = format!("no library defines the material '{name}': a grey surface stands in");
                        if self.undefined.insert(name.clone()) {
                            self.approximated(Some(span), message);
                        }
                    }
                    self.painted(&mut mesh)
                }
            };
            let name = [&part.object, &part.group].into_iter().find(|name| !name.is_empty());
            self.shape(mesh, look, name.cloned());
        }
    }

    /// Says so where a file names libraries, and no face one of their materials.
    fn unnamed_materials(&mut self, file: &obj::ObjFile, source: FileId) {
        let Some(library) = file.libraries.first().filter(|_| !self.materials.is_empty()) else { return };
        if file.meshes.iter().any(|part| part.material.is_some()) {
            return;
        }
        let mut names: Vec<&str> = self.materials.keys().map(String::as_str).collect();
        names.sort_unstable();
        let some = names.iter().take(5).map(|n| format!("'{n}'")).collect::<Vec<_>>().join(", ");
        let message = format!(
            "no face has a material of '{}', so the model is grey: \
             a line 'usemtl NAME' before the faces gives them one of {some}",
            library.name
        );
        let span = Span::new(source, library.offset, library.offset + "mtllib ".len() + library.name.len());
        self.import.diagnostics.warn(&self.import.desc.sources, Some(span), message);
    }

    fn report_skipped(&mut self, skipped: &obj::Skipped, source: FileId) {
        let drawn = [
            (skipped.points, "point statements"),
            (skipped.lines, "line statements"),
            (skipped.free_form, "statements of free-form curves and surfaces"),
            (skipped.degenerate, "faces of less than three corners"),
            (skipped.references, "texture coordinates and normals that faces name and the file has not"),
            (skipped.colors, "colours of vertices that are not finite"),
            (skipped.not_finite, "texture coordinates and normals that are not finite"),
            (skipped.bad_faces, "faces at vertices that are not finite"),
        ];
        for (count, what) in drawn.into_iter().filter(|d| d.0 > 0) {
            self.dropped(None, format!("{count} {what} in '{}'", self.path.display()));
        }
        if skipped.unknown > 0 {
            let span = Span::new(source, skipped.unknown_offset, skipped.unknown_offset + 1);
            let message = format!("{} statements that OBJ does not have; this is the first", skipped.unknown);
            self.dropped(Some(span), message);
        }
    }

    /// Reads a material library; a material that several define is that of the first.
    fn library(&mut self, name: &str, span: Span) {
        let found = self.search.find(name).or_else(|e| file_name(name).and_then(|n| self.search.find(n).ok()).ok_or(e));
        let read = found.and_then(|path| files::read(&path, &self.options.limits).map(|bytes| (path, bytes)));
        let (path, bytes) = match read {
            Ok(read) => read,
            Err(e) => return self.approximated(Some(span), format!("{e}: grey surfaces stand in")),
        };
        let bytes = text::to_utf8(bytes);
        let library = mtl::read(&bytes);
        let source = self.import.desc.sources.add(&path, bytes);
        for remark in library.remarks {
            let span = Span::new(source, remark.position, remark.position + 1);
            self.dropped(Some(span), remark.message);
        }
        // Textures stand beside the library.
        if let Some(folder) = path.parent().filter(|f| !self.search.folders.iter().any(|known| known == f)) {
            self.search.folders.push(folder.into());
        }
        let is_lit = |m: &&mtl::Material| m.ambient.is_some_and(|c| c != [0.0; 3]);
        if let Some(first) = library.materials.iter().find(is_lit) {
            let span = Span::new(source, first.position, first.position + "newmtl".len());
            let message =
                "'Ka' counts under a light 'ambient' alone (whitted, raster): light from all sides is traced otherwise";
            self.import.diagnostics.note(&self.import.desc.sources, Some(span), message);
        }
        for mut material in library.materials {
            material.locate(source);
            self.materials.entry(material.name.clone()).or_insert(material);
        }
    }

    /// The look of a mesh without a material: its own colours, or nothing.
    fn painted(&mut self, mesh: &mut Mesh) -> Look {
        let is_color = |a: &&mut Attribute| a.name == "color" && a.channels >= 3;
        let by_vertex =
            mesh.attributes.iter().position(|a| a.name == "color" && a.channels >= 3 && a.domain == Domain::Vertex);
        let chosen = match by_vertex {
            Some(i) => mesh.attributes.get_mut(i),
            None => mesh.attributes.iter_mut().find(is_color),
        };
        let Some(color) = chosen else { return Look::default() };
        if color.channels == 4 {
            // Opacity is not ours to guess: alpha is often zero where it means nothing.
            color.data = color.data.chunks_exact(4).flat_map(|c| [c[0], c[1], c[2]]).collect();
            color.channels = 3;
        }
        let domain = if color.domain == Domain::Vertex { "vertex" } else { "face" };
        let brightest = color.data.iter().copied().filter(|v| v.is_finite()).fold(1.0, f32::max);
        let mut texture =
            Node::new(Family::Texture, "mesh_attribute", None).with("name", "color").with("domain", domain);
        if brightest > 1.0 {
            texture.set("scale", f64::from(1.0 / brightest), None);
            self.approximated(None, format!("colours reach {brightest}; they are scaled so that the brightest is 1"));
        }
        let desc = &mut self.import.desc;
        let texture = desc.add(texture);
        let diffuse = desc.add(Node::new(Family::Material, "diffuse", None).with("reflectance", texture));
        let both = desc.add(Node::new(Family::Material, "two_sided", None).with("front", diffuse));
        Look { material: Some(both), emission: None }
    }

    fn shape(&mut self, mut mesh: Mesh, look: Look, name: Option<String>) {
        if mesh.triangles.is_empty() && mesh.patches.is_empty() {
            return;
        }
        smooth::smooth(&mut mesh, self.crease);
        let desc = &mut self.import.desc;
        let node = desc.add(Node { name, ..Node::new(Family::Shape, "mesh", None) });
        let mesh = desc.add_mesh(mesh);
        desc.shapes.push(Shape {
            mesh: Some(mesh),
            material: look.material,
            emission: look.emission,
            ..Shape::new(node)
        });
    }

    fn finish(mut self) -> Import {
        if self.losses > MOST_SHOWN {
            let message = format!("{} further approximations and omissions", self.losses - MOST_SHOWN);
            self.import.diagnostics.dropped(&self.import.desc.sources, None, message);
        }
        if self.import.diagnostics.has_errors() {
            return self.import;
        }
        if self.import.desc.shapes.is_empty() {
            let message = format!("'{}' has no faces: there is nothing to render", self.path.display());
            self.import.diagnostics.error(&self.import.desc.sources, None, message);
            return self.import;
        }
        stage::set(&mut self.import, self.options, self.knows_up);
        self.import
    }
}

/// The last part of a path of any system: exporters write the full paths of the machine they ran on.
fn file_name(path: &str) -> Option<&str> {
    path.rsplit(['/', '\\']).next().filter(|n| !n.is_empty() && *n != path)
}

#[cfg(test)]
mod tests;
