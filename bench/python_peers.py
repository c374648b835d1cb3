#!/usr/bin/env python3
"""SimVis from Python beside MuJoCo and Open3D, on the same triangles: `bench/python_peers.py [--run build/release]`.

The interpreter needs the packages `mujoco` and `open3d` beside NumPy; a peer that is missing is left out, with the reason on
stderr. All read the triangles of scenes/marvin, which simvis-run exports as they stand in its first frame. Each task is
done by all in turns, with a new pose each time; a time is the median, from the call until the numbers are in NumPy arrays.
Errors are differences to intersections in double precision with every triangle, for a sample of the rays. `other_surface`
counts those beyond 10 mm, which is more than rounding does, and which the other columns leave out.

  three_scans  3 x 361 rays        lidar  64 x 2048 rays        camera  640 x 480 pixels, colour and depth

Open3D has no renderer here: its camera casts a ray for each pixel and gives depth alone. MuJoCo's renderer is OpenGL
(MUJOCO_GL=egl or osmesa). MuJoCo and Open3D keep vertices in single precision.

Prints CSV: task, who, rays, ms, error_median_m, error_largest_m, other_surface, sample.
"""
import argparse
import json
import os
import statistics
import struct
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
OTHER_SURFACE_M = 0.01
REACH_M = 60.0
SAMPLE = 1000  # rays that are compared with every triangle
ORIGIN = np.array([-3.0, 0.1, 1.0])  # in the laboratory, a metre from everything
WIDTH, HEIGHT, HFOV_DEG = 640, 480, 65.0


def triangles_of(file: Path) -> np.ndarray:
    """(n, 3, 3) float64: the triangles of a GLB in the world of SimVis (z up; glTF has y up)."""
    data = file.read_bytes()
    size = struct.unpack_from("<I", data, 12)[0]
    scene, binary = json.loads(data[20:20 + size]), data[28 + size:]

    def array(index: int) -> np.ndarray:
        accessor = scene["accessors"][index]
        view = scene["bufferViews"][accessor["bufferView"]]
        kind = {5121: np.uint8, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}[accessor["componentType"]]
        width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}[accessor["type"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        stride = view.get("byteStride", width * np.dtype(kind).itemsize)
        rows = np.ndarray((accessor["count"], width), kind, binary, start, (stride, np.dtype(kind).itemsize))
        return rows if width > 1 else rows[:, 0]

    def matrix(node: dict) -> np.ndarray:
        if "matrix" in node:
            return np.array(node["matrix"], float).reshape(4, 4).T
        x, y, z, w = node.get("rotation", (0, 0, 0, 1))
        turn = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                         [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                         [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])
        whole = np.eye(4)
        whole[:3, :3] = turn * np.array(node.get("scale", (1, 1, 1)))
        whole[:3, 3] = node.get("translation", (0, 0, 0))
        return whole

    found = []

    def walk(index: int, above: np.ndarray) -> None:
        node = scene["nodes"][index]
        world = above @ matrix(node)
        for part in scene["meshes"][node["mesh"]]["primitives"] if "mesh" in node else ():
            if part.get("mode", 4) == 4:
                points = array(part["attributes"]["POSITION"]).astype(float) @ world[:3, :3].T + world[:3, 3]
                found.append(points[array(part["indices"])].reshape(-1, 3, 3) if "indices" in part else points.reshape(-1, 3, 3))
        for child in node.get("children", ()):
            walk(child, world)

    up = np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]], float)
    for root in scene["scenes"][scene.get("scene", 0)]["nodes"]:
        walk(root, up)
    return np.concatenate(found)


def write_stl(file: Path, triangles: np.ndarray) -> None:
    rows = np.zeros(len(triangles), [("normal", "<f4", 3), ("points", "<f4", (3, 3)), ("attribute", "<u2")])
    rows["points"] = triangles
    file.write_bytes(b"\0" * 80 + struct.pack("<I", len(rows)) + rows.tobytes())


