"""simvis.data: frames by number, the same in any order, process and batch."""
import pickle
import random
import tempfile
import unittest
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import simvis
from simvis.data import Frames
from small_scene import SCENE

OUTPUTS = ["SCAN.range_m", "CAM.rgb", "EYES.left_depth", "PSD.range_m", "SCAN.points"]


def place(draw: random.Random) -> dict[str, float]:
    return {"P.x": draw.uniform(-0.5, 0.5), "P.yaw": draw.uniform(-90, 90)}


def bytes_of(frames: Frames, number: int) -> dict[str, bytes]:
    return {name: array.tobytes() for name, array in frames[number].items()}


class Data(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.scene = Path(folder.name) / "scene.xml"
        self.scene.write_text(SCENE)
        self.frames = Frames(self.scene, 5, place, OUTPUTS, seed=7)
        self.addCleanup(self.frames.close)

    def test_a_frame_has_what_the_sensors_measure_with_its_parameters(self) -> None:
        frame = self.frames[3]
        self.assertEqual(list(frame), [*OUTPUTS, "parameters"])
        drawn = place(random.Random("7 3"))
        np.testing.assert_array_equal(frame["parameters"], list(drawn.values()))
        sim = simvis.Simulation.load(self.scene)
        sim.parameters.update(drawn)
        sim.step()
        np.testing.assert_array_equal(frame["SCAN.range_m"], sim["SCAN"].range_m)
        np.testing.assert_array_equal(frame["SCAN.points"], sim["SCAN"].points())
        np.testing.assert_array_equal(frame["CAM.rgb"], sim["CAM"].rgb)
        np.testing.assert_array_equal(frame["EYES.left_depth"], sim["EYES"].depth)
        self.assertEqual(frame["PSD.range_m"], sim["PSD"]["range_m"])
        for array in frame.values():
            self.assertTrue(array.flags.writeable and array.flags.owndata)

    def test_frames_are_the_same_in_any_order_and_process(self) -> None:
        forward = [bytes_of(self.frames, i) for i in range(5)]
        self.assertEqual(len({each["SCAN.range_m"] for each in forward}), 5)
        self.assertEqual([bytes_of(self.frames, i) for i in (4, 2, 0)], [forward[4], forward[2], forward[0]])
        self.assertEqual(bytes_of(self.frames, -1), forward[4])
        with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
            self.assertEqual(pool.submit(bytes_of, self.frames, 2).result(), forward[2])
        again = pickle.loads(pickle.dumps(self.frames))
        self.assertEqual(bytes_of(again, 1), forward[1])
        again.close()
        other = Frames(self.scene, 5, place, OUTPUTS, seed=8)
        self.assertNotEqual(bytes_of(other, 1)["SCAN.range_m"], forward[1]["SCAN.range_m"])
        other.close()

    def test_batches(self) -> None:
        batches = list(self.frames.batches(2))
        self.assertEqual([batch["CAM.rgb"].shape for batch in batches], [(2, 16, 32, 3), (2, 16, 32, 3), (1, 16, 32, 3)])
        np.testing.assert_array_equal(batches[1]["SCAN.range_m"][1], self.frames[3]["SCAN.range_m"])
        self.assertEqual(len(list(self.frames)), len(self.frames))

    def test_nothing_is_drawn_without_a_function(self) -> None:
        frames = Frames(self.scene, 2, None, ["SCAN.range_m"])
        self.assertEqual(bytes_of(frames, 0), bytes_of(frames, 1))
        self.assertEqual(frames[0]["parameters"].shape, (0,))
        frames.close()

    def test_mistakes(self) -> None:
        with self.assertRaises(IndexError):
            self.frames[5]
        with self.assertRaisesRegex(simvis.InputError, '"SCAN" names no output, expected SENSOR.OUTPUT'):
            Frames(self.scene, 1, None, ["SCAN"])
        with self.assertRaisesRegex(simvis.InputError, "outputs is empty"):
            Frames(self.scene, 1, None, [])
        with self.assertRaisesRegex(simvis.InputError, "count is -1"):
            Frames(self.scene, -1, None, OUTPUTS)
        with self.assertRaisesRegex(simvis.InputError, "size is 0"):
            next(self.frames.batches(0))
        with self.assertRaisesRegex(simvis.UnknownName, 'has no output "ranges", did you mean "range_m"?'):
            Frames(self.scene, 1, None, ["SCAN.ranges"])[0]
        with self.assertRaisesRegex(simvis.UnknownName, 'there is no sensor "SCN"'):
            Frames(self.scene, 1, None, ["SCN.range_m"])[0]


if __name__ == "__main__":
    unittest.main()
