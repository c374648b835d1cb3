"""Meshes and round shapes of USD as triangles."""

import math

import numpy
from pxr import Gf, UsdGeom

SECTORS, RINGS = 48, 24


class Triangles:
    """Corners of triangles: into the points, and into the corners and faces of the file."""

    def __init__(self, points, counts, indices):
        counts, indices = numpy.asarray(counts, numpy.int64), numpy.asarray(indices, numpy.int64)
        if len(counts) and (counts.min() < 0 or counts.sum() != len(indices)):
            raise ValueError("faceVertexCounts do not fit faceVertexIndices")
        if len(indices) and (indices.min() < 0 or indices.max() >= len(points)):
            raise ValueError("faceVertexIndices beyond the points")
        first = numpy.concatenate([[0], numpy.cumsum(counts)])[:-1].astype(numpy.int64)
        fans = numpy.maximum(counts - 2, 0)
        self.faces = numpy.repeat(numpy.arange(len(counts)), fans)
        within = numpy.arange(fans.sum()) - numpy.repeat(numpy.cumsum(fans) - fans, fans)
        start = first[self.faces]
        self.corners = numpy.stack([start, start + within + 1, start + within + 2], axis=1)
        self._cut_concave(points, indices, first, counts)
        self.points = indices[self.corners] if len(self.corners) else self.corners

    def _cut_concave(self, points, indices, first, counts):
        """Polygons whose fan has a triangle that is turned over are cut ear by ear."""
        if not len(self.corners):
            return
        at = points[indices[self.corners]]
        across = numpy.cross(at[:, 1] - at[:, 0], at[:, 2] - at[:, 0])
        whole = numpy.zeros((len(counts), 3))
        numpy.add.at(whole, self.faces, across)
        turned = numpy.einsum("ij,ij->i", across, whole[self.faces]) < 0
        for face in numpy.unique(self.faces[turned]):
            corners = list(range(first[face], first[face] + counts[face]))
            cut = cut_ears(points[indices[corners]], whole[face])
            self.corners[self.faces == face] = [[corners[i] for i in ear] for ear in cut]


def cut_ears(at, normal):
    left, ears = list(range(len(at))), []
    while len(left) > 3:
        for i in range(len(left)):
            a, b, c = left[i - 1], left[i], left[(i + 1) % len(left)]
            if numpy.dot(numpy.cross(at[b] - at[a], at[c] - at[a]), normal) <= 0:
                continue
            others = at[[p for p in left if p not in (a, b, c)]]
            if not are_inside(others, at[a], at[b], at[c], normal).any():
                break
        else:
            i = 0
        ears.append([left[i - 1], left[i], left[(i + 1) % len(left)]])
        del left[i]
    return ears + [left]


def are_inside(points, a, b, c, normal):
    """Which of the points are within a triangle or on its edges."""
    sides = [(points - o) @ numpy.cross(normal, q - o) >= 0 for o, q in ((a, b), (b, c), (c, a))]
    return sides[0] & sides[1] & sides[2]


def per_corner(values, interpolation, triangles, what):
    """The values of each corner of the triangles, three each. None: there are none that fit."""
    if values is None or not len(values):
        return None
    if interpolation == UsdGeom.Tokens.faceVarying:
        index = triangles.corners
    elif interpolation in (UsdGeom.Tokens.vertex, UsdGeom.Tokens.varying):
        index = triangles.points
    elif interpolation == UsdGeom.Tokens.uniform:
        index = numpy.repeat(triangles.faces[:, None], 3, axis=1)
    else:
        index = numpy.zeros_like(triangles.points)
    if len(index) and index.max() >= len(values):
        raise ValueError(what + " are fewer than their interpolation " + str(interpolation) + " needs")
    return values[index]


def smooth_normals(points, triangles):
    at = points[triangles.points]
    across = numpy.cross(at[:, 1] - at[:, 0], at[:, 2] - at[:, 0])
    normals = numpy.zeros((len(points), 3))
    for corner in range(3):
        numpy.add.at(normals, triangles.points[:, corner], across)
    return units(normals)[triangles.points]


def units(vectors):
    length = numpy.linalg.norm(vectors, axis=-1, keepdims=True)
    return numpy.where(length > 0, vectors / numpy.where(length > 0, length, 1), [0.0, 0.0, 1.0])


