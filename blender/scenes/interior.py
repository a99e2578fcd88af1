"""A room with a window, a lamp in its shade, and furniture with bevelled edges."""

from common import camera, empty, lamp, matte, principled, shape, world


def build():
    """Builds the scene."""
    scene = empty()
    world((0.6, 0.75, 1.0), 0.4)
    white, red, wood = (
        matte("White", (0.75, 0.73, 0.7)),
        matte("Red", (0.6, 0.12, 0.08)),
        principled("Wood", base_color=(0.35, 0.18, 0.08), roughness=0.4),
    )
    for name, size, at in (
        ("Floor", (6, 6, 0.1), (0, 0, -0.05)),
        ("Ceiling", (6, 6, 0.1), (0, 0, 3.05)),
        ("Back", (6, 0.1, 3), (0, 3, 1.5)),
        ("Left low", (0.1, 6, 1), (-3, 0, 0.5)),
        ("Left high", (0.1, 6, 0.6), (-3, 0, 2.7)),
        ("Left near", (0.1, 3, 1.4), (-3, -1.5, 1.7)),
        ("Left far", (0.1, 1, 1.4), (-3, 2.5, 1.7)),
        ("Right", (0.1, 6, 3), (3, 0, 1.5)),
    ):
        wall = shape(
            "cube", wood if name == "Floor" else red if name == "Right" else white, size=1, location=at, scale=size
        )
        wall.name = name
    table = shape("cube", wood, size=1, location=(0.6, 1.2, 0.4), scale=(1.6, 0.9, 0.8))
    bevel = table.modifiers.new("Bevel", "BEVEL")
    bevel.width, bevel.segments = 0.06, 3
    shape(
        "uv_sphere",
        principled("Glazed", base_color=(0.1, 0.3, 0.6), roughness=0.15),
        smooth=True,
        radius=0.3,
        location=(0.4, 1.1, 1.1),
    )
    shape(
        "cone",
        principled("Brass", base_color=(0.85, 0.6, 0.25), metallic=1.0, roughness=0.3),
        radius1=0.25,
        depth=0.6,
        location=(1.1, 1.3, 1.1),
    )
    lamp("AREA", 60, (-2.93, 1.0, 1.7), (0, -90, 0), shape="RECTANGLE", size=1.3, size_y=1.8, color=(1.0, 0.95, 0.85))
    lamp("POINT", 25, (1.8, 2.0, 2.2), shadow_soft_size=0.12, color=(1.0, 0.75, 0.5))
    camera((-1.2, -5.5, 1.7), (0.3, 1.0, 1.1), 30)
    return scene


if __name__ == "__main__":
    build()
