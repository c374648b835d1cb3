#!/usr/bin/env python3
"""What light costs, and how far each kind of it is from that of the scene: `light_costs.py [FRAMES]` prints CSV.

It is the list of light that `simvis-run --price` writes, of cameras of 120 x 68 pixels where ROOM_CAM of scenes/marvin and
WORLD_CAM of scenes/ravon stand. Rows of drawn pictures take turns in every frame; a row of paths is one frame."""
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PROGRAM = ROOT / "build/release/bin/simvis-run"
# Where the cameras stand, and how far they see.
CAMERAS = {"marvin": 'insert_at="LAB" pose_offset="-5.3 -4.1 2.5 0 19 40" hfov="76"',
           "ravon": 'insert_at="GROUND" pose_offset="-19 0.2 1.15 0 4.5 -12" hfov="62"'}


def costs(scene, frames, folder):
    """The lines of the list."""
    Path(folder, "scene.xml").write_text(
        f'<simvis><include file="{ROOT}/scenes/{scene}/{scene}.xml"/>'
        f'<sensor type="camera" name="LIT" {CAMERAS[scene]} width="120" height="68"/></simvis>', encoding="utf-8")
    subprocess.run([PROGRAM, "--price", "--quiet", "--frames", frames, "--sensor", "LIT", "--out", folder,
                    Path(folder, "scene.xml")], check=True)
    return Path(folder, "light_price.csv").read_text(encoding="utf-8").splitlines()


def main():
    frames = sys.argv[1] if len(sys.argv) > 1 else "5"
    for number, scene in enumerate(CAMERAS):
        with tempfile.TemporaryDirectory() as folder:
            head, *rows = costs(scene, frames, folder)
        if number == 0:
            print(f"scene,{head}")
        for row in rows:
            print(f"{scene},{row}", flush=True)


if __name__ == "__main__":
    main()
