#!/usr/bin/env python3
"""Drives a robot by what its front scanner sees: driver.py NAME. Ends with the simulation.

The robot is the element R_POSE, the scanner is FRONT_SCANNER. driver.c and driver.cpp beside this file do the same.
"""
import math
import sys

import simvis_client

FREE_M = 3.0          # farther away, everything is as good
STOP_M = 0.6          # nearer, the robot only turns
WINDOW = 20           # beams on each side that must be free, too
SPEED_M_S = 0.6
TURN_DEG_S = 90.0
STRAIGHT_M = 1.0      # a way straight ahead may be so much shorter than one at 90 degrees


def free_way(ranges, azimuths):
    """(azimuth, distance) of the way to go."""
    best, way, distance = -math.inf, 0.0, 0.0
    for i, azimuth in enumerate(azimuths):
        nearest = min(FREE_M, *ranges[max(0, i - WINDOW):i + WINDOW + 1])
        value = nearest - STRAIGHT_M * abs(azimuth) / (math.pi / 2)
        if value > best:
            best, way, distance = value, azimuth, nearest
    return way, distance


def drive(sim):
    robot = sim["R_POSE"]
    x, y, yaw_deg = robot["x"], robot["y"], robot["yaw"]
    frame, time_s = sim.frame, sim.time_s
    sim.ready()  # in lock-step, each frame waits for this
    while sim.wait_frame(frame):
        frame, dt_s = sim.frame, sim.time_s - time_s
        time_s += dt_s
        scan = sim.latest("FRONT_SCANNER")
        way, distance = free_way(scan["range_m"][0].tolist(), scan["azimuth_rad"][0].tolist())
        turn_deg = max(-TURN_DEG_S * dt_s, min(TURN_DEG_S * dt_s, math.degrees(way)))
        ahead = abs(way) < math.radians(30) and distance > STOP_M
        yaw_deg += turn_deg
        step_m = SPEED_M_S * dt_s if ahead else 0.0
        x += step_m * math.cos(math.radians(yaw_deg))
        y += step_m * math.sin(math.radians(yaw_deg))
        robot.set(x=x, y=y, yaw=yaw_deg)  # all of them at once
        sim.ready()


if __name__ == "__main__":
    with simvis_client.connect(sys.argv[1], client="driver", timeout_s=60) as connection:
        try:
            drive(connection)
        except simvis_client.MissingHost:
            pass  # the host ended while this program computed
