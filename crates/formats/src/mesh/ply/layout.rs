//! Meaning of the properties of an element, by their names.

use super::header::{Element, Type};
use steradian_math::color::transfer::srgb_decode;

/// Conversion of a stored number to a value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Scale {
    /// As it is.
    Plain,
    /// Divided by the largest value of its integer type.
    Unit(f32),
    /// Divided by the largest value of its integer type, then decoded from sRGB to linear.
    Srgb(f32),
}

impl Scale {
    pub(super) fn apply(self, v: f32) -> f32 {
        match self {
            Self::Plain => v,
            Self::Unit(max) => v / max,
            Self::Srgb(max) => srgb_decode(v / max),
        }
    }
}

/// A group of properties that make one attribute.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct AttributeLayout {
    pub(super) name: String,
    /// Indices of the properties, 1 to 4, with how to read each.
    pub(super) slots: Vec<(usize, Scale)>,
}

/// Indices of the properties of a vertex that mean something.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct VertexLayout {
    pub(super) position: [usize; 3],
    pub(super) normal: Option<[usize; 3]>,
    pub(super) uv: Option<[usize; 2]>,
    pub(super) uv_scale: [Scale; 2],
    pub(super) attributes: Vec<AttributeLayout>,
}

/// The names under which texture coordinates are found, in order of preference.
const UV_NAMES: [[&str; 2]; 9] = [
    ["u", "v"],
    ["s", "t"],
    ["texture_u", "texture_v"],
    ["texture_s", "texture_t"],
    ["texcoord_u", "texcoord_v"],
    ["texcoord_s", "texcoord_t"],
    ["texcoord_x", "texcoord_y"],
    ["texcoord_0", "texcoord_1"],
    ["tex_u", "tex_v"],
];

fn find<const N: usize>(element: &Element, names: [&str; N]) -> Option<[usize; N]> {
    let mut slots = [0; N];
    for (slot, name) in slots.iter_mut().zip(names) {
        *slot = element.properties.iter().position(|p| p.name == name && p.length.is_none())?;
    }
    Some(slots)
}

impl VertexLayout {
    /// `Err` names the coordinate that is absent.
    pub(super) fn new(element: &Element) -> Result<Self, &'static str> {
        for name in ["x", "y", "z"] {
            find(element, [name]).ok_or(name)?;
        }
        let position = find(element, ["x", "y", "z"]).ok_or("x")?;
        let normal = find(element, ["nx", "ny", "nz"]);
        let uv = UV_NAMES.iter().find_map(|&names| find(element, names));
        let mut used: Vec<usize> = position.to_vec();
        used.extend(normal.into_iter().flatten().chain(uv.into_iter().flatten()));
        let unit = |slot: usize| element.properties[slot].item.integer_max().map_or(Scale::Plain, Scale::Unit);
        Ok(Self {
            position,
            normal,
            uv,
            uv_scale: uv.map_or([Scale::Plain; 2], |s| s.map(unit)),
            attributes: attributes(element, &used),
        })
    }
}

/// Colour channels of integer types are encoded values; alpha and numbers of other kinds are not.
fn color_scale(item: Type, channel: usize) -> Scale {
    match item.integer_max() {
        None => Scale::Plain,
        Some(max) if channel < 3 => Scale::Srgb(max),
        Some(max) => Scale::Unit(max),
    }
}

/// Groups properties into attributes by Mitsuba's rules: `r g b [a]` or `red green blue [alpha]` are `color`, as are
/// `diffuse_red diffuse_green diffuse_blue [diffuse_alpha]`;
/// neighbours `{prefix}_x, _y, …` (also `_r _g _b _a`, `_0 _1 …`, `_1 _2 …`) are `{prefix}`, with `_color` added for
/// the letters of a colour.
pub(super) fn attributes(element: &Element, used: &[usize]) -> Vec<AttributeLayout> {
    const SUFFIXES: [&[u8]; 4] = [b"xyzw", b"rgba", b"0123", b"1234"];
    let mut out = Vec::new();
    let scale = |slot: usize, channel: usize| color_scale(element.properties[slot].item, channel);
    let diffuse = ["diffuse_red", "diffuse_green", "diffuse_blue", "diffuse_alpha"];
    for names in [["r", "g", "b", "a"], ["red", "green", "blue", "alpha"], diffuse] {
        let [r, g, b, a] = names;
        if let Some(rgb) = find(element, [r, g, b]) {
            let alpha = find(element, [a]);
            let slots = rgb.into_iter().chain(alpha.into_iter().flatten());
            let slots = slots.enumerate().map(|(channel, slot)| (slot, scale(slot, channel))).collect();
            out.push(AttributeLayout { name: "color".into(), slots });
            break;
        }
    }

    let mut i = 0;
    while i < element.properties.len() {
        let start = i;
        i += 1;
        let split = |slot: usize| {
            let p = element.properties.get(slot).filter(|p| p.length.is_none() && !used.contains(&slot))?;
            let (prefix, suffix) = p.name.rsplit_once('_')?;
            (suffix.len() == 1 && !prefix.is_empty()).then_some((prefix, suffix.as_bytes()[0]))
        };
        let Some((prefix, suffix)) = split(start) else { continue };
        let Some(family) = SUFFIXES.iter().find(|f| f[0] == suffix) else { continue };
        let more = |slot: usize, k: usize| split(slot).is_some_and(|(p, s)| p == prefix && family.get(k) == Some(&s));
        while more(i, i - start) {
            i += 1;
        }
        let is_color = family[0] == b'r';
        let name = if is_color { format!("{prefix}_color") } else { prefix.to_owned() };
        if out.iter().any(|a: &AttributeLayout| a.name == name) {
            continue;
        }
        let slots = (start..i)
            .enumerate()
            .map(|(channel, slot)| (slot, if is_color { scale(slot, channel) } else { Scale::Plain }))
            .collect();
        out.push(AttributeLayout { name, slots });
    }
    out
}
