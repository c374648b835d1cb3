"""simvis.VectorSimulation and vector environments: against single simulations, and against Gymnasium's own vectors."""
import gc
import os
import threading
import unittest
import weakref
from importlib.util import find_spec
from typing import Any

import numpy as np
import simvis
from small_scene import SCENE

if find_spec("gymnasium"):
    import gymnasium
    from gymnasium.vector import AutoresetMode
    from simvis import gym

NOISY = SCENE.replace('<sensor type="laser', '<sensor range_noise="0.01" type="laser')
OUTPUTS = ["SCAN.range_m", "SCAN.error_bound_m", "CAM.rgb", "CAM.color", "CAM.depth", "EYES.left_depth"]


class Shy(simvis.CustomElement, type="shy_of_vectors"):
    """An element that raises for some values, in whatever thread."""

    attributes = [simvis.Attribute("at", 0, "", "raises above 1", live=True)]

    def __init__(self, context: simvis.Context) -> None:
        pass

    def update(self, values: dict[str, float]) -> None:
        if values["at"] > 1:
            raise OverflowError(f"{values['at']:g} is too much")


def environments(count: int = 3, **settings: Any) -> simvis.VectorSimulation:
    return simvis.VectorSimulation.from_string(NOISY, count, seed=5, **settings)


def read(sim: simvis.Simulation, name: str) -> Any:
    sensor, _, output = name.partition(".")
    return sim.sensors[sensor].rgb if output == "rgb" else sim.sensors[sensor][output]


