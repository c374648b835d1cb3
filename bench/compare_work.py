#!/usr/bin/env python3
"""Compares counts of work with committed ones: `compare_work.py COMMITTED.csv NOW.csv|PROGRAM`.

Prints each count that differs by more than SLACK, and exits with status 1 if one of them has grown. A program is run,
and what it prints is compared. Counts of shader invocations are compared only on the device that the committed file
names, for drivers count them differently; pictures and scans have the same counts everywhere."""
import csv
import io
import os
import subprocess
import sys
from pathlib import Path

# A share of the committed count. Processors that multiply and add in one instruction round differently when boxes are
# tested against a view, so that a few triangles more or less are drawn.
SLACK = 0.02
OF_THE_DRIVER = "invocations"
NAMES = ("device", "scene", "way")


def text_of(source):
    if source.endswith(".csv"):
        return Path(source).read_text(encoding="utf-8")
    return subprocess.run([os.path.abspath(source)], check=True, capture_output=True, text=True).stdout


def counts(source):
    """The devices' names, and the counts by scene, way and column."""
    rows = list(csv.DictReader(io.StringIO(text_of(source))))
    return {row["device"] for row in rows}, {(row["scene"], row["way"], column): int(count)
                                             for row in rows
                                             for column, count in row.items() if column not in NAMES}


def main():
    committed_device, committed = counts(sys.argv[1])
    device, now = counts(sys.argv[2])
    grown = False
    for key in sorted(committed.keys() | now.keys()):
        if device != committed_device and key[2].endswith(OF_THE_DRIVER):
            continue
        before, after = committed.get(key), now.get(key)
        if before is None or after is None:
            print(f"{', '.join(key)}: {'new' if before is None else 'not counted any more'}")
            grown = True
        elif abs(after - before) > SLACK * before:
            print(f"{', '.join(key)}: {before} -> {after}")
            grown = grown or after > before
    sys.exit(grown)


if __name__ == "__main__":
    main()
