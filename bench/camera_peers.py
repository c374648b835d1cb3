#!/usr/bin/env python3
"""Compares a camera of SimVis with MuJoCo's OpenGL renderer: `camera_peers.py CAMERA_FRAMES [ROUNDS]`.

CAMERA_FRAMES is the benchmark program of that name. Both draw the same triangles from the same place with as many
lights, 640 x 480, colour in memory, on the processor (MuJoCo by EGL, which is llvmpipe where there is no GPU), in
turns. MuJoCo lights vertices, without textures and, as here, without shadows; SimVis lights pixels, with the scene's
textures, highlights and glass. Prints CSV: the medians of the rounds' medians in milliseconds, and their ratio.

MuJoCo is the package `mujoco` of PyPI. Where it cannot be had, this says so and exits with status 77."""
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

os.environ.setdefault("MUJOCO_GL", "egl")
os.environ.setdefault("LIBGL_ALWAYS_SOFTWARE", "1")

SKIPPED = 77
FRAMES = 20  # of each round
CASES = ("marvin robot", "marvin room", "lab 10k", "lab 100k", "lab 1M")
MULTISAMPLED = {"marvin robot msaa 4": "marvin robot", "marvin room msaa 4": "marvin room"}


def load(mujoco, numpy, folder, name, samples):
    """The model of an exported frame."""
    frame = json.loads((folder / f"{name}.json").read_text())
    data = numpy.fromfile(folder / f"{name}.bin", dtype=numpy.uint32)
    spec = mujoco.MjSpec()
    spec.visual.quality.offsamples = samples
    spec.visual.headlight.active = 0
    spec.visual.global_.fovy = 2 * numpy.degrees(numpy.arctan(frame["height"] / (2 * frame["fy_px"])))
    spec.visual.map.znear = 0.01
    at = 0
    for number, item in enumerate(frame["items"]):
        vertices, indices = item["vertices"], item["indices"]
        mesh = spec.add_mesh(name=str(number))
        mesh.uservert = data[at:at + 3 * vertices].view(numpy.float32)
        mesh.userface = data[at + 3 * vertices:at + 3 * vertices + indices].view(numpy.int32)
        mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL
        at += 3 * vertices + indices
        spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=str(number), rgba=item["color"],
                                contype=0, conaffinity=0)
    for light in frame["lights"]:
        kind = mujoco.mjtLightType
        spec.worldbody.add_light(pos=light["position"], dir=light["direction"], castshadow=False,
                                 type=(kind.mjLIGHT_DIRECTIONAL, kind.mjLIGHT_POINT, kind.mjLIGHT_SPOT)[light["kind"]])
    turn = numpy.array([frame["right"], [-x for x in frame["down"]], [-x for x in frame["forward"]]]).T
    quaternion = numpy.zeros(4)
    mujoco.mju_mat2Quat(quaternion, turn.flatten())
    spec.worldbody.add_camera(name="CAMERA", pos=frame["eye"], quat=quaternion,
                              fovy=spec.visual.global_.fovy)
    return spec.compile()


class Peer:
    """MuJoCo's renderer of one frame."""

    def __init__(self, mujoco, numpy, folder, name, samples):
        model = load(mujoco, numpy, folder, name, samples)
        self.data = mujoco.MjData(model)
        mujoco.mj_forward(model, self.data)
        self.renderer = mujoco.Renderer(model, 480, 640, max_geom=100000)
        self.render()

    def render(self):
        """Draws a frame and reads its colour."""
        self.renderer.update_scene(self.data, camera="CAMERA")
        return self.renderer.render()

    def median_ms(self):
        """The median of a round."""
        took = []
        for _ in range(FRAMES):
            start = time.perf_counter()
            self.render()
            took.append(1e3 * (time.perf_counter() - start))
        return statistics.median(took)


def simvis_ms(program, name):
    """The median of a round."""
    lines = subprocess.run([program, str(FRAMES), name], check=True, capture_output=True, text=True).stdout.splitlines()
    return float(lines[-1].split(",")[2])


def main():
    """Prints the table."""
    program, rounds = os.path.abspath(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 5
    try:
        import mujoco
        import numpy
    except ImportError as error:
        print(f"SKIPPED: {error}; `pip install mujoco` has it", file=sys.stderr)
        sys.exit(SKIPPED)
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([program, "--export", folder], check=True)
        try:
            peers = {name: Peer(mujoco, numpy, Path(folder), name, 0) for name in CASES}
            peers |= {name: Peer(mujoco, numpy, Path(folder), of, 4) for name, of in MULTISAMPLED.items()}
        except Exception as error:  # pylint: disable=broad-except
            print(f"SKIPPED: MuJoCo {mujoco.__version__} cannot draw here: {error}", file=sys.stderr)
            sys.exit(SKIPPED)
        print("case,rounds,simvis_ms,mujoco_ms,ratio")
        for name, peer in peers.items():
            pairs = [(simvis_ms(program, name), peer.median_ms()) for _ in range(rounds)]
            own, other = (statistics.median(column) for column in zip(*pairs))
            ratio = statistics.median(a / b for a, b in pairs)
            print(f"{name},{rounds},{own:.1f},{other:.1f},{ratio:.2f}", flush=True)


if __name__ == "__main__":
    main()
