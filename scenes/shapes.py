"""Closed, counter-clockwise triangle shapes with good normals, from which the scenes' models are put together.

A shape is a list of faces (points, normals, uvs), three of each. Frames: x forward, y left, z up, metres; angles in
degrees. Texture coordinates are metres on the surface; `None` stands for a projection along the nearest axis.
"""
import math


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def unit(v):
    length = math.sqrt(dot(v, v))
    return (v[0] / length, v[1] / length, v[2] / length)


def along(a, b, t):
    return tuple(p + (q - p) * t for p, q in zip(a, b))


_SMALLEST_AREA_M2 = 1e-10  # thinner faces are the collapsed corners of rounded shapes


def _face(points, normals, uvs):
    area = cross(sub(points[1], points[0]), sub(points[2], points[0]))
    if dot(area, area) < 4 * _SMALLEST_AREA_M2 ** 2:
        return []
    return [(tuple(points), tuple(normals) if normals else (unit(area),) * 3, tuple(uvs) if uvs else None)]


def quad(points, normals=None, uvs=None):
    """Two triangles; flat unless normals are given."""
    faces = []
    for corners in ((0, 1, 2), (0, 2, 3)):
        pick = lambda values: [values[c] for c in corners] if values else None
        faces += _face(pick(points), pick(normals), pick(uvs))
    return faces


def picture(width, height):
    """A rectangle in the plane x = 0 that faces +x, with texture coordinates 0..1 (as seen from the front)."""
    y, z = width / 2, height / 2
    return quad([(0, -y, -z), (0, y, -z), (0, y, z), (0, -y, z)], uvs=[(0, 1), (1, 1), (1, 0), (0, 0)])


def box(sx, sy, sz):
    """Centred at the origin."""
    return rounded_box(sx, sy, sz, 0, 0)


def rounded_box(sx, sy, sz, radius, steps=2):
    """Centred at the origin; edges and corners rounded in `steps` steps (none: a plain box)."""
    hx, hy, hz = sx / 2 - radius, sy / 2 - radius, sz / 2 - radius
    if steps == 0:
        radius, hx, hy, hz = 0, sx / 2, sy / 2, sz / 2
        return [f for turn in ((0, 1, 2), (1, 2, 0), (2, 0, 1)) for s in (-1, 1)
                for f in _box_side((hx, hy, hz), turn, s)]
    rings = []
    for sign, start in ((-1, -90), (1, 0)):
        for i in range(steps + 1):
            lat = math.radians(start + 90 * i / steps)
            ring = []
            for quadrant, (qx, qy) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1))):
                for k in range(steps + 1):
                    lon = math.radians(90 * quadrant + 90 * k / steps)
                    n = (math.cos(lat) * math.cos(lon), math.cos(lat) * math.sin(lon), math.sin(lat))
                    ring.append(((qx * hx + radius * n[0], qy * hy + radius * n[1], sign * hz + radius * n[2]), n))
            rings.append(ring)
    faces = _strips(rings)
    s = steps + 1
    for ring, order, n in ((rings[0], (0, 3, 2, 1), (0, 0, -1)), (rings[-1], (0, 1, 2, 3), (0, 0, 1))):
        faces += quad([ring[s * c][0] for c in order], [n] * 4)
    return faces


def _box_side(half, turn, sign):
    def corner(u, v):
        point = [0.0, 0.0, 0.0]
        point[turn[0]], point[turn[1]], point[turn[2]] = u * half[turn[0]], v * half[turn[1]], sign * half[turn[2]]
        return tuple(point)
    corners = [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)]
    return quad(corners if sign > 0 else corners[::-1])


def _strips(rings, uvs=None):
    """Quads between closed rings of (point, normal); each ring lies above the one before it."""
    faces = []
    for i in range(len(rings) - 1):
        count = len(rings[i])
        for k in range(count):
            corners = [(i, k), (i, (k + 1) % count), (i + 1, (k + 1) % count), (i + 1, k)]
            uv = None
            if uvs:
                uv = [uvs(a, b) for a, b in ((i, k), (i, k + 1), (i + 1, k + 1), (i + 1, k))]
            faces += quad([rings[a][b][0] for a, b in corners], [rings[a][b][1] for a, b in corners], uv)
    return faces


def _profile_normals(profile, crease_deg):
    """Per segment the normals at its two ends, as (radial, axial); a corner sharper than the crease stays sharp."""
    segment = []
    for (r0, z0), (r1, z1) in zip(profile, profile[1:]):
        length = math.hypot(r1 - r0, z1 - z0)
        segment.append(((z1 - z0) / length, (r0 - r1) / length))
    limit = math.cos(math.radians(crease_deg))

    def shared(k, other):
        if not 0 <= other < len(segment):
            return segment[k]
        a, b = segment[k], segment[other]
        if a[0] * b[0] + a[1] * b[1] < limit:
            return a
        length = math.hypot(a[0] + b[0], a[1] + b[1])
        return ((a[0] + b[0]) / length, (a[1] + b[1]) / length)
    return [(shared(k, k - 1), shared(k, k + 1)) for k in range(len(segment))]


