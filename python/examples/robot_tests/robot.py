"""The software of a robot: it follows the wall on its right, and maps what its scanner sees. Nothing here is of SimVis."""
import math

import numpy as np


class WallFollower:
    """Speeds of a robot from its scan of 181 beams from -90 to 90 degrees."""

    distance_m = 0.8  #: to the wall on the right
    stop_m = 0.9      #: something ahead is nearer: turn away

    def ahead(self, ranges: np.ndarray) -> float:
        """Distance to what the robot would meet: its own width is 0.4 m."""
        angles = np.radians(np.arange(-90, 91))
        beside = np.abs(ranges * np.sin(angles))
        return float(np.min(np.where((beside < 0.4) & (np.abs(angles) < 1), ranges * np.cos(angles), np.inf)))

    def drive(self, ranges: np.ndarray) -> tuple[float, float]:
        """Forward speed in m/s and turning speed in rad/s, to the left."""
        if self.ahead(ranges) < self.stop_m:
            return 0.05, 0.9
        right, between = float(ranges[0]), float(ranges[45])
        angle = math.atan2(between * math.sqrt(0.5) - right, between * math.sqrt(0.5))
        error = right * math.cos(angle) - self.distance_m
        return 0.4, max(-0.9, min(0.9, -1.2 * error - 1.5 * angle))


class FollowerWithBug(WallFollower):
    """It looks ahead with one beam, so it does not see what stands beside that beam and still in its way."""

    def ahead(self, ranges: np.ndarray) -> float:
        return float(ranges[90])


class Mapper:
    """A map of square cells around the origin: how many beams ended in each."""

    cell_m = 0.1

    def __init__(self, half_m: float = 4.0) -> None:
        self.cells = int(2 * half_m / self.cell_m)
        self.hits = np.zeros((self.cells, self.cells), int)

    def add(self, points: np.ndarray) -> None:
        """Adds points (n, 2) of the world, in metres."""
        places = np.floor(points / self.cell_m).astype(int) + self.cells // 2
        inside = ((places >= 0) & (places < self.cells)).all(axis=1)
        np.add.at(self.hits, (places[inside, 1], places[inside, 0]), 1)

    def occupied(self) -> np.ndarray:
        """The centres (n, 2) of the cells in which beams ended."""
        rows, columns = np.nonzero(self.hits)
        return (np.stack([columns, rows], axis=1) - self.cells // 2 + 0.5) * self.cell_m


class Wheels:
    """Where ideal wheels take the robot."""

    def __init__(self, x: float, y: float, yaw: float) -> None:
        self.x, self.y, self.yaw = x, y, yaw

    def move(self, forward: float, turn: float, seconds: float) -> None:
        self.yaw += turn * seconds
        self.x += forward * seconds * math.cos(self.yaw)
        self.y += forward * seconds * math.sin(self.yaw)
