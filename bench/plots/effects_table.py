#!/usr/bin/env python3
"""The table of bench/effects: what each effect costs, and what its knob buys.

`effects_table.py FILE.csv FOLDER` writes FOLDER/effects.md; with `--check` before, it only says whether that is what
stands there."""
from committed_table import CommittedTable

SENSORS = {"camera": ("camera 320 x 180", ""), "laser_scanner": ("scanner of 361 beams", " m")}

TEXT = """# What effects cost

Made from `effects.csv` by `bench/run effects`; `effects.txt` says on what machine and of which commit. Scene `showcase`;
frames with and without the effect in turns. The price is the median frame's time as a ratio to the same scene without
the effect. The error is the RMS difference to the most exact value of the knob that was tried: of linear radiance, or
of ranges in metres. What has no knob is exact. Rain, snow and sand have particles with echoes of their own; fog and dust
are soft media.

{table}
"""


def by_effect(rows):
    """The rows of each effect, under (sensor, effect), in the order of the file."""
    groups = {}
    for row in rows:
        groups.setdefault((row["sensor"], row["effect"]), []).append(row)
    return groups


def error(row):
    return f"{float(row['error']):.1e}".replace("e-0", "e-").replace("e+00", "")


def cells(sensor, effect, rows):
    unit = SENSORS[sensor][1]
    errors = [f"{row['value']}: {error(row)}{unit}" for row in rows[:-1] if row["error"]]
    prices = [f"{float(row['ratio']):.2f}" for row in rows]
    return [SENSORS[sensor][0], f"`{effect}`" if effect != "all" else "all together",
            f"`{rows[0]['knob']}`" if rows[0]["knob"] else "", "; ".join(errors),
            "; ".join(f"{row['value']}: {price}" if row["value"] else price for row, price in zip(rows, prices))]


def table(rows):
    lines = ["| sensor | effect | knob | error at its values | price at its values |", "|---|---|---|---|---|"]
    for (sensor, effect), group in by_effect(rows).items():
        lines.append("| " + " | ".join(cells(sensor, effect, group)) + " |")
    return "\n".join(lines)


def text(rows):
    return TEXT.format(table=table(rows))


TABLE = CommittedTable("effects.md", text)

if __name__ == "__main__":
    TABLE.main()
