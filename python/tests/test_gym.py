"""simvis.gym: spaces, episodes and wrappers, checked by Gymnasium's own checker and against the simulation."""
import tempfile
import unittest
import warnings
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import simvis
from small_scene import SCENE

if find_spec("gymnasium"):
    import gymnasium
    from gymnasium.utils.env_checker import check_env
    from simvis import gym

NOISY = SCENE.replace('<sensor type="laser', '<sensor range_noise="0.01" type="laser')


@unittest.skipUnless(find_spec("gymnasium"), "gymnasium is not installed")
class Gym(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.scene = Path(folder.name) / "scene.xml"
        self.scene.write_text(NOISY)

    def make(self, **settings: Any) -> Any:
        env = gymnasium.make("simvis/Scene-v0", scene=self.scene, actions={"P.x": (-1, 1), "P.yaw": (-90, 90)}, **settings)
        self.addCleanup(env.close)
        return env

    def test_the_checker_of_gymnasium(self) -> None:
        envs = [self.make(sensors=["SCAN", "CAM"], render_mode="rgb_array", render_camera="CAM"), self.make(reload=False),
                gymnasium.make("simvis/Drive-v0", reload=False)]
        for env in envs:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # that spaces have no limits
                check_env(env.unwrapped, skip_render_check=True)
            env.close()

    def test_actions_set_parameters_and_wrappers_add_measurements(self) -> None:
        env = gym.CameraObservation(gym.ScanObservation(self.make(), "SCAN", reach_m=2.5), "CAM")
        env = gym.CameraObservation(env, "EYES", output="left_depth")
        env.reset(seed=1)
        seen, _, _, _, info = env.step(np.array([0.25, 30], np.float32))
        sim = env.get_wrapper_attr("sim")
        self.assertEqual((sim["P"].x, sim["P"].yaw), (0.25, 30))
        self.assertEqual(info, {"frames": 1})
        np.testing.assert_array_equal(seen["parameters"], np.array([0.25, 30], np.float32))
        np.testing.assert_array_equal(seen["SCAN"], np.minimum(sim["SCAN"].range_m, np.float32(2.5)))
        self.assertTrue((seen["SCAN"] == 2.5).any() and (seen["SCAN"] < 2.5).any())
        np.testing.assert_array_equal(seen["CAM"], sim["CAM"].rgb)
        np.testing.assert_array_equal(seen["EYES"], sim["EYES"].image("left_depth").array)
        self.assertTrue(env.observation_space.contains(seen))
        kinds = {name: (space.shape, space.dtype.name) for name, space in env.observation_space.spaces.items()}
        self.assertEqual(kinds, {"parameters": ((2,), "float32"), "SCAN": ((3, 31), "float32"), "CAM": ((16, 32, 3), "uint8"),
                                 "EYES": ((8, 16), "float32")})

    def test_an_episode_depends_on_its_seed_alone(self) -> None:
        def episode(env: Any, seed: int | None) -> bytes:
            seen = [env.reset(seed=seed)[0]]
            seen += [env.step(np.array([0.1, turn], np.float32))[0] for turn in (10, 20)]
            return b"".join(each["SCAN"].tobytes() for each in seen)

        one, other = (gym.ScanObservation(self.make(), "SCAN") for _ in range(2))
        first = episode(one, 3)
        self.assertEqual(len({first, episode(one, None), episode(one, 4)}), 3)  # with noise of their own
        self.assertEqual(episode(other, 3), first)
        self.assertEqual(episode(one, 3), first)

    def test_reset_sets_parameters_back(self) -> None:
        for reload in (True, False):
            env = self.make(reload=reload)
            env.reset(seed=0)
            env.step(np.array([1, 90], np.float32))
            seen, _ = env.reset()
            np.testing.assert_array_equal(seen["parameters"], [0, 0])

    def test_rewards_and_ends(self) -> None:
        env = self.make(reward=lambda sim: sim["P"].x, ended=lambda sim: sim["P"].x > 0.5, max_episode_steps=3)
        env.reset()
        results = [env.step(np.array([x, 0], np.float32))[1:4] for x in (0.25, 0.5, 0.75)]
        self.assertEqual(results, [(0.25, False, False), (0.5, False, False), (0.75, True, True)])

    def test_sensors_that_are_not_named_are_off(self) -> None:
        env = self.make(sensors=["SCAN"], render_mode="rgb_array", render_camera="CAM")
        env.reset()
        enabled = [name for name, sensor in env.unwrapped.sim.sensors.items() if sensor.enabled]
        self.assertEqual(enabled, ["SCAN", "CAM"])
        np.testing.assert_array_equal(env.render(), env.unwrapped.sim["CAM"].rgb)

    def test_the_robot_of_marvin_drives_and_bumps(self) -> None:
        env = gymnasium.make("simvis/DriveByCamera-v0", reload=False)
        self.addCleanup(env.close)
        before = env.reset(seed=0)[0]["parameters"]
        for frame in range(200):
            seen, reward, ended, _, _ = env.step(np.array([1, 0], np.float32))
            way_m = float(np.hypot(*(seen["parameters"] - before)[:2]))
            self.assertAlmostEqual(way_m, (frame + 1) * 0.1, places=5)  # 1 m/s at 10 Hz; float32 of some metres
            self.assertEqual(reward, -10 if ended else 0.1)
            if ended:
                break
        self.assertTrue(ended)
        self.assertLess(float(env.unwrapped.sim["FRONT_SCANNER"].range_m.min()), 0.4)  # type: ignore[attr-defined]
        self.assertEqual(seen["ROBOT_CAM"].shape, (480, 640, 3))

    def test_mistakes(self) -> None:
        for settings, message in (({"render_mode": "human"}, "render_mode is 'human', expected None"),
                                  ({"render_mode": "rgb_array"}, "with render_camera"), ({"rate": 3}, 'no setting "rate"')):
            with self.subTest(settings=settings), self.assertRaisesRegex(Exception, message):
                gym.SceneEnv(self.scene, {"P.x": (0, 1)}, **settings)
        with self.assertRaisesRegex(simvis.InputError, "actions is empty"):
            gym.SceneEnv(self.scene, {})
        with self.assertRaisesRegex(simvis.UnknownName, 'there is no sensor "SCN", did you mean "SCAN"'):
            gym.ScanObservation(self.make(), "SCN")
        with self.assertRaisesRegex(simvis.InputError, "reach_m is 0"):
            gym.ScanObservation(self.make(), "SCAN", reach_m=0)


if __name__ == "__main__":
    unittest.main()
