"""A scene that is quick to load and to draw: boxes around a pose with a scanner and cameras."""
import simvis

SCENE = """<simvis>
  <part shape="box" size="10 10 0.1" name="FLOOR" insert_at="ROOT"/>
  <part shape="box" size="0.2 4 2" name="WALL" insert_at="ROOT" pose_offset="3 0 0 0 0 0"/>
  <part shape="sphere" radius="0.5" name="BALL" insert_at="ROOT" pose_offset="0 2 0.5 0 0 0"/>
  <part name="ROBOT" insert_at="ROOT"/>
  <element type="pose" name="P" insert_at="ROBOT" z="0.5"/>
  <sensor type="laser_scanner" name="SCAN" insert_at="ROBOT" samples="31" min_angle="-90" max_angle="90"
          vertical_samples="3" vertical_min_angle="-2" vertical_max_angle="10" intensity="on"/>
  <sensor type="camera" name="CAM" insert_at="ROBOT" width="32" height="16" outputs="color depth"/>
  <sensor type="stereo_camera" name="EYES" insert_at="ROBOT" width="16" height="8" outputs="color depth disparity"/>
  <sensor type="psd" name="PSD" insert_at="ROBOT"/>
</simvis>"""


def load(scene: str = SCENE, **settings: object) -> simvis.Simulation:
    return simvis.Simulation.from_string(scene, **settings)  # type: ignore[arg-type]
