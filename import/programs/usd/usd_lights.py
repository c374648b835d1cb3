"""Lights of UsdLux as those of KHR_lights_punctual, and as an element `sky`.

UsdLux gives the luminance L of the light's surface. A distant light of half angle a brings pi L sin(a)^2 lux, a sphere
of radius r has pi r^2 L candela, and a flat light of area A has A L straight on.
"""

import math

from pxr import Gf, UsdGeom, UsdLux


def add_light(stage, prim, node):
    light, value = UsdLux.LightAPI(prim), lambda name: prim.GetAttribute("inputs:" + name).Get(stage.time)
    luminance = value("intensity") * 2.0 ** min(value("exposure") or 0, 1000)
    color = [max(0.0, float(c)) for c in (value("color") or Gf.Vec3f(1))]
    if not all(math.isfinite(x) for x in (luminance, *color)):
        raise ValueError(f"light {prim.GetPath()} has an intensity or a colour that is not finite")
    if value("enableColorTemperature"):
        stage.warn("light", prim.GetPath(), "is shown without its colour temperature")
    if prim.IsA(UsdLux.DomeLight):
        return add_dome(stage, prim, color, luminance)
    kind, strength = strength_of(stage, prim, value, luminance, bool(value("normalize")))
    if kind is None:
        return stage.warn("light", prim.GetPath(), f"is of type {prim.GetTypeName()}, which is left out")
    largest = max([*color, 1.0])
    made = {"type": kind, "color": [c / largest for c in color], "intensity": float(strength * largest)}
    shaping = UsdLux.ShapingAPI(prim) if prim.HasAPI(UsdLux.ShapingAPI) else None
    if kind == "point" and shaping and value("shaping:cone:angle") is not None and value("shaping:cone:angle") < 90:
        outer = math.radians(max(value("shaping:cone:angle"), 0.01))
        made["type"] = "spot"
        softness = min(max(value("shaping:cone:softness") or 0, 0.001), 1)
        made["spot"] = {"outerConeAngle": outer, "innerConeAngle": outer * (1 - softness)}
    root, extension = stage.gltf.root, "KHR_lights_punctual"
    stage.gltf.use(extension)
    lights = root.setdefault("extensions", {}).setdefault(extension, {}).setdefault("lights", [])
    lights.append(made)
    stage.gltf.root["nodes"][node].setdefault("extensions", {})[extension] = {"light": len(lights) - 1}


def strength_of(stage, prim, value, luminance, is_normalized):
    metres = stage.metres
    if prim.IsA(UsdLux.DistantLight):
        sine = math.sin(math.radians(min(value("angle") or 0, 360)) / 2)
        return "directional", luminance * (1 if is_normalized or sine == 0 else math.pi * sine * sine)
    if prim.IsA(UsdLux.SphereLight):
        r = value("radius") * metres
        if prim.GetAttribute("treatAsPoint").Get(stage.time) or r == 0:
            return "point", luminance
        return "point", luminance / 4 if is_normalized else luminance * math.pi * r * r
    area = None
    if prim.IsA(UsdLux.DiskLight):
        area = math.pi * (value("radius") * metres) ** 2
    if prim.IsA(UsdLux.RectLight):
        area = value("width") * value("height") * metres * metres
    if area is None:
        return None, 0
    stage.warn("light", prim.GetPath(), "has an area; it shines from its middle to all sides")
    return "point", luminance if is_normalized else luminance * area


def add_dome(stage, prim, color, luminance):
    if prim.GetAttribute("inputs:texture:file").Get(stage.time):
        stage.warn("light", prim.GetPath(), "is a dome with a picture, whose mean is taken as white")
    name = stage.unique(prim.GetName())
    numbers = " ".join(
        f'{prefix}{channel}="{c * luminance!r}"'
        for prefix in ("", "ambient_")
        for channel, c in zip(("red", "green", "blue"), color)
    )
    stage.commands.append(f'<element type="sky" name="{name}" {numbers}/>')
