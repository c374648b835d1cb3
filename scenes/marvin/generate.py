#!/usr/bin/env python3
"""Makes the parts of the marvin scene and its drive.

    generate.py            writes them beside this file
    generate.py --out DIR  writes them into DIR
    generate.py --check    makes them in memory and compares them with the files beside this one

It needs Python 3.9 or newer and nothing else, and takes some seconds. marvin.xml is written by hand; the drive is
checked against the furniture that stands in it.
"""
import argparse
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.dont_write_bytecode = True
sys.path[:0] = [str(HERE), str(HERE.parent)]

import committed
import drive
import furniture
import gltf_writer
import materials
import robot
import room
import things


def models():
    made = [room.laboratory(), room.window(), room.door(), room.lamp(), room.radiator(),
            furniture.table(), furniture.round_table(), furniture.swivel_chair(), furniture.visitor_chair(),
            furniture.stool(), furniture.shelf("shelf_books", 41, "bbbbb"),
            furniture.shelf("shelf_mixed", 42, "xxmbm"), furniture.cupboard(), furniture.carpet(),
            things.monitor("monitor_code", materials.CODE_SCREEN),
            things.monitor("monitor_scan", materials.SCAN_SCREEN), things.computer(), things.keyboard(),
            things.mug(), things.oscilloscope(), things.cardboard_box(),
            things.waste_bin(), things.plant(), things.whiteboard(), things.poster(), things.clock(),
            things.extinguisher(), robot.robot(), robot.tilt_head()]
    for model in made:
        model.check()
    return {model.name: model for model in made}


def make():
    """The files by name, and the models that they were made from."""
    made = models()
    files = {f"{name}.glb": gltf_writer.glb(name, model.faces, model.lights) for name, model in made.items()}
    table = drive.rows()
    files["drive.csv"] = drive.csv(table).encode()
    return files, made, table


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=HERE, metavar="DIR")
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    files, made, table = make()
    distance, nearest = drive.clearance(table, drive.obstacles(HERE / "marvin.xml", made))
    if distance < drive.SMALLEST_CLEARANCE_M:
        sys.exit(f"the drive comes within {distance:.3f} m of {nearest}")
    if arguments.check:
        problems = committed.problems(HERE, files)
        if problems:
            sys.exit("\n".join(problems))
        return
    arguments.out.mkdir(parents=True, exist_ok=True)
    for name, data in files.items():
        (arguments.out / name).write_bytes(data)
        if name.endswith(".glb"):
            print(f"{name:24} {made[name[:-4]].triangles():6} triangles {len(data):8} bytes")
    print(f"the drive keeps {distance:.3f} m from everything; nearest is {nearest}")


if __name__ == "__main__":
    main()
