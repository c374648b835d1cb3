"""Gymnasium: its checker on the environment of a robot that must not bump.

packages: gymnasium==1.4.0 numpy==2.4.6
"""
import sys
import time
import warnings

import trial

sys.path.insert(0, str(trial.ROOT / "build/release/python"))


def measure(folder):
    import gymnasium
    import simvis.gym  # registers the environments
    from gymnasium.utils.env_checker import check_env

    begin, environment = time.monotonic(), gymnasium.make("simvis/Drive-v0")
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        check_env(environment.unwrapped)  # raises what is wrong
    return [("warnings of the checker", len(found), "", time.monotonic() - begin)]


trial.main(measure)
