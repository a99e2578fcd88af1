"""A ball that flies past, a fan that turns, and a camera that moves: motion blur."""

from common import camera, empty, lamp, matte, principled, shape, world


def build():
    """Builds the scene."""
    scene = empty()
    world((0.5, 0.55, 0.6), 0.5)
    shape("plane", matte("Ground", (0.5, 0.5, 0.5)), size=20)
    ball = shape("uv_sphere", principled("Ball", base_color=(0.7, 0.1, 0.05), roughness=0.3), smooth=True, radius=0.4)
    fan = shape("cube", matte("Fan", (0.1, 0.3, 0.6)), size=1, scale=(1.6, 0.3, 0.1))
    still = shape("cone", matte("Still", (0.6, 0.6, 0.2)), radius1=0.4, depth=1.0, location=(0, 1.5, 0.5))
    still.name = "Still"
    eye = camera((0, -6.0, 2.0), (0, 0, 0.6), 40)
    for frame, x, turn, height in ((1, -2.4, 0.0, 2.0), (11, 2.4, 2.5, 2.3)):
        ball.location, fan.location = (x, -0.5, 0.6), (1.0, 0.3, 1.2)
        fan.rotation_euler = (1.2, 0.0, turn)
        eye.location.z = height
        for thing, path in ((ball, "location"), (fan, "location"), (fan, "rotation_euler"), (eye, "location")):
            thing.keyframe_insert(path, frame=frame)
    lamp("AREA", 300, (-3, -3, 5), (45, 0, -45), size=1.0)
    scene.render.use_motion_blur = True
    scene.render.motion_blur_shutter = 0.8
    scene.frame_set(5)
    return scene


if __name__ == "__main__":
    build()
