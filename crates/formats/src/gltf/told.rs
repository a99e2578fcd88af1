//! Members of materials that change nothing where light is traced.

use super::{Reader, json::At};

impl Reader<'_> {
    /// Notes the members of materials that are understood but not followed, each once for the whole file.
    pub(super) fn members_without_effect(&mut self, root: &At<'_>) {
        let occlusion = |m: At<'_>| m.get("occlusionTexture").map(|t| t.pointer);
        let thickness = |m: At<'_>| m.extension("KHR_materials_volume")?.get("thicknessTexture").map(|t| t.pointer);
        let found = [
            (root.list("materials").find_map(occlusion), "the light that corners get is traced"),
            (root.list("materials").find_map(thickness), "a volume is as thick as the mesh that encloses it"),
        ];
        for (pointer, why) in found {
            let Some(pointer) = pointer else { continue };
            let message = format!("{pointer}: this texture has no effect in any material: {why}");
            let span = self.span_of(&pointer);
            self.import.diagnostics.note(&self.import.desc.sources, span, message);
        }
    }
}
