"""Cameras of USD as sensors, with the f-theta lenses of Omniverse."""

import math

import numpy
from pxr import UsdGeom

WIDTH = 640  # of the picture of a camera whose file has no size in pixels
MAX_PIXELS = 16384
LENS = "omni:lensdistortion:"


def add_camera(stage, camera, node):
    turn = numpy.array([[0, -1, 0, 0], [0, 0, 1, 0], [-1, 0, 0, 0], [0, 0, 0, 1.0]])
    name = camera.GetPrim().GetName()
    point = stage.add_point(stage.add_node(node, name, turn), name)
    wide, high = camera.GetHorizontalApertureAttr().Get(stage.time), camera.GetVerticalApertureAttr().Get(stage.time)
    length = camera.GetFocalLengthAttr().Get(stage.time)
    if camera.GetProjectionAttr().Get(stage.time) != UsdGeom.Tokens.perspective or not min(wide, high, length) > 0:
        return stage.warn("camera", name, "has no perspective; it is left out")
    near = camera.GetClippingRangeAttr().Get(stage.time)[0] * stage.metres
    across = camera.GetHorizontalApertureOffsetAttr().Get(stage.time) or 0
    up = camera.GetVerticalApertureOffsetAttr().Get(stage.time) or 0
    if not math.isfinite(across + up):
        return stage.warn("camera", name, "has an offset of its aperture that is not finite; it is left out")
    pixels = ftheta(stage, camera.GetPrim()) or pinhole(wide, high, length, across, up)
    stage.commands.append(
        f'<sensor type="camera" name="{point}" insert_at="{point}" {pixels} near="{max(near, 1e-6)!r}"/>'
    )


def pinhole(wide, high, length, across, up):
    rows = max(1, round(WIDTH * high / wide))
    size = f'width="{WIDTH}" height="{rows}"'
    if not (across or up):
        return f'{size} hfov="{math.degrees(2 * math.atan(wide / (2 * length)))!r}"'
    # The aperture is moved, and the optical axis in the picture the other way.
    focal = WIDTH * length / wide
    cx, cy = WIDTH * (0.5 - across / wide) - 0.5, rows / 2 + focal * up / length - 0.5
    return f'{size} fx="{focal!r}" cx="{cx!r}" cy="{cy!r}"'


def ftheta(stage, prim):
    """The attributes of a lens with the schema OmniLensDistortionFthetaAPI: its polynomial leads from pixels to angles,
    and pixels count from the centre of the first one. None: the camera is a pinhole."""
    model = prim.GetAttribute(LENS + "model").Get(stage.time)
    if model is None:
        return None
    names = ["nominalWidth", "nominalHeight", "opticalCenter", "k0", "k1", "k2", "k3", "k4"]
    values = [prim.GetAttribute(f"{LENS}ftheta:{name}").Get(stage.time) for name in names]
    if model != "ftheta" or None in values or not fills_picture(*values[:3], values[3:]):
        return stage.warn("camera", prim.GetName(), "has a lens that is not taken over; it is a pinhole")
    (width, height, centre), polynomial = values[:3], " ".join(repr(float(k)) for k in values[3:])
    return (f'width="{round(width)}" height="{round(height)}" cx="{float(centre[0])!r}" cy="{float(centre[1])!r}" '
            f'distortion="ftheta_backward" polynomial="{polynomial}"')


def fills_picture(width, height, centre, k):
    """Whether the polynomial is 0 on the axis and rises up to the corner that is farthest from it."""
    if not (all(map(math.isfinite, [width, height, *centre, *k])) and k[0] == 0):
        return False
    if not (1 <= round(width) <= MAX_PIXELS and 1 <= round(height) <= MAX_PIXELS):
        return False
    corner = math.hypot(max(abs(centre[0]), abs(width - centre[0])), max(abs(centre[1]), abs(height - centre[1])))
    radius = numpy.linspace(0, corner + 1, 1000)
    return bool((sum(i * k[i] * radius ** (i - 1) for i in range(1, len(k))) > 0).all())