class Vectors(unittest.TestCase):
    def test_environments_are_single_simulations_with_their_seeds(self) -> None:
        for threads in (1, 2):
            sims = environments(threads=threads)
            alone = [simvis.Simulation.from_string(NOISY, seed=5 + i) for i in range(3)]
            for frame in range(3):
                yaws = np.array([0.0, 20, 40]) + frame
                sims.parameters["P.yaw"] = yaws
                sims.step()
                for i, sim in enumerate(alone):
                    sim["P"].yaw = yaws[i]
                    sim.step()
                    for name in OUTPUTS:
                        self.assertEqual(sims.outputs[name][i].tobytes(), read(sim, name).tobytes(), name)
                        self.assertEqual(sims.outputs[name][i].dtype, read(sim, name).dtype)
                        self.assertEqual(sims.outputs[name][i].shape, read(sim, name).shape)

    def test_an_array_keeps_its_numbers(self) -> None:
        sims = environments()
        self.assertTrue(np.isnan(sims.outputs["SCAN.range_m"]).all())
        sims.step()
        ranges = sims.outputs["SCAN.range_m"]
        kept = ranges.copy()
        sims.parameters["P.x"] = 1
        sims.step()
        np.testing.assert_array_equal(ranges, kept)
        self.assertFalse((sims.outputs["SCAN.range_m"] == kept).all())
        sims.close()
        np.testing.assert_array_equal(ranges, kept)
        with self.assertRaises(ValueError):
            ranges[0] = 1

    def test_environments_are_simulations(self) -> None:
        with environments() as sims:
            self.assertEqual((len(sims), len(list(sims))), (3, 3))
            sims.only("SCAN")
            sims.step()
            self.assertEqual([sim.measured for sim in sims], [["SCAN"]] * 3)
            sims[-1].step()
            sims.step_some([0])
            self.assertEqual([round(sim.time_s * 15) for sim in sims], [1, 0, 1])
            sims.step(dt_s=2)
            self.assertEqual([round(sim.time_s * 15) for sim in sims], [31, 30, 31])
            held = sims[2]
        self.assertEqual(repr(sims), "closed environments")
        held.step()  # it lives as long as it is held
        with self.assertRaisesRegex(simvis.InputError, "closed"):
            sims.step()

    def test_states_and_seeds(self) -> None:
        sims = environments()
        sims.step()
        sims.save_states()
        sims.step()
        first = sims.outputs["SCAN.range_m"]
        sims.step()
        sims.restore_states(np.array([True, False, True]))
        sims.step()
        again = sims.outputs["SCAN.range_m"]
        np.testing.assert_array_equal(again[[0, 2]], first[[0, 2]])
        self.assertFalse((again[1] == first[1]).all())
        sims.reload([6, 2**64 - 1], [0, 1])
        sims.step_some([0, 1])
        alone = simvis.Simulation.from_string(NOISY, seed=6)
        alone.step()
        np.testing.assert_array_equal(sims.outputs["SCAN.range_m"][0], alone["SCAN"].range_m)

    def test_parameters(self) -> None:
        sims = environments()
        sims.parameters["P.x"] = [1, 2, 3]
        sims.parameters["P.y"] = np.float32(4)
        self.assertEqual(sims.parameters["P.x"].tolist(), [1, 2, 3])
        self.assertEqual({name: values.tolist() for name, values in sims.parameters.items()}["P.y"], [4, 4, 4])
        self.assertEqual([sim["P"].x for sim in sims], [1, 2, 3])

    def test_mistakes(self) -> None:
        sims = environments()
        for call, error, message in (
                (lambda: simvis.VectorSimulation.from_string(NOISY, 0), simvis.InputError, "0 environments are not possible"),
                (lambda: simvis.VectorSimulation.load("no.xml", 2), simvis.InputError, "no.xml"),
                (lambda: environments(rate=3), TypeError, r'VectorSimulation.from_string\(\) has no setting "rate"'),
                (lambda: sims.outputs["SCN.range_m"], simvis.UnknownName, 'no sensor "SCN", did you mean "SCAN"'),
                (lambda: sims.outputs["SCAN.rang_m"], simvis.InputError, 'no output "rang_m", did you mean "range_m"'),
                (lambda: sims.outputs["SCAN"], simvis.UnknownName, "names no output, expected SENSOR.OUTPUT"),
                (lambda: sims.parameters["P.z9"], simvis.UnknownName, 'has no parameter "z9"'),
                (lambda: sims.parameters.update({"Q.x": 1}), simvis.UnknownName, 'no element "Q"'),
                (lambda: sims.parameters.update({"P.x": [1, 2]}), simvis.InputError, "P.x has 2 values, expected 1 or 3"),
                (lambda: sims.parameters.update({"P.x": [[1, 2, 3]]}), simvis.InputError, r"has the shape \(1, 3\)"),
                (lambda: sims.parameters.update({"P.x": "far"}), simvis.InputError, "P.x is 'far'"),
                (lambda: sims.parameters.update({"P.x": [0, np.nan, 0]}), simvis.InputError, r"\(environment 1\)"),
                (lambda: sims.restore_states(), simvis.InputError, "no state to restore, expected save_states"),
                (lambda: sims.step_some([0, 0]), simvis.InputError, "environment 0 comes twice"),
                (lambda: sims.step_some([-1]), simvis.InputError, "expected numbers from 0, or 3 values of bool"),
                (lambda: sims.step_some([True]), simvis.InputError, "expected numbers from 0, or 3 values of bool"),
                (lambda: sims.reload([1]), simvis.InputError, "1 seeds for 3 environments"),
                (lambda: sims.reload([-1], [0]), simvis.InputError, "a seed is -1"),
                (lambda: sims.step(dt_s=-1), simvis.InputError, "dt_s is -1"),
                (lambda: sims[3], IndexError, "no environment 3 among 3")):
            with self.subTest(message=message), self.assertRaisesRegex(error, message):
                call()

    def test_what_python_raises_in_any_thread(self) -> None:
        scene = NOISY.replace("</simvis>", '<element type="shy_of_vectors" name="SHY" insert_at="ROOT"/></simvis>')
        for threads in (1, 2, 4):
            sims = simvis.VectorSimulation.from_string(scene, 8, threads=threads)
            sims.only("SCAN")
            for failing in range(8):
                values = np.zeros(8)
                values[failing] = 2
                sims.parameters["SHY.at"] = values
                with self.assertRaisesRegex(OverflowError, "2 is too much"):
                    sims.step()
                self.assertEqual(sims.failed, [failing])
                sims.parameters["SHY.at"] = 0
                sims.step()
                self.assertEqual(sims.failed, [])

    def test_one_thread_at_a_time(self) -> None:
        sims = environments(64)
        failures: list[str] = []

        def step() -> None:
            for _ in range(20):
                try:
                    sims.step()
                except simvis.InputError as error:
                    failures.append(str(error))

        threads = [threading.Thread(target=step) for _ in range(2)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertTrue(failures)
        self.assertEqual({message.partition(",")[0] for message in failures}, {"these environments are in use by another thread"})

    def test_a_forked_process(self) -> None:
        sims = environments()
        sims.step()
        child = os.fork()
        if child == 0:
            status = 1
            try:
                sims.step()
            except simvis.InputError as error:
                status = 7 if "was forked" in str(error) else 2
            del sims
            os._exit(status)
        self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), 7)
        sims.step()

    def test_nothing_is_left(self) -> None:
        sims = environments()
        array = sims.outputs["SCAN.range_m"]
        gone = weakref.ref(array.base)
        del array
        gc.collect()
        self.assertIsNone(gone())


