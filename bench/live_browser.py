#!/usr/bin/env python3
"""Measures what a person at a live page waits for, in a real browser: `bench/live_browser.py [--run FOLDER] [SCENE...]`.

Opens Debian's chromium, without a window and without a GPU, on simvis-run --live of the build in FOLDER (build/release).
Without a scene, all of them: small (a robot, a wall, a scanner, a camera of 64 x 48), marvin, 10000 parts, 1000000
triangles (a scanner and a camera of 640 x 480 before each). Prints CSV; times are in ms. `first_frame_ms` is the time
from the address to the first frame that the page shows. A key then moves a slider, once the page has been at rest, and
`view_ms` is the time from the slider's event until the 3-D view has been drawn with the value, `picture_ms` until the
image of a camera that measured with it has been decoded and shown, both as medians; `picture_max_ms` is the longest of
the latter. `frames_per_s` is how many frames the page shows during that time, of a run at 15 Hz. The browser draws on the same
cores as the simulation. Ends with status 77 and the reason where there is no browser.
"""
import argparse
import json
import shutil
import statistics
import struct
import sys
import tempfile
import time
from array import array
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests/live"))
from browser import Browser, skip  # noqa: E402
from live_host import LiveHost  # noqa: E402

SENSORS = """
  <sensor type="camera" name="CAM" insert_at="ROBOT" width="640" height="480" outputs="color depth"/>
  <sensor type="laser_scanner" name="FRONT" insert_at="ROBOT" samples="361" min_angle="-90" max_angle="90"/>"""
ROBOT = """
  <part name="ROBOT" insert_at="ROOT" shape="box" size="0.1 0.1 0.1"/>
  <element type="pose" name="MOVE" insert_at="ROBOT"/>"""
SMALL = f"""
  <part file="{ROOT}/scenes/marvin/robot.glb" name="ROBOT" insert_at="ROOT"/>
  <part name="WALL" insert_at="ROOT" shape="box" size="0.1 4 2" pose_offset="9 0 1 0 0 0"/>
  <element type="pose" name="MOVE" insert_at="ROBOT"/>
  <element type="light" name="LAMP" insert_at="ROOT" kind="directional"/>
  <sensor type="laser_scanner" name="SCAN" insert_at="ROBOT" samples="5" min_angle="-20" max_angle="20"/>
  <sensor type="camera" name="CAM" insert_at="ROOT" width="64" height="48" pose_offset="-3 0 1 0 0 0"/>"""

# The slider's event is the start. The page writes values before the pictures and the number of the same frame.
MEASURE = """
(async () => {
  const {page} = await import("simvis/main.js"), {values} = page;
  const index = page.scene().parameters.findIndex((each) => each?.element === %s && each.name === %s);
  const slider = document.querySelector(%s), image = document.querySelector("#images img");
  const frame = () => document.documentElement.dataset.frame;
  const written = (wanted) => new Promise((found) => {
    let value = values[index];
    const set = (now) => { value = now; if (now === wanted) found(frame()); };
    Object.defineProperty(values, index, {configurable: true, get: () => value, set});
  });
  const onScreen = (done) => new Promise((found) => {
    const look = () => requestAnimationFrame(done() ? () => setTimeout(() => found(performance.now())) : look);
    look();
  });
  const measure = async (start) => {
    const before = await written(Number(slider.value));
    const view = await onScreen(() => frame() !== before);
    await image.decode().catch(() => null);  // a newer image has come
    return {view: view - start, picture: (await onScreen(() => image.complete)) - start};
  };
  window.moved = new Promise((found) => slider.addEventListener("input", ({timeStamp}) => found(measure(timeStamp)), {once: true}));
  slider.focus();
})()
"""


def write_parts(folder):
    boxes = "\n".join(f'  <part name="BOX_{i}" insert_at="ROOT" shape="box" size="0.2 0.2 0.2" '
                      f'pose_offset="{2 + 0.5 * (i % 100)} {0.5 * (i // 100) - 25} 0 0 0 0"/>' for i in range(10_000))
    return write_scene(folder, ROBOT + SENSORS + boxes)


