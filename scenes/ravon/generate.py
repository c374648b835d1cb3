#!/usr/bin/env python3
"""Makes the parts of the ravon scene, its drive and the table of its ground.

    generate.py            writes them beside this file
    generate.py --out DIR  writes them into DIR
    generate.py --check    makes them in memory and compares them with the files beside this one

It needs Python 3.9 or newer and nothing else, and takes some seconds. ravon.xml is written by hand.
"""
import argparse
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.dont_write_bytecode = True
sys.path[:0] = [str(HERE), str(HERE.parent)]

import drive
import gltf_writer
import ground
import layout
import robot
import trees
import undergrowth


def make():
    """The files by name, and how many triangles each draws, instances counted."""
    plan = layout.Layout()
    plants, grass = trees.kinds(), undergrowth.grass_kinds()
    rocks = {f"rock_{i + 1}": undergrowth.rock(211 + i, flat) for i, flat in enumerate((0.42, 0.34, 0.52))}
    parts = {
        "ground": [("ground", ground.surfaces(plan.shade.at), [])],
        "plants": [(kind, plants[kind], places) for kind, places in plan.plants.items()],
        "grass": [(f"{kind[0]}_{kind[1]}", grass[kind], places) for kind, places in sorted(plan.grass.items())],
        "rocks": [(kind, rocks[kind], places) for kind, places in sorted(plan.rocks.items())] +
                 [("log", undergrowth.log(), plan.log)],
        "horizon": [("far_forest", undergrowth.far_forest(), []), ("clouds", undergrowth.clouds(), [])],
        "robot_shade": [("robot_shade", robot.shade(), [])],
    }
    files = {f"{name}.glb": gltf_writer.instanced_glb(name, kinds) for name, kinds in parts.items()}
    for model in (robot.robot(), robot.head()):
        model.check()
        files[f"{model.name}.glb"] = gltf_writer.glb(model.name, model.faces)
    files["drive.csv"] = drive.csv(drive.rows()).encode()
    files["ground.csv"] = ground.csv().encode()
    triangles = {f"{name}.glb": sum(len(s.indices) // 3 * max(1, len(places)) for _, surfaces, places in kinds
                                    for s in surfaces) for name, kinds in parts.items()}
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
        same = found == data if name.endswith(".csv") else gltf_writer.content(found) == gltf_writer.content(data)
        if not same:
            problems.append(f"{name} is not what generate.py makes")
    known = {HERE / name for name in files}
    problems += [f"{path.name} is made by nobody" for path in sorted(HERE.glob("*.glb")) if path not in known]
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
    arguments.out.mkdir(parents=True, exist_ok=True)
    for name, data in files.items():
        (arguments.out / name).write_bytes(data)
        print(f"{name:24} {triangles.get(name, 0):7} triangles drawn {len(data):8} bytes")


if __name__ == "__main__":
    main()
