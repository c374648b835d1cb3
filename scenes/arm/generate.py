#!/usr/bin/env python3
"""Makes the parts of the arm scene and its trajectory.

    generate.py            writes them beside this file
    generate.py --out DIR  writes them into DIR
    generate.py --check    makes them in memory and compares them with the files beside this one

It needs Python 3.9 or newer and nothing else. arm.xml is written by hand.
"""
import argparse
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.dont_write_bytecode = True
sys.path[:0] = [str(HERE), str(HERE.parent)]

import gltf_writer
import reach
import robot
import things


def make():
    """The files by name, and the triangles of each."""
    files, triangles = robot.files()
    for model in things.models():
        name = f"{model.name}.glb"
        files[name], triangles[name] = gltf_writer.glb(model.name, model.faces, model.lights), model.triangles()
    files["reach.csv"] = reach.csv().encode()
    return files, triangles


def check(files):
    """Messages about files that are not what this generator makes."""
    problems = []
    for name, data in files.items():
        path = HERE / name
        if not path.exists():
            problems.append(f"{name} is missing")
            continue
        found = path.read_bytes()
        if not (gltf_writer.content(found) == gltf_writer.content(data) if name.endswith(".glb") else found == data):
            problems.append(f"{name} is not what generate.py makes")
    known = {HERE / name for name in files}
    problems += [f"{path.name} is made by nobody" for path in sorted([*HERE.glob("*.glb"), *HERE.glob("meshes/*")])
                 if path not in known]
    return problems


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=HERE, metavar="DIR")
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    files, triangles = make()
    if arguments.check:
        problems = check(files)
        if problems:
            sys.exit("\n".join(problems))
        return
    for name, data in files.items():
        (arguments.out / name).parent.mkdir(parents=True, exist_ok=True)
        (arguments.out / name).write_bytes(data)
        if name in triangles:
            print(f"{name:24} {triangles[name]:6} triangles {len(data):8} bytes")


if __name__ == "__main__":
    main()