def profile_of(prim, time):
    """Half a section through a round shape, from its lower end to its upper one, as radius, height and normal."""
    half = math.pi / 2
    size = lambda name: prim.GetAttribute(name).Get(time)
    if prim.IsA(UsdGeom.Sphere):
        r = size("radius")
        angles = [half * (2 * i / RINGS - 1) for i in range(RINGS + 1)]
        return [[(r * math.cos(a), r * math.sin(a), math.cos(a), math.sin(a)) for a in angles]]
    r, h = size("radius"), size("height")
    if prim.IsA(UsdGeom.Cylinder):
        return [
            [(0, -h / 2, 0, -1), (r, -h / 2, 0, -1)],
            [(r, -h / 2, 1, 0), (r, h / 2, 1, 0)],
            [(r, h / 2, 0, 1), (0, h / 2, 0, 1)],
        ]
    if prim.IsA(UsdGeom.Cone):
        slant = math.hypot(r, h)
        outwards, upwards = h / slant, r / slant
        return [
            [(0, -h / 2, 0, -1), (r, -h / 2, 0, -1)],
            [(r, -h / 2, outwards, upwards), (0, h / 2, outwards, upwards)],
        ]
    lower = [half * (i / RINGS - 1) for i in range(RINGS + 1)]
    upper = [half * i / RINGS for i in range(RINGS + 1)]
    ball = lambda angles, z: [(r * math.cos(a), z + r * math.sin(a), math.cos(a), math.sin(a)) for a in angles]
    return [ball(lower, -h / 2) + ball(upper, h / 2)]


def turned_surface(prim, time):
    """The surface that a profile makes about the shape's axis: points, normals and triangles."""
    points, normals, triangles = [], [], []
    for strip in profile_of(prim, time):
        start = len(points)
        for radius, height, outwards, upwards in strip:
            for i in range(SECTORS + 1):
                c, s = math.cos(2 * math.pi * i / SECTORS), math.sin(2 * math.pi * i / SECTORS)
                points.append((radius * c, radius * s, height))
                normals.append((outwards * c, outwards * s, upwards))
        row = SECTORS + 1
        for k in range(len(strip) - 1):
            for i in range(SECTORS):
                a = start + k * row + i
                if strip[k][0] > 0:
                    triangles.append((a, a + 1, a + row + 1))
                if strip[k + 1][0] > 0:
                    triangles.append((a, a + row + 1, a + row))
    axis = prim.GetAttribute("axis").Get(time) if prim.HasAttribute("axis") else "Z"
    turn = {"X": [2, 0, 1], "Y": [1, 2, 0], "Z": [0, 1, 2]}[str(axis)]
    return numpy.array(points)[:, turn], numpy.array(normals)[:, turn], numpy.array(triangles)


def box_surface(half):
    points, normals, triangles = [], [], []
    for axis in range(3):
        for side in (-1, 1):
            u, v = (axis + 1) % 3, (axis + 2) % 3
            start = len(points)
            for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                corner, normal = [0.0] * 3, [0.0] * 3
                corner[axis], corner[u], corner[v], normal[axis] = side, a, b, side
                points.append([c * h for c, h in zip(corner, half)])
                normals.append(normal)
            ring = (0, 1, 2, 3) if side > 0 else (0, 3, 2, 1)
            triangles += [[start + ring[i] for i in ear] for ear in ((0, 1, 2), (0, 2, 3))]
    return numpy.array(points), numpy.array(normals), numpy.array(triangles)


def plane_surface(prim, time):
    w, l = prim.GetAttribute("width").Get(time) / 2, prim.GetAttribute("length").Get(time) / 2
    axis = {"X": 0, "Y": 1, "Z": 2}[str(prim.GetAttribute("axis").Get(time))]
    u, v = {0: (2, 1), 1: (0, 2), 2: (0, 1)}[axis]
    points, normal = numpy.zeros((4, 3)), [0.0] * 3
    normal[axis] = 1.0
    for i, (a, b) in enumerate(((-w, -l), (w, -l), (w, l), (-w, l))):
        points[i, u], points[i, v] = a, b
    triangles = numpy.array([[0, 1, 2], [0, 2, 3]])
    across = numpy.cross(points[1] - points[0], points[2] - points[0])
    return points, numpy.array([normal] * 4), triangles if across[axis] > 0 else triangles[:, ::-1]
