"""Reads GLB files with Khronos' validator (npm's gltf-validator) and with trimesh (of PyPI), installed below FOLDER once.

read_glb.py EXPECTED.json FOLDER: a list of objects with file, triangles, min and max of the world, z up. Prints what
differs and ends with 1; ends with 77 and the reason where a reader cannot be had.
"""
import json
import os
import subprocess
import sys

SKIPPED = 77
TOLERANCE = 1e-6  # of the largest coordinate: trimesh rounds some of them to float32, by 6e-8 each

# Meshes of SimVis have no tangents: it computes them from a normal map where it shades, as other readers do.
ACCEPTED = {"MESH_PRIMITIVE_GENERATED_TANGENT_SPACE"}

VALIDATE = """
const {validateBytes} = require('gltf-validator');
const read = async (file) => (await validateBytes(new Uint8Array(require('fs').readFileSync(file)), {maxIssues: 20})).issues;
Promise.all(process.argv.slice(1).map(read)).then((all) => console.log(JSON.stringify(all)));
"""


def skip(reason):
    print(reason)
    sys.exit(SKIPPED)


def install(command, result, what):
    if os.path.exists(result):
        return
    os.makedirs(os.path.dirname(result), exist_ok=True)
    try:
        if subprocess.run(command, capture_output=True, timeout=100).returncode == 0:
            return
    except (OSError, subprocess.TimeoutExpired):
        pass
    skip(f"{what} cannot be installed")


def validate(files, folder):
    install(["npm", "install", "--silent", "--no-audit", "--no-fund", "--prefix", folder, "gltf-validator"],
            os.path.join(folder, "node_modules", "gltf-validator"), "npm's gltf-validator")
    run = subprocess.run(["node", "-e", VALIDATE, *files], capture_output=True, text=True, cwd=folder, check=True)
    return [f"{file}: validator: {message['code']} {message['message']} at {message.get('pointer')}"
            for file, issues in zip(files, json.loads(run.stdout)) for message in issues["messages"]
            if message["severity"] < 2 and message["code"] not in ACCEPTED]


def measure(expected, folder):
    packages = os.path.join(folder, "packages")
    install([sys.executable, "-m", "pip", "install", "--quiet", "--no-input", "--no-deps", "--retries", "0", "--target",
             packages, "trimesh"], os.path.join(packages, "trimesh"), "trimesh")
    sys.path.insert(0, packages)
    try:
        import trimesh
    except ImportError as error:
        skip(f"trimesh cannot be used: {error}")
    wrong = []
    for each in expected:
        scene = trimesh.load(each["file"])
        meshes = [scene.geometry[scene.graph[node][1]] for node in scene.graph.nodes_geometry]
        triangles = sum(len(mesh.faces) for mesh in meshes if hasattr(mesh, "faces"))
        (x0, y0, z0), (x1, y1, z1) = scene.bounds  # y up
        if triangles != each["triangles"]:
            wrong.append(f"{each['file']}: trimesh: {triangles} triangles, expected {each['triangles']}")
        largest = max(map(abs, each["min"] + each["max"]))
        for seen, true in (((x0, -z1, y0), each["min"]), ((x1, -z0, y1), each["max"])):
            if max(abs(a - b) for a, b in zip(seen, true)) > TOLERANCE * largest:
                wrong.append(f"{each['file']}: trimesh: a corner at {seen}, expected {true}")
    return wrong


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        expected = json.load(file)
    folder = sys.argv[2]
    wrong = validate([each["file"] for each in expected], folder) + measure(expected, folder)
    print("\n".join(wrong))
    sys.exit(1 if wrong else 0)


main()
