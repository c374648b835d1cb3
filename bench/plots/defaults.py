"""The defaults of settings, from docs/reference.md, which simvis-run --describe has written."""
import re
from pathlib import Path

REFERENCE = Path(__file__).resolve().parent.parent.parent / "docs/reference.md"


def default_of(attribute, type_name=""):
    """The default as it is written there: of the type whose heading has the name, or of the first that has the attribute."""
    text = REFERENCE.read_text(encoding="utf-8")
    if type_name:
        text = text[text.index(f"`{type_name}`\n"):]
    return re.search(rf"^\| `{attribute}` \| [^|]*\| ([^| ]*) ?\|", text, re.MULTILINE)[1]


def at_default(rows, default):
    """Of rows from the coarsest value to the finest one: the first that is as fine as the default."""
    values = [float(row["value"]) for row in rows]
    ascends = values[-1] > values[0]
    for row, value in zip(rows, values):
        if (value >= float(default)) if ascends else (value <= float(default)):
            return row
    return rows[-1]
