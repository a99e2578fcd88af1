//! MaterialX documents (1.38 and 1.39) as layers: each material is a prim `/MaterialX/Materials/NAME`, as OpenUSD has
//! them, with copies of all nodes and graphs of the document below it, so that references may name it alone.

use super::{
    layer::{Fault, Layer, Spec, Specifier, join, property},
    value::{Item, ListOp, Value},
};
use crate::xml;
use roxmltree::Node as Element;
use std::sync::Arc;
use steradian_math::color::transfer::srgb_decode;

/// Deepest nesting of elements.
const MOST_NESTED: usize = 64;
/// Most prims and properties of a document, copies counted.
const MOST_SPECS: usize = 200_000;
/// Path of the prims of materials.
pub(super) const ROOT: &str = "/MaterialX/Materials";

/// True for texts of such documents.
pub(super) fn looks_like(bytes: &[u8]) -> bool {
    let beginning = bytes.get(..4096).unwrap_or(bytes);
    bytes.trim_ascii_start().starts_with(b"<") && beginning.windows(10).any(|w| w == b"<materialx")
}

/// Reads a document.
pub(super) fn read(bytes: &[u8]) -> Result<Layer, Fault> {
    let text = std::str::from_utf8(bytes)
        .map_err(|e| Fault { at: Some(e.valid_up_to()), message: "this is not UTF-8 text".into() })?;
    let fault = |f: xml::Fault| Fault { at: Some(f.at.start), message: f.message };
    xml::precheck(text, MOST_NESTED).map_err(fault)?;
    let document = xml::parse(text).map_err(fault)?;
    let root = document.root_element();
    if root.tag_name().name() != "materialx" {
        let message = format!("a MaterialX document is a <materialx>, not a <{}>", root.tag_name().name());
        return Err(Fault { at: Some(root.range().start), message });
    }
    let mut made = Made { layer: Layer::default() };
    made.prim("/", "", &root);
    made.prim("/MaterialX", "Scope", &root);
    made.prim(ROOT, "Scope", &root);
    for element in root.children().filter(Element::is_element) {
        if element.tag_name().name().ends_with("include") {
            let message = "<xi:include> is not followed: what it names belongs into this file".into();
            return Err(Fault { at: Some(element.range().start), message });
        }
        if element.attribute("type") == Some("material") {
            made.material(&root, &element)?;
        }
    }
    Ok(made.layer)
}

struct Made {
    layer: Layer,
}

impl Made {
    fn spec(&mut self, path: String, element: &Element<'_, '_>) -> &mut Spec {
        let range = element.range();
        let spec = self.layer.specs.entry(path).or_default();
        spec.at = Some((range.start, range.end));
        spec
    }

    /// Defines a prim, and names it among the children of the one above.
    fn prim(&mut self, path: &str, kind: &str, element: &Element<'_, '_>) {
        let spec = self.spec(path.into(), element);
        spec.specifier = Specifier::Def;
        spec.fields.insert("typeName".into(), Value::Text(kind.into()));
        if let Some((above, name)) = path.rsplit_once('/').filter(|p| !p.1.is_empty()) {
            let above = if above.is_empty() { "/" } else { above };
            if let Some(above) = self.layer.specs.get_mut(above) {
                above.children.push(name.into());
            }
        }
    }

    /// Sets a field of a property.
    fn set(&mut self, (prim, name): (&str, &str), field: &str, value: Value, element: &Element<'_, '_>) {
        if let Some(prim) = self.layer.specs.get_mut(prim)
            && !prim.properties.iter().any(|known| known == name)
        {
            prim.properties.push(name.into());
        }
        self.spec(property(prim, name), element).fields.insert(field.into(), value);
    }

    fn connect(&mut self, at: (&str, &str), to: String, element: &Element<'_, '_>) {
        let list = ListOp { explicit: Some(vec![Item { path: to, ..Item::default() }]), ..ListOp::default() };
        self.set(at, "connect", Value::List(Arc::new(list)), element);
    }

    fn material(&mut self, root: &Element<'_, '_>, element: &Element<'_, '_>) -> Result<(), Fault> {
        let Some(name) = element.attribute("name") else {
            return Err(Fault { at: Some(element.range().start), message: "this material has no name".into() });
        };
        let path = join(ROOT, name);
        self.prim(&path, "Material", element);
        let input =
            |name: &str| element.children().find(|c| c.has_tag_name("input") && c.attribute("name") == Some(name));
        if let Some(surface) = input("surfaceshader").and_then(|s| s.attribute("nodename")) {
            self.connect((&path, "outputs:mtlx:surface"), format!("{path}/{surface}.outputs:out"), element);
        }
        if let Some(what) = ["displacementshader", "volumeshader"].into_iter().find(|name| input(name).is_some()) {
            self.set((&path, "outputs:mtlx:unread"), "default", Value::Text(what.into()), element);
        }
        self.nodes(&path, root)
    }

