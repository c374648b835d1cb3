"""Threads, processes, interrupts and memory."""
import copy
import gc
import os
import pickle
import resource
import signal
import subprocess
import sys
import tempfile
import textwrap
import threading
import unittest
import weakref
from contextlib import closing
from importlib import import_module
from importlib.util import find_spec
from itertools import count, islice
from pathlib import Path
from typing import Any

import numpy as np
import simvis
from simvis import testing
from small_scene import SCENE, load

ROOT = Path(__file__).resolve().parents[2]
EMPTY = '<s><part shape="box" size="1 1 1" name="B" insert_at="ROOT" pose_offset="2 0 0 0 0 0"/>' \
        '<element type="pose" name="P" insert_at="ROOT"/>' \
        '<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="9"/></s>'


def ranges_of(simulation: simvis.Simulation) -> np.ndarray:
    simulation.step()
    return simulation["SCAN"].range_m.copy()


def measurement_of(sim: simvis.Simulation) -> simvis.Measurement:
    sim.step()
    return sim.sensors["SCANNER"].measurement


START = f"""
import sys
sys.path[:0] = {sys.path!r}
import os, threading, time, simvis
EMPTY = {EMPTY!r}
def load(more=""):
    sim = simvis.Simulation.from_string(EMPTY.replace("</s>", more + "</s>"))
    sim.step()
    return sim
def daemon(function):
    def loop():
        while True: function()
    threading.Thread(target=loop, daemon=True).start()
    time.sleep(0.2)
"""


def started(program: str) -> subprocess.Popen[str]:
    """A program that begins with START: `daemon` calls a function again and again in a thread."""
    return subprocess.Popen([sys.executable, "-c", START + textwrap.dedent(program)], stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, text=True)


def frames_of(simulation: simvis.Simulation) -> int:
    simulation.step()
    return max(sensor.frames for sensor in simulation.sensors.values())


def dask_client() -> Any:
    return import_module("distributed").Client(n_workers=2, threads_per_worker=1, dashboard_address=None)


