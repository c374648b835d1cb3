"""tonic: events of a camera that turns in front of bars, added up to a picture, beside the change of light that a camera sees.

packages: tonic==1.7.0 pillow==13.0.0 numpy==2.4.6
"""
import time

import numpy as np
import tonic
from PIL import Image

import bars
import trial

THRESHOLD, DARKNESS = 0.2, 0.001
SCENE = bars.scene(f'hfov="60" threshold_on="{THRESHOLD}" threshold_off="{THRESHOLD}" darkness="{DARKNESS}"') + f"""
  <sensor type="camera" name="LIGHT" insert_at="EYE_AT" width="{bars.WIDTH}" height="{bars.HEIGHT}" hfov="60" supersampling="16"/>"""


def logarithm_of_light(file):
    codes = np.asarray(Image.open(file).convert("RGB")) / 255
    linear = np.where(codes <= 0.04045, codes / 12.92, ((codes + 0.055) / 1.055) ** 2.4)
    return np.log(linear @ (0.2126, 0.7152, 0.0722) + DARKNESS)


def measure(folder):
    (folder / "turn.csv").write_text("time_s,TURN.yaw\n0,0\n0.2,4\n")
    out = trial.simvis_run(SCENE, folder, "--trajectory", folder / "turn.csv", "--rate", 10, "--format", "scan=npz")
    files = [np.load(file) for file in sorted(out.glob("EYE/*.npz"))]
    begin = time.monotonic()
    events = tonic.io.make_structured_array(
        *(np.concatenate([file[name] for file in files]) for name in ("x", "y", "t_us", "polarity")))
    off_count, on_count = tonic.transforms.ToImage(sensor_size=(bars.WIDTH, bars.HEIGHT, 2))(events).astype(float)
    seconds = time.monotonic() - begin
    light = [logarithm_of_light(file) for file in sorted(out.glob("LIGHT/*.png"))]
    error = np.abs((on_count - off_count) - (light[-1] - light[0]) / THRESHOLD)
    return [("events", len(events), "", seconds), ("in the picture", (off_count + on_count).sum(), "", seconds),
            ("change of the logarithm of light, median", np.median(error), "thresholds", seconds),
            ("change of the logarithm of light, largest", error.max(), "thresholds", seconds)]


trial.main(measure)
