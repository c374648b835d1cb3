"""A gymnasium environment: a robot drives through the laboratory and must not bump. It observes its front scanner.

    python bumper_env.py            # a random policy for 200 steps
"""
import math
import sys
from typing import Any

import gymnasium
import numpy as np
import simvis


class BumperEnv(gymnasium.Env[np.ndarray, np.ndarray]):
    """Action: speed in m/s and turn in degrees per second. Observation: ranges in metres, at most 10."""

    rate_hz, radius_m, reach_m = 10, 0.4, 10.0

    def __init__(self) -> None:
        self.sim = simvis.Simulation.load(simvis.scene("marvin"), rate_hz=self.rate_hz)
        self.sim.only("FRONT_SCANNER")
        self.robot = self.sim.elements["R_POSE"]
        self.start = {name: self.robot[name] for name in self.robot}
        self.sim.step()
        beams = self.sim.sensors["FRONT_SCANNER"].range_m.size
        self.observation_space = gymnasium.spaces.Box(0, self.reach_m, (beams,), np.float32)
        self.action_space = gymnasium.spaces.Box(np.array([0, -90], np.float32), np.array([1, 90], np.float32))

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[np.ndarray, dict[str, Any]]:
        super().reset(seed=seed)
        self.robot.set(**self.start)
        self.robot.yaw = float(self.np_random.uniform(-180, 180))
        self.sim.step()
        return self._observation(), {}

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        speed, turn = (float(each) / self.rate_hz for each in action)
        yaw = self.robot.yaw + turn
        self.robot.set(yaw=yaw, x=self.robot.x + speed * math.cos(math.radians(yaw)),
                       y=self.robot.y + speed * math.sin(math.radians(yaw)))
        self.sim.step()
        observation = self._observation()
        bumped = bool(observation.min() < self.radius_m)
        return observation, -10.0 if bumped else speed, bumped, False, {}

    def _observation(self) -> np.ndarray:
        return np.minimum(self.sim.sensors["FRONT_SCANNER"].range_m.ravel(), np.float32(self.reach_m))

    def close(self) -> None:
        self.sim.close()


if __name__ == "__main__":
    env = BumperEnv()
    env.reset(seed=0)
    env.action_space.seed(0)
    bumps, reward = 0, 0.0
    for _ in range(20 if "--short" in sys.argv else 200):
        _, earned, ended, _, _ = env.step(env.action_space.sample())
        reward += earned
        if ended:
            bumps += 1
            env.reset()
    print(f"{bumps} bumps, reward {reward:.1f}")
