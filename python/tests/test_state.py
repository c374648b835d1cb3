"""Saved states go on to the bit."""
import random
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
