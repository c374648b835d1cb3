#!/usr/bin/env python3
"""tools/finish_wheel: the same contents are the same bytes, and what a wheel lists is what it has. BUILD is a build folder.
tools/bind_older_versions: binaries ask for older versions of functions, and work as before.

Wheels are made up: libraries of this build, and a library of Debian as auditwheel copies it.
"""
import ctypes
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path(sys.argv.pop(1)).resolve()
INFO = "simvis-0.2.0.dist-info"
SECONDS = 1_000_000_000  # the date of all entries


def library(name: str) -> Path:
    return next(Path("/usr/lib").glob(f"*-linux-gnu/{name}"))


def copied(file: Path) -> str:
    """The name that auditwheel gives to a copy."""
    stem, _, ending = file.name.partition(".so")
    return f"simvis.libs/{stem}-{hashlib.sha256(file.read_bytes()).hexdigest()[:8]}.so{ending}"


def contents() -> dict[str, bytes]:
    zlib = library("libz.so.1")
    return {"simvis/__init__.py": b"", "simvis/bin/program": Path("/bin/true").read_bytes(),
            copied(zlib): zlib.read_bytes(), f"{INFO}/METADATA": b"Metadata-Version: 2.4\nName: simvis\nLicense-File: LICENSE\n\n",
            f"{INFO}/RECORD": b"", f"{INFO}/sboms/auditwheel.cdx.json": b"{}"}


