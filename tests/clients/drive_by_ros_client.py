"""Drives a robot by the client library of ROS 2 in the package dora-rs of PyPI: publishes /cmd_vel, and compares /scan
with /ROBOT/odom, the robot's true pose, in front of a wall whose face is at x = 3.9 m. Exits with 77 where the machine
has no multicast, by which the client finds others. ROS_DOMAIN_ID is the domain; AMENT_PREFIX_PATH has the definitions of
the messages.
"""
import socket
import sys
import time

import dora
import pyarrow as pa

WALL_M, AHEAD_M, ABOVE_M = 3.9, 0.3, 0.2  # of the wall's face; of the scanner in the robot's frame
FAR_M = 1.0  # how far it drives
SPEED_M_S = 0.5
# A range comes as a float: half a unit of its last place at up to 4 m. The wall's face is rounded to a float in the wall's
# frame: half a unit of the last place at 0.1 m. Poses are doubles.
RANGE_ROUNDING_M = 2**-23 + 2**-28
PATIENCE_S = 90


def has_multicast() -> bool:
    """Whether a packet to a multicast group comes back."""
    group, text = "239.255.0.77", b"simvis"
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        receiver.settimeout(2)
        try:
            receiver.bind(("", 0))
            receiver.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, socket.inet_aton(group) + socket.inet_aton("0.0.0.0"))
            sender.sendto(text, (group, receiver.getsockname()[1]))
            return receiver.recv(100) == text
        except OSError:
            return False


def stamp(message: dict) -> tuple[int, int]:
    return message["header"]["stamp"]["sec"], message["header"]["stamp"]["nanosec"]


def expected_range(pose: dict) -> float:
    """Along the scanner's x axis to the wall, from the robot's pose."""
    p, q = pose["position"], pose["orientation"]
    x, y, z, w = q["x"], q["y"], q["z"], q["w"]
    axis_x, axis_z = 1 - 2 * (y * y + z * z), 2 * (x * z + w * y)  # x components of the robot's axes x and z
    return (WALL_M - (p["x"] + AHEAD_M * axis_x + ABOVE_M * axis_z)) / axis_x


def main() -> int:
    if not has_multicast():
        print("no packet comes back from a multicast group")
        return 77
    node = dora.Ros2Context().new_node("driver", "/", dora.Ros2NodeOptions(rosout=False))
    sensors = dora.Ros2QosPolicies(reliable=False, max_blocking_time=0.1, keep_last=5)
    reliable = dora.Ros2QosPolicies(reliable=True, max_blocking_time=0.1, keep_last=10)
    scans = node.create_subscription(node.create_topic("/scan", "sensor_msgs/LaserScan", sensors))
    poses = node.create_subscription(node.create_topic("/ROBOT/odom", "nav_msgs/Odometry", reliable))
    commands = node.create_publisher(node.create_topic("/cmd_vel", "geometry_msgs/Twist", reliable))
    still = {axis: 0.0 for axis in "xyz"}
    ranges, expected = {}, {}
    way_m, end = 0.0, time.time() + PATIENCE_S
    while way_m < FAR_M and time.time() < end:
        commands.publish(pa.array([{"linear": {**still, "x": SPEED_M_S}, "angular": still}]))
        if (got := poses.next()) is not None:
            message = got[0].as_py()
            expected[stamp(message)] = expected_range(message["pose"]["pose"])
            way_m = message["pose"]["pose"]["position"]["x"]
        if (got := scans.next()) is not None:
            message = got[0].as_py()
            ranges[stamp(message)] = message["ranges"][1]
    both = sorted(ranges.keys() & expected.keys())
    worst_m = max((abs(ranges[each] - expected[each]) for each in both), default=float("nan"))
    print(f"{way_m} m driven, {len(both)} scans, the largest difference is {worst_m} m")
    if way_m < FAR_M or len(both) < 10 or not worst_m <= RANGE_ROUNDING_M:
        return 1
    print("the robot was driven")
    return 0


if __name__ == "__main__":
    sys.exit(main())
