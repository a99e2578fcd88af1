//! Which extensions are known, and what becomes of those that are not.

use super::{Reader, json::At};
use steradian_scene::names::nearest;

/// Extensions that are read.
const READ: &[&str] = &[
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_materials_volume_scatter",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_texture_basisu",
    "KHR_texture_transform",
    "KHR_animation_pointer",
    "KHR_node_visibility",
    "KHR_xmp_json_ld",
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
];

/// Extensions that are known and not implemented: what a file loses that only uses them.
const LACKING: &[(&str, &str)] = &[
    ("EXT_texture_avif", "AVIF pictures are not decoded; the picture beside them is used"),
    ("MSFT_texture_dds", "the picture beside the .dds is used"),
    ("EXT_lights_image_based", "image-based lights are left out"),
    ("MSFT_lod", "the finest level of detail is used"),
];

/// Refuses required extensions that are not implemented, and names the losses of those that are only used.
pub(super) fn check(reader: &mut Reader<'_>, root: &At<'_>) {
    let known = || READ.iter().copied().chain(LACKING.iter().map(|l| l.0));
    for name in root.list("extensionsRequired") {
        let Some(text) = name.value.as_str() else {
            reader.error(&name, "the name of an extension is expected");
            continue;
        };
        if READ.contains(&text) {
            continue;
        }
        if LACKING.iter().any(|l| l.0 == text) {
            reader.error(&name, format!("the file needs the extension '{text}', which is not implemented"));
        } else {
            let help = nearest(text, known()).map(|n| format!("did you mean '{n}'?"));
            reader.error_help(&name, format!("the file needs the unknown extension '{text}'"), help);
        }
    }
    for name in root.list("extensionsUsed") {
        let Some(text) = name.value.as_str() else { continue };
        let is_required = root.list("extensionsRequired").any(|r| r.value == name.value);
        if is_required || READ.contains(&text) {
            continue;
        }
        match LACKING.iter().find(|l| l.0 == text) {
            Some((_, loss)) => reader.dropped(&name, format!("extension '{text}': {loss}")),
            None => reader.dropped(&name, format!("the unknown extension '{text}' is left out")),
        }
    }
}
