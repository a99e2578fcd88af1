"""Panels of the properties editor: Steradian's own, and those of Blender that it makes use of."""

from __future__ import annotations

from typing import Any

import bpy

ENGINE = "STERADIAN"
# Panels that say so for Blender's own renderers, but mean nothing here, by the beginnings of their names.
EXCLUDED = (
    "NODE_",
    "VIEWLAYER_PT_filter",
    "VIEWLAYER_PT_freestyle",
    "RENDER_PT_simplify_greasepencil",
    "RENDER_PT_grease_pencil",
    "RENDER_PT_freestyle",
    "DATA_PT_light",
    "DATA_PT_EEVEE_light",
    "DATA_PT_spot",
    "DATA_PT_area",
)
# Panels that are useful here, but do not say so.
INCLUDED = {
    "VIEWLAYER_PT_layer_passes",
    "VIEWLAYER_PT_layer_passes_cryptomatte",
    "VIEWLAYER_PT_layer_passes_lightgroups",
    "VIEWLAYER_PT_override",
    "EEVEE_MATERIAL_PT_context_material",
    "MATERIAL_PT_preview",
    "DATA_PT_camera_dof",
    "DATA_PT_camera_dof_aperture",
    "DATA_PT_light_animation",
    "PARTICLE_PT_hair_shape",
    "CURVES_PT_shape",
}


class _Panel(bpy.types.Panel):
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Shown where Steradian is the engine."""
        return context.engine == ENGINE

    def _rows(self, owner: Any, *names: str) -> None:
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        for name in names:
            if hasattr(owner, name):
                self.layout.prop(owner, name)


class STERADIAN_PT_sampling(_Panel):
    """Samples and method."""

    bl_label = "Sampling"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        own = context.scene.steradian
        self._rows(
            own, "method", "samples", "preview_samples", "time_limit", "error", "adaptive", "seed", "animate_seed"
        )


class STERADIAN_PT_light(_Panel):
    """Paths of light."""

    bl_label = "Light Paths"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        own = context.scene.steradian
        self._rows(own, "max_depth", "clamp", *(("caustics",) if own.method == "path" else ()), "spectral")


class STERADIAN_PT_denoising(_Panel):
    """Denoisers."""

    bl_label = "Denoising"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        self._rows(context.scene.steradian, "denoiser", "preview_denoise")


class STERADIAN_PT_film(_Panel):
    """Film and pixel filter."""

    bl_label = "Film"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        own = context.scene.steradian
        self._rows(context.scene.render, "film_transparent")
        self._rows(own, "filter", *(("filter_width",) if own.filter != "BOX" else ()))


class STERADIAN_PT_motion(_Panel):
    """Motion blur."""

    bl_label = "Motion Blur"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header(self, context: bpy.types.Context) -> None:
        """Draws the switch."""
        self.layout.prop(context.scene.render, "use_motion_blur", text="")

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        self._rows(context.scene.render, "motion_blur_position", "motion_blur_shutter")


class STERADIAN_PT_performance(_Panel):
    """Threads."""

    bl_label = "Performance"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        self._rows(context.scene.steradian, "threads")
        self.layout.operator("steradian.open")


class STERADIAN_PT_passes(_Panel):
    """Passes of a view layer."""

    bl_label = "Data"
    bl_context = "view_layer"
    bl_parent_id = "VIEWLAYER_PT_layer_passes"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        self._rows(
            context.view_layer,
            "use_pass_z",
            "use_pass_position",
            "use_pass_normal",
            "use_pass_uv",
            "use_pass_diffuse_color",
        )
        self._rows(context.scene.steradian, "store_guides")


class STERADIAN_PT_lamp(_Panel):
    """Lights."""

    bl_label = "Light"
    bl_context = "data"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Shown for lights."""
        return context.engine == ENGINE and getattr(context, "light", None) is not None

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        lamp = context.light
        self.layout.row().prop(lamp, "type", expand=True)
        self._rows(lamp, "use_temperature", "temperature", "color", "energy", "exposure", "normalize")
        if lamp.type == "POINT":
            self._rows(lamp, "shadow_soft_size")
        elif lamp.type == "SPOT":
            self._rows(lamp, "spot_size", "spot_blend")
        elif lamp.type == "SUN":
            self._rows(lamp, "angle")
        else:
            self._rows(lamp, "shape", "size", *(("size_y",) if lamp.shape in {"RECTANGLE", "ELLIPSE"} else ()))


class STERADIAN_PT_material(_Panel):
    """Surface of a material."""

    bl_label = "Surface"
    bl_context = "material"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Shown for materials."""
        return context.engine == ENGINE and getattr(context, "material", None) is not None

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the node at the output."""
        _node(self.layout, context.material, "OUTPUT_MATERIAL", "Surface")


class STERADIAN_PT_world(_Panel):
    """Surface of a world."""

    bl_label = "Surface"
    bl_context = "world"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Shown for worlds."""
        return context.engine == ENGINE and getattr(context, "world", None) is not None

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the node at the output."""
        _node(self.layout, context.world, "OUTPUT_WORLD", "Surface")


def _node(layout: bpy.types.UILayout, owner: Any, kind: str, socket: str) -> None:
    """The tree at an input of the output node."""
    layout.use_property_split = True
    tree = owner.node_tree
    output = next((node for node in tree.nodes if node.type == kind and node.is_active_output), None) if tree else None
    if output is None:
        layout.label(text="No output node")
    else:
        layout.template_node_view(tree, output, output.inputs[socket])


CLASSES = (
    STERADIAN_PT_sampling,
    STERADIAN_PT_light,
    STERADIAN_PT_denoising,
    STERADIAN_PT_film,
    STERADIAN_PT_motion,
    STERADIAN_PT_performance,
    STERADIAN_PT_passes,
    STERADIAN_PT_lamp,
    STERADIAN_PT_material,
    STERADIAN_PT_world,
)


def _shared() -> list[Any]:
    """Blender's own panels that are drawn for this renderer, too."""
    panels = [panel for panel in bpy.types.Panel.__subclasses__() if hasattr(panel, "COMPAT_ENGINES")]
    return [
        panel
        for panel in panels
        if panel.__name__ in INCLUDED
        or ("BLENDER_RENDER" in panel.COMPAT_ENGINES and not panel.__name__.startswith(EXCLUDED))
    ]


def register() -> None:
    """Shows Blender's own panels for camera, world, output, particles and the like."""
    for panel in _shared():
        panel.COMPAT_ENGINES.add(ENGINE)


def unregister() -> None:
    """Hides them again."""
    for panel in bpy.types.Panel.__subclasses__():
        getattr(panel, "COMPAT_ENGINES", set()).discard(ENGINE)
