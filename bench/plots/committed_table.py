"""A table that is made from the figures of a benchmark and is committed beside them."""
import csv
import sys
from pathlib import Path


class CommittedTable:
    def __init__(self, name, text):
        self.name, self.text = name, text  # text(rows) is the whole file

    def write(self, rows, folder):
        Path(folder, self.name).write_text(self.text(rows), encoding="utf-8")

    def main(self):
        """The command line of a script: [--check] FILE.csv FOLDER."""
        *options, path, folder = sys.argv[1:]
        with open(path, newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        if options != ["--check"]:
            self.write(rows, folder)
        elif Path(folder, self.name).read_text(encoding="utf-8") != self.text(rows):
            sys.exit(f"{self.name} is not what {Path(sys.argv[0]).name} makes of {path}")
