"""The drive: once around the desks in twenty seconds, back to where it began. Checked against the furniture."""
import math
import os
import xml.etree.ElementTree

import robot
import room

SECONDS, ROWS_PER_SECOND = 20, 10
SMALLEST_CLEARANCE_M = 0.15
# Corners of the course, in the order in which they are passed.
COURSE = [(-2.45, -2.1), (-0.8, -2.35), (1.0, -2.25), (2.45, -2.0), (2.75, -0.4), (2.55, 1.5), (1.6, 2.3), (0.0, 2.35),
          (-1.6, 2.25), (-2.6, 1.6), (-2.75, 0.0)]


def _spline(samples_per_leg=200):
    """A smooth closed curve through the course (uniform Catmull-Rom)."""
    points, n = [], len(COURSE)
    for i in range(n):
        p = [COURSE[(i + k - 1) % n] for k in range(4)]
        for s in range(samples_per_leg):
            t = s / samples_per_leg
            weights = ((-t + 2 * t * t - t ** 3) / 2, (2 - 5 * t * t + 3 * t ** 3) / 2,
                       (t + 4 * t * t - 3 * t ** 3) / 2, (-t * t + t ** 3) / 2)
            points.append(tuple(sum(w * q[a] for w, q in zip(weights, p)) for a in range(2)))
    return points


def rows():
    """(time_s, x, y, yaw_deg, tilt_deg), evenly in time at constant speed; yaw goes on past 180."""
    points = _spline()
    points.append(points[0])
    lengths = [0.0]
    for a, b in zip(points, points[1:]):
        lengths.append(lengths[-1] + math.hypot(b[0] - a[0], b[1] - a[1]))
    result, k, yaw_before = [], 0, None
    count = SECONDS * ROWS_PER_SECOND
    for i in range(count + 1):
        at = lengths[-1] * i / count
        while k < len(points) - 2 and lengths[k + 1] < at:
            k += 1
        f = (at - lengths[k]) / (lengths[k + 1] - lengths[k])
        a, b = points[k], points[k + 1]
        before, after = points[k - 1 if k else -2], points[k + 2 if k + 2 < len(points) else 1]
        slope = [(1 - f) * (b[c] - before[c]) + f * (after[c] - a[c]) for c in range(2)]
        yaw = math.degrees(math.atan2(slope[1], slope[0]))
        if yaw_before is not None:
            yaw += 360 * round((yaw_before - yaw) / 360)
        yaw_before = yaw
        tilt = 25 * math.sin(2 * math.pi * i / (4 * ROWS_PER_SECOND))
        result.append((i / ROWS_PER_SECOND, a[0] + (b[0] - a[0]) * f, a[1] + (b[1] - a[1]) * f, yaw, tilt))
    return result


def csv(table):
    lines = ["time_s,R_POSE.x,R_POSE.y,R_POSE.yaw,TILT.value"]
    lines += [",".join(f"{round(v, d) + 0.0:.{d}f}" for v, d in zip(row, (1, 4, 4, 3, 3))) for row in table]
    return "\n".join(lines) + "\n"


def _rectangle(x, y, yaw_deg, x0, x1, y0, y1):
    c, s = math.cos(math.radians(yaw_deg)), math.sin(math.radians(yaw_deg))
    return [(x + c * u - s * v, y + s * u + c * v) for u, v in ((x0, y0), (x1, y0), (x1, y1), (x0, y1))]


def obstacles(scene_file, models):
    """The outlines, seen from above, of the parts that marvin.xml puts into the laboratory below the robot's height."""
    robot_height = 1.6
    result = []
    for part in xml.etree.ElementTree.parse(scene_file).getroot().iter("part"):
        if part.get("insert_at") != "LAB" or part.get("name") == "ROBOT":
            continue
        name = os.path.splitext(part.get("file"))[0]
        if name == "carpet":  # Marvin drives over it
            continue
        x, y, z, _, _, yaw = (float(v) for v in part.get("pose_offset", "0 0 0 0 0 0").split())
        points = [p for faces in models[name].faces.values() for face in faces for p in face[0]]
        if z + min(p[2] for p in points) > robot_height:
            continue
        result.append((part.get("name"), _rectangle(x, y, yaw, min(p[0] for p in points), max(p[0] for p in points),
                                                    min(p[1] for p in points), max(p[1] for p in points))))
    return result


def _distance(a, b):
    """Between two convex outlines; 0 or less where they overlap."""
    def gap(p, q):  # the widest gap between the two along the normals of p's sides
        widest = -math.inf
        for (x0, y0), (x1, y1) in zip(p, p[1:] + p[:1]):
            length = math.hypot(x1 - x0, y1 - y0)
            nx, ny = (y1 - y0) / length, (x0 - x1) / length
            widest = max(widest, min((x - x0) * nx + (y - y0) * ny for x, y in q))
        return widest

    def corner_to_side(p, q):
        closest = math.inf
        for (x0, y0), (x1, y1) in zip(p, p[1:] + p[:1]):
            dx, dy = x1 - x0, y1 - y0
            for x, y in q:
                t = max(0.0, min(1.0, ((x - x0) * dx + (y - y0) * dy) / (dx * dx + dy * dy)))
                closest = min(closest, math.hypot(x - x0 - t * dx, y - y0 - t * dy))
        return closest
    if max(gap(a, b), gap(b, a)) <= 0:
        return 0.0
    return min(corner_to_side(a, b), corner_to_side(b, a))


def clearance(table, outlines):
    """The smallest distance of the driving robot to anything, and what it is."""
    closest = (math.inf, "")
    half_x, half_y = robot.LENGTH / 2, robot.WIDTH / 2
    for time_s, x, y, yaw, _ in table:
        body = _rectangle(x, y, yaw, -half_x, half_x, -half_y, half_y)
        wall = min(min(room.HALF_X - abs(px), room.HALF_Y - abs(py)) for px, py in body)
        closest = min(closest, (wall, f"the wall at {time_s} s"))
        for name, outline in outlines:
            closest = min(closest, (_distance(body, outline), f"{name} at {time_s} s"))
    return closest
