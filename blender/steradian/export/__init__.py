"""From Blender's dependency graph to the scene language."""
