#!/usr/bin/env python3
"""The table of bench/knobs: the error and the processor time of each value of each knob.

`knobs_table.py FILE.csv FOLDER` writes FOLDER/knobs.md; with `--check` before, it only says whether that is what
stands there."""
from committed_table import CommittedTable

TEXT = """# Knobs of light, lens and events: error against processor time

Made from `knobs.csv` by `bench/run knobs`; `knobs.txt` says on what machine and of which commit. A frame of a camera of 320 x 180
in the scene `showcase`, or of an event camera of 48 x 36 before a turning fan: processor time of all threads, the device
included, which is a CPU; median of frames in which all values of a knob take turns. "off" is the same camera without the
effect. Errors of cameras are the RMS of linear radiance over pixels that show a surface: of lamps and skies against the sum of 1,024
pictures with one light each, without the hundredth of the pixels that differs most (highlights), of other knobs against their most exact value, which has no error here. Errors of events are the
99th percentile of the error of their times, in microseconds, and the share of events in pixels that have another number of
them than with `step` 0.02 and `time_error` 1e-8.

{table}
"""


def by_knob(rows):
    """The rows of each knob, in the order of the file."""
    groups = {}
    for row in rows:
        groups.setdefault(row["knob"], []).append(row)
    return groups


def cell(row):
    if not row["error"]:
        return ""
    if row["missed"]:
        return f"{float(row['error']):.2g} us, {100 * float(row['missed']):.2g} %"
    return f"{float(row['error']):.2g}"


def table(rows):
    lines = ["| knob | value | processor time in ms | error |", "|---|---|---|---|"]
    for knob, group in by_knob(rows).items():
        for row in group:
            lines.append(f"| `{knob}` | {row['value']} | {float(row['processor_ms']):.3g} | {cell(row)} |")
    return "\n".join(lines)


def text(rows):
    return TEXT.format(table=table(rows))


TABLE = CommittedTable("knobs.md", text)

if __name__ == "__main__":
    TABLE.main()
