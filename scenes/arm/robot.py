"""The arm: its meshes, each in the frame of its link, and its URDF."""
import math

import mesh_writer
from kinematics import (FINGER, FINGERS, FOREARM, GRIP_MAX, HAND, LIMITS, SHOULDER_Z, UPPER_ARM, UPPER_ARM_Z, WRIST)
from shapes import cylinder, lathe, moved, rounded_box, rounded_rectangle, slab, turned

COLORS = {"shell": "#e8ebee", "joint": "#ee7f1a", "dark": "#33383f", "steel": "#a9b0b6", "rubber": "#1d1f22",
          "lens": "#16263f"}
SEGMENTS = 40


class Mesh:
    """Shapes by material, as shapes.Model has them, but named as in the MTL file."""

    def __init__(self):
        self.faces = {}

    def add(self, material, shape, at=(0, 0, 0)):
        self.faces.setdefault(material, []).extend(moved(shape, *at))
        return self

    def triangles(self):
        return sum(map(len, self.faces.values()))


def along_x(shape):
    return turned(shape, "y", 90)


def along_y(shape):
    return turned(shape, "x", -90)


def barrel(radius, height, bevel=0.006):
    return cylinder(radius, height, SEGMENTS, bevel)


def bracket(mesh, at, y0, y1, radius):
    """A joint's housing about y, with coloured lids."""
    x, _, z = at
    mesh.add("shell", along_y(barrel(radius, y1 - y0)), (x, y0, z))
    for y, height in ((y0 - 0.006, 0.008), (y1 - 0.002, 0.008)):
        mesh.add("joint", along_y(barrel(radius * 0.8, height, 0.002)), (x, y, z))


def base():
    mesh = Mesh()
    mesh.add("dark", lathe([(0, 0), (0.105, 0), (0.108, 0.004), (0.108, 0.014), (0.104, 0.018), (0.085, 0.02),
                            (0.078, 0.026), (0.074, 0.08), (0, 0.08)], SEGMENTS))
    mesh.add("joint", barrel(0.077, 0.012, 0.003), (0, 0, 0.074))
    mesh.add("dark", barrel(0.07, 0.02, 0.002), (0, 0, SHOULDER_Z - 0.02))
    for i in range(6):
        a = math.radians(60 * i + 30)
        mesh.add("steel", cylinder(0.006, 0.005, 6, 0), (0.096 * math.cos(a), 0.096 * math.sin(a), 0.016))
    return mesh


def turret():
    mesh = Mesh()
    mesh.add("shell", lathe([(0, 0), (0.068, 0), (0.072, 0.004), (0.072, 0.05), (0.06, 0.085), (0.045, 0.11),
                             (0, 0.11)], SEGMENTS))
    bracket(mesh, (0, 0, UPPER_ARM_Z), -0.062, 0.062, 0.062)
    return mesh


def upper_arm():
    """Beside the turret and the elbow, so that it can turn past both."""
    mesh = Mesh()
    y0, y1 = 0.07, 0.155
    bracket(mesh, (0, 0, 0), y0, y1, 0.058)
    bracket(mesh, (0, 0, UPPER_ARM), y0, y1, 0.05)
    tube = lathe([(0, 0), (0.044, 0), (0.039, UPPER_ARM), (0, UPPER_ARM)], SEGMENTS)
    mesh.add("shell", tube, (0, (y0 + y1) / 2, 0))
    for z in (0.075, UPPER_ARM - 0.07):
        mesh.add("joint", barrel(0.046, 0.01, 0.003), (0, (y0 + y1) / 2, z))
    return mesh


def forearm():
    mesh = Mesh()
    bracket(mesh, (0, 0, 0), -0.05, 0.062, 0.05)
    mesh.add("shell", along_x(lathe([(0, 0), (0.04, 0), (0.036, FOREARM - 0.02), (0, FOREARM - 0.02)], SEGMENTS)))
    mesh.add("joint", along_x(barrel(0.041, 0.01, 0.003)), (0.07, 0, 0))
    mesh.add("dark", along_x(barrel(0.034, 0.02, 0.002)), (FOREARM - 0.02, 0, 0))
    return mesh


def forearm_roll():
    """A fork that holds the wrist."""
    mesh = Mesh()
    mesh.add("shell", along_x(barrel(0.036, 0.035, 0.004)))
    mesh.add("shell", rounded_box(0.03, 0.098, 0.05, 0.006, 3), (0.038, 0, 0))
    for side in (-1, 1):
        outline = rounded_rectangle(WRIST + 0.028 - 0.03, 0.056, 0.0279, 8)
        plate = along_y(slab(outline, 0.012, 0.003))
        mesh.add("shell", plate, (0.03 + (WRIST - 0.002) / 2, 0.043 if side > 0 else -0.055, 0))
        lid = along_y(barrel(0.02, 0.008, 0.002))
        mesh.add("joint", lid, (WRIST, 0.051 if side > 0 else -0.059, 0))
    return mesh


def wrist():
    mesh = Mesh()
    mesh.add("dark", along_y(barrel(0.032, 0.08, 0.004)), (0, -0.04, 0))
    mesh.add("shell", along_x(barrel(0.03, HAND - 0.012, 0.003)))
    mesh.add("joint", along_x(barrel(0.033, 0.012, 0.003)), (HAND - 0.012, 0, 0))
    return mesh


