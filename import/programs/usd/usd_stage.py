"""A stage of USD as glTF, with insertion points, commands and what physics needs in extras."""

import math
import os

import numpy
from pxr import Ar, Gf, Usd, UsdGeom, UsdLux, UsdPhysics, UsdShade

from usd_absent import Absent
from usd_cameras import add_camera
from usd_gltf import Gltf
from usd_labels import class_of, label_commands
from usd_lights import add_light
from usd_materials import Materials
from usd_matrix import columns, rigid_part
from usd_mesh import Triangles, box_surface, per_corner, plane_surface, smooth_normals, turned_surface, units
from usd_physics import Physics

MAX_PRIMS = 1_000_000
# Prims that are no place in the scene.
NOWHERE = (UsdPhysics.Joint, UsdPhysics.Scene, UsdShade.Material, UsdShade.Shader, UsdShade.NodeGraph, UsdGeom.Subset)
ROUND = (UsdGeom.Sphere, UsdGeom.Cylinder, UsdGeom.Cone, UsdGeom.Capsule)


class Stage:
    def __init__(self, stage, folders):
        self.stage, self.gltf = stage, Gltf()
        self.first, self.seen = {}, {}
        self.time = Usd.TimeCode.EarliestTime()
        self.metres = UsdGeom.GetStageMetersPerUnit(stage)
        if not (math.isfinite(self.metres) and self.metres > 0):
            raise ValueError("metersPerUnit is not above 0")
        self.world = UsdGeom.XformCache(self.time)
        self.absent = Absent(folders)
        self.absent.find_layers(stage)
        self.materials = Materials(self.gltf, self.absent, self.warn)
        self.physics = Physics(self)
        self.meshes, self.names, self.commands, self.classes = {}, {}, [], {}
        self.volumes, self.volume = {}, 0.0  # of the meshes, in m^3 where they are closed
        self.shown = 0  # prims with a mesh
        self.nodes, self.places = {}, {}  # by the path of a prim: its node, and where that stands

    def warn(self, kind, subject, what, details=""):
        """Notes a warning. Equal `what` are one warning, with the subject and the details of the first."""
        self.seen[what] = self.seen.get(what, 0) + 1
        self.first.setdefault(what, f'{kind} "{subject}" {what}{details}')

    def unique(self, name):
        count = self.names[name] = self.names.get(name, 0) + 1
        return name if count == 1 else self.unique(f"{name}_{count}")

    def to_z_up(self):
        turn = numpy.eye(4)
        if UsdGeom.GetStageUpAxis(self.stage) == UsdGeom.Tokens.y:
            turn[:3, :3] = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]
        return turn

    def run(self):
        root = self.add_node(None, "stage", self.to_z_up())
        self.gltf.root["scenes"][0]["nodes"].append(root)
        pseudo = self.stage.GetPseudoRoot()
        self.nodes[pseudo.GetPath()], self.places[pseudo.GetPath()] = root, numpy.eye(4)
        self.physics.find_joints()
        flags = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)
        postponed, walk, count = [], iter(Usd.PrimRange(pseudo, flags)), 0
        for prim in walk:
            count += 1
            if count > MAX_PRIMS:
                raise ValueError(f"has more than {MAX_PRIMS} prims")
            if prim == pseudo:
                continue
            if not self.is_shown(prim):
                walk.PruneChildren()
            elif self.physics.parent_of(prim) is not None:
                postponed.append(prim)
                walk.PruneChildren()
            else:
                self.add_prim(prim, walk)
        self.add_jointed(postponed, flags)
        self.gltf.root["nodes"][root]["extras"] = {"simvis": self.commands + label_commands(self)}
        return self.gltf.bytes(self.physics.description(), self.absent.description(self.shown))

    def counted_warnings(self):
        """One warning for each kind, with the first place."""
        more = {what: f" (and {count - 1} more)" if count > 1 else "" for what, count in self.seen.items()}
        return [text + more[what] for what, text in self.first.items()]

    def add_jointed(self, postponed, flags):
        """Links behind joints, each after the link in front of its joint."""
        while postponed:
            ready = [p for p in postponed if self.physics.parent_of(p) in self.nodes]
            if not ready:
                raise ValueError("joints hold links that are not shown: " + str(postponed[0].GetPath()))
            for prim in ready:
                postponed.remove(prim)
                walk = iter(Usd.PrimRange(prim, flags))
                for each in walk:
                    if not self.is_shown(each):
                        walk.PruneChildren()
                    elif each != prim and self.physics.parent_of(each) is not None:
                        postponed.append(each)
                        walk.PruneChildren()
                    else:
                        self.add_prim(each, walk)

    def is_shown(self, prim):
        if any(prim.IsA(kind) for kind in NOWHERE):
            return False
        if prim.IsA(UsdGeom.PointInstancer):
            return True
        imageable = UsdGeom.Imageable(prim)
        if not imageable:
            return True
        if imageable.GetVisibilityAttr().Get(self.time) == UsdGeom.Tokens.invisible:
            return False
        return imageable.GetPurposeAttr().Get() not in (UsdGeom.Tokens.guide, UsdGeom.Tokens.proxy)

    def add_node(self, parent, name, matrix, **more):
        node = {"name": name, **more}
        if not numpy.array_equal(matrix, numpy.eye(4)):
            if not numpy.isfinite(matrix).all():
                raise ValueError(f'prim "{name}" has a place that is not finite')
            node["matrix"] = [float(x) for x in matrix.T.flatten()]
        number = self.gltf.add("nodes", node)
        if parent is not None:
            self.gltf.root["nodes"][parent].setdefault("children", []).append(number)
        return number

    def add_point(self, node, name, kind="simvis_points"):
        """An insertion point at the frame of a node; `simvis_links`: a link's, `simvis_models`: that of a labelled prim."""
        name = self.unique(name)
        self.gltf.root["nodes"][node].setdefault("extras", {}).setdefault(kind, []).append(name)
        return name

    def world_of(self, prim):
        return columns(self.world.GetLocalToWorldTransform(prim), self.metres)

    def add_prim(self, prim, walk):
        path, label = prim.GetPath(), class_of(prim)
        parent, at = self.physics.place_of(prim) or self.parent_node(prim)
        place = self.world_of(prim) if prim.IsA(UsdGeom.Xformable) else at
        if label or self.physics.is_link(prim):
            frame = rigid_part(place)
            node = self.add_node(parent, prim.GetName(), numpy.linalg.inv(at) @ frame)
            kind = "simvis_links" if self.physics.is_link(prim) else "simvis_models"
            point = self.add_point(node, prim.GetName(), kind)
            self.classes[point] = (path, label, kind)
            self.physics.note_link(prim, point, node)
            self.nodes[path], self.places[path] = node, frame
            parent, at = node, frame
            if numpy.allclose(frame, place, rtol=0, atol=1e-9):
                self.add_content(prim, node, walk)
                return
        node = self.add_node(parent, prim.GetName(), self.local(prim, at, place))
        if path not in self.nodes:
            self.nodes[path], self.places[path] = node, place
        self.add_content(prim, node, walk)

    def parent_node(self, prim):
        above = prim.GetParent().GetPath()
        while above not in self.nodes:
            above = above.GetParentPath()
        return self.nodes[above], self.places[above]

    def local(self, prim, at, place):
        """The matrix as written, unless the node's parent stands elsewhere than the prim's."""
        if prim.IsA(UsdGeom.Xformable) and self.nodes.get(prim.GetParent().GetPath()) is not None:
            matrix, resets = self.world.GetLocalTransformation(prim)
            above = prim.GetParent()
            written = self.world_of(above) if above.IsA(UsdGeom.Xformable) else numpy.eye(4)
            if not resets and numpy.array_equal(at, written):
                return columns(matrix, self.metres)
        return numpy.linalg.inv(at) @ place

    def add_content(self, prim, node, walk):
        if prim.IsA(UsdGeom.PointInstancer):
            self.add_instances(UsdGeom.PointInstancer(prim), node)
            walk.PruneChildren()
        elif prim.IsA(UsdGeom.Gprim):
            self.add_shape(prim, node)
            self.physics.note_collision(prim, self.meshes.get(self.source_of(prim).GetPath()))
        elif prim.IsA(UsdGeom.Camera):
            add_camera(self, UsdGeom.Camera(prim), node)
        elif prim.HasAPI(UsdLux.LightAPI):
            add_light(self, prim, node)

    def add_instances(self, instancer, node):
        matrices = instancer.ComputeInstanceTransformsAtTime(self.time, self.time)
        prototypes = instancer.GetPrototypesRel().GetForwardedTargets()
        numbers = instancer.GetProtoIndicesAttr().Get(self.time) or []
        mask = instancer.ComputeMaskAtTime(self.time)
        if len(mask):
            numbers = [n for n, is_on in zip(numbers, mask) if is_on]
        found = [self.stage.GetPrimAtPath(path) for path in prototypes]
        if any(not 0 <= n < len(found) or not found[n] for n in numbers):
            what = "has instances of a prototype that is not there; it is left out"
            return self.warn("prim", instancer.GetPath(), what)
        for number, matrix in zip(numbers, matrices):
            prototype = found[number]
            # The transform of an instance has that of the prototype's own prim in it.
            self.add_copy(prototype, self.add_node(node, prototype.GetName(), columns(matrix, self.metres)), True)

    def add_copy(self, prim, node, is_first):
        if not self.is_shown(prim):
            return
        if not is_first:
            matrix = self.world.GetLocalTransformation(prim)[0] if prim.IsA(UsdGeom.Xformable) else Gf.Matrix4d(1)
            node = self.add_node(node, prim.GetName(), columns(matrix, self.metres))
        if prim.IsA(UsdGeom.Gprim):
            self.add_shape(prim, node)
        for child in prim.GetFilteredChildren(Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)):
            self.add_copy(child, node, False)

    @staticmethod
    def source_of(prim):
        return prim.GetPrimInPrototype() if prim.IsInstanceProxy() else prim

    def add_shape(self, prim, node):
        source = self.source_of(prim)
        if source.GetPath() not in self.meshes:
            self.meshes[source.GetPath()] = self.make_mesh(source, prim)
        if self.meshes[source.GetPath()] is not None:
            self.gltf.root["nodes"][node]["mesh"] = self.meshes[source.GetPath()]
            self.shown += 1

    def make_mesh(self, source, prim):
        self.volume = 0.0
        try:
            primitives = self.primitives_of(prim)
        except ValueError as wrong:
            raise ValueError(f"prim {prim.GetPath()}: {wrong}") from wrong
        if not primitives:
            return None
        self.volumes[len(self.volumes)] = self.volume
        return self.gltf.add("meshes", {"name": source.GetName(), "primitives": primitives})

    def primitives_of(self, prim):
        if prim.IsA(UsdGeom.Mesh):
            return self.mesh_primitives(UsdGeom.Mesh(prim))
        if prim.IsA(UsdGeom.Points) or prim.IsA(UsdGeom.Curves) or prim.IsA(UsdGeom.NurbsPatch):
            self.warn("prim", prim.GetPath(), f"is of type {prim.GetTypeName()}, which is left out")
            return []
        if prim.IsA(UsdGeom.Cube):
            points, normals, triangles = box_surface([prim.GetAttribute("size").Get(self.time) / 2] * 3)
        elif prim.IsA(UsdGeom.Plane):
            points, normals, triangles = plane_surface(prim, self.time)
        elif any(prim.IsA(kind) for kind in ROUND):
            points, normals, triangles = turned_surface(prim, self.time)
        else:
            self.warn("prim", prim.GetPath(), f"is of type {prim.GetTypeName()}, which is left out")
            return []
        material = self.material_of(prim, prim)[0]
        return [self.primitive(points[triangles], normals[triangles], None, material)]

    def material_of(self, prim, bound):
        gprim = UsdGeom.Gprim(prim)
        colors, opacities = gprim.GetDisplayColorAttr().Get(self.time), gprim.GetDisplayOpacityAttr().Get(self.time)
        color = tuple(float(max(0, min(1, c))) for c in colors[0]) if colors else (0.18, 0.18, 0.18)
        if colors and len(colors) > 1 and prim.IsA(UsdGeom.Mesh):
            color = (1.0, 1.0, 1.0)  # its corners have colours
        opacity = float(max(0, min(1, opacities[0]))) if opacities else 1.0
        # usdview shows both sides of shapes that do not say it.
        sides = gprim.GetDoubleSidedAttr()
        double_sided = not sides.HasAuthoredValue() or bool(sides.Get(self.time))
        return self.materials.of(bound, color, opacity, double_sided)

    def mesh_primitives(self, mesh):
        prim, time = mesh.GetPrim(), self.time
        points = numpy.array(mesh.GetPointsAttr().Get(time) or [], dtype=float).reshape(-1, 3)
        counts, indices = mesh.GetFaceVertexCountsAttr().Get(time), mesh.GetFaceVertexIndicesAttr().Get(time)
        triangles = Triangles(points, counts or [], indices or [])
        if not len(triangles.faces):
            return []
        normals = self.normals_of(mesh, points, triangles)
        if mesh.GetOrientationAttr().Get(time) == UsdGeom.Tokens.leftHanded:
            triangles.points, triangles.corners = triangles.points[:, ::-1], triangles.corners[:, ::-1]
            normals = normals[:, ::-1] if normals is not None else None
        made, colors = [], self.colors_of(prim, triangles)
        for faces, bound in self.subsets_of(mesh, triangles):
            material, uv_name = self.material_of(prim, bound)
            uv = self.uv_of(prim, uv_name, triangles)
            chosen = lambda values: values[faces] if values is not None else None
            shown = chosen(colors) if not self.materials.is_bound(bound) else None
            made.append(self.primitive(points[triangles.points[faces]], chosen(normals), chosen(uv), material, shown))
        return made

    def colors_of(self, prim, triangles):
        """The display colour of each corner, if the prim has several."""
        primvar = UsdGeom.Gprim(prim).GetDisplayColorPrimvar()
        values = primvar.ComputeFlattened(self.time) if primvar.HasValue() else None
        if not values or len(values) < 2:
            return None
        values = numpy.clip(numpy.array(values, dtype=float).reshape(-1, 3), 0, 1)
        return per_corner(values, primvar.GetInterpolation(), triangles, "display colours")

    def subsets_of(self, mesh, triangles):
        """Which triangles have which prim's material."""
        rest, parts = numpy.ones(len(triangles.faces), bool), []
        for subset in UsdGeom.Subset.GetGeomSubsets(mesh, UsdGeom.Tokens.face, "materialBind"):
            own = numpy.isin(triangles.faces, numpy.array(subset.GetIndicesAttr().Get(self.time) or [])) & rest
            rest &= ~own
            if own.any():
                parts.append((own, subset.GetPrim()))
        return parts + ([(rest, mesh.GetPrim())] if rest.any() else [])

    def normals_of(self, mesh, points, triangles):
        primvar = UsdGeom.PrimvarsAPI(mesh).GetPrimvar("normals")
        scheme = mesh.GetSubdivisionSchemeAttr().Get(self.time)
        if scheme != UsdGeom.Tokens.none:
            if scheme and len(points) > 8:
                self.warn("prim", mesh.GetPath(), "is a subdivision surface; its cage is shown, with smooth normals")
            return smooth_normals(points, triangles)
        if primvar and primvar.HasValue():
            values, interpolation = primvar.ComputeFlattened(self.time), primvar.GetInterpolation()
        else:
            values, interpolation = mesh.GetNormalsAttr().Get(self.time), mesh.GetNormalsInterpolation()
        values = numpy.array(values, dtype=float).reshape(-1, 3) if values else None
        normals = per_corner(values, interpolation, triangles, "normals")
        return None if normals is None else units(normals)

    def uv_of(self, prim, name, triangles):
        primvar = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance(name) if name else None
        if not primvar or not primvar.HasValue():
            return None
        values = numpy.array(primvar.ComputeFlattened(self.time), dtype=float).reshape(-1, 2)
        uv = per_corner(values, primvar.GetInterpolation(), triangles, "texture coordinates")
        return None if uv is None else uv * [1, -1] + [0, 1]

    def primitive(self, points, normals, uv, material, colors=None):
        """A primitive of triangles with three corners each; equal corners become one vertex."""
        points = points * self.metres
        self.volume += abs(numpy.einsum("ij,ij->i", points[:, 0], numpy.cross(points[:, 1], points[:, 2])).sum()) / 6
        rows = [points.reshape(-1, 3)]
        rows += [values.reshape(-1, values.shape[-1]) for values in (normals, colors, uv) if values is not None]
        table = numpy.concatenate(rows, axis=1).astype(numpy.float32)
        if not numpy.isfinite(table).all():
            raise ValueError("has a point, normal or texture coordinate that is not finite")
        table, index = numpy.unique(table, axis=0, return_inverse=True)
        attributes = {"POSITION": self.gltf.accessor(numpy.ascontiguousarray(table[:, :3]), "VEC3", True)}
        if normals is not None:
            attributes["NORMAL"] = self.gltf.accessor(numpy.ascontiguousarray(table[:, 3:6]), "VEC3")
        if colors is not None:
            first = 3 if normals is None else 6
            attributes["COLOR_0"] = self.gltf.accessor(numpy.ascontiguousarray(table[:, first : first + 3]), "VEC3")
        if uv is not None:
            attributes["TEXCOORD_0"] = self.gltf.accessor(numpy.ascontiguousarray(table[:, -2:]), "VEC2")
        indices = self.gltf.accessor(index.reshape(-1).astype(numpy.uint32), "SCALAR")
        return {"attributes": attributes, "indices": indices, "material": material}


def read_stage(file, folders):
    stage = Usd.Stage.Open(os.path.abspath(file))
    paths = (layer.realPath for layer in stage.GetUsedLayers())
    inputs = sorted({Ar.SplitPackageRelativePathOuter(path)[0] for path in paths if path})
    made = Stage(stage, folders)
    for each in inputs:
        if made.absent.is_outside(os.path.realpath(each)):
            raise ValueError(f"uses the layer {each}, which is outside the folders of the part")
    content = made.run()
    inputs = sorted({*inputs, *made.materials.files})
    return content, made.absent.warnings() + made.counted_warnings(), inputs
