"""Saved states go on to the bit."""
import pathlib
import random
import tempfile
import unittest

import simvis

SCENE = """<simvis>
  <element type="physics" name="PHYSICS" insert_at="ROOT"/>
  <part name="FLOOR" insert_at="ROOT" shape="box" size="20 20 1" pose_offset="0 0 -0.5 0 0 0"/>
  <element type="body" name="FLOOR_BODY" insert_at="FLOOR" kind="static"/>
  <part name="BOX" insert_at="ROOT" shape="box" size="0.2 0.2 0.2" pose_offset="0 0 0.5 10 20 30"/>
  <element type="body" name="BODY" insert_at="BOX" mass="1" restitution="0.5"/>
  <part name="TOP" insert_at="ROOT" shape="box" size="0.2 0.2 0.2" pose_offset="0.05 0 0.9 0 0 0"/>
  <element type="body" name="TOP_BODY" insert_at="TOP" mass="1"/>
  <sensor type="imu" name="IMU" insert_at="BOX"/>
  <sensor type="odometry" name="ODOM" insert_at="TOP" kind="wheel" slip_stddev="0.01"/>
</simvis>"""


HISTORY = """<simvis>
  <element type="light" name="SUN" insert_at="ROOT"/>
  <part name="BOX" insert_at="ROOT" shape="box" size="0.6 0.6 0.6" pose_offset="3 0 0 0 0 0"/>
  <element type="pose" name="MOVE" insert_at="BOX"/>
  <element type="trail" name="PATH" insert_at="ROOT" part="BOX" step="0.02" width="0.1"/>
  <sensor type="event_camera" name="EVENTS" insert_at="ROOT" width="8" height="6" leak="20" picture="on"/>
  <sensor type="camera" name="FLOW" insert_at="ROOT" width="8" height="6" outputs="flow_backward flow_forward"/>
  <sensor type="camera" name="LATE" insert_at="ROOT" width="8" height="6" outputs="flow_forward occlusion" delay="0.15"/>
  <sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="5" method="auto" resolution="128"/>
  <sensor type="camera" name="SHOWN" insert_at="ROOT" width="8" height="6" view="visualization"/>
</simvis>"""


def frame(sim: simvis.Simulation) -> list[bytes]:
    """Makes a frame, and returns what it gives."""
    sim.step()
    values = [sim[name].value(column) for name, column in (("IMU", "specific_force_z_m_s2"), ("ODOM", "x_m"))]
    return [repr((sim["BODY"].x, sim["BODY"].z, sim["TOP_BODY"].roll, *values)).encode()]


class SavedStates(unittest.TestCase):
    def test_a_thousand_restores_at_random_frames(self) -> None:
        sim = simvis.Simulation.from_string(SCENE)
        states, frames = [], []
        for _ in range(40):
            states.append(sim.save_state())
            frames.append(frame(sim))
        other = simvis.Simulation.from_string(SCENE)
        generator = random.Random(1)
        for i in range(1000):
            k = generator.randrange(len(states))
            restored = sim if i % 2 else other
            restored.restore_state(states[k])
            self.assertEqual(frame(restored), frames[k])

    def test_sensors_with_history_from_files(self) -> None:
        def measured(sim: simvis.Simulation, index: int) -> list[bytes]:
            sim["MOVE"].y = 0.02 * index
            sim.step()
            outputs = (("EVENTS", "picture"), ("EVENTS", "time_s"), ("FLOW", "flow_backward"), ("FLOW", "flow_forward"),
                       ("LATE", "flow_forward"), ("SCAN", "range_m"), ("SHOWN", "color"))
            arrived = [(sensor, output) for sensor, output in outputs if sensor != "LATE" or index >= 5]
            return [sim[sensor].measurement[output].tobytes() for sensor, output in arrived]

        sim, other = simvis.Simulation.from_string(HISTORY), simvis.Simulation.from_string(HISTORY)
        with tempfile.TemporaryDirectory() as folder:
            frames = []
            for i in range(8):
                pathlib.Path(folder, f"state{i}").write_bytes(sim.save_state())
                frames.append(measured(sim, i))
            generator = random.Random(2)
            for i in range(40):
                k = generator.randrange(len(frames))
                restored = sim if i % 2 else other
                restored.restore_state(pathlib.Path(folder, f"state{k}").read_bytes())
                self.assertEqual(measured(restored, k), frames[k])

    def test_errors(self) -> None:
        sim = simvis.Simulation.from_string(SCENE)
        state = sim.save_state()
        self.assertIsInstance(state, bytes)
        with self.assertRaisesRegex(simvis.InputError, "the state is cut off"):
            sim.restore_state(state[:-1])
        with self.assertRaises(TypeError):
            sim.restore_state("text")  # type: ignore[arg-type]
        other = simvis.Simulation.from_string("<simvis/>")
        with self.assertRaisesRegex(simvis.InputError, "the state is of another scene"):
            other.restore_state(state)


if __name__ == "__main__":
    unittest.main()
