#!/usr/bin/env python3
"""Ratios of a quick run beside the committed ones: `quick.py COMMITTED NOW`, two folders of tables.

Times say little on a machine that does other work too; ratios of what ran in turns in one process say more. A ratio far
from the committed one is a reason to run that benchmark in full."""
import csv
import io
import sys
from pathlib import Path

# A table, the columns that name its rows, the ratio, and what that is a ratio to.
RATIOS = (
    ("ray_methods", ("method", "max_error_rel"), "ratio_to_nearest", "method nearest"),
    ("ray_methods", ("rays", "engine"), "ratio_to_packets", "bare Embree in packets of 16"),
    ("camera_peer", ("scene", "loop"), "ratio_to_bare", "the same commands, submitted again"),
    ("scan_curves", ("curve", "triangles", "beams", "way", "max_error_rel", "threads"), "ratio_to_best",
     "the fastest method"),
)


def rows_of(path):
    """The rows of all tables of a file. A line without a number begins a table with other columns."""
    columns, rows = None, []
    if path.exists():
        for line in csv.reader(io.StringIO(path.read_text(encoding="utf-8"))):
            if not any(cell[:1].isdigit() for cell in line):
                columns = line
            else:
                rows.append(dict(zip(columns, line)))
    return rows


def ratios(folder, table, names, column):
    return {" ".join(row[name] for name in names if row[name]): float(row[column])
            for row in rows_of(Path(folder, f"{table}.csv")) if column in row}


def main():
    committed, now = sys.argv[1:]
    for table, names, column, base in RATIOS:
        before, after = ratios(committed, table, names, column), ratios(now, table, names, column)
        print(f"\n{table}: time as a multiple of {base}\n{'':40} committed       now")
        for name, ratio in after.items():
            known = f"{before[name]:9.2f}" if name in before else "         "
            print(f"{name:40} {known} {ratio:9.2f}")


if __name__ == "__main__":
    main()
