"""Reads a GLB with Khronos' validator (npm's gltf-validator) and with trimesh (of PyPI), which are installed below FOLDER.

read_glb.py FILE.glb EXPECTED FOLDER: EXPECTED is JSON with triangles, min and max of the world, z up. Prints what differs
and ends with 1; ends with 77 and the reason where a reader cannot be had.
"""
import json
import os
import subprocess
import sys

SKIPPED = 77
TOLERANCE_M = 1e-5  # trimesh computes in float32, on numbers below 10 m

VALIDATE = """
const {validateBytes} = require('gltf-validator');
validateBytes(new Uint8Array(require('fs').readFileSync(process.argv[1])), {maxIssues: 20}).then((report) => {
  console.log(JSON.stringify(report.issues));
});
"""


def skip(reason):
    print(reason)
    sys.exit(SKIPPED)


def install(command, what):
    try:
        if subprocess.run(command, capture_output=True, timeout=100).returncode == 0:
            return
    except (OSError, subprocess.TimeoutExpired):
        pass
    skip(f"{what} cannot be installed")


def validate(file, folder):
    install(["npm", "install", "--silent", "--prefix", folder, "gltf-validator"], "npm's gltf-validator")
    run = subprocess.run(["node", "-e", VALIDATE, file], capture_output=True, text=True, cwd=folder, check=True)
    issues = json.loads(run.stdout)
    return [f"validator: {m['code']} {m['message']} at {m.get('pointer')}" for m in issues["messages"] if m["severity"] < 2]


def measure(file, expected, folder):
    packages = os.path.join(folder, "packages")
    install([sys.executable, "-m", "pip", "install", "--quiet", "--no-input", "--no-deps", "--retries", "0", "--target", packages, "trimesh"],
            "trimesh")
    sys.path.insert(0, packages)
    import trimesh
    scene = trimesh.load(file)
    triangles = sum(len(scene.geometry[scene.graph[node][1]].faces) for node in scene.graph.nodes_geometry)
    (x0, y0, z0), (x1, y1, z1) = scene.bounds  # y up
    wrong = []
    if triangles != expected["triangles"]:
        wrong.append(f"trimesh: {triangles} triangles, expected {expected['triangles']}")
    for seen, true in (((x0, -z1, y0), expected["min"]), ((x1, -z0, y1), expected["max"])):
        if max(abs(a - b) for a, b in zip(seen, true)) > TOLERANCE_M:
            wrong.append(f"trimesh: a corner at {seen}, expected {true}")
    return wrong


def main():
    file, expected, folder = os.path.abspath(sys.argv[1]), json.loads(sys.argv[2]), sys.argv[3]
    wrong = validate(file, folder) + measure(file, expected, folder)
    print("\n".join(wrong))
    sys.exit(1 if wrong else 0)


main()
