"""Gymnasium's Ant in MuJoCo, with a camera and a laser scanner of SimVis: pip install "gymnasium[mujoco]".

MuJoCo moves the robot; SimVis puts its bodies where MuJoCo has them, and measures.
"""
import sys

import gymnasium
import simvis
import simvis.mujoco

STEPS = 3 if "--short" in sys.argv else 200

env = gymnasium.make("Ant-v5").unwrapped
SCENE = f"""<simvis>
  <part name="ANT" insert_at="ROOT" file="{env.fullpath}"/>
  <part name="WALL" insert_at="ROOT" shape="box" size="0.2 8 2" pose_offset="4 0 1 0 0 0"/>
  <sensor type="laser_scanner" name="LIDAR" insert_at="torso" pose_offset="0 0 0.35 0 0 0" samples="181"
          min_angle="-90" max_angle="90"/>
  <sensor type="camera" name="CAMERA" insert_at="ROOT" pose_offset="-3 -3 2 0 20 45" width="320" height="240"/>
</simvis>"""

env.reset(seed=1)
sim = simvis.Simulation.from_string(SCENE, rate_hz=1 / env.dt)
ant = simvis.mujoco.follow(sim, env.model, env.data)
for step in range(STEPS):
    env.step(env.action_space.sample())  # it calls mj_step(), and mj_rnePostConstraint() on the poses before
    ant.update()
    sim.step()
    print(f"{sim.time_s:.2f} s: torso at {env.data.body('torso').xpos.round(3)}, wall at "
          f"{sim['LIDAR'].range_m.min():.3f} m, image {sim['CAMERA'].rgb.shape}")
