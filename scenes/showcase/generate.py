#!/usr/bin/env python3
"""Makes the parts of the showcase scene.

    generate.py            writes them beside this file
    generate.py --out DIR  writes them into DIR
    generate.py --check    makes them in memory and compares them with the files beside this one

It needs Python 3.9 or newer and nothing else. showcase.xml is written by hand.
"""
import argparse
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.dont_write_bytecode = True
sys.path[:0] = [str(HERE), str(HERE.parent)]

import committed
import gltf_writer
import splats
import surfaces
import yard


def make():
    files = {f"{model.name}.glb": gltf_writer.glb(model.name, model.faces, model.lights) for model in yard.models() + surfaces.models()}
    return files | {"bush.ply": splats.ply(splats.bush())}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=HERE, metavar="DIR")
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    files = make()
    if arguments.check:
        problems = committed.problems(HERE, files)
        if problems:
            sys.exit("\n".join(problems))
        return
    for name, data in files.items():
        (arguments.out / name).write_bytes(data)
        print(f"{name:16} {len(data):8} bytes")


if __name__ == "__main__":
    main()
