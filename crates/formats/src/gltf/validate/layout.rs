//! Buffers, buffer views and accessors: lengths, strides, alignment, declared bounds.

use super::{
    Issues,
    document::{Accessor, Document, component_size, index, list, number},
    issues::shown,
    uri,
};
use serde_json::Value;

pub(super) fn check(document: &Document<'_>, issues: &mut Issues) {
    for (k, buffer) in document.list("buffers").iter().enumerate() {
        if let Some(media) = buffer["uri"].as_str().and_then(uri::media_type)
            && !["application/octet-stream", "application/gltf-buffer"].contains(&media)
        {
            let message = format!(
                "the data of a buffer has the media type 'application/octet-stream' or 'application/gltf-buffer', not '{}'",
                shown(media)
            );
            issues.add(format!("/buffers/{k}/uri"), message);
        }
    }
    for (k, view) in document.list("bufferViews").iter().enumerate() {
        check_view(document, view, &format!("/bufferViews/{k}"), issues);
    }
    for (k, (accessor, value)) in document.accessors.iter().zip(document.list("accessors")).enumerate() {
        let place = format!("/accessors/{k}");
        check_accessor(document, accessor, &place, issues);
        check_bounds(accessor, value, &place, issues);
        if let Some(sparse) = value.get("sparse").filter(|s| s.is_object()) {
            check_sparse(document, accessor, sparse, &format!("{place}/sparse"), issues);
        }
    }
}

fn check_view(document: &Document<'_>, view: &Value, place: &str, issues: &mut Issues) {
    let (offset, length, stride) = (number(view, "byteOffset"), number(view, "byteLength"), number(view, "byteStride"));
    if let Some((_, buffer)) = document.item(view, "buffer", "buffers") {
        let there = number(buffer, "byteLength");
        let end = offset.saturating_add(length);
        if end > there {
            let member = if offset >= there { "byteOffset" } else { "byteLength" };
            issues.add(format!("{place}/{member}"), format!("the view ends at byte {end}, but its buffer has {there}"));
        }
    }
    if stride > length {
        issues.add(format!("{place}/byteStride"), format!("a stride of {stride} exceeds the view of {length} bytes"));
    }
    if view.get("byteStride").is_some() && view["target"] == 34963 {
        issues.add(
            format!("{place}/byteStride"),
            "only a view of vertex attributes has a 'byteStride', not one of indices",
        );
    }
}

fn check_accessor(document: &Document<'_>, accessor: &Accessor<'_>, place: &str, issues: &mut Issues) {
    if accessor.is_normalized && matches!(accessor.component, 5125 | 5126) {
        let message = "only integers of 8 and 16 bits can be normalized";
        issues.add(format!("{place}/normalized"), message);
    }
    if !accessor.is_known() {
        return;
    }
    let (size, offset) = (accessor.size(), accessor.offset);
    if !offset.is_multiple_of(size) {
        let message = format!("an offset of {offset} is not a multiple of the {size} bytes of a component");
        issues.add(format!("{place}/byteOffset"), message);
    }
    if accessor.kind.starts_with("MAT") && !offset.is_multiple_of(4) {
        let message = format!("matrices start at multiples of 4 bytes, not at {offset}");
        issues.add(format!("{place}/byteOffset"), message);
    }
    let Some(view) = document.view(accessor) else { return };
    let total = offset.saturating_add(number(view, "byteOffset"));
    if !total.is_multiple_of(size) {
        let message =
            format!("its data starts at byte {total} of the buffer, no multiple of the {size} bytes of a component");
        issues.add(place, message);
    }
    let element = accessor.element();
    let stride = match number(view, "byteStride") {
        0 => element,
        stride if stride < element => {
            issues.add(place, format!("an element has {element} bytes, but the stride of its view is {stride}"));
            return;
        }
        stride => stride,
    };
    let needed = accessor.count.saturating_sub(1).saturating_mul(stride).saturating_add(element).saturating_add(offset);
    let there = number(view, "byteLength");
    if accessor.count > 0 && needed > there {
        let member = if offset >= there { "/byteOffset" } else { "" };
        let message = format!("{} elements end at byte {needed} of a view of {there} bytes", accessor.count);
        issues.add(format!("{place}{member}"), message);
    }
}

/// `min` and `max` have a number for each component, which its type can hold.
fn check_bounds(accessor: &Accessor<'_>, value: &Value, place: &str, issues: &mut Issues) {
    let range = match accessor.component {
        5120 => (-128.0, 127.0),
        5121 => (0.0, 255.0),
        5122 => (-32768.0, 32767.0),
        5123 => (0.0, 65535.0),
        5125 => (0.0, f64::from(u32::MAX)),
        _ => (f64::NEG_INFINITY, f64::INFINITY),
    };
    for name in ["min", "max"] {
        let bounds = list(value, name);
        let channels = accessor.channels();
        if !bounds.is_empty() && channels > 0 && bounds.len() != channels {
            let message = format!("{} values stand here instead of {channels} for {}", bounds.len(), accessor.kind);
            issues.add(format!("{place}/{name}"), message);
        }
        for (k, bound) in bounds.iter().take(channels).enumerate() {
            let Some(bound) = bound.as_f64() else { continue };
            let is_integer = !matches!(accessor.component, 5126 | 0);
            if bound < range.0 || bound > range.1 || is_integer && bound.fract() != 0.0 {
                let message = format!("{bound} is no value that the component type {} can hold", accessor.component);
                issues.add(format!("{place}/{name}/{k}"), message);
            }
        }
    }
}

fn check_sparse(document: &Document<'_>, accessor: &Accessor<'_>, sparse: &Value, place: &str, issues: &mut Issues) {
    let count = number(sparse, "count");
    if count > accessor.count {
        let message = format!("{count} elements are replaced, but the accessor has {}", accessor.count);
        issues.add(format!("{place}/count"), message);
    }
    let parts = [
        ("indices", component_size(number(&sparse["indices"], "componentType")), 0),
        ("values", accessor.element(), accessor.size()),
    ];
    for (name, element, alignment) in parts {
        let part = &sparse[name];
        let Some(view) = index(part, "bufferView").and_then(|v| document.list("bufferViews").get(v)) else { continue };
        let offset = number(part, "byteOffset");
        let place = format!("{place}/{name}");
        let alignment = if alignment == 0 { element } else { alignment };
        if alignment > 0 && !offset.is_multiple_of(alignment) {
            let message = format!("an offset of {offset} is not a multiple of the {alignment} bytes of a component");
            issues.add(format!("{place}/byteOffset"), message);
        } else if alignment > 0 && !offset.saturating_add(number(view, "byteOffset")).is_multiple_of(alignment) {
            let message = format!("its data does not start at a multiple of the {alignment} bytes of a component");
            issues.add(&place, message);
        }
        let (end, there) = (offset.saturating_add(count.saturating_mul(element)), number(view, "byteLength"));
        if end > there {
            issues.add(&place, format!("{count} elements end at byte {end} of a view of {there} bytes"));
        }
        if view.get("byteStride").is_some() || view.get("target").is_some() {
            let message = "a view of sparse data has neither 'byteStride' nor 'target'";
            issues.add(format!("{place}/bufferView"), message);
        }
    }
}