def lathe(profile, segments=24, crease_deg=50):
    """Turns a profile of (radius, z), going up its outside, about z. Textures run around it, and straight over ends."""
    normals = _profile_normals(profile, crease_deg)
    reference = max(r for r, _ in profile)
    faces, length = [], 0.0
    for k, ((r0, z0), (r1, z1)) in enumerate(zip(profile, profile[1:])):
        step = math.hypot(r1 - r0, z1 - z0)
        rings = []
        for r, z, (nr, nz) in ((r0, z0, normals[k][0]), (r1, z1, normals[k][1])):
            turns = [(math.cos(2 * math.pi * i / segments), math.sin(2 * math.pi * i / segments))
                     for i in range(segments)]
            rings.append([((r * c, r * s, z), (nr * c, nr * s, nz)) for c, s in turns])
        start = length
        around = lambda row, i: (2 * math.pi * reference * i / segments, -(start + row * step))
        faces += _strips(rings, around if z0 != z1 else None)
        length += step
    return faces


def cylinder(radius, height, segments=24, bevel=0.0):
    """About z from z = 0 to `height`, with a rounded rim."""
    b = bevel
    if not b:
        return lathe([(0, 0), (radius, 0), (radius, height), (0, height)], segments)
    c = b * (1 - math.sqrt(0.5))
    return lathe([(0, 0), (radius - b, 0), (radius - c, c), (radius, b), (radius, height - b),
                  (radius - c, height - c), (radius - b, height), (0, height)], segments)


def sphere(radius, segments=16, rings=10):
    return lathe([(radius * math.sin(math.pi * i / rings), -radius * math.cos(math.pi * i / rings))
                  for i in range(rings + 1)], segments)


def filleted(path, radius, steps=4):
    """The path with its inner corners rounded."""
    result = [path[0]]
    for before, corner, after in zip(path, path[1:], path[2:]):
        a, b = unit(sub(before, corner)), unit(sub(after, corner))
        half = math.acos(max(-1.0, min(1.0, dot(a, b)))) / 2
        reach = radius / math.tan(half)
        middle = unit(tuple(p + q for p, q in zip(a, b)))
        centre = tuple(c + m * radius / math.sin(half) for c, m in zip(corner, middle))
        start = sub(tuple(c + v * reach for c, v in zip(corner, a)), centre)
        end = sub(tuple(c + v * reach for c, v in zip(corner, b)), centre)
        angle = math.pi - 2 * half
        for i in range(steps + 1):
            f, g = math.sin(angle * (1 - i / steps)) / math.sin(angle), math.sin(angle * i / steps) / math.sin(angle)
            result.append(tuple(c + f * s + g * e for c, s, e in zip(centre, start, end)))
    return result + [path[-1]]


def tube(path, radius, segments=10):
    """A round bar with flat ends along a path of points."""
    tangents = [unit(sub(path[min(i + 1, len(path) - 1)], path[max(i - 1, 0)])) for i in range(len(path))]
    side = unit(cross(tangents[0], (1, 0, 0) if abs(tangents[0][0]) < 0.9 else (0, 1, 0)))
    rings = []
    for point, t in zip(path, tangents):
        side = unit(tuple(s - t_ * dot(side, t) for s, t_ in zip(side, t)))
        other = cross(t, side)
        ring = []
        for k in range(segments):
            c, s = math.cos(2 * math.pi * k / segments), math.sin(2 * math.pi * k / segments)
            n = tuple(c * a + s * b for a, b in zip(side, other))
            ring.append((tuple(p + radius * v for p, v in zip(point, n)), n))
        rings.append(ring)
    faces = _strips(rings)
    for ring, centre, n in ((rings[0][::-1], path[0], tuple(-v for v in tangents[0])),
                            (rings[-1], path[-1], tangents[-1])):
        for a, b in zip(ring, ring[1:] + ring[:1]):
            faces += _face([centre, a[0], b[0]], [n] * 3, None)
    return faces


def rounded_rectangle(sx, sy, radius, steps=4):
    """An outline: points with normals (x, y, nx, ny), counter-clockwise."""
    outline = []
    for quadrant, (qx, qy) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1))):
        for k in range(steps + 1):
            a = math.radians(90 * quadrant + 90 * k / steps)
            nx, ny = math.cos(a), math.sin(a)
            outline.append((qx * (sx / 2 - radius) + radius * nx, qy * (sy / 2 - radius) + radius * ny, nx, ny))
    return outline


