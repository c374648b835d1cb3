"""Joints, masses and collisions of UsdPhysics.

Links are nodes with insertion points. The node of a link behind a joint stands below that of the joint, which stands
below that of the link in front, so that an element `joint` moves all that is behind it.
"""

import math

import numpy
from pxr import Gf, Usd, UsdGeom, UsdPhysics, UsdShade

from usd_matrix import columns, rigid_part

KINDS = {
    "PhysicsRevoluteJoint": "revolute",
    "PhysicsPrismaticJoint": "prismatic",
    "PhysicsFixedJoint": "fixed",
    "PhysicsSphericalJoint": "ball",
}


# Where a joint stands follows from poses; rad or m.
START_ROUNDING = 1e-9


class Joint:
    def __init__(self, prim, kind, parent, child, is_turned):
        self.prim, self.kind, self.parent, self.child, self.is_turned = prim, kind, parent, child, is_turned
        self.name = ""


class Physics:
    def __init__(self, stage):
        self.stage = stage
        self.joints, self.above = [], {}  # by the path of the child
        self.links, self.collisions = {}, []
        self.bodies = set()

    def find_joints(self):
        flags = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)
        for prim in Usd.PrimRange(self.stage.stage.GetPseudoRoot(), flags):
            if prim.HasAPI(UsdPhysics.RigidBodyAPI):
                self.bodies.add(prim.GetPath())
            if prim.IsA(UsdPhysics.Joint):
                self.add_joint(UsdPhysics.Joint(prim))

    def add_joint(self, joint):
        prim, warn = joint.GetPrim(), self.stage.warn
        if joint.GetJointEnabledAttr().Get() is False:
            return
        kind = KINDS.get(prim.GetTypeName())
        ends = [self.body_of(rel) for rel in (joint.GetBody0Rel(), joint.GetBody1Rel())]
        if kind is None:
            return warn("joint", prim.GetPath(), f"is of type {prim.GetTypeName()}, which is left out")
        if ends[0] == ends[1]:
            return warn("joint", prim.GetPath(), "has no two bodies; it is left out")
        if joint.GetExcludeFromArticulationAttr().Get() and kind != "fixed":
            return warn("joint", prim.GetPath(), "is excluded from its articulation; it is left out")
        is_turned = ends[1] is None or ends[1] in self.above
        parent, child = reversed(ends) if is_turned else ends
        if child is None or child in self.above or self.is_behind(parent, child):
            return warn("joint", prim.GetPath(), "closes a circle of joints; it is left out")
        made = Joint(prim, kind, parent, child, is_turned)
        self.joints.append(made)
        self.above[child] = made

    def body_of(self, relation):
        """The rigid body at or above the prim that a joint names; None: the world."""
        targets = relation.GetForwardedTargets()
        prim = self.stage.stage.GetPrimAtPath(targets[0]) if targets else None
        while prim and prim.GetPath() not in self.bodies and not prim.IsPseudoRoot():
            if prim.HasAPI(UsdPhysics.RigidBodyAPI):
                self.bodies.add(prim.GetPath())
                break
            prim = prim.GetParent()
        return None if not prim or prim.IsPseudoRoot() else prim.GetPath()

    def is_behind(self, path, start):
        while path is not None:
            if path == start:
                return True
            path = self.above[path].parent if path in self.above else None
        return False

    def is_link(self, prim):
        return prim.GetPath() in self.bodies

    def parent_of(self, prim):
        """The link in front of a link; None: none is."""
        joint = self.above.get(prim.GetPath())
        return joint.parent if joint else None

    def place_of(self, prim):
        """The node of the joint in front of a link, and where that stands; None: no joint is in front of it."""
        joint = self.above.get(prim.GetPath())
        if joint is None:
            return None
        place = self.joint_place(joint)
        if joint.parent is None:
            node, at = self.stage.parent_node(prim)
        else:
            node, at = self.stage.nodes[joint.parent], self.stage.places[joint.parent]
        own = self.stage.add_node(node, joint.prim.GetName(), numpy.linalg.inv(at) @ place)
        if joint.kind != "fixed":
            joint.name = self.stage.add_point(own, joint.prim.GetName())
            self.add_command(joint)
        return own, place

    def frame_at(self, joint, end):
        """Where a joint stands in the world, by one of its ends."""
        api = UsdPhysics.Joint(joint.prim)
        path = joint.child if (end == 1) != joint.is_turned else joint.parent
        at = api.GetLocalPos0Attr() if end == 0 else api.GetLocalPos1Attr()
        turn = api.GetLocalRot0Attr() if end == 0 else api.GetLocalRot1Attr()
        local = Gf.Matrix4d().SetRotate(Gf.Quatd(turn.Get() or Gf.Quatf(1)).GetNormalized())
        local.SetTranslateOnly(Gf.Vec3d(at.Get() or Gf.Vec3f(0)))
        world = Gf.Matrix4d(1)
        if path is not None:
            world = self.stage.world.GetLocalToWorldTransform(self.stage.stage.GetPrimAtPath(path))
        return rigid_part(columns(local * world, self.stage.metres))

    def joint_place(self, joint):
        return self.frame_at(joint, 0 if joint.is_turned else 1)

    def limits_of(self, joint):
        lower, upper = (joint.prim.GetAttribute("physics:" + name).Get() for name in ("lowerLimit", "upperLimit"))
        if lower is None or upper is None or lower > upper:
            return None
        unit = math.pi / 180 if joint.kind == "revolute" else self.stage.metres
        lower, upper = lower * unit, upper * unit
        start = self.start_of(joint)
        # Values count from the pose of the file. The end that is turned counts the other way.
        lower, upper = (-upper + start, -lower + start) if joint.is_turned else (lower - start, upper - start)
        return [x if math.isfinite(x) else None for x in (lower, upper)]

    def axis_of(self, joint):
        axis = str(joint.prim.GetAttribute("physics:axis").Get() or "X")
        return {"X": [1.0, 0, 0], "Y": [0, 1.0, 0], "Z": [0, 0, 1.0]}[axis]

    def start_of(self, joint):
        """Where the joint stands in the pose of the file, by its two frames."""
        first, second = self.frame_at(joint, 0), self.frame_at(joint, 1)
        between = numpy.linalg.inv(first) @ second
        axis = numpy.array(self.axis_of(joint))
        if joint.kind == "prismatic":
            value = float(axis @ between[:3, 3])
        else:
            i = int(numpy.argmax(axis))
            j, k = (i + 1) % 3, (i + 2) % 3
            value = math.atan2(between[k, j], between[j, j])
        return value

    def add_command(self, joint):
        if joint.kind == "ball":
            self.stage.commands.append(f'<element type="pose" name="{joint.name}" insert_at="{joint.name}"/>')
            return
        axis, limits = self.axis_of(joint), self.limits_of(joint) or [None, None]
        unit = 180 / math.pi if joint.kind == "revolute" else 1
        lower, upper = (-math.inf if limits[0] is None else limits[0], math.inf if limits[1] is None else limits[1])
        # The joint starts at 0, or at the limit nearest to it. Fifteen digits give the degrees of the file back.
        start = min(max(0.0, lower), upper)
        if abs(start) > START_ROUNDING:
            shown = " and ".join(f"{limit * unit:.15g}" for limit in (lower, upper))
            self.stage.warn(
                "joint",
                joint.prim.GetPath(),
                "stands outside of its limits in the file, and starts at the nearest one",
                f": at 0, its limits are {shown} {'deg' if joint.kind == 'revolute' else 'm'} from there",
            )
        numbers = (("lower", lower), ("upper", upper), ("value", start))
        words = "".join(f' {name}="{x * unit:.15g}"' for name, x in numbers if math.isfinite(x))
        self.stage.commands.append(
            f'<element type="joint" name="{joint.name}" insert_at="{joint.name}" kind="{joint.kind}" '
            f'axis="{axis[0]} {axis[1]} {axis[2]}"{words}/>'
        )

    def note_link(self, prim, point, node):
        self.links[prim.GetPath()] = point

    def note_collision(self, prim, mesh):
        if not prim.HasAPI(UsdPhysics.CollisionAPI):
            return
        if UsdPhysics.CollisionAPI(prim).GetCollisionEnabledAttr().Get() is not False:
            self.collisions.append((prim, mesh))

    def link_of(self, prim):
        """The rigid body that a collision belongs to; None: it stands."""
        while prim and not prim.IsPseudoRoot():
            if prim.GetPath() in self.links:
                return prim.GetPath()
            prim = prim.GetParent()
        return None

    def description(self):
        """What physics needs of the file, in metres, kilograms and radians; None: it has none of it."""
        if not self.links and not self.collisions:
            return None
        shapes = {}
        for prim, mesh in self.collisions:
            path = self.link_of(prim)
            frame = numpy.eye(4) if path is None else self.stage.places[path]
            shape = shape_of(self.stage, prim, mesh, numpy.linalg.inv(frame))
            if shape:
                shapes.setdefault(path, []).append(shape)
        turn = self.stage.to_z_up()
        bodies = []
        if None in shapes:
            fixed = [{**s, "matrix": flat(turn @ unflat(s["matrix"]))} for s in shapes[None]]
            bodies.append({"static": True, "links": [{"name": "", "collisions": fixed}], "joints": []})
        for path in self.links:
            joint = self.above.get(path)
            if joint is None or joint.parent is None:
                bodies.append(self.tree(path, shapes, turn))
        return {"bodies": bodies}

    def tree(self, path, shapes, turn):
        """A link and all behind it. A link that a joint holds at the world has an anchor in front."""
        links, joints, numbers = [], [], {}
        if path in self.above:
            links.append({"name": "", "collisions": []})
        order = [path]
        for each in order:
            numbers[each] = len(links)
            links.append(self.link(each, shapes.get(each, [])))
            joint = self.above.get(each)
            if joint is not None:
                at = numpy.eye(4) if joint.parent is None else self.stage.places[joint.parent]
                front = turn if joint.parent is None else numpy.linalg.inv(at)
                joints.append(self.joint(joint, numbers.get(joint.parent, 0), numbers[each], front))
                # The link stands where its frame is, which need not be that of the joint.
                child = numpy.linalg.inv(self.joint_place(joint)) @ self.stage.places[each]
                joints[-1]["joint_from_child"] = flat(child)
            order += [j.child for j in self.joints if j.parent == each and j.child in self.links]
        return {
            "held": path in self.above,
            "point": "" if path in self.above else self.links[path],
            "place": flat(turn if path in self.above else turn @ self.stage.places[path]),
            "links": links,
            "joints": joints,
        }

    def joint(self, joint, parent, child, front):
        limits = (self.limits_of(joint) if joint.kind in ("revolute", "prismatic") else None) or [None, None]
        made = {
            "name": joint.name,
            "kind": joint.kind,
            "parent": parent,
            "child": child,
            "parent_from_joint": flat(front @ self.joint_place(joint)),
            "axis": self.axis_of(joint) if joint.kind in ("revolute", "prismatic") else [1.0, 0, 0],
            "lower": limits[0],
            "upper": limits[1],
        }
        drive = self.drive_of(joint)
        return {**made, "drive": drive} if drive else made

    def drive_of(self, joint):
        name = {"revolute": "angular", "prismatic": "linear"}.get(joint.kind)
        if name is None or not joint.prim.HasAPI(UsdPhysics.DriveAPI, name):
            return None
        drive = UsdPhysics.DriveAPI(joint.prim, name)
        if drive.GetTypeAttr().Get() == "acceleration":
            return self.stage.warn("joint", joint.prim.GetPath(), "has a drive by acceleration, which is left out")
        unit = 180 / math.pi if name == "angular" else 1 / self.stage.metres
        force = drive.GetMaxForceAttr().Get()
        target, speed = drive.GetTargetPositionAttr().Get() or 0.0, drive.GetTargetVelocityAttr().Get() or 0.0
        sign = -1 if joint.is_turned else 1
        return {
            "stiffness": (drive.GetStiffnessAttr().Get() or 0.0) * unit,
            "damping": (drive.GetDampingAttr().Get() or 0.0) * unit,
            "max_effort": force if force is not None and math.isfinite(force) else None,
            "target": sign * (target / unit - self.start_of(joint)),
            "target_speed": sign * speed / unit,
        }

    def link(self, path, shapes):
        prim = self.stage.stage.GetPrimAtPath(path)
        made = {"name": self.links[path], "collisions": shapes}
        mass = UsdPhysics.MassAPI(prim)
        kilograms = mass.GetMassAttr().Get() or 0.0
        inertia, center = mass.GetDiagonalInertiaAttr().Get(), mass.GetCenterOfMassAttr().Get()
        density = mass.GetDensityAttr().Get() or DENSITY
        if UsdPhysics.RigidBodyAPI(prim).GetKinematicEnabledAttr().Get():
            self.stage.warn("body", path, "is kinematic; physics moves it")
        if kilograms > 0 and inertia is not None and any(inertia):
            turn = Gf.Matrix4d().SetRotate(Gf.Quatd(mass.GetPrincipalAxesAttr().Get() or Gf.Quatf(1)).GetNormalized())
            frame = numpy.array(turn, dtype=float).T
            has_center = center is not None and all(math.isfinite(c) for c in center)
            frame[:3, 3] = [c * self.stage.metres for c in center] if has_center else [0, 0, 0]
            made["inertial"] = {
                "mass": kilograms,
                "frame": flat(frame),
                "moments": [i * self.stage.metres**2 for i in inertia],
            }
            return made
        volumes = [shape["volume"] for shape in shapes]
        if sum(volumes) > 0:
            scale = kilograms / sum(volumes) if kilograms > 0 else density
            made["solids"] = [{**shape, "mass": shape["volume"] * scale} for shape in shapes if shape["volume"] > 0]
        elif kilograms > 0:
            self.stage.warn("body", path, "has a mass without an inertia and without a solid; its moments are 1 kg m^2")
            made["inertial"] = {"mass": kilograms, "frame": flat(numpy.eye(4)), "moments": [1.0, 1.0, 1.0]}
        return made


