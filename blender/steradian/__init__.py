"""Steradian, a physically based renderer, as a render engine of Blender."""

from . import engine, operators, panels, settings

CLASSES = (engine.SteradianEngine, *panels.CLASSES, *operators.CLASSES)


def register() -> None:
    """Called by Blender when the extension is enabled."""
    import bpy

    settings.register()
    for each in CLASSES:
        bpy.utils.register_class(each)
    panels.register()
    operators.register()


def unregister() -> None:
    """Called by Blender when the extension is disabled."""
    import bpy

    operators.unregister()
    panels.unregister()
    for each in reversed(CLASSES):
        bpy.utils.unregister_class(each)
    settings.unregister()
