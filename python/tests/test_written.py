"""Elements and sensors that are written in Python."""
import os
import unittest
from collections.abc import Mapping
from typing import Any

import numpy as np
import simvis


class Door(simvis.CustomElement, type="python_door", summary="A door on its hinge."):
    attributes = [simvis.Attribute("open", 0, "%", "how open", min=0, max=100, live=True),
                  simvis.Attribute("width", 1.0, "m", min=0)]

    def __init__(self, context: simvis.Context) -> None:
        self.hinge = context.insert_transform()
        self.width = context.attributes["width"]

    def update(self, values: Mapping[str, float]) -> None:
        self.hinge.set_pose(yaw=0.9 * values["open"])


class Plate(simvis.CustomElement, type="python_plate"):
    attributes = [simvis.Attribute("x", 1, "m", live=True)]

    def __init__(self, context: simvis.Context) -> None:
        corners = np.array([[0, -1, -1], [0, 1, -1], [0, 1, 1], [0, -1, 1]], np.float32)
        self.place = context.insert_mesh(corners, np.array([[0, 2, 1], [0, 3, 2]], np.uint32), [0.1, 0.5, 0.9])

    def update(self, values: Mapping[str, float]) -> None:
        if values["x"] == 13:
            raise RuntimeError("no plate stands at 13")
        self.place.set_pose(x=values["x"])


class Bumper(simvis.CustomSensor, type="python_bumper"):
    attributes = [simvis.Attribute("offset", 0.0, "m")]
    values = ["nearest_m", "time_s"]
    directions = [[1, 0, 0], [0, 1, 0]]

    def __init__(self, context: simvis.Context) -> None:
        self.offset = context.attributes["offset"]

    def measure(self, ranges_m: Any, time_s: float) -> Mapping[str, float]:
        return {"nearest_m": ranges_m.min() - self.offset, "time_s": time_s}


SCENE = """<s>
  <element type="python_plate" name="PLATE" insert_at="ROOT" x="2"/>
  <part name="R" insert_at="ROOT"/>
  <element type="python_door" name="DOOR" insert_at="R"/>
  <sensor type="python_bumper" name="BUMPER" insert_at="R" offset="0.5" rate="5"/>
</s>"""


class Written(unittest.TestCase):
    def test_a_scene_names_them(self) -> None:
        sim: Any = simvis.Simulation.from_string(SCENE)
        sim.step()
        self.assertAlmostEqual(sim["BUMPER"].value("nearest_m"), 1.5, 6)
        sim["PLATE"].x = 3
        for _ in range(3):
            sim.step()
        self.assertAlmostEqual(sim["BUMPER"].value("nearest_m"), 2.5, 6)
        self.assertAlmostEqual(sim["BUMPER"].value("time_s"), 0.2, 6)
        self.assertEqual(sim["BUMPER"].frames, 2)
        self.assertIn("gives nearest_m: scalar, f64, 1\n", str(sim))
        sim["DOOR"].open = 100
        sim.step(dt_s=1)
        self.assertEqual(sim["BUMPER"].value("nearest_m"), float("inf"))
        with self.assertRaisesRegex(simvis.InputError, "DOOR.open"):
            sim["DOOR"].open = 101

    def test_what_update_raises_the_step_raises(self) -> None:
        sim: Any = simvis.Simulation.from_string(SCENE)
        sim["PLATE"].x = 13
        with self.assertRaisesRegex(RuntimeError, "no plate stands at 13"):
            sim.step()
        sim["PLATE"].x = 1
        sim.step()

    def test_what_a_constructor_raises_stands_at_the_command(self) -> None:
        class Broken(simvis.CustomElement, type="python_broken"):
            def __init__(self, context: simvis.Context) -> None:
                raise RuntimeError("nothing works")

        with self.assertRaises(simvis.InputError) as caught:
            simvis.Simulation.from_string('<s>\n<element type="python_broken" name="B" insert_at="ROOT"/></s>')
        self.assertIn("its Python class raised RuntimeError: nothing works", str(caught.exception))
        self.assertEqual(caught.exception.line, 2)
        self.assertIsInstance(caught.exception.__cause__, RuntimeError)

    def test_a_refused_request_of_a_client_does_not_raise_what_its_class_raised(self) -> None:
        import simvis_client

        class Refused(simvis.CustomElement, type="python_refused"):
            def __init__(self, context: simvis.Context) -> None:
                raise RuntimeError("not this one")

        name = f"test-python-refused-{os.getpid()}"
        sim: Any = simvis.Simulation.from_string(SCENE)
        sim.serve(name)
        with simvis_client.connect(name, timeout_s=60) as client:
            client.send('<element type="python_refused" name="R" insert_at="ROOT"/>')
            sim.step()
            texts = [text for _, _, _, text in client.log()[0]]
        self.assertTrue(any("its Python class raised RuntimeError" in text for text in texts), texts)
        sim["PLATE"].x = 13
        with self.assertRaisesRegex(RuntimeError, "no plate stands at 13"):
            sim.step()
        with self.assertRaises(simvis.InputError) as caught:
            sim.execute('<element type="nothing" name="N" insert_at="ROOT"/>')
        self.assertIsNone(caught.exception.__cause__)

    def test_the_scene_changes_in_update_only(self) -> None:
        kept: list[Any] = []

        class Keeper(simvis.CustomElement, type="python_keeper"):
            def __init__(self, context: simvis.Context) -> None:
                kept.extend([context, context.insert_transform()])

            def update(self, values: Mapping[str, float]) -> None:
                pass

        simvis.Simulation.from_string('<element type="python_keeper" name="K" insert_at="ROOT"/>')
        with self.assertRaisesRegex(simvis.InputError, "in an element's __init__"):
            kept[1].set_pose(x=1)
        with self.assertRaisesRegex(simvis.InputError, "belongs into the __init__"):
            kept[0].insert_transform()

    def test_names_and_tables_are_checked(self) -> None:
        with self.assertRaisesRegex(simvis.InputError, 'type "pose" exists already'):
            class Pose(simvis.CustomElement, type="pose"):
                pass
        with self.assertRaises(simvis.InputError):
            class Live(simvis.CustomElement, type="python_live"):
                attributes = [simvis.Attribute("x", live=True)]
        with self.assertRaisesRegex(simvis.InputError, "registered with another table"):
            class Other(simvis.CustomElement, type="python_door"):
                pass
        with self.assertRaisesRegex(simvis.InputError, "has no values"):
            class Nothing(simvis.CustomSensor, type="python_nothing"):
                directions = [[1, 0, 0]]

        class Long(simvis.CustomSensor, type="python_long"):
            values = ["x"]
            directions = [[2, 0, 0]]
        with self.assertRaisesRegex(simvis.InputError, "direction 0 has length 2, expected 1"):
            simvis.Simulation.from_string('<sensor type="python_long" name="L" insert_at="ROOT"/>')

    def test_the_same_class_again_replaces_the_first(self) -> None:
        for number in (1.0, 2.0):
            class Counter(simvis.CustomSensor, type="python_counter", summary="A counter."):
                values = ["count"]
                directions = [[1, 0, 0]]
                count = number

                def measure(self, ranges_m: Any, time_s: float) -> Mapping[str, float]:
                    return {"count": self.count}

            sim: Any = simvis.Simulation.from_string('<sensor type="python_counter" name="C" insert_at="ROOT"/>')
            sim.step()
            self.assertEqual(sim["C"].value("count"), number)


if __name__ == "__main__":
    unittest.main()