DENSITY = 1000.0  # kg/m^3, UsdPhysics's own


def flat(matrix):
    return [float(x) for x in matrix.T.flatten()]


def unflat(numbers):
    return numpy.array(numbers).reshape(4, 4).T


def shape_of(stage, prim, mesh, link_from_world):
    """A collision, with its scale in its sizes. None: it has no surface."""
    whole = link_from_world @ stage.world_of(prim)
    frame = rigid_part(whole)
    scale = numpy.abs(numpy.diag(numpy.linalg.inv(frame) @ whole)[:3]) * stage.metres
    size = lambda name: prim.GetAttribute(name).Get(stage.time)
    made = {"matrix": flat(frame), **surface_of(prim)}
    if prim.IsA(UsdGeom.Cube):
        edges = [size("size") * s for s in scale]
        return {**made, "kind": "box", "size": edges, "volume": math.prod(edges)}
    uniform = max(scale) - min(scale) < 1e-6 * max(scale)
    if prim.IsA(UsdGeom.Sphere) and uniform:
        r = size("radius") * scale[0]
        return {**made, "kind": "sphere", "size": [r, 0, 0], "volume": 4 / 3 * math.pi * r**3}
    if (prim.IsA(UsdGeom.Cylinder) or prim.IsA(UsdGeom.Capsule)) and uniform:
        r, length = size("radius") * scale[0], size("height") * scale[0]
        turn = {"X": [[0, 0, 1], [1, 0, 0], [0, 1, 0]], "Y": [[0, 1, 0], [0, 0, 1], [1, 0, 0]], "Z": numpy.eye(3)}
        frame[:3, :3] = frame[:3, :3] @ numpy.array(turn[str(size("axis"))])
        is_capsule = prim.IsA(UsdGeom.Capsule)
        volume = math.pi * r * r * (length + (4 / 3 * r if is_capsule else 0))
        kind = "capsule" if is_capsule else "cylinder"
        return {**made, "matrix": flat(frame), "kind": kind, "size": [r, 0, length], "volume": volume}
    if prim.IsA(UsdGeom.Plane):
        turn = {"X": [[0, 0, 1], [1, 0, 0], [0, 1, 0]], "Y": [[0, 1, 0], [0, 0, 1], [1, 0, 0]], "Z": numpy.eye(3)}
        frame[:3, :3] = frame[:3, :3] @ numpy.array(turn[str(size("axis"))])
        return {**made, "matrix": flat(frame), "kind": "plane", "size": [0, 0, 0], "volume": 0.0}
    if mesh is None:
        return None
    # The mesh has metres already, and the rest of the scale and shear stands in its matrix.
    stretch = numpy.linalg.inv(frame) @ whole
    stretch[:3, 3] = 0
    volume = stage.volumes[mesh] * abs(numpy.linalg.det(stretch))
    return {**made, "kind": "mesh", "mesh": mesh, "stretch": flat(stretch), "size": [1, 1, 1], "volume": float(volume)}


def surface_of(prim):
    material = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial("physics")[0]
    if not material or not material.GetPrim().HasAPI(UsdPhysics.MaterialAPI):
        return {}
    api = UsdPhysics.MaterialAPI(material.GetPrim())
    # Two surfaces multiply their numbers here.
    friction, restitution = api.GetDynamicFrictionAttr().Get() or 0.0, api.GetRestitutionAttr().Get() or 0.0
    return {"friction": math.sqrt(max(friction, 0.0)), "restitution": math.sqrt(min(max(restitution, 0.0), 1.0))}