class Wheels(unittest.TestCase):
    def setUp(self) -> None:
        self.folder = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)

    def wheel(self, name: str, entries: dict[str, bytes], year: int = 2020) -> Path:
        file = self.folder / name
        with zipfile.ZipFile(file, "w") as archive:
            for entry, data in entries.items():
                archive.writestr(zipfile.ZipInfo(entry, (year, 1, 2, 3, 4, 6)), data)
        return file

    def run_script(self, *arguments: object) -> subprocess.CompletedProcess[str]:
        return subprocess.run([sys.executable, ROOT / "tools/finish_wheel", *map(str, arguments)], text=True, capture_output=True,
                              env={**os.environ, "SOURCE_DATE_EPOCH": str(SECONDS)})

    def finished(self, name: str, entries: dict[str, bytes], year: int = 2020) -> Path:
        file = self.wheel(name, entries, year)
        run = self.run_script(file, "--build", BUILD)
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        return file

    def assert_refused(self, entries: dict[str, bytes], text: str) -> None:
        file = self.wheel("refused.whl", entries)
        before = file.read_bytes()
        run = self.run_script(file, "--build", BUILD)
        self.assertNotEqual(run.returncode, 0)
        self.assertIn(text, run.stderr)
        self.assertEqual(file.read_bytes(), before)
        self.assertEqual([each.name for each in self.folder.iterdir()], ["refused.whl"])

    def test_order_and_times_of_files_do_not_matter(self) -> None:
        one = self.finished("one.whl", contents())
        other = self.finished("other.whl", dict(reversed(contents().items())), year=2021)
        self.assertEqual(one.read_bytes(), other.read_bytes())
        with zipfile.ZipFile(one) as archive:
            self.assertEqual({entry.date_time for entry in archive.infolist()}, {(2001, 9, 9, 1, 46, 40)})

    def test_the_list_has_what_the_build_read_and_what_was_copied(self) -> None:
        with zipfile.ZipFile(self.finished("simvis.whl", contents())) as archive:
            self.assertNotIn(f"{INFO}/sboms/auditwheel.cdx.json", archive.namelist())
            sbom = json.loads(archive.read(f"{INFO}/sboms/simvis.cdx.json"))
            known = {each["name"]: each for each in sbom["components"]}
            self.assertEqual((sbom["bomFormat"], sbom["metadata"]["component"]["name"]), ("CycloneDX", "simvis"))
            for name in ("glm", "pugixml", "cli11", "three.js", "zlib"):  # headers, an embedded script, a copy
                self.assertIn(name, known)
                text = known[name]["properties"][0]["value"]
                self.assertIn(b"Copyright", archive.read(f"{INFO}/{text}"))
                self.assertIn(f"License-File: {text.removeprefix('licenses/')}\n", archive.read(f"{INFO}/METADATA").decode())
            version = subprocess.run(["dpkg-query", "--show", "--showformat=${source:Version}", "zlib1g"], text=True, capture_output=True)
            self.assertEqual(known["zlib"]["version"], version.stdout)
            places = [place["location"] for place in known["zlib"]["evidence"]["occurrences"]]
            self.assertIn(copied(library("libz.so.1")), places)
            self.assertIn("Expat", [each["license"]["name"] for each in known["glm"]["licenses"]])

    def test_each_difference_between_list_and_files_is_found(self) -> None:
        good = self.finished("good.whl", contents())
        self.assertEqual(self.run_script(good, "--check").returncode, 0)
        with zipfile.ZipFile(good) as archive:
            entries = {name: archive.read(name) for name in archive.namelist()}
        zlib = copied(library("libz.so.1"))
        licence = next(name for name in entries if re.search("licenses/others/glm-", name))
        changes = {
            "simvis.libs/libother.so: the SBOM has another file": {**entries, "simvis.libs/libother.so": entries[zlib]},
            f"{zlib}: the SBOM has another file": {**entries, zlib: entries[zlib] + b"\0"},
            f"{zlib}: it is in the SBOM alone": {name: data for name, data in entries.items() if name != zlib},
            "glm: its licence": {name: data for name, data in entries.items() if name != licence},
            "RECORD is not that": {**entries, "simvis/__init__.py": b"#"},
            "entries are not sorted": dict(reversed(entries.items())),
        }
        for text, changed in changes.items():
            with self.subTest(text):
                run = self.run_script(self.wheel("changed.whl", changed), "--check")
                self.assertEqual(run.returncode, 1)
                self.assertIn(text, run.stdout)

    def test_a_library_of_unknown_origin_is_refused(self) -> None:
        self.assert_refused({**contents(), "simvis.libs/libz-01234567.so.1": library("libz.so.1").read_bytes()},
                            "simvis.libs/libz-01234567.so.1: it is not a copy of a library of an installed Debian package")

    def test_a_driver_without_a_list_is_refused(self) -> None:
        self.assert_refused({**contents(), "simvis/lib/simvis/libvulkan_lvp.so": Path("/bin/true").read_bytes()},
                            "the wheel has a driver without a list")

    def test_a_path_of_this_machine_is_refused(self) -> None:
        self.assert_refused({**contents(), "simvis/lib/a.so": b"\x7fELF " + str(ROOT / "engine/mesh.cpp").encode()},
                            "simvis/lib/a.so: it has the path")

    def bound(self, source: str) -> tuple[Path, set[str]]:
        """A library of this source of C that was in a wheel with older versions, and the versions of glibc that it needs."""
        (self.folder / "source.c").write_text(source)
        file = self.folder / f"{hashlib.sha256(source.encode()).hexdigest()}.so"
        subprocess.run(["cc", "-shared", "-fPIC", "-o", file, self.folder / "source.c", "-lm"], check=True)
        wheel = self.wheel("bound.whl", {"library.so": file.read_bytes(), "text.txt": b"GLIBC_2.35"})
        subprocess.run([sys.executable, ROOT / "tools/bind_older_versions", wheel], check=True)
        with zipfile.ZipFile(wheel) as archive:
            self.assertEqual(archive.read("text.txt"), b"GLIBC_2.35")
            file.write_bytes(archive.read("library.so"))
        versions = subprocess.run(["readelf", "--version-info", "--wide", file], text=True, capture_output=True, check=True).stdout
        return file, set(re.findall(r"Name: (GLIBC_[0-9.]+)", versions))

    def test_a_function_is_bound_to_its_older_version(self) -> None:
        file, needed = self.bound("double hypot(double, double); double sin(double);"
                                  "double length(double x, double y) { return 0 * sin(x) + hypot(x, y); }")
        self.assertEqual(needed, {"GLIBC_2.2.5"})
        length = ctypes.CDLL(str(file)).length
        length.argtypes, length.restype = [ctypes.c_double] * 2, ctypes.c_double
        self.assertEqual(length(3, 4), 5)

    def test_a_function_without_older_version_keeps_its_own(self) -> None:
        _, needed = self.bound("double hypot(double, double); double fmaximum(double, double); double sin(double);"
                               "double length(double x, double y) { return 0 * sin(x) + hypot(x, fmaximum(x, y)); }")
        self.assertIn("GLIBC_2.35", needed)


if __name__ == "__main__":
    for tool in ("ninja", "dpkg-query"):
        if shutil.which(tool) is None:
            print(f"skipped: {tool} is not installed")
            sys.exit(77)
    unittest.main()