class Life(unittest.TestCase):
    def test_two_simulations_in_two_threads(self) -> None:
        results: dict[int, list[bytes]] = {}

        def work(number: int) -> None:
            sim = load(EMPTY)
            found = []
            for frame in range(50):
                sim["P"].yaw = frame
                sim.step()
                found.append(sim["SCAN"].range_m.tobytes())
            results[number] = found

        threads = [threading.Thread(target=work, args=(number,)) for number in range(2)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(results[0], results[1])

    def test_a_second_thread_is_refused_and_nothing_breaks(self) -> None:
        sim = load(EMPTY)
        refused, wrong = [], []
        done = threading.Event()

        def meddle() -> None:
            while not done.is_set():
                try:
                    sim["P"].yaw = 1
                    sim.step()
                    sim["SCAN"].range_m.sum()
                except simvis.InputError as error:
                    refused.append(str(error))
                except BaseException as error:  # noqa: BLE001
                    wrong.append(error)

        threads = [threading.Thread(target=meddle) for _ in range(3)]
        for thread in threads:
            thread.start()
        for _ in range(300):
            try:
                sim.step()
                sim["SCAN"].range_m.sum()
            except simvis.InputError as error:
                refused.append(str(error))
        done.set()
        for thread in threads:
            thread.join()
        self.assertEqual(wrong, [])
        for message in refused:
            self.assertTrue("in use by another thread" in message or "has not measured" in message, message)
        sim.step()

    def test_a_callback_of_its_own_step_is_refused(self) -> None:
        class Meddler(simvis.CustomElement, type="life_meddler"):
            attributes = [simvis.Attribute("x", 0, live=True)]

            def update(self, values: object) -> None:
                if sims:
                    sims[0].step()

        sims: list[simvis.Simulation] = []
        sims.append(load('<element type="life_meddler" name="M" insert_at="ROOT"/>'))
        sims[0]["M"].x = 1
        with self.assertRaisesRegex(simvis.InputError, "in use by another thread, or by the step that called"):
            sims[0].step()

    @unittest.skipIf("libasan" in os.environ.get("LD_PRELOAD", ""), "the address sanitizer keeps freed memory")
    def test_no_leak_over_many_steps(self) -> None:
        sim = load(EMPTY)
        kept = None

        def steps(count: int) -> int:
            nonlocal kept
            for frame in range(count):
                sim["P"].yaw = frame % 90
                sim.step()
                kept = sim["SCAN"].range_m
                sim["SCAN"].points()
            gc.collect()
            with open("/proc/self/statm") as file:
                return int(file.read().split()[1]) * resource.getpagesize()

        before = steps(2000)
        after = steps(4000)
        self.assertLess(after - before, 1 << 20)  # 4000 frames of 5 kB would be 20 MB

    def test_a_forked_process_is_refused_and_ends(self) -> None:
        sim = load(EMPTY)
        sim.step()
        child = os.fork()
        if child == 0:
            status = 1
            try:
                sim.step()
            except simvis.InputError as error:
                status = 0 if "was forked from process" in str(error) else 2
            try:
                load(EMPTY)
                status = 3
            except simvis.InputError:
                pass
            os._exit(status)
        self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), 0)
        sim.step()

    def test_a_forked_process_leaves_the_page_alone(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            sims = [load(EMPTY), load(EMPTY)]
            for i, sim in enumerate(sims):
                sim.record_page(f"{folder}/{i}.html")
                sim.step()
            before = sorted(os.listdir(folder))
            sims[1].close()
            child = os.fork()
            if child == 0:
                sims.clear()
                del sim
                gc.collect()
                os._exit(0)
            self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), 0)
            self.assertEqual(sorted(os.listdir(folder)), before)
            sims[0].finish_page()
            self.assertIn("0.html", os.listdir(folder))

    def test_map_gives_the_same_bytes_for_any_number_of_workers(self) -> None:
        scene = Path(self.id() + ".xml").absolute()
        scene.write_text(SCENE.replace("<sensor type=\"laser", "<sensor range_noise=\"0.01\" type=\"laser"))
        self.addCleanup(scene.unlink)
        results = [[found.tobytes() for found in simvis.map(ranges_of, scene, seeds=range(4), workers=workers)]
                   for workers in (0, 2)]
        self.assertEqual(results[0], results[1])
        self.assertEqual(len(set(results[0])), 4)
        by_yaw = list(simvis.map(ranges_of, scene, parameters=[{"P.yaw": 0}, {"P.yaw": 30}], workers=0))
        self.assertFalse(np.array_equal(*by_yaw))

    def test_map_reads_seeds_without_end_as_results_are_taken(self) -> None:
        from concurrent.futures import ThreadPoolExecutor

        scene = ROOT / "scenes/first/first.xml"
        kinds: list[dict[str, Any]] = [{"workers": 0}, {"workers": 1}, {"executor": ThreadPoolExecutor(2)}]
        for kind in kinds:
            with self.subTest(**kind):
                with closing(simvis.map(frames_of, scene, seeds=count(), **kind)) as results:
                    self.assertEqual(list(islice(results, 3)), [1, 1, 1])

    def test_map_passes_measurements(self) -> None:
        scene = ROOT / "scenes/first/first.xml"
        here, there = (next(iter(simvis.map(measurement_of, scene, seeds=[1], workers=workers))) for workers in (0, 1))
        self.assertEqual(here["range_m"].tobytes(), there["range_m"].tobytes())
        self.assertEqual(here.sensor, there.sensor)

    def test_map_takes_executors(self) -> None:
        from concurrent.futures import ThreadPoolExecutor

        scene = ROOT / "scenes/first/first.xml"
        found = list(simvis.map(frames_of, scene, seeds=range(3), executor=ThreadPoolExecutor(2)))
        self.assertEqual(found, [1, 1, 1])
        for module, executor in (("distributed", dask_client), ("ray", lambda: "ray")):
            with self.subTest(executor=module):
                if find_spec(module) is None:
                    continue  # tested only where it is installed
                found = list(simvis.map(frames_of, scene, seeds=range(3), executor=executor()))
                self.assertEqual(found, [1, 1, 1])

    def test_an_interrupt_ends_a_long_run(self) -> None:
        program = f"""if True:
            import sys
            sys.path[:0] = {sys.path!r}
            import simvis
            sim = simvis.Simulation.from_string({EMPTY!r})
            sim.step()
            try:
                print("running", flush=True)
                while True:
                    sim.step()
            except KeyboardInterrupt:
                sim.step()
                print("stopped", flush=True)
        """
        process = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   text=True)
        assert process.stdout is not None
        self.assertEqual(process.stdout.readline(), "running\n")
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.communicate(timeout=60), ("stopped\n", ""))
        self.assertEqual(process.returncode, 0)

    def test_the_interpreter_ends_while_threads_work(self) -> None:
        written = """
            class Slow(simvis.CustomElement, type="slow"):
                attributes = [simvis.Attribute("x", 0, live=True)]
                def update(self, values):
                    for _ in range(3000): pass
            sim = load('<element type="slow" name="S" insert_at="ROOT"/>')
            numbers = iter(range(10**9))
            def work():
                sim["S"].x = next(numbers)
                sim.step()
            daemon(work)"""
        programs = {
            "steps": "sim = load()\ndaemon(sim.step)",
            "frames under way": "sim = load()\ndaemon(sim.step_async)",
            "loads": "daemon(load)",
            "written elements": written,
            "pictures": """
                sim = load('<sensor type="camera" name="CAM" insert_at="ROOT" width="640" height="480"/>')
                image = sim["CAM"].image()
                daemon(lambda: (image.rgb(), image.png(), image.array))""",
            "a scene of the thread's own": """
                def work():
                    sim = load()
                    while True: sim.step()
                daemon(work)""",
            "a frame under way": "sim = load()\nsim.step_async()\nsys.modules['keep'] = sim",
        }
        for name, program in programs.items():
            for _ in range(2):
                with self.subTest(program=name):
                    process = started(textwrap.dedent(program) + "\nsys.exit(7)")
                    self.assertEqual(process.communicate(timeout=60), ("", ""))
                    self.assertEqual(process.returncode, 7)

    def test_handlers_of_the_end_may_step_and_wait_for_threads(self) -> None:
        process = started("""
            import atexit
            def end():
                stop.set()
                thread.join()
                sim.step()
                sim.close()
                print("closed", flush=True)
            atexit.unregister(simvis._ending._wait_for_threads)
            atexit.register(end)
            atexit.register(simvis._ending._wait_for_threads)  # after what was registered later, as for an early import
            sim, stop = load(), threading.Event()
            other = load()
            def work():
                while not stop.is_set(): other.step()
            thread = threading.Thread(target=work, daemon=True)
            thread.start()
            time.sleep(0.2)""")
        self.assertEqual(process.communicate(timeout=60), ("closed\n", ""))
        self.assertEqual(process.returncode, 0)

    def test_an_interrupt_ends_the_wait_for_threads(self) -> None:
        process = started("""
            class Endless(simvis.CustomElement, type="endless"):
                attributes = [simvis.Attribute("x", 0, live=True)]
                def update(self, values):
                    if values["x"]: time.sleep(1000)
            sim = load('<element type="endless" name="E" insert_at="ROOT"/>')
            sim["E"].x = 1
            daemon(sim.step)
            print("ends", flush=True)""")
        assert process.stdout is not None
        self.assertEqual(process.stdout.readline(), "ends\n")
        with self.assertRaises(subprocess.TimeoutExpired):
            process.wait(0.5)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.communicate(timeout=60), ("", ""))
        self.assertEqual(process.returncode, -signal.SIGINT)

    def test_a_process_that_is_forked_while_a_thread_steps_is_refused_and_ends(self) -> None:
        process = started("""
            sim = load()
            daemon(sim.step)
            for _ in range(3):
                child = os.fork()
                if child == 0:
                    try:
                        sim.step()
                    except simvis.InputError as error:
                        sys.exit(5 if "was forked from process" in str(error) else 6)
                print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), flush=True)
            sys.exit(7)""")
        self.assertEqual(process.communicate(timeout=60), ("5\n5\n5\n", ""))
        self.assertEqual(process.returncode, 7)

    def test_a_class_of_its_own_inherits_everything(self) -> None:
        class Counted(simvis.Simulation):
            steps = 0

            def step(self, *, dt_s: float | None = None) -> None:
                self.steps += 1
                super().step(dt_s=dt_s)

        with Counted.from_string(EMPTY) as sim:
            self.assertIs(type(sim), Counted)
            self.assertEqual(list(sim.run(3, progress=False)), [0, 1, 2])
            self.assertEqual((sim.steps, sim.sensors["SCAN"].frames), (3, 3))
        with self.assertRaisesRegex(simvis.InputError, "this simulation is closed"):
            sim.set("P", "x", 1)

    def test_a_simulation_neither_pickles_nor_copies(self) -> None:
        sim = load(EMPTY)
        for call in (pickle.dumps, copy.copy, copy.deepcopy):
            with self.subTest(call=call.__name__), self.assertRaisesRegex(TypeError, "cannot pickle 'Simulation' object"):
                call(sim)

    def test_a_run_that_is_dropped_ends_its_simulation(self) -> None:
        run = testing.Run(lambda: load(EMPTY), 1)
        run.step()
        seen = weakref.ref(run.sim)
        del run
        gc.collect()
        self.assertIsNone(seen())

    def test_what_ends_a_program_is_raised_itself(self) -> None:
        class Ending(simvis.CustomElement, type="life_ending"):
            attributes = [simvis.Attribute("x", 0, live=True)]

            def __init__(self, context: simvis.Context) -> None:
                raise kind("now")

            def update(self, values: object) -> None:
                pass

        command = '<element type="life_ending" name="E" insert_at="ROOT"/>'
        sim = load(EMPTY)
        for kind in (KeyboardInterrupt, SystemExit):
            for call in (lambda: load(f"<s>{command}</s>"), lambda: sim.execute(command)):
                with self.subTest(kind=kind), self.assertRaises(kind):
                    call()
        kind = ValueError  # type: ignore[assignment]
        with self.assertRaisesRegex(simvis.InputError, "its Python class raised ValueError: now"):
            sim.execute(command)
        sim.step()

    @unittest.skipUnless(find_spec("_xxsubinterpreters"), "needs the subinterpreters of CPython up to 3.12")
    def test_a_subinterpreter_is_refused(self) -> None:
        process = started("""
            import _xxsubinterpreters
            other = _xxsubinterpreters.create()
            try:
                _xxsubinterpreters.run_string(other, f"import sys; sys.path[:0] = {sys.path!r}; import simvis")
            except _xxsubinterpreters.RunFailedError as error:
                print(error, flush=True)
            _xxsubinterpreters.destroy(other)
            load()""")
        out, err = process.communicate(timeout=60)
        self.assertIn("simvis works in the main interpreter only", out)
        self.assertEqual((err, process.returncode), ("", 0))


if __name__ == "__main__":
    unittest.main()
