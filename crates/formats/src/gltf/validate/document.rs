//! Short ways to the parts of a document, and its accessors in a table.

use super::Issues;
use crate::gltf::draco;
use serde_json::Value;
use std::collections::HashSet;

/// State shared by the checks of references and of data.
pub(super) struct Document<'a> {
    pub root: &'a Value,
    pub accessors: Vec<Accessor<'a>>,
    /// The accessors whose data are in Draco meshes.
    pub packed: HashSet<usize>,
}

/// An accessor, as far as it is well-formed.
#[derive(Clone, Debug, Default)]
pub(super) struct Accessor<'a> {
    pub view: Option<usize>,
    pub offset: u64,
    pub component: u64,
    pub is_normalized: bool,
    pub count: u64,
    pub kind: &'a str,
}

impl Accessor<'_> {
    /// Bytes of a component; 0 if it is unknown.
    pub fn size(&self) -> u64 {
        component_size(self.component)
    }

    /// Numbers of an element; 0 if its type is unknown.
    pub fn channels(&self) -> usize {
        match self.kind {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" | "MAT2" => 4,
            "MAT3" => 9,
            "MAT4" => 16,
            _ => 0,
        }
    }

    /// Numbers of a column of a matrix, or all of a vector.
    pub fn rows(&self) -> usize {
        match self.kind {
            "MAT2" => 2,
            "MAT3" => 3,
            "MAT4" => 4,
            _ => self.channels(),
        }
    }

    /// Bytes from one column of a matrix to the next, which starts at a multiple of four.
    pub fn column(&self) -> u64 {
        let column = self.rows() as u64 * self.size();
        if self.kind.starts_with("MAT") { column.next_multiple_of(4) } else { column }
    }

    /// Bytes of an element.
    pub fn element(&self) -> u64 {
        self.column() * (self.channels() / self.rows().max(1)) as u64
    }

    /// Its type in words.
    pub fn format(&self) -> String {
        let normalized = if self.is_normalized { " normalized" } else { "" };
        format!("{} of{normalized} {}", self.kind, component_name(self.component))
    }

    /// Tests for one of the given types and component types; each component type is a code and its `normalized` flag.
    pub fn is(&self, kinds: &[&str], components: &[(u64, bool)]) -> bool {
        kinds.contains(&self.kind) && components.contains(&(self.component, self.is_normalized))
    }

    /// True if the format is a known one: otherwise the schema reports the fault.
    pub fn is_known(&self) -> bool {
        self.element() > 0
    }
}

pub(super) fn component_size(code: u64) -> u64 {
    match code {
        5120 | 5121 => 1,
        5122 | 5123 => 2,
        5125 | 5126 => 4,
        _ => 0,
    }
}

fn component_name(code: u64) -> &'static str {
    match code {
        5120 => "BYTE",
        5121 => "UNSIGNED_BYTE",
        5122 => "SHORT",
        5123 => "UNSIGNED_SHORT",
        5125 => "UNSIGNED_INT",
        5126 => "FLOAT",
        _ => "unknown numbers",
    }
}

impl<'a> Document<'a> {
    pub fn new(root: &'a Value) -> Self {
        let accessor = |a: &'a Value| Accessor {
            view: index(a, "bufferView"),
            offset: number(a, "byteOffset"),
            component: number(a, "componentType"),
            is_normalized: a["normalized"] == true,
            count: number(a, "count"),
            kind: a["type"].as_str().unwrap_or_default(),
        };
        let mut packed = HashSet::new();
        for primitive in list(root, "meshes").iter().flat_map(|mesh| list(mesh, "primitives")) {
            let Some(extension) = primitive["extensions"].get(draco::NAME) else { continue };
            packed.extend(index(primitive, "indices"));
            let names = extension["attributes"].as_object().into_iter().flat_map(|ids| ids.keys());
            packed.extend(names.filter_map(|name| index(&primitive["attributes"], name)));
        }
        Self { root, accessors: list(root, "accessors").iter().map(accessor).collect(), packed }
    }

    pub fn list(&self, name: &str) -> &'a [Value] {
        list(self.root, name)
    }

    /// The item of the list `of` that the member `name` refers to.
    pub fn item(&self, object: &Value, name: &str, of: &str) -> Option<(usize, &'a Value)> {
        let index = index(object, name)?;
        Some((index, self.list(of).get(index)?))
    }

    /// The accessor that the member `name` refers to.
    pub fn accessor(&self, object: &Value, name: &str) -> Option<(usize, &Accessor<'a>)> {
        let index = index(object, name)?;
        Some((index, self.accessors.get(index)?))
    }

    pub fn view(&self, accessor: &Accessor<'_>) -> Option<&'a Value> {
        self.list("bufferViews").get(accessor.view?)
    }

    pub fn uses(&self, extension: &str) -> bool {
        list(self.root, "extensionsUsed").iter().any(|e| e == extension)
    }

    pub fn has_bounds(&self, accessor: usize) -> bool {
        let accessor = &self.list("accessors")[accessor];
        accessor.get("min").is_some() && accessor.get("max").is_some()
    }
}

/// The items of a member that is an array; none of anything else.
pub(super) fn list<'a>(object: &'a Value, name: &str) -> &'a [Value] {
    object.get(name).and_then(Value::as_array).map_or(&[], Vec::as_slice)
}

pub(super) fn index(object: &Value, name: &str) -> Option<usize> {
    object.get(name)?.as_u64().and_then(|v| usize::try_from(v).ok())
}

/// A whole number; 0 where it is missing.
pub(super) fn number(object: &Value, name: &str) -> u64 {
    object.get(name).and_then(Value::as_u64).unwrap_or(0)
}

/// The numbers of an array, if there are exactly so many.
pub(super) fn numbers<const N: usize>(object: &Value, name: &str) -> Option<[f64; N]> {
    let values: Vec<f64> = list(object, name).iter().filter_map(Value::as_f64).collect();
    values.try_into().ok()
}

/// Says that an accessor has a format that does not fit its use.
pub(super) fn wrong_format(issues: &mut Issues, place: &str, accessor: &Accessor<'_>, right: &str) {
    if accessor.is_known() {
        issues.add(place, format!("an accessor of {} cannot be used here; {right} can", accessor.format()));
    }
}