@unittest.skipUnless(find_spec("gymnasium"), "gymnasium is not installed")
class VectorEnvs(unittest.TestCase):
    def pair(self, name: str, **settings: Any) -> tuple[Any, Any]:
        own = gymnasium.make_vec(name, 3, **settings)
        other = gymnasium.make_vec(name, 3, vectorization_mode="sync", **settings)
        self.addCleanup(own.close)
        self.addCleanup(other.close)
        return own, other

    def same(self, own: Any, other: Any) -> None:
        self.assertEqual(own.keys(), other.keys())
        for name in own:
            self.assertEqual((own[name].dtype, own[name].tobytes()), (other[name].dtype, other[name].tobytes()), name)

    def test_the_vector_is_that_of_single_environments(self) -> None:
        for name in ("simvis/Drive-v0", "simvis/DriveByCamera-v0"):
            own, other = self.pair(name, max_episode_steps=6)
            self.assertEqual(own.metadata["autoreset_mode"], AutoresetMode.NEXT_STEP)
            self.assertEqual((own.single_observation_space, own.observation_space, own.single_action_space, own.action_space),
                             (other.single_observation_space, other.observation_space, other.single_action_space,
                              other.action_space))
            for seed in (3, [4, 9, 2]):
                self.same(own.reset(seed=seed)[0], other.reset(seed=seed)[0])
                frames = 20 if "Camera" not in name else 8
                for frame in range(frames):
                    actions = np.random.default_rng(frame).uniform([0.5, -90], [1, 90], (3, 2)).astype(np.float32)
                    one, two = own.step(actions), other.step(actions)
                    self.same(one[0], two[0])
                    for k in (1, 2, 3):
                        np.testing.assert_array_equal(one[k], two[k])
                    np.testing.assert_array_equal(one[4]["frames"], two[4]["frames"])
                    self.assertTrue(own.observation_space.contains(one[0]))

    def test_bumps_end_single_episodes(self) -> None:
        own, other = self.pair("simvis/Drive-v0")
        own.reset(seed=1), other.reset(seed=1)
        ends = 0
        for _ in range(60):
            actions = np.tile(np.array([1, 0], np.float32), (3, 1))
            one, two = own.step(actions), other.step(actions)
            np.testing.assert_array_equal(one[2], two[2])
            np.testing.assert_array_equal(one[1], two[1])
            self.same(one[0], two[0])
            ends += int(one[2].sum())
        self.assertGreater(ends, 2)

    def test_a_scene_with_outputs(self) -> None:
        import tempfile
        from pathlib import Path

        with tempfile.TemporaryDirectory() as folder:
            scene = Path(folder) / "scene.xml"
            scene.write_text(NOISY)
            for reload in (True, False):
                env = gym.SceneVectorEnv(2, scene, {"P.x": (-1, 1)}, outputs=["SCAN.range_m", "CAM.rgb"], reload=reload,
                                         reward=lambda sims: sims.parameters["P.x"], max_episode_steps=2,
                                         ended=lambda sims: sims.parameters["P.x"] > 0.5, render_mode="rgb_array",
                                         render_camera="CAM")
                first, _ = env.reset(seed=0)
                self.assertEqual({name: each.shape for name, each in first.items()},
                                 {"parameters": (2, 1), "SCAN.range_m": (2, 3, 31), "CAM.rgb": (2, 16, 32, 3)})
                results = [env.step(np.array([[x], [0]], np.float32)) for x in (0.75, 0.25, 0.25)]
                self.assertEqual([each[1].tolist() for each in results], [[0.75, 0], [0, 0], [0.25, 0]])
                self.assertEqual([each[2].tolist() for each in results], [[True, False], [False, False], [False, False]])
                self.assertEqual([each[3].tolist() for each in results], [[False, False], [False, True], [False, False]])
                again = results[1][0]["SCAN.range_m"][0]
                self.assertEqual((again == first["SCAN.range_m"][0]).all(), not reload)  # with noise of its own
                self.assertEqual(results[1][0]["parameters"][0], 0)
                self.assertEqual(np.array(env.render()).shape, (2, 16, 32, 3))
                env.close()

    def test_wrappers_of_gymnasium(self) -> None:
        env = gymnasium.wrappers.vector.RecordEpisodeStatistics(gymnasium.make_vec("simvis/Drive-v0", 2, max_episode_steps=3))
        self.addCleanup(env.close)
        env.reset(seed=0)
        infos = [env.step(env.action_space.sample())[4] for _ in range(3)]
        self.assertEqual(infos[-1]["episode"]["l"].tolist(), [3, 3])

    def test_mistakes(self) -> None:
        env = gymnasium.make_vec("simvis/Drive-v0", 2)
        self.addCleanup(env.close)
        with self.assertRaises(gymnasium.error.ResetNeeded):
            env.step(env.action_space.sample())
        with self.assertRaisesRegex(simvis.InputError, "3 seeds, expected 2"):
            env.reset(seed=[1, 2, 3])
        with self.assertRaisesRegex(simvis.InputError, "actions is empty"):
            gym.SceneVectorEnv(2, simvis.scene("marvin"), {})
        wrong = gym.SceneVectorEnv(2, simvis.scene("marvin"), {"R_POSE.x": (0, 1)}, sensors=["FRONT_SCANNER"],
                                   reward=lambda sims: 1.0)
        self.addCleanup(wrong.close)
        wrong.reset()
        with self.assertRaisesRegex(simvis.InputError, r"returned the shape \(\), expected \(2,\)"):
            wrong.step(np.zeros((2, 1), np.float32))


if __name__ == "__main__":
    unittest.main()