def write_triangles(folder):
    """Hills of 708 x 707 squares, two triangles each."""
    columns, rows = 709, 708
    points = array("f")
    for y in range(rows):
        for x in range(columns):
            points.extend((0.03 * x, 0.03 * (y - rows / 2), 0.02 * ((x * x + 3 * y * y) % 17) - 0.6))
    triangles = bytearray()
    for y in range(rows - 1):
        for x in range(columns - 1):
            corner = y * columns + x
            triangles += struct.pack("<BiiiBiii", 3, corner, corner + 1, corner + columns, 3, corner + 1,
                                     corner + columns + 1, corner + columns)
    head = (f"ply\nformat binary_little_endian 1.0\nelement vertex {columns * rows}\nproperty float x\nproperty float y\n"
            f"property float z\nelement face {2 * (columns - 1) * (rows - 1)}\n"
            "property list uchar int vertex_indices\nend_header\n")
    (folder / "hills.ply").write_bytes(head.encode() + points.tobytes() + triangles)
    return write_scene(folder, ROBOT + SENSORS + '\n  <part file="hills.ply" name="HILLS" insert_at="ROOT"/>')


def write_scene(folder, commands):
    (folder / "scene.xml").write_text(f"<simvis>{commands}\n</simvis>\n")
    return folder / "scene.xml"


# The scene, the element whose slider moves, and its parameter.
SCENES = {
    "small": (lambda folder: write_scene(folder, SMALL), "MOVE", "x"),
    "marvin": (lambda folder: ROOT / "scenes/marvin/marvin.xml", "R_POSE", "yaw"),
    "10000 parts": (write_parts, "MOVE", "yaw"),
    "1000000 triangles": (write_triangles, "MOVE", "yaw"),
}


def slider_of(page, element, parameter):
    """The selector of a slider, which is scrolled to where it is seen."""
    number = page.run(f"""[...document.querySelectorAll('[data-element={element}] .parameter')]
        .findIndex((row) => row.firstChild.textContent === {json.dumps(parameter)}) + 1""")
    selector = f"[data-element={element}] .parameter:nth-of-type({number}) input[type=range]"
    page.area(selector)
    return selector


def frame_of(page):
    return int(page.run("document.documentElement.dataset.frame"))


def measure(program, name, moves, folder):
    write, element, parameter = SCENES[name]
    with LiveHost(program, write(folder), "--real-time", "1") as host:
        start = time.perf_counter()
        with Browser(host.url) as page:
            page.wait_for("!!document.documentElement?.dataset.frame", "a frame")
            first_frame_ms = 1e3 * (time.perf_counter() - start)
            page.wait_for("!!document.querySelector('#images img')?.complete", "an image")
            slider = slider_of(page, element, parameter)
            times, began, first = [], time.perf_counter(), frame_of(page)
            for i in range(moves):
                page.run(MEASURE % (json.dumps(element), json.dumps(parameter), json.dumps(slider)))
                page.press("ArrowRight" if i % 2 == 0 else "ArrowLeft", 39 if i % 2 == 0 else 37)
                times.append(page.run("window.moved"))
                time.sleep(0.5)
            frames_per_s = (frame_of(page) - first) / (time.perf_counter() - began)
    view, picture = ([each[what] for each in times] for what in ("view", "picture"))
    print(f"{name},{moves},{first_frame_ms:.0f},{statistics.median(view):.0f},{statistics.median(picture):.0f},"
          f"{max(picture):.0f},{frames_per_s:.1f}", flush=True)


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--run", default=str(ROOT / "build/release"), help="the build folder")
    arguments.add_argument("--moves", type=int, default=15, help="of the slider, in each scene")
    arguments.add_argument("scene", nargs="*", choices=[[], *SCENES], help="default: all")
    options = arguments.parse_args()
    if not shutil.which("chromium"):
        skip("chromium is not installed")
    print("scene,moves,first_frame_ms,view_ms,picture_ms,picture_max_ms,frames_per_s")
    for name in options.scene or SCENES:
        with tempfile.TemporaryDirectory() as folder:
            measure(str(Path(options.run) / "bin/simvis-run"), name, options.moves, Path(folder))


main()
