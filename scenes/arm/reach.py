"""The arm's work: it takes the red block from the mat, lays it into the tray, and goes back to where it began."""
import math

import kinematics
from kinematics import FINGER, LIMITS, reach_down
from things import BLOCK

RATE_HZ = 15
REST = (0.0, -20.0, 40.0, 0.0, 60.0, 0.0)
OPEN, CLOSED = 0.036, BLOCK / 2  # of each finger, from the middle
TAKE = (0.33, 0.14, BLOCK / 2 + 0.003, 25.0)  # x y z yaw of the block's middle, in the arm's base frame
LAY = (0.22, -0.36, BLOCK / 2 + 0.006, -30.0)
DEPTH = 0.012  # how far the tips reach below the block's middle
LIFT = 0.16


def _hover(place, above):
    x, y, z, yaw = place
    return reach_down(x, y, z - DEPTH + above, yaw)


def _stations():
    """(seconds to get there, joints, finger, what carries the block)."""
    return [(0.0, REST, OPEN, "mat"), (0.4, REST, OPEN, "mat"),
            (1.8, _hover(TAKE, LIFT), OPEN, "mat"), (1.2, _hover(TAKE, 0), OPEN, "mat"),
            (0.6, _hover(TAKE, 0), CLOSED, "hand"), (1.2, _hover(TAKE, LIFT), CLOSED, "hand"),
            (2.2, _hover(LAY, LIFT), CLOSED, "hand"), (1.2, _hover(LAY, 0), CLOSED, "hand"),
            (0.6, _hover(LAY, 0), OPEN, "tray"), (1.0, _hover(LAY, LIFT), OPEN, "tray"),
            (1.8, REST, OPEN, "tray")]


def _product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(4)) for j in range(4)] for i in range(4)]


def _turn(axis, degrees):
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    m = _shift(0, 0, 0)
    m[i][i], m[i][j], m[j][i], m[j][j] = c, -s, s, c
    return m


def _shift(x, y, z):
    return [[1, 0, 0, x], [0, 1, 0, y], [0, 0, 1, z], [0, 0, 0, 1]]


def tips(joints):
    """base_from_tips: the frame between the fingers' tips."""
    k = kinematics
    m = _shift(0, 0, 0)
    for place, axis, value in zip(((0, 0, k.SHOULDER_Z), (0, 0, k.UPPER_ARM_Z), (0, 0, k.UPPER_ARM),
                                   (k.FOREARM, 0, 0), (k.WRIST, 0, 0), (k.HAND, 0, 0)), "zyyxyx", joints):
        m = _product(_product(m, _shift(*place)), _turn(axis, value))
    return _product(m, _shift(k.FINGERS + FINGER, 0, 0))


def _inverse(m):
    rotation = [[m[j][i] for j in range(3)] for i in range(3)]
    shift = [-sum(rotation[i][k] * m[k][3] for k in range(3)) for i in range(3)]
    return [rotation[i] + [shift[i]] for i in range(3)] + [[0, 0, 0, 1]]


def _place(x, y, z, yaw):
    return _product(_shift(x, y, z), _turn("z", yaw))


def _pose(m):
    """x y z roll pitch yaw, angles in degrees; R = Rz(yaw) Ry(pitch) Rx(roll)."""
    pitch = math.asin(max(-1.0, min(1.0, -m[2][0])))
    roll, yaw = math.atan2(m[2][1], m[2][2]), math.atan2(m[1][0], m[0][0])
    return (m[0][3], m[1][3], m[2][3], math.degrees(roll), math.degrees(pitch), math.degrees(yaw))


def rows():
    """One row per frame: time, the six joints, the finger, and the block's pose in the arm's base frame."""
    stations = _stations()
    taken = _product(_inverse(tips(_hover(TAKE, 0))), _place(*TAKE))  # tips_from_block
    table, start = [], 0.0
    ends = []
    for seconds, *_ in stations:
        start += seconds
        ends.append(start)
    for frame in range(round(ends[-1] * RATE_HZ) + 1):
        time = frame / RATE_HZ
        k = next((i for i in range(1, len(ends)) if time <= ends[i] + 1e-9), len(ends) - 1)
        f = min(1.0, max(0.0, (time - ends[k - 1]) / stations[k][0]))
        f = f * f * (3 - 2 * f)
        (_, from_joints, from_grip, _), (_, joints, grip, holder) = stations[k - 1], stations[k]
        now = [a + (b - a) * f for a, b in zip(from_joints, joints)]
        if holder == "mat":
            block = _place(*TAKE)
        elif holder == "hand":
            block = _product(tips(now), taken)
        else:
            block = _product(tips(_hover(LAY, 0)), taken)
        table.append((time, *now, from_grip + (grip - from_grip) * f, *_pose(block)))
    return table


def csv():
    names = [f"{joint}.value" for joint in (*LIMITS, "GRIP")] + [f"BLOCK.{p}" for p in
                                                                 ("x", "y", "z", "roll", "pitch", "yaw")]
    lines = ["time_s," + ",".join(names)]
    for row in rows():
        lines.append(",".join(f"{round(v, 5) + 0.0:.5f}".rstrip("0").rstrip(".") for v in row))
    return "\n".join(lines) + "\n"
