//! Rules between members of single objects: versions, extensions, cameras, lights, pictures of textures.

use super::{
    Issues,
    document::{Document, list},
    issues::shown,
};
use serde_json::Value;
use std::collections::HashSet;

/// Media types of pictures that need an extension.
pub(super) const MEDIA: &[(&str, &str)] = &[
    ("image/webp", "EXT_texture_webp"),
    ("image/avif", "EXT_texture_avif"),
    ("image/ktx2", "KHR_texture_basisu"),
    ("image/vnd-ms.dds", "MSFT_texture_dds"),
];

pub(super) fn check(document: &Document<'_>, issues: &mut Issues) {
    check_versions(&document.root["asset"], issues);
    check_extensions(document, issues);
    for (k, camera) in document.list("cameras").iter().enumerate() {
        check_camera(camera, &format!("/cameras/{k}"), issues);
    }
    let lights = document.root.pointer("/extensions/KHR_lights_punctual");
    for (k, light) in lights.map_or(&[][..], |l| list(l, "lights")).iter().enumerate() {
        check_light(light, &format!("/extensions/KHR_lights_punctual/lights/{k}"), issues);
    }
    for (k, material) in document.list("materials").iter().enumerate() {
        let place = "/extensions/KHR_materials_ior/ior";
        if material.pointer(place).and_then(Value::as_f64).is_some_and(|ior| ior > 0.0 && ior < 1.0) {
            issues.add(format!("/materials/{k}{place}"), "an index of refraction is 0, or 1 or more");
        }
    }
    check_textures(document, issues);
}

fn check_versions(asset: &Value, issues: &mut Issues) {
    let version = |name: &str| -> Option<(u64, u64)> {
        let (major, minor) = asset[name].as_str()?.split_once('.')?;
        Some((major.parse().ok()?, minor.parse().ok()?))
    };
    if let (Some(least), Some(own)) = (version("minVersion"), version("version"))
        && least > own
    {
        let message = format!("{}.{} is more than the version {}.{} of the document", least.0, least.1, own.0, own.1);
        issues.add("/asset/minVersion", message);
    }
}

fn check_extensions(document: &Document<'_>, issues: &mut Issues) {
    let names = |list: &'static str| document.list(list).iter().map(|e| e.as_str().unwrap_or_default());
    let used: HashSet<&str> = names("extensionsUsed").collect();
    for (k, name) in names("extensionsRequired").enumerate().filter(|(_, name)| !used.contains(name)) {
        let message = format!("'{}' is required, so 'extensionsUsed' must have it too", shown(name));
        issues.add(format!("/extensionsRequired/{k}"), message);
    }
    let quantization = "KHR_mesh_quantization";
    if let Some(k) = names("extensionsUsed").position(|name| name == quantization)
        && !names("extensionsRequired").any(|name| name == quantization)
    {
        issues.add(format!("/extensionsUsed/{k}"), format!("'{quantization}' must be in 'extensionsRequired' too"));
    }
}

fn check_camera(camera: &Value, place: &str, issues: &mut Issues) {
    for kind in ["perspective", "orthographic"] {
        let lens = &camera[kind];
        for name in ["xmag", "ymag"] {
            if lens[name].as_f64() == Some(0.0) {
                issues.add(format!("{place}/{kind}/{name}"), format!("'{name}' must not be zero"));
            }
        }
        if let (Some(near), Some(far)) = (lens["znear"].as_f64(), lens["zfar"].as_f64())
            && far <= near
        {
            issues.add(format!("{place}/{kind}"), format!("zfar {far} must be more than znear {near}"));
        }
    }
    if let Some(kind) = camera["type"].as_str().filter(|k| matches!(*k, "perspective" | "orthographic"))
        && camera.get(kind).is_none()
        && (camera.get("perspective").is_some() || camera.get("orthographic").is_some())
    {
        issues.add(place, format!("a camera of type '{kind}' needs '{kind}'"));
    }
}

fn check_light(light: &Value, place: &str, issues: &mut Issues) {
    if light["type"] == "spot" && light.get("spot").is_none() {
        issues.add(place, "'spot' is missing: a light of type 'spot' must have it");
    }
    let angle = |name: &str, default| light["spot"].get(name).map_or(Some(default), Value::as_f64);
    if let (Some(inner), Some(outer)) =
        (angle("innerConeAngle", 0.0), angle("outerConeAngle", std::f64::consts::FRAC_PI_4))
        && light["spot"].is_object()
        && outer <= inner
    {
        let name = if light["spot"].get("outerConeAngle").is_some() { "outerConeAngle" } else { "innerConeAngle" };
        issues.add(
            format!("{place}/spot/{name}"),
            format!("the outer angle {outer} must be more than the inner one {inner}"),
        );
    }
}

/// Pictures have a type that their use allows.
fn check_textures(document: &Document<'_>, issues: &mut Issues) {
    let declared = |image: &Value| image["mimeType"].as_str().map(str::to_owned);
    for (k, image) in document.list("images").iter().enumerate() {
        if let Some(media) = declared(image) {
            check_media(document, &media, &format!("/images/{k}"), issues);
        }
    }
    for (k, texture) in document.list("textures").iter().enumerate() {
        let place = format!("/textures/{k}");
        let source = |object: &Value| declared(document.item(object, "source", "images")?.1);
        if let Some(media) = source(texture).filter(|m| !matches!(m.as_str(), "image/png" | "image/jpeg")) {
            let message = format!("the source of a texture is 'image/png' or 'image/jpeg', not '{}'", shown(media));
            issues.add(format!("{place}/source"), message);
        }
        for (right, name) in MEDIA {
            let Some(extension) = texture.pointer(&format!("/extensions/{name}")) else { continue };
            if let Some(media) = source(extension).filter(|m| m != right) {
                let message = format!("the source of {name} is '{right}', not '{}'", shown(media));
                issues.add(format!("{place}/extensions/{name}/source"), message);
            }
        }
    }
}

/// Says so where pictures of a type need an extension that is not used.
pub(super) fn check_media(document: &Document<'_>, media: &str, place: &str, issues: &mut Issues) {
    if let Some((_, extension)) = MEDIA.iter().find(|(m, _)| *m == media).filter(|(_, e)| !document.uses(e)) {
        issues.add(place, format!("a picture of type '{media}' needs the extension '{extension}' in 'extensionsUsed'"));
    }
}
