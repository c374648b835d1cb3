"""The drive along the path: the robot's pose from the ground under its four wheels, and its head's pan and tilt."""
import math

import ground
from robot import WHEEL_X, WHEEL_Y

BEGIN_X, END_X = 27.0, -13.0
SECONDS, ROWS_PER_SECOND = 40, 10
COLUMNS = ("time_s", "R_POSE.x", "R_POSE.y", "R_POSE.z", "R_POSE.roll", "R_POSE.pitch", "R_POSE.yaw", "PAN.value",
           "TILT.value")


def stand(x, y, yaw_rad):
    """z, roll and pitch (radians) of the plane that fits the ground at the four wheels best.

    Four heights over a rectangle leave one misfit, a twist; the plane shares it out evenly, and tyres take it up.
    """
    roll = pitch = 0.0
    for _ in range(4):  # where the wheels stand depends a little on roll and pitch
        cy, cp, cr = math.cos(yaw_rad), math.cos(pitch), math.cos(roll)
        sy, sp, sr = math.sin(yaw_rad), math.sin(pitch), math.sin(roll)
        heights = []
        for wx, wy in ((WHEEL_X, WHEEL_Y), (WHEEL_X, -WHEEL_Y), (-WHEEL_X, WHEEL_Y), (-WHEEL_X, -WHEEL_Y)):
            u, v = cp * wx + sp * sr * wy, cr * wy
            heights.append(ground.height(x + cy * u - sy * v, y + sy * u + cy * v))
        front_left, front_right, rear_left, rear_right = heights
        pitch = -math.asin((front_left + front_right - rear_left - rear_right) / (4 * WHEEL_X))
        roll = math.asin((front_left + rear_left - front_right - rear_right) / (4 * WHEEL_Y) / math.cos(pitch))
    return sum(heights) / 4, roll, pitch


def rows():
    """Evenly in time, at constant speed along the middle of the path."""
    xs = [BEGIN_X + (END_X - BEGIN_X) * i / 4000 for i in range(4001)]
    lengths = [0.0]
    for a, b in zip(xs, xs[1:]):
        lengths.append(lengths[-1] + math.hypot(b - a, ground.path_y(b) - ground.path_y(a)))
    count, k, result = SECONDS * ROWS_PER_SECOND, 0, []
    for i in range(count + 1):
        at = lengths[-1] * i / count
        while k < len(xs) - 2 and lengths[k + 1] < at:
            k += 1
        x = xs[k] + (xs[k + 1] - xs[k]) * (at - lengths[k]) / (lengths[k + 1] - lengths[k])
        y, yaw = ground.path_y(x), math.pi + math.atan(ground.path_slope(x))
        z, roll, pitch = stand(x, y, yaw)
        time = i / ROWS_PER_SECOND
        result.append((time, x, y, z, math.degrees(roll), math.degrees(pitch), math.degrees(yaw),
                       20 * math.sin(2 * math.pi * time / 16), 6 + 4 * math.sin(2 * math.pi * time / 10)))
    return result


def csv(table):
    lines = [",".join(COLUMNS)]
    lines += [",".join(f"{round(v, d) + 0.0:.{d}f}" for v, d in zip(row, (1, 4, 4, 4, 3, 3, 3, 3, 3))) for row in table]
    return "\n".join(lines) + "\n"
