"""Writes OBJ files with their materials, and binary STL, with the Python standard library alone.

Shapes are those of shapes.py, z up, metres; the same shapes give the same bytes.
"""
import struct

DECIMALS = 5  # 10 micrometres


def _number(value, decimals=DECIMALS):
    text = f"{value:.{decimals}f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text


class _Table:
    """Lines of one kind, each once, counted from 1 as OBJ does."""

    def __init__(self):
        self.lines = {}

    def index(self, line):
        return self.lines.setdefault(line, len(self.lines) + 1)


def obj(name, faces_by_material):
    """The text of NAME.obj, whose materials are in robot.mtl; every face has its normals."""
    points, normals, faces = _Table(), _Table(), []
    for material, shape in faces_by_material.items():
        faces.append(f"usemtl {material}")
        for corners, directions, _ in shape:
            words = []
            for point, normal in zip(corners, directions):
                v = points.index(" ".join(_number(c) for c in point))
                n = normals.index(" ".join(_number(c, 3) for c in normal))
                words.append(f"{v}//{n}")
            if len({w.split("/")[0] for w in words}) == 3:
                faces.append("f " + " ".join(words))
    lines = ["mtllib robot.mtl", f"o {name}"]
    lines += ["v " + line for line in points.lines] + ["vn " + line for line in normals.lines] + faces
    return "\n".join(lines) + "\n"


def mtl(colors):
    """The text of an MTL file: names with sRGB colours, "#rrggbb"."""
    lines = []
    for name, color in colors.items():
        channels = [_number(int(color[i:i + 2], 16) / 255, 4) for i in (1, 3, 5)]
        lines += [f"newmtl {name}", "Kd " + " ".join(channels)]
    return "\n".join(lines) + "\n"


def stl(name, shape):
    """The bytes of a binary STL file, which has facets and nothing else."""
    facets = []
    for points, _, _ in shape:
        rounded = [tuple(round(c, DECIMALS) + 0.0 for c in p) for p in points]
        if len(set(rounded)) < 3:
            continue
        (ax, ay, az), b, c = rounded
        ux, uy, uz = b[0] - ax, b[1] - ay, b[2] - az
        vx, vy, vz = c[0] - ax, c[1] - ay, c[2] - az
        n = (uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx)
        length = sum(v * v for v in n) ** 0.5
        if length == 0:
            continue
        facets.append(struct.pack("<12fH", *(v / length for v in n), *rounded[0], *b, *c, 0))
    return name.encode().ljust(80, b" ") + struct.pack("<I", len(facets)) + b"".join(facets)