def nearest_m(triangles: np.ndarray, origin: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """Distances to the first triangle by the method of Moeller and Trumbore in double precision; inf: none."""
    corner, first, second = triangles[:, 0], triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    from_corner = origin - corner
    with_first = np.cross(from_corner, first)
    found = np.full(len(directions), np.inf)
    with np.errstate(divide="ignore", invalid="ignore"):
        for i, direction in enumerate(directions):
            across = np.cross(direction, second)
            determinant = np.einsum("ij,ij->i", first, across)
            u = np.einsum("ij,ij->i", from_corner, across) / determinant
            v = with_first @ direction / determinant
            t = np.einsum("ij,ij->i", second, with_first) / determinant
            hit = (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0)
            found[i] = t[hit].min(initial=np.inf)
    return found


def beams(rings: int, count: int, low_deg: float, high_deg: float, width_deg: float) -> np.ndarray:
    azimuth, elevation = np.meshgrid(np.radians(np.linspace(-width_deg / 2, width_deg / 2, count)),
                                     np.radians(np.linspace(low_deg, high_deg, rings)))
    return np.stack([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)],
                    -1).reshape(-1, 3)


def pixel_rays() -> np.ndarray:
    """Through the centres of the pixels, with length 1 along the optical axis, so that distances along them are depths."""
    focal_px = WIDTH / 2 / np.tan(np.radians(HFOV_DEG) / 2)
    u, v = np.meshgrid(np.arange(WIDTH) + 0.5, np.arange(HEIGHT) + 0.5)
    return np.stack([np.ones_like(u), (WIDTH / 2 - u) / focal_px, (HEIGHT / 2 - v) / focal_px], -1).reshape(-1, 3)


SETS = {"three_scans": beams(3, 361, -10, 10, 180), "lidar": beams(64, 2048, -24, 2, 359), "camera": pixel_rays()}


def moved(frame: int) -> np.ndarray:
    return ORIGIN + [0.001 * frame, 0.0005 * frame, 0]


class SimVis:
    def __init__(self, mesh: Path, folder: str) -> None:
        import simvis

        sys.path.insert(0, folder)
        self.sim = simvis.Simulation.from_string(f"""<simvis>
          <part file="{mesh}" name="WORLD" insert_at="ROOT"/>
          <part name="HEAD" insert_at="ROOT"/>
          <element type="pose" name="P" insert_at="HEAD"/>
          <element type="light" name="SUN" insert_at="ROOT"/>
          <sensor type="laser_scanner" name="three_scans" insert_at="HEAD" samples="361" min_angle="-90" max_angle="90"
                  vertical_samples="3" vertical_min_angle="-10" vertical_max_angle="10" range_max="{REACH_M}"/>
          <sensor type="laser_scanner" name="lidar" insert_at="HEAD" samples="2048" min_angle="-179.5" max_angle="179.5"
                  vertical_samples="64" vertical_min_angle="-24" vertical_max_angle="2" range_max="{REACH_M}"/>
          <sensor type="camera" name="camera" insert_at="HEAD" width="{WIDTH}" height="{HEIGHT}" hfov="{HFOV_DEG}"
                  outputs="color depth"/></simvis>""")
        self.pose = self.sim.elements["P"]

    def prepare(self, task: str) -> None:
        self.sim.only(task)

    def measure(self, task: str, origin: np.ndarray, rays: np.ndarray) -> np.ndarray:
        self.pose.set(x=origin[0], y=origin[1], z=origin[2])
        self.sim.step()
        if task != "camera":
            return self.sim.sensors[task].range_m.ravel()
        self.sim.sensors[task].rgb
        return self.sim.sensors[task].depth.ravel()


class MuJoCo:
    def __init__(self, mesh: Path, folder: str) -> None:
        import mujoco

        self.mujoco = mujoco
        focal = np.degrees(2 * np.arctan(np.tan(np.radians(HFOV_DEG) / 2) * HEIGHT / WIDTH))
        self.model = mujoco.MjModel.from_xml_string(f"""<mujoco>
          <asset><mesh name="m" file="{mesh}" inertia="shell"/></asset>
          <visual><global offwidth="{WIDTH}" offheight="{HEIGHT}"/></visual>
          <worldbody><geom type="mesh" mesh="m" contype="0" conaffinity="0"/><light pos="0 0 3"/>
            <body name="head" mocap="true"><camera name="c" fovy="{focal}" xyaxes="0 -1 0 0 0 1"/></body></worldbody></mujoco>""")
        self.data = mujoco.MjData(self.model)
        self.renderer = None

    def prepare(self, task: str) -> None:
        if task == "camera":
            self.renderer = self.mujoco.Renderer(self.model, HEIGHT, WIDTH)

    def measure(self, task: str, origin: np.ndarray, rays: np.ndarray) -> np.ndarray:
        self.data.mocap_pos[0] = origin
        self.mujoco.mj_forward(self.model, self.data)
        if task == "camera":
            self.renderer.update_scene(self.data, "c")
            self.renderer.render()
            self.renderer.enable_depth_rendering()
            depth = self.renderer.render()
            self.renderer.disable_depth_rendering()
            return depth.ravel()
        which, found = np.empty(len(rays), np.int32), np.empty(len(rays))
        self.mujoco.mj_multiRay(self.model, self.data, origin, rays.ravel(), None, True, -1, which, found, None, len(rays), REACH_M)
        return np.where(found < 0, np.inf, found)