def hand():
    mesh = Mesh()
    mesh.add("steel", along_x(barrel(0.034, 0.012, 0.002)))
    mesh.add("shell", rounded_box(0.04, 0.11, 0.05, 0.01, 3), (0.03, 0, 0))
    mesh.add("dark", rounded_box(0.016, 0.118, 0.03, 0.003, 2), (FINGERS - 0.008, 0, 0))
    # The camera, above the fingers and bent a little towards their tips; see the joint CAMERA_MOUNT.
    mesh.add("dark", rounded_box(0.03, 0.05, 0.026, 0.005, 2), (0.03, 0, 0.038))
    mesh.add("dark", turned(along_x(barrel(0.012, 0.02, 0.002)), "y", 18), (0.036, 0, 0.041))
    mesh.add("lens", turned(along_x(barrel(0.009, 0.002, 0.0005)), "y", 18), (0.0549, 0, 0.0348))
    return mesh


def finger():
    """The left one, which touches at y = 0; the right one is its mirror image."""
    shape = rounded_box(0.03, 0.022, 0.024, 0.003, 2)
    shape = moved(shape, 0.01, 0.013, 0) + moved(rounded_box(FINGER, 0.01, 0.02, 0.003, 2), FINGER / 2, 0.0072, 0)
    return shape


def pad():
    return moved(rounded_box(0.026, 0.003, 0.016, 0.0012, 1), FINGER - 0.015, 0.0016, 0)


def files():
    """The meshes by their names in the folder, and the triangles of each."""
    made, triangles = {"meshes/robot.mtl": mesh_writer.mtl(COLORS).encode()}, {}
    for make in (base, turret, upper_arm, forearm, forearm_roll, wrist, hand):
        mesh, name = make(), f"meshes/{make.__name__}.obj"
        made[name] = mesh_writer.obj(make.__name__, mesh.faces).encode()
        triangles[name] = mesh.triangles()
    for make in (finger, pad):
        shape, name = make(), f"meshes/{make.__name__}.stl"
        made[name] = mesh_writer.stl(make.__name__, shape)
        triangles[name] = len(shape)
    made["arm.urdf"] = urdf().encode()
    return made, triangles


def _rgba(color):
    return " ".join(f"{int(color[i:i + 2], 16) / 255:.4f}" for i in (1, 3, 5)) + " 1"


def _link(name, *visuals):
    if not visuals:
        return [f'  <link name="{name}"/>']
    lines = [f'  <link name="{name}">']
    for file, extra in visuals:
        scale, material = extra
        lines += ["    <visual>", f'      <geometry><mesh filename="meshes/{file}"{scale}/></geometry>']
        lines += [f'      <material name="{material}"/>'] if material else []
        lines += ["    </visual>"]
    return lines + ["  </link>"]


def _joint(name, kind, parent, child, xyz, axis=None, limits=None, more=()):
    lines = [f'  <joint name="{name}" type="{kind}">', f'    <parent link="{parent}"/>', f'    <child link="{child}"/>']
    lines += [f'    <origin xyz="{xyz}"/>' if isinstance(xyz, str) else f'    <origin xyz="{xyz[0]}" rpy="{xyz[1]}"/>']
    lines += [f'    <axis xyz="{axis}"/>'] if axis else []
    if limits:
        lines += [f'    <limit lower="{limits[0]!r}" upper="{limits[1]!r}" effort="20" velocity="2"/>']
    return lines + [f"    {line}" for line in more] + ["  </joint>"]


def urdf():
    own = ("", None)
    lines = ['<?xml version="1.0"?>', "<!-- Made by generate.py: an arm with six joints and a gripper, whose right "
             "finger follows the left one. -->", '<robot name="arm">']
    for name in ("steel", "rubber"):
        lines += [f'  <material name="{name}"><color rgba="{_rgba(COLORS[name])}"/></material>']
    names = ("base", "turret", "upper_arm", "forearm", "forearm_roll", "wrist", "hand")
    for name in names:
        lines += _link(name, (f"{name}.obj", own))
    mirror = ' scale="1 -1 1"'
    lines += _link("left_finger", ("finger.stl", ("", "steel")), ("pad.stl", ("", "rubber")))
    lines += _link("right_finger", ("finger.stl", (mirror, "steel")), ("pad.stl", (mirror, "rubber")))
    lines += _link("camera")
    places = (f"0 0 {SHOULDER_Z}", f"0 0 {UPPER_ARM_Z}", f"0 0 {UPPER_ARM}", f"{FOREARM} 0 0", f"{WRIST} 0 0",
              f"{HAND} 0 0")
    axes = ("0 0 1", "0 1 0", "0 1 0", "1 0 0", "0 1 0", "1 0 0")
    for i, (name, limits) in enumerate(LIMITS.items()):
        lines += _joint(name, "revolute", names[i], names[i + 1], places[i], axes[i],
                        [math.radians(v) for v in limits])
    lines += _joint("GRIP", "prismatic", "hand", "left_finger", f"{FINGERS} 0 0", "0 1 0", (0.0, GRIP_MAX))
    lines += _joint("GRIP_RIGHT", "prismatic", "hand", "right_finger", f"{FINGERS} 0 0", "0 -1 0", (0.0, GRIP_MAX),
                    ['<mimic joint="GRIP"/>'])
    lines += _joint("CAMERA_MOUNT", "fixed", "hand", "camera", ("0.0565 0 0.0343", f"0 {math.radians(18)!r} 0"))
    return "\n".join(lines + ["</robot>"]) + "\n"
