"""A policy in an environment of Gymnasium: the robot of marvin turns away from what its scanner sees, and must not bump.

    python bumper_env.py            # 200 steps of a random policy, and of one that looks ahead
"""
import sys

import gymnasium
import numpy as np
import simvis.gym


def look_ahead(observation: simvis.gym.Observation) -> np.ndarray:
    ranges = observation["FRONT_SCANNER"][0]
    right, ahead, left = (part.min() for part in np.array_split(ranges, 3))
    return np.array([0.5 if ahead > 1 else 0, 60 if left > right else -60], np.float32)


def drive(env: gymnasium.Env, policy, steps: int) -> str:
    observation, _ = env.reset(seed=0)
    bumps, reward = 0, 0.0
    for _ in range(steps):
        observation, earned, ended, cut, _ = env.step(policy(observation))
        reward += float(earned)
        bumps += ended
        if ended or cut:
            observation, _ = env.reset()
    return f"{bumps} bumps, reward {reward:.1f}"


if __name__ == "__main__":
    env = gymnasium.make("simvis/Drive-v0", reload=False)
    env.action_space.seed(0)
    steps = 20 if "--short" in sys.argv else 200
    print("at random:", drive(env, lambda observation: env.action_space.sample(), steps))
    print("ahead:    ", drive(env, look_ahead, steps))