class Open3D:
    def __init__(self, mesh: Path, folder: str) -> None:
        import open3d

        self.tensor = open3d.core.Tensor
        points = np.frombuffer(mesh.read_bytes()[84:], [("n", "<f4", 3), ("p", "<f4", 9), ("a", "<u2")])["p"].reshape(-1, 3)
        self.scene = open3d.t.geometry.RaycastingScene()
        self.scene.add_triangles(self.tensor(np.ascontiguousarray(points)),
                                 self.tensor(np.arange(len(points), dtype=np.uint32).reshape(-1, 3)))

    def prepare(self, task: str) -> None:
        pass

    def measure(self, task: str, origin: np.ndarray, rays: np.ndarray) -> np.ndarray:
        both = np.concatenate([np.broadcast_to(origin, rays.shape), rays], 1).astype(np.float32)
        return self.scene.cast_rays(self.tensor(both))["t_hit"].numpy()


def compare(task: str, peers: dict[str, object], triangles: np.ndarray, repeats: int) -> None:
    rays = SETS[task]
    times: dict[str, list[float]] = {name: [] for name in peers}
    for name, peer in list(peers.items()):
        try:
            peer.prepare(task)
            peer.measure(task, ORIGIN, rays)
        except Exception as error:  # a renderer without a display, for example
            print(f"{task}: {name} is left out: {error}", file=sys.stderr)
            peers.pop(name)
    for frame in range(repeats):
        for name, peer in peers.items():
            start = time.perf_counter()
            peer.measure(task, moved(frame), rays)
            times[name].append(time.perf_counter() - start)
    sample = np.random.default_rng(0).choice(len(rays), min(SAMPLE, len(rays)), replace=False)
    exact = nearest_m(triangles, ORIGIN, rays[sample])
    hit = exact < REACH_M
    for name, peer in peers.items():
        measured = np.asarray(peer.measure(task, ORIGIN, rays), float)[sample]
        error = np.abs(np.where(np.isfinite(measured), measured, np.inf) - exact)[hit]
        near = error[error <= OTHER_SURFACE_M]
        print(f"{task},{name},{len(rays)},{1e3 * statistics.median(times[name]):.3f},{np.median(near):.2e},{near.max():.2e},"
              f"{len(error) - len(near)},{len(error)}", flush=True)


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--run", default=str(ROOT / "build/release"), help="build folder with simvis-run and the module")
    arguments.add_argument("--repeats", type=int, default=60)
    options = arguments.parse_args()
    sys.path.insert(0, str(Path(options.run).resolve() / "python"))
    os.environ.setdefault("MUJOCO_GL", "egl")
    print("task,who,rays,ms,error_median_m,error_largest_m,other_surface,sample")
    with tempfile.TemporaryDirectory() as folder:
        exported, mesh = Path(folder) / "marvin.glb", Path(folder) / "marvin.stl"
        subprocess.run([Path(options.run) / "bin/simvis-run", "--quiet", "--frames", "1", "--out", f"{folder}/out", "--export",
                        exported, ROOT / "scenes/marvin/marvin.xml"], check=True)
        triangles = triangles_of(exported)
        write_stl(mesh, triangles)
        triangles = triangles.astype(np.float32).astype(float)  # as the file has them
        for task in SETS:
            peers = {}
            for kind in (SimVis, MuJoCo, Open3D):
                try:
                    peers[kind.__name__] = kind(mesh, folder)
                except ImportError as error:
                    print(f"{kind.__name__} is left out: {error}", file=sys.stderr)
            compare(task, peers, triangles, options.repeats if task == "three_scans" else options.repeats // 6)


if __name__ == "__main__":
    main()
