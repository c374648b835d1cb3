"""What the wheel has beside the package: the client of running simulations, and the reader of USD."""
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import simvis

SCENE = """<part name="BALL" insert_at="ROOT" shape="sphere" radius="1" pose_offset="5 0 0 0 0 0"/>
<element type="pose" name="MOVE" insert_at="ROOT"/>
<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="1" min_angle="0" max_angle="0"/>"""


class Client(unittest.TestCase):
    def test_it_reads_what_is_served_and_raises_when_the_host_has_ended(self) -> None:
        import simvis_client

        name = f"python-client-{os.getpid()}"
        sim = simvis.Simulation.from_string(SCENE)
        sim.serve(name)
        with simvis_client.connect(name) as client:
            client["MOVE"].set(x=1)
            sim.step()
            self.assertEqual(client["MOVE"]["x"], 1)
            self.assertEqual(client.latest("SCAN")["range_m"][0, 0], sim["SCAN"].range_m[0, 0])
            del sim
            with self.assertRaisesRegex(simvis_client.SimvisError, "has ended"):
                client["MOVE"].set(x=2)

    def test_a_closed_connection_and_a_wrong_request_are_errors(self) -> None:
        import simvis_client

        name = f"python-closed-{os.getpid()}"
        sim = simvis.Simulation.from_string(SCENE)
        sim.serve(name)
        client = simvis_client.connect(name)
        self.assertIsNone(client.latest("SCAN"))
        move = client["MOVE"]
        for call, message in ((lambda: client["MOV"], 'there is no element "MOV"'), (lambda: client.latest("SCN"), "no sensor"),
                              (lambda: client.send("<s/>\0"), "has a NUL"), (lambda: client.send("x" * (1 << 18)), "at most")):
            with self.assertRaisesRegex(simvis_client.SimvisError, message):
                call()
        client.close()
        for call in (lambda: move["x"], lambda: client.frame, client.elements, lambda: client.wait_frame(timeout_s=1)):
            with self.assertRaisesRegex(simvis_client.SimvisError, "the connection is closed"):
                call()
        sim.step()

    def test_it_finds_the_library_where_packages_have_it(self) -> None:
        import simvis_client

        library = os.path.realpath(simvis_client._library._name)
        show = "import simvis_client; print(simvis_client._library._name)"
        with tempfile.TemporaryDirectory() as root:
            for module, place in (("a", "a"), ("wheel", "wheel/simvis/lib"), ("build/python", "build/lib"),
                                  ("prefix/share/simvis/python", "prefix/lib"), ("source/exchange/clients", "source/build/release/lib")):
                folder, link = Path(root) / module, Path(root) / place / "libsimvis-client.so.9"
                for made in (folder, link.parent):
                    made.mkdir(parents=True, exist_ok=True)
                shutil.copy(simvis_client.__file__, folder)
                link.symlink_to(library)
                environment = {each: value for each, value in os.environ.items() if each != "SIMVIS_CLIENT_LIBRARY"}
                run = subprocess.run([sys.executable, "-c", show], env={**environment, "PYTHONPATH": str(folder)}, text=True,
                                     capture_output=True)
                self.assertEqual(os.path.realpath(run.stdout.strip()), library, run.stderr)
                self.assertTrue(os.path.samefile(Path(run.stdout.strip()).parent, link.parent))

    @unittest.skipUnless(os.geteuid() == 0, "needs root, who can give files to others")
    def test_it_takes_no_library_of_another_user(self) -> None:
        import simvis_client

        nobody, load = 65534, "import simvis_client; print(simvis_client._library._name)"
        environment = {each: value for each, value in os.environ.items() if each != "SIMVIS_CLIENT_LIBRARY"}
        with tempfile.TemporaryDirectory() as root:
            os.chmod(root, 0o1777)
            folder, planted = Path(root) / "own", Path(root) / "lib" / "libsimvis-client.so.9"
            folder.mkdir()
            shutil.copy(simvis_client.__file__, folder)
            for owner, mode, taken in ((nobody, 0o755, False), (0, 0o777, False), (0, 0o755, True)):
                with self.subTest(owner=owner, mode=oct(mode)):
                    shutil.rmtree(planted.parent, ignore_errors=True)
                    planted.parent.mkdir()
                    planted.symlink_to(os.path.realpath(simvis_client._library._name))
                    planted.parent.chmod(mode)
                    os.chown(planted.parent, owner, owner)
                    run = subprocess.run([sys.executable, "-c", load], env={**environment, "PYTHONPATH": str(folder)}, text=True,
                                         capture_output=True)
                    self.assertEqual(".so.9" in run.stdout, taken, run.stdout + run.stderr)


class Usd(unittest.TestCase):
    def test_it_is_read_by_the_interpreter_that_imports_the_package(self) -> None:
        named = os.environ.pop("SIMVIS_PYTHON", None)
        try:
            simvis._usd.read_by_this_python()
            self.assertEqual(os.environ["SIMVIS_PYTHON"], sys.executable)
            os.environ["SIMVIS_PYTHON"] = "/another/python3"
            simvis._usd.read_by_this_python()
            self.assertEqual(os.environ["SIMVIS_PYTHON"], "/another/python3")
        finally:
            os.environ.pop("SIMVIS_PYTHON")
            if named is not None:
                os.environ["SIMVIS_PYTHON"] = named


if __name__ == "__main__":
    unittest.main()
