"""An event camera that turns in front of bars."""
WIDTH, HEIGHT = 96, 72
BARS = "".join(f'<part name="BAR_{y_m}" insert_at="ROOT" shape="box" size="0.02 0.1 1" pose_offset="1 {y_m} 0 0 0 0"/>'
               for y_m in (-0.4, -0.2, 0, 0.2, 0.4))


def scene(attributes=""):
    """Commands of a scene with the camera EYE, which has these attributes besides, at EYE_AT; TURN turns it."""
    return f"""
  <element type="sky" name="SKY" insert_at="ROOT" red="0.3" green="0.3" blue="0.3" ambient_red="0.6" ambient_green="0.6"
           ambient_blue="0.6"/>{BARS}
  <part name="EYE_AT" insert_at="ROOT"/>
  <element type="pose" name="TURN" insert_at="EYE_AT"/>
  <sensor type="event_camera" name="EYE" insert_at="EYE_AT" width="{WIDTH}" height="{HEIGHT}" {attributes}/>"""
