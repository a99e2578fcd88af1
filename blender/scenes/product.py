"""A bottle of glass and metal balls in a studio, with depth of field."""

from common import camera, empty, lamp, matte, principled, shape, world


def build():
    """Builds the scene."""
    scene = empty()
    world(strength=0.6, picture="studio")
    shape("plane", matte("Paper", (0.7, 0.7, 0.72)), size=20)
    shape(
        "uv_sphere",
        principled("Steel", base_color=(0.7, 0.72, 0.75), metallic=1.0, roughness=0.2),
        smooth=True,
        radius=0.5,
        location=(-1.1, 0, 0.5),
    )
    shape(
        "uv_sphere",
        principled("Lacquer", base_color=(0.6, 0.03, 0.03), roughness=0.35, coat_weight=1.0),
        smooth=True,
        radius=0.5,
        location=(0, 0.1, 0.5),
    )
    shape(
        "uv_sphere",
        principled("Glass", transmission_weight=1.0, roughness=0.0, base_color=(1.0, 1.0, 1.0)),
        smooth=True,
        radius=0.5,
        location=(1.1, 0, 0.5),
    )
    shape(
        "torus",
        principled("Rubber", base_color=(0.04, 0.04, 0.05), roughness=0.8),
        smooth=True,
        major_radius=0.4,
        minor_radius=0.12,
        location=(0.4, -1.0, 0.12),
    )
    lamp("AREA", 120, (-2.5, -2.0, 3.0), (45, 0, -50), size=2.5)
    eye = camera((0, -5.0, 1.6), (0, 0, 0.45), 50)
    eye.data.dof.use_dof, eye.data.dof.focus_distance, eye.data.dof.aperture_fstop = True, 5.0, 0.8
    return scene


if __name__ == "__main__":
    build()
