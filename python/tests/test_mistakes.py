"""Mistakes of users, each with the message that helps."""
import os
import pickle
import tempfile
import unittest
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import simvis
from small_scene import SCENE, load


class Mistakes(unittest.TestCase):
    sim: simvis.Simulation

    @classmethod
    def setUpClass(cls) -> None:
        cls.sim = load()
        cls.sim.step()

    def expect(self, message: str, call: Callable[[], Any], kind: type[BaseException] = simvis.InputError) -> Any:
        with self.assertRaises(kind) as caught:
            call()
        self.assertIn(message, str(caught.exception))
        return caught.exception

    def test_in_scenes(self) -> None:
        error = self.expect('unknown sensor type "camra", did you mean "camera"?',
                            lambda: load('<s>\n  <sensor type="camra" name="C" insert_at="ROOT"/>\n</s>', name="s.xml"))
        self.assertEqual((error.file, error.line, error.column), ("s.xml", 2, 11))
        again = pickle.loads(pickle.dumps(error))
        self.assertEqual((str(again), again.line), (str(error), 2))
        error = self.expect("", lambda: load("<s><part</s>"))
        self.assertEqual(error.line, 1)
        self.expect("no_such_scene.xml", lambda: simvis.Simulation.load("no_such_scene.xml"))
        self.expect("there is no insertion point", lambda: load('<part shape="box" size="1 1 1" name="B" insert_at="RO"/>'))
        self.expect('there is no scene "marvn" in the package, expected one of arm, ', lambda: simvis.scene("marvn"))
        self.expect("expected Simulation.load(FILE)", lambda: simvis.Simulation("scene.xml"))  # type: ignore[arg-type]
        self.expect('text "scene.xml" between commands', lambda: load("scene.xml<s/>"))

    def test_in_paths(self) -> None:
        load_text = simvis.Simulation.from_string
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "a").write_text("<s/>")
            named = f"{folder}/a"
            calls: dict[str, Callable[[Any], Any]] = {
                "scene": simvis.Simulation.load, "file": simvis.load_plugin, "folder": lambda path: load_text("<s/>", folder=path),
                "cache_dir": lambda path: load_text("<s/>", cache_dir=path),
                'package "a"': lambda path: load_text("<s/>", packages={"a": path}),
            }
            sim = load()
            opened: dict[str, Callable[[Any], Any]] = {
                "file": sim.record, "file ": sim.record_page, "a folder": lambda path: sim.serve("paths", [path]),
                "folder": lambda path: sim.execute("<s/>", folder=path),
            }
            for of in (calls, opened):
                for name, call in of.items():
                    for path in ("\0", named + "\0b", named.encode() + b"\0"):
                        with self.subTest(name=name, path=path):
                            error = self.expect("expected a path without NUL", lambda: call(path))
                            self.assertTrue(str(error).startswith(name.strip() + " is "), error)
            self.assertEqual(os.listdir(folder), ["a"])
            self.assertEqual(simvis.Simulation.load(os.fsencode(named)).sensors, {})
            missing = folder + "/\udc80.xml"  # a byte that is no UTF-8
            error = self.expect("cannot be read: No such file", lambda: simvis.Simulation.load(missing))
            self.assertEqual(error.file, missing)
            Path(missing).write_text("<s/>")
            simvis.Simulation.load(missing)
            self.expect("File name too long", lambda: simvis.Simulation.load("x" * 5000))
            self.expect("no file can have this name", lambda: simvis.load_plugin(""))

    def test_in_texts_with_nul_or_half_of_a_pair(self) -> None:
        self.expect(r"a\x00b:1:2: error: ", lambda: load("<s", name="a\0b"))
        self.expect(r'no Vulkan device matches "a\x00b"', lambda: load("<s/>", device="a\0b"))
        self.expect(r'there is no part or link "a\x00b"', lambda: self.sim.track_part("a\0b"))
        for name, settings in {"device": {"device": "\udc80"}, "overrides": {"overrides": {"\udc80": "1"}},
                               "override": {"overrides": {"camera.width": "\udc80"}},
                               "packages": {"packages": {"\udc80": "/"}}}.items():
            with self.subTest(name=name):
                self.expect(r"is '\udc80', expected a text of whole characters", lambda: load("<s/>", **settings))

    def test_in_names(self) -> None:
        sim: Any = self.sim
        self.expect('there is no element or sensor "SCN", did you mean "SCAN"?', lambda: sim["SCN"])
        self.expect('element "P" has no parameter "yww", did you mean "yaw"?', lambda: sim["P"].yww)
        self.expect('there is no sensor "SCN", did you mean "SCAN"?', lambda: sim.sensors["SCN"])
        self.expect('there is no element "p", did you mean "P"?', lambda: sim.elements["p"])
        self.expect('there is no element or sensor "0"', lambda: sim[0])
        self.expect("['SCAN', 'CAM'] is no name, expected names", lambda: sim.only(["SCAN", "CAM"]))
        self.assertEqual(list(sim), ["P", "SCAN", "CAM", "EYES", "PSD"])
        self.assertNotIn("SCN", sim)
        self.expect('element "P" has no parameter "yww"', lambda: setattr(sim["P"], "yww", 1))
        self.expect('"yaw" names no parameter, expected ELEMENT.PARAMETER', lambda: sim.parameters["yaw"])
        self.assertIsNone(sim.parameters.get("P.nothing"))
        self.assertFalse(hasattr(sim["P"], "nothing"))
        self.expect('sensor "CAM", a camera, has no output "range_m", expected one of color', lambda: sim["CAM"].range_m)
        self.expect('sensor "SCAN" has no image "color"', lambda: sim["SCAN"].color)
        self.expect('truth="hit" in the scene adds them', lambda: sim["SCAN"].labels)
        self.expect('"SCAN"', lambda: sim["SCAN"].reading)
        self.expect('has no channel "returns", expected one of intensity', lambda: sim["SCAN"].scan.channel("returns"))

    def test_of_newcomers(self) -> None:
        self.expect('there is no file "marvin", did you mean simvis.scene("marvin")?', lambda: simvis.Simulation.load("marvin"))
        self.expect("there is no scene \"rover\" in the package, expected one of arm, ", lambda: simvis.scene("rover"))
        sim = load()
        sim.only("SCAN")
        sim.step()
        for read in (lambda: sim["CAM"].rgb, lambda: sim["PSD"].range_m, lambda: sim["EYES"].depth):
            self.expect("is switched off, as only() does with all others", read)

    def test_of_keywords(self) -> None:
        for settings, right in (({"rate": 10}, "rate_hz"), ({"rate_Hz": 10}, "rate_hz"), ({"fps": 10}, "rate_hz"),
                                ({"override": {}}, "overrides"), ({"num_threads": 1}, "threads"), ({"gpu": "0"}, "device")):
            for name, call in (("from_string", load), ("load", simvis.Simulation.load)):
                with self.subTest(settings=settings, call=name):
                    wrong = next(iter(settings))
                    self.expect(f'Simulation.{name}() has no setting "{wrong}", did you mean "{right}"?',
                                lambda: call("scene.xml", **settings), TypeError)  # type: ignore[arg-type]
        self.expect('has no setting "\udc80", expected one of scene, rate_hz, seed',
                    lambda: simvis.Simulation.load("s", **{"\udc80": 1}), TypeError)  # type: ignore[arg-type]

    def test_of_names_in_wrong_places(self) -> None:
        sim: Any = self.sim
        self.expect('"ROBOT" is a part, expected an element or a sensor, did you mean "P", which is inserted at it?',
                    lambda: sim["ROBOT"].x)
        self.expect('"BALL" is a part, expected an element or a sensor; <element type="pose" name="BALL_POSE" insert_at="BALL"/> '
                    "in the scene moves it", lambda: sim["BALL"])
        for name in ("P", "SCAN"):
            self.expect(f'"{name}" is in the scene, did you mean sim["{name}"]?', lambda: getattr(sim, name), AttributeError)
        self.expect('a Simulation has no "stepp", did you mean "step"?', lambda: sim.stepp, AttributeError)
        self.assertFalse(hasattr(sim, "SCN") or hasattr(sim, "_nothing"))
        self.expect('"samples" of sensor "SCAN" cannot be set; expected it in the scene, or '
                    'overrides={"laser_scanner.samples": "10"} of', lambda: setattr(sim["SCAN"], "samples", 10), AttributeError)
        more = load(overrides={"laser_scanner.samples": "10"})
        more.step()
        self.assertEqual(more["SCAN"].range_m.shape, (3, 10))
        for wrong, right in {"ranges": "range_m", "distances": "range_m", "intensities": "intensity"}.items():
            self.expect(f'has no output "{wrong}", did you mean "{right}"?', lambda: getattr(sim["SCAN"], wrong))
        closed = load()
        closed.close()
        self.assertFalse(hasattr(closed, "P"))

    def test_of_calls(self) -> None:
        sim: Any = load()
        self.expect("step() has 10 without a name, expected step(dt_s=10) for a frame 10 s later, or for frame in run(10)",
                    lambda: sim.step(10))
        self.assertTrue(np.isnan(sim.time_s))
        for text in ("scene.xml", Path("scene.xml")):
            self.expect("'scene.xml' has no commands of a scene, did you mean Simulation.load('scene.xml')?", lambda: load(text))

    def test_in_values(self) -> None:
        sim: Any = self.sim
        self.expect("P.x", lambda: sim.set("P", "x", float("nan")))
        self.expect("P.x is 'far', expected a number", lambda: setattr(sim["P"], "x", "far"))
        self.expect("P.x is None, expected a number", lambda: sim.set("P", "x", None))
        self.expect("P.x is 'far', expected a number", lambda: sim.parameters.update({"P.x": "far"}))
        self.expect("the matrix is not rigid", lambda: sim["P"].set_pose(2 * np.eye(4)))
        self.expect("the matrix has shape (3, 3), expected (4, 4)", lambda: sim["P"].set_pose(np.eye(3)))
        self.expect("dt_s is -1, expected seconds above 0", lambda: sim.step(dt_s=-1))
        self.expect("dt_s is '0.1', expected seconds", lambda: sim.step(dt_s="0.1"))
        self.expect("a rate of 0 frames per second is not possible", lambda: load(rate_hz=0))
        self.expect("rate_hz is '15', expected a number", lambda: load(rate_hz="15"))
        self.expect("threads is 1.5, expected a whole number", lambda: load(threads=1.5))
        self.expect('is 10, expected the text of an attribute, such as "10"', lambda: load(overrides={"psd.rate": 10}))
        self.expect('frame is "wrld", expected "sensor" or "world"', lambda: sim["SCAN"].points("wrld"))
        self.expect('no Vulkan device matches "nothing"', lambda: load(device="nothing"))
        self.expect("seed is -1", lambda: load(seed=-1))
        self.expect('override "method": expected TYPE.ATTRIBUTE', lambda: load(overrides={"method": "planar"}))
        self.expect("expected times_s with it", lambda: simvis.Trajectory({"P.x": [0, 1]}))
        self.expect("times_s are not finite and increasing", lambda: simvis.Trajectory({"P.x": [0, 1]}, [1, 1]))
        self.expect("P.x is None at 0 s", lambda: simvis.Trajectory({"P.x": lambda t: None}).apply(sim, 0))
        self.expect("expected a simvis.Trajectory", lambda: list(sim.run(1, {"P.x": [0, 1]}, progress=False)))
        self.expect("expected a Simulation", lambda: simvis.viewer("scene.xml"))  # type: ignore[arg-type]
        self.expect("port is 70000, expected 0 to 65535", lambda: simvis.viewer(sim, 70000))
        self.expect("frames is -1", lambda: list(sim.run(-1)))

    def test_in_many_simulations(self) -> None:
        scene = simvis.scene("marvin")
        self.expect("expected either seeds or parameters", lambda: simvis.map(print, scene))
        self.expect("is no scene file", lambda: simvis.map(print, SCENE, seeds=[1]))
        self.expect("expected a function that a module defines", lambda: simvis.map(lambda sim: 1, scene, seeds=[1], workers=1))
        self.expect("workers is -1", lambda: simvis.map(print, scene, seeds=[1], workers=-1))

    def test_in_types_of_their_own(self) -> None:
        for base in (simvis.CustomElement, simvis.CustomSensor):
            self.expect(f'class Door has no name for scenes, expected one as in: class Door(simvis.{base.__name__}, '
                        'type="door")', lambda base=base: type("Door", (base,), {}))

        class Forgotten(simvis.CustomElement, type="mistake_forgotten"):
            attributes = [simvis.Attribute("x", 0, live=True)]

        class Other(simvis.CustomSensor, type="mistake_other"):
            values = ["near_m", "far_m"]
            directions = [[1, 0, 0]]

            def measure(self, ranges_m: Any, time_s: float) -> Any:
                return {"near_m": 1.0}

        self.expect("the class Forgotten has no update()",
                    lambda: load('<element type="mistake_forgotten" name="F" insert_at="ROOT"/>').step(), NotImplementedError)
        self.expect("Other.measure() returned {'near_m': 1.0}, expected a number for each of near_m, far_m",
                    lambda: load('<sensor type="mistake_other" name="O" insert_at="ROOT"/>').step())

        given: dict[str, Any] = {}

        class Third(simvis.CustomSensor, type="mistake_third"):
            values = ["near_m"]
            directions = [[1, 0, 0]]

            def measure(self, ranges_m: Any, time_s: float) -> Any:
                return given

        sim = load('<sensor type="mistake_third" name="T" insert_at="ROOT"/>')
        for value, text in ((np.zeros(2, np.float32), "an array of float32 of shape (2,)"), ("3", "'3', a str"),
                            (None, "None, a NoneType"), (np.zeros(()), "an array of float64 of shape ()")):
            given["near_m"] = value
            self.expect(f'sensor "T": output "near_m": Third.measure() gave {text}, expected one number, f64', sim.step)
        given["near_m"] = np.float32(0.5)
        Third.values = ["near_m", "far_m"]  # the type has the names that it had when it was registered
        sim.step()
        self.assertEqual(sim["T"].value("near_m"), 0.5)
        with self.assertRaisesRegex(simvis.InputError, "attributes has 'x', expected rows such as simvis.Attribute"):
            class Rows(simvis.CustomElement, type="mistake_rows"):
                attributes = ["x"]  # type: ignore[list-item]

    def test_in_buffers(self) -> None:
        sim: Any = self.sim
        wrong = "expected a writable float32 array of shape (3, 31)"
        self.expect(wrong, lambda: sim["SCAN"].scan.read(np.empty((3, 31))))
        self.expect("the array has shape (31, 3)", lambda: sim["SCAN"].scan.read(np.empty((31, 3), np.float32)))
        self.expect(wrong, lambda: sim["SCAN"].scan.read(sim["SCAN"].range_m))
        self.expect(wrong, lambda: sim["SCAN"].scan.read(np.empty((3, 62), np.float32)[:, ::2]))
        self.expect('the image "depth" of "CAM" has no colour', lambda: sim["CAM"].image("depth").rgb())

    def test_in_the_order_of_calls(self) -> None:
        sim: Any = load()
        other: Any = load()
        self.expect('sensor "SCAN" has not measured yet, expected step() before', lambda: sim["SCAN"].range_m)
        self.expect('sensor "CAM" has not measured yet', lambda: sim["CAM"].rgb)
        sim.step_async()
        self.expect("a frame is under way, expected finish() before this", lambda: sim.execute("<s/>"))
        sim.finish()
        self.expect("is not tracked, expected track_part() before", lambda: sim.part_pose("ROBOT"))
        scanner = sim["SCAN"]
        sim.execute('<remove name="SCAN"/>')
        self.expect('there is no sensor "SCAN"', lambda: scanner.range_m)
        sim.close()
        for call in (sim.step, lambda: sim["P"], lambda: sim.warnings, lambda: scanner.range_m, lambda: sim.time_s):
            self.expect("this simulation is closed", call)
        parameters = other.parameters
        self.assertEqual(parameters.get("P.nothing", 7.0), 7)
        self.assertEqual(parameters.get("nothing", 7.0), 7)
        other.close()
        for name in ("P.x", "P.nothing", "nothing"):
            with self.assertRaises(simvis.InputError) as caught:
                parameters.get(name, 7.0)
            self.assertNotIsInstance(caught.exception, KeyError)
        self.assertEqual(repr(sim), "a closed simulation")
        sim.close()


if __name__ == "__main__":
    unittest.main()
