#!/usr/bin/env python3
"""Finds the software of others that a build contains: `tools/bundled_software.py BUILD [SOURCE]` prints it as JSON.

BUILD is a build folder of ninja. What it contains are the packages of Debian and of Python whose headers, archives or
scripts its outputs were made of. SOURCE is an unpacked source package of Debian that was built there, such as Mesa's. Each
entry has name, version, purl, licences (names) and text (the copyright file).
"""
import functools
import importlib.metadata
import json
import re
import subprocess
import sys
from pathlib import Path

Software = dict[str, object]


def output_of(*command: str, paths: list[str] | None = None) -> str:
    """What the command prints; it may fail for some of the paths."""
    return subprocess.run([*command, *(paths or [])], capture_output=True, text=True).stdout


def licence_names(copyright_text: str) -> list[str]:
    """The short names of a machine-readable copyright file of Debian; otherwise none."""
    return sorted({name.strip() for name in re.findall(r"^License: *(\S.*)$", copyright_text, re.MULTILINE)})


def debian_source(name: str, version: str, text: str) -> Software:
    return {"name": name, "version": version, "purl": f"pkg:deb/debian/{name}@{version}?arch=source".replace("+", "%2B"),
            "licences": licence_names(text), "text": text}


@functools.cache
def package_of(file: str) -> str | None:
    """The installed package of Debian that has this file. Packages name files in /usr/lib or in /lib."""
    for path in (file, file.removeprefix("/usr"), "/usr" + file):
        found = re.match(r"([^:,]+)", output_of("dpkg-query", "--search", path))
        if found:
            return found[1]
    return None


def packages_of(files: set[str]) -> set[str]:
    """The installed packages of Debian that have these files."""
    found = output_of("dpkg-query", "--search", paths=sorted(files))
    packages = {line.split(":")[0] for line in found.splitlines() if not line.startswith("diversion")}
    named = {line.split(": ", 1)[1] for line in found.splitlines() if ": " in line}
    return packages | {name for file in files - named if (name := package_of(file))}


def software_of_package(package: str) -> Software:
    """The source package of an installed package, with the copyright file that it installs."""
    query = output_of("dpkg-query", "--show", "--showformat=${source:Package}\n${source:Version}\n", package).split("\n")
    text = (Path("/usr/share/doc") / package / "copyright").read_text(errors="replace")
    return debian_source(query[0], query[1], text)


def software_in_python(files: set[str]) -> list[Software]:
    """The distributions of this Python that have these files, with the licences that lie beside them."""
    owners = importlib.metadata.packages_distributions()
    found: dict[str, Software] = {}
    for file in sorted(files):
        folder, _, inside = file.partition("/site-packages/")
        for name in owners.get(inside.split("/")[0], []):
            distribution = importlib.metadata.distribution(name)
            texts = [Path(folder) / "site-packages" / each for each in distribution.files or [] if "LICENSE" in each.name.upper()]
            licence = distribution.metadata.get("License-Expression") or distribution.metadata.get("License") or ""
            found[name] = {"name": name, "version": distribution.version, "purl": f"pkg:pypi/{name}@{distribution.version}",
                           "licences": [licence] if licence else [],
                           "text": "\n".join(text.read_text(errors="replace") for text in sorted(texts))}
    return list(found.values())


def software_of_build(build: Path) -> list[Software]:
    """What the outputs of this build folder were made of, by name."""
    read = set(re.findall(r"^    (/\S+)$", output_of("ninja", "-C", str(build), "-t", "deps"), re.MULTILINE))
    read |= set(re.findall(r"(?<=[ =])/usr/[^\s:|$]+(?:\.a|/copyright)(?=\s)", (build / "build.ninja").read_text()))
    if not read:
        raise SystemExit(f"{build}: ninja has no record of what was read, expected a finished build")
    in_python = {file for file in read if "/site-packages/" in file}
    packages = packages_of({file for file in read - in_python if file.startswith("/usr/") and Path(file).exists()})
    all_of_it = software_in_python(in_python) + [software_of_package(package) for package in sorted(packages)]
    return sorted({software["name"]: software for software in all_of_it}.values(), key=lambda software: str(software["name"]))


def software_of_source(source: Path) -> Software:
    """The source package of Debian that is unpacked in this folder."""
    first = re.match(r"(\S+) \(([^)]+)\)", (source / "debian/changelog").read_text())
    if first is None:
        raise SystemExit(f"{source}: there is no debian/changelog with a version")
    return debian_source(first[1], first[2], (source / "debian/copyright").read_text(errors="replace"))


def main() -> None:
    found = software_of_build(Path(sys.argv[1]))
    if len(sys.argv) > 2:
        found.append(software_of_source(Path(sys.argv[2])))
    json.dump(found, sys.stdout, indent=1, sort_keys=True)
    print()


if __name__ == "__main__":
    main()
