"""Paints convex shapes with palette indices, row by row, fast enough for large textures in plain Python."""
import math

from gltf_writer import Texture
from painting import ramp

_PIXEL = [bytes([index]) for index in range(256)]


def palette(clear, *ramps):
    """A palette of (r, g, b, a): index 0 is clear, with the colour that its neighbours fade into, then the ramps.

    `ramps` holds (colours, count). Returns the palette and each ramp's first index.
    """
    entries, starts = [(*ramp([clear, clear], 2)[0], 0)], []
    for colors, count in ramps:
        starts.append(len(entries))
        entries += [(*color, 255) for color in ramp(colors, count)]
    return tuple(entries), starts


class Brush:
    """Palette pixels, y down. `tiled`: what leaves the picture on one side comes in on the other, at its upper and
    lower edge only if the rows repeat."""

    def __init__(self, width, height, background=0, tiled=False, rows_repeat=True):
        self.width, self.height, self.tiled, self.rows_repeat = width, height, tiled, tiled and rows_repeat
        self.rows = [bytearray([background]) * width for _ in range(height)]

    def span(self, y, x0, x1, index):
        """The pixels from x0 up to x1, x1 left out."""
        if self.rows_repeat:
            y %= self.height
        elif not 0 <= y < self.height:
            return
        row = self.rows[y]
        if self.tiled:
            x0, x1 = x0 % self.width, x0 % self.width + x1 - x0
            if x1 > self.width:
                row[0:x1 - self.width] = _PIXEL[index] * (x1 - self.width)
                x1 = self.width
        else:
            if x0 < 0:
                x0 = 0
            if x1 > self.width:
                x1 = self.width
        if x1 > x0:
            row[x0:x1] = _PIXEL[index] * (x1 - x0)

    def convex(self, points, index):
        """A convex polygon: in each row whose middle it meets at least one pixel."""
        met, span = {}, self.span
        x0, y0 = points[-1]
        for x1, y1 in points:
            if y0 != y1:
                low, high = (y0, y1) if y0 < y1 else (y1, y0)
                row, end = math.ceil(low - 0.5), math.ceil(high - 0.5)
                if row < end:
                    slope = (x1 - x0) / (y1 - y0)
                    x = x0 + (row + 0.5 - y0) * slope
                    while row < end:
                        other = met.get(row)
                        if other is None:
                            met[row] = x
                        else:
                            left, right = (int(x + 0.5), int(other + 0.5)) if x < other else (int(other + 0.5),
                                                                                               int(x + 0.5))
                            span(row, left, right if right > left else left + 1, index)
                        row += 1
                        x += slope
            x0, y0 = x1, y1

    def stroke(self, points, widths, indices):
        """A line of changing width; `indices` holds one per leg."""
        for k in range(len(points) - 1):
            (x0, y0), (x1, y1) = points[k], points[k + 1]
            length = math.hypot(x1 - x0, y1 - y0) or 1.0
            nx, ny = (y0 - y1) / length / 2, (x1 - x0) / length / 2
            a, b = widths[k], widths[k + 1]
            self.convex([(x0 + nx * a, y0 + ny * a), (x1 + nx * b, y1 + ny * b), (x1 - nx * b, y1 - ny * b),
                         (x0 - nx * a, y0 - ny * a)], indices[k])

    def blob(self, x, y, radius_x, radius_y, index, turn=0.0, corners=9):
        c, s = math.cos(turn), math.sin(turn)
        points = []
        for k in range(corners):
            u, v = radius_x * math.cos(2 * math.pi * k / corners), radius_y * math.sin(2 * math.pi * k / corners)
            points.append((x + c * u - s * v, y + s * u + c * v))
        self.convex(points, index)

    def leaf(self, x, y, angle, length, width, profile, halves, vein):
        """A leaf from its stalk at (x, y); `halves` are the indices of its left and right half, `vein` its lines'."""
        c, s = math.cos(angle), math.sin(angle)
        place = lambda t, w: (x + c * t * length - s * w * width, y + s * t * length + c * w * width)
        for side, index in ((-0.5, halves[0]), (0.5, halves[1])):
            self.convex([place(t, side * w) for t, w in profile], index)
            for t in (0.2, 0.36, 0.52, 0.68) if length > 55 else ():
                w = next(b for (a0, _), (a1, b) in zip(profile, profile[1:]) if a1 >= t + 0.1)
                self.stroke([place(t, 0), place(t + 0.14, side * 0.82 * w)], [1.6, 0.8], [vein])
        self.stroke([place(-0.14, 0), place(0.92, 0)], [2.4, 1.0], [vein])

    def texture(self, name, colors, clamp=False):
        return Texture(name, self.width, self.height, b"".join(self.rows), colors, clamp)
