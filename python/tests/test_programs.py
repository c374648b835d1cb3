"""What the wheel has beside the package: the client of running simulations, and the reader of USD."""
import os
import sys
import unittest

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