def slab(outline, height, bevel, steps=2):
    """A convex outline, which contains the origin, raised from z = 0 to `height`, its rims rounded."""
    rings = []
    for centre_z, start in ((bevel, -90), (height - bevel, 0)):
        for i in range(steps + 1):
            lat = math.radians(start + 90 * i / steps)
            c, s = math.cos(lat), math.sin(lat)
            rings.append([((x - nx * bevel * (1 - c), y - ny * bevel * (1 - c), centre_z + bevel * s),
                           (c * nx, c * ny, s)) for x, y, nx, ny in outline])
    faces = _strips(rings)
    for ring, n in ((rings[0][::-1], (0, 0, -1)), (rings[-1], (0, 0, 1))):
        for a, b in zip(ring, ring[1:] + ring[:1]):
            faces += _face([(0, 0, a[0][2]), a[0], b[0]], [n] * 3, None)
    return faces


def subdivided(shape):
    """Every face cut in four."""
    faces = []
    for points, normals, uvs in shape:
        mid = lambda v, i, j: along(v[i], v[j], 0.5)
        p = list(points) + [mid(points, 0, 1), mid(points, 1, 2), mid(points, 2, 0)]
        n = list(normals) + [unit(mid(normals, *e)) for e in ((0, 1), (1, 2), (2, 0))]
        t = list(uvs) + [mid(uvs, *e) for e in ((0, 1), (1, 2), (2, 0))] if uvs else None
        for c in ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)):
            faces.append((tuple(p[i] for i in c), tuple(n[i] for i in c), tuple(t[i] for i in c) if t else None))
    return faces


def warped(shape, function):
    """Moves every point by `function`; normals follow by its derivative, taken numerically."""
    h = 1e-5

    def normal(p, n):
        helper = (1, 0, 0) if abs(n[0]) < 0.7 else (0, 1, 0)
        t = unit(cross(helper, n))
        b = cross(n, t)
        step = lambda d: sub(function(tuple(x + h * y for x, y in zip(p, d))),
                             function(tuple(x - h * y for x, y in zip(p, d))))
        return unit(cross(step(t), step(b)))
    return [(tuple(function(p) for p in points), tuple(normal(p, n) for p, n in zip(points, normals)), uvs)
            for points, normals, uvs in with_uvs(shape)]


def with_uvs(shape, swap=False):
    """The shape with projected texture coordinates where it has none; `swap` runs the texture across."""
    faces = []
    for points, normals, uvs in shape:
        if uvs is None:
            n = cross(sub(points[1], points[0]), sub(points[2], points[0]))
            axis = max(range(3), key=lambda i: abs(n[i]))
            u, v = ((1, 2), (0, 2), (0, 1))[axis]
            uvs = tuple((p[v], -p[u]) if swap else (p[u], -p[v]) for p in points)
        faces.append((points, normals, uvs))
    return faces


def grid(us, vs, point, normal, hole=None):
    """A flat surface of cells between the cuts `us` and `vs`: `point(u, v)` places a corner, `normal` gives the side.

    Cells for whose middle `hole(u, v)` is true are left out. Texture coordinates are (u, -v).
    """
    faces = []
    for u0, u1 in zip(us, us[1:]):
        for v0, v1 in zip(vs, vs[1:]):
            if hole and hole((u0 + u1) / 2, (v0 + v1) / 2):
                continue
            corners = [(u0, v0), (u1, v0), (u1, v1), (u0, v1)]
            points = [point(*c) for c in corners]
            if dot(cross(sub(points[1], points[0]), sub(points[2], points[0])), normal) < 0:
                corners, points = corners[::-1], points[::-1]
            faces += quad(points, [normal] * 4, [(u, -v) for u, v in corners])
    return faces


def moved(shape, x, y, z):
    return [(tuple((p[0] + x, p[1] + y, p[2] + z) for p in points), normals, uvs) for points, normals, uvs in shape]


def turned(shape, axis, angle_deg):
    """About the x, y or z axis, by the right hand."""
    c, s = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]

    def turn(v):
        result = list(v)
        result[i], result[j] = c * v[i] - s * v[j], s * v[i] + c * v[j]
        return tuple(result)
    return [(tuple(map(turn, points)), tuple(map(turn, normals)), uvs) for points, normals, uvs in with_uvs(shape)]


class Model:
    """Shapes with materials, to be written as one part."""

    def __init__(self, name):
        self.name = name
        self.faces = {}
        self.lights = []

    def add(self, material, shape, at=(0, 0, 0), swap=False):
        self.faces.setdefault(material, []).extend(moved(with_uvs(shape, swap), *at))

    def merge(self, other, place=lambda shape: shape):
        for material, faces in other.faces.items():
            self.faces.setdefault(material, []).extend(place(faces))

    def triangles(self):
        return sum(map(len, self.faces.values()))

    def check(self):
        """Every face is wound the way its normals point, and no normal is off unit length."""
        for material, faces in self.faces.items():
            for points, normals, _ in faces:
                area = cross(sub(points[1], points[0]), sub(points[2], points[0]))
                assert all(dot(area, n) > 0 for n in normals), (self.name, material.name, points, normals)
                assert all(abs(dot(n, n) - 1) < 1e-6 for n in normals), (self.name, material.name, normals)