    /// The nodes and graphs of an element, below a prim.
    fn nodes(&mut self, path: &str, of: &Element<'_, '_>) -> Result<(), Fault> {
        for element in of.children().filter(Element::is_element) {
            let Some(name) = element.attribute("name") else { continue };
            if self.layer.specs.len() > MOST_SPECS {
                let message = format!("the materials of this document have more than {MOST_SPECS} nodes and inputs");
                return Err(Fault { at: Some(element.range().start), message });
            }
            let own = join(path, name);
            match (element.tag_name().name(), element.attribute("type").unwrap_or_default()) {
                ("input" | "output" | "nodedef" | "token", _) | (_, "material") => continue,
                ("nodegraph", _) => {
                    self.prim(&own, "NodeGraph", &element);
                    self.nodes(&own, &element)?;
                }
                (category, kind) => {
                    self.prim(&own, "Shader", &element);
                    let id =
                        if kind == "multioutput" { format!("ND_{category}") } else { format!("ND_{category}_{kind}") };
                    self.set((&own, "info:id"), "default", Value::Text(id), &element);
                    self.set((&own, "outputs:out"), "typeName", Value::Text(kind.into()), &element);
                }
            }
            // Names of nodes are those beside this one.
            for part in element.children().filter(Element::is_element) {
                self.input((path, &own), &part)?;
            }
        }
        Ok(())
    }

    /// An input, or the output of a graph.
    fn input(&mut self, (beside, own): (&str, &str), part: &Element<'_, '_>) -> Result<(), Fault> {
        let Some(name) = part.attribute("name") else { return Ok(()) };
        let (name, siblings) = match part.tag_name().name() {
            "input" => (format!("inputs:{name}"), beside),
            "output" => (format!("outputs:{name}"), own),
            _ => return Ok(()),
        };
        let at = (own, name.as_str());
        let output = part.attribute("output").unwrap_or("out");
        if let Some(node) = part.attribute("nodename") {
            self.connect(at, format!("{}.outputs:{output}", join(siblings, node)), part);
        } else if let Some(graph) = part.attribute("nodegraph") {
            self.connect(at, format!("{}.outputs:{output}", join(siblings, graph)), part);
        } else if let Some(interface) = part.attribute("interfacename") {
            // That of the graph around.
            self.connect(at, format!("{beside}.inputs:{interface}"), part);
        } else if let Some(text) = part.attribute("value") {
            let value = value(part, text).map_err(|message| Fault {
                at: Some(part.attribute_node("value").map_or(0, |a| a.range().start)),
                message,
            })?;
            self.set(at, "default", value, part);
            if let Some(space) = inherited(part, "colorspace") {
                self.set(at, "colorSpace", Value::Text(space.into()), part);
            }
        }
        Ok(())
    }
}

/// An attribute of an element, or of the nearest around it that has it.
fn inherited<'a>(element: &Element<'a, '_>, name: &str) -> Option<&'a str> {
    element.ancestors().find_map(|e| e.attribute(name))
}

/// The value of an input by its type.
fn value(element: &Element<'_, '_>, text: &str) -> Result<Value, String> {
    let kind = element.attribute("type").unwrap_or_default();
    let numbers = || -> Result<Vec<f64>, String> {
        let number = |v: &str| v.trim().parse::<f64>().ok().filter(|v| v.is_finite());
        let numbers: Option<Vec<f64>> = text.split(',').map(number).collect();
        numbers.ok_or_else(|| format!("'{text}' is not a {kind}"))
    };
    Ok(match kind {
        "boolean" => Value::Bool(text.trim() == "true"),
        "string" | "geomname" => Value::Text(text.into()),
        "filename" => Value::Asset(format!("{}{text}", inherited(element, "fileprefix").unwrap_or_default())),
        "float" | "integer" => match numbers()?.as_slice() {
            [v] => Value::Number(*v),
            _ => return Err(format!("'{text}' is not a {kind}")),
        },
        "color3" | "color4" | "vector2" | "vector3" | "vector4" => {
            let mut numbers = numbers()?;
            let count = if kind.ends_with('4') { 4 } else { 2 + usize::from(kind.ends_with('3')) };
            if numbers.len() != count {
                return Err(format!("a {kind} is {count} numbers, not {}", numbers.len()));
            }
            if kind.starts_with("color") && inherited(element, "colorspace") == Some("srgb_texture") {
                numbers.iter_mut().take(3).for_each(|v| *v = f64::from(srgb_decode(*v as f32)));
            }
            Value::Numbers(numbers.into())
        }
        _ => Value::Text(text.into()),
    })
}
