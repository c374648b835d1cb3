"""The drive: once around the desks in twenty seconds, from rest to rest, back to where it began. Checked against the
furniture."""
import math
import os
import xml.etree.ElementTree

import robot
import room

SECONDS, ROWS_PER_SECOND = 20, 10
ACCELERATION_M_S2, TURN_RAD_S = 0.4, math.radians(50)  # at most
SMALLEST_CLEARANCE_M = 0.15
# Corners of the course, in the order in which they are passed; the last is the first. marvin.xml has the pose at its beginning.
COURSE = [(-2.45, -2.1), (-0.8, -2.35), (1.0, -2.25), (2.45, -2.0), (2.75, -0.4), (2.55, 1.5), (1.6, 2.3), (0.0, 2.35),
          (-1.6, 2.25), (-2.6, 1.6), (-2.75, 0.0), (-2.45, -2.1)]
START_YAW_DEG = -50.329
STEPS_PER_LEG = 1000


def _tangents():
    """Of the cubic spline through the course whose curvature is continuous; both ends have the given direction."""
    end = 1.5  # metres for each leg
    first = (end * math.cos(math.radians(START_YAW_DEG)), end * math.sin(math.radians(START_YAW_DEG)))
    tangents = [first] * len(COURSE)
    for _ in range(60):  # each round divides what is left by about two
        for i in range(1, len(COURSE) - 1):
            tangents[i] = tuple((3 * (COURSE[i + 1][c] - COURSE[i - 1][c]) - tangents[i - 1][c] - tangents[i + 1][c]) / 4
                                for c in range(2))
    return tangents


def _path():
    """Points of the spline: x, y, yaw in radians, which goes on past 180 degrees, curvature."""
    tangents, points = _tangents(), []
    for step in range((len(COURSE) - 1) * STEPS_PER_LEG + 1):
        leg = min(step // STEPS_PER_LEG, len(COURSE) - 2)
        t = step / STEPS_PER_LEG - leg
        ends = COURSE[leg], COURSE[leg + 1], tangents[leg], tangents[leg + 1]
        place, slope, bend = ([sum(w * end[c] for w, end in zip(weights, ends)) for c in range(2)] for weights in (
            (2 * t ** 3 - 3 * t * t + 1, 3 * t * t - 2 * t ** 3, t ** 3 - 2 * t * t + t, t ** 3 - t * t),
            (6 * t * t - 6 * t, 6 * t - 6 * t * t, 3 * t * t - 4 * t + 1, 3 * t * t - 2 * t),
            (12 * t - 6, 6 - 12 * t, 6 * t - 4, 6 * t - 2)))
        yaw = math.atan2(slope[1], slope[0])
        if points:
            yaw += 2 * math.pi * round((points[-1][2] - yaw) / (2 * math.pi))
        points.append((*place, yaw, (slope[0] * bend[1] - slope[1] * bend[0]) / math.hypot(*slope) ** 3))
    return points


def _times(points, fastest_m_s):
    """When each point is passed, from rest to rest: no faster than this, and within the limits of turning and accelerating."""
    legs = [math.hypot(b[0] - a[0], b[1] - a[1]) for a, b in zip(points, points[1:])]
    speeds = [min(fastest_m_s, TURN_RAD_S / max(abs(point[3]), 1e-9)) for point in points]
    speeds[0] = speeds[-1] = 0
    for i, leg in enumerate(legs):
        speeds[i + 1] = min(speeds[i + 1], math.sqrt(speeds[i] ** 2 + 2 * ACCELERATION_M_S2 * leg))
    for i in reversed(range(len(legs))):
        speeds[i] = min(speeds[i], math.sqrt(speeds[i + 1] ** 2 + 2 * ACCELERATION_M_S2 * legs[i]))
    times = [0.0]
    for i, leg in enumerate(legs):
        times.append(times[-1] + 2 * leg / (speeds[i] + speeds[i + 1]))
    return times


def _times_of_course(points):
    """Those that take SECONDS: a greatest speed is found between 0.1 and 10 m/s by halving."""
    slow, fast = 0.1, 10.0
    for _ in range(30):
        middle = (slow + fast) / 2
        slow, fast = (middle, fast) if _times(points, middle)[-1] > SECONDS else (slow, middle)
    times = _times(points, fast)
    if abs(times[-1] - SECONDS) > 0.001:
        raise SystemExit(f"the course takes {times[-1]:.3f} s at least, expected at most {SECONDS} s")
    return times


def rows():
    """(time_s, x, y, yaw_deg, tilt_deg), evenly in time; yaw goes on past 180."""
    points = _path()
    times, result, k = _times_of_course(points), [], 0
    for i in range(SECONDS * ROWS_PER_SECOND + 1):
        time = i / ROWS_PER_SECOND
        while k < len(points) - 2 and times[k + 1] < time:
            k += 1
        f = min((time - times[k]) / (times[k + 1] - times[k]), 1.0)
        x, y, yaw = (a + (b - a) * f for a, b in zip(points[k][:3], points[k + 1][:3]))
        result.append((time, x, y, math.degrees(yaw), 25 * math.sin(2 * math.pi * time / 4)))
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
