"""What a change touches: the files that changed since a commit, on disk too, and the source files that include them."""
import pathlib
import re
import subprocess

root = pathlib.Path(__file__).resolve().parent.parent
INCLUDE = re.compile(r'^\s*#\s*include\s*["<]([^">]+)[">]', re.MULTILINE)
SOURCE_ENDINGS = (".c", ".cpp", ".h")


def git(*arguments):
    return subprocess.run(["git", *arguments], cwd=root, check=True, text=True, stdout=subprocess.PIPE).stdout


def is_product(file):
    """Whether a file, relative to the root, is source code of SimVis and not of its tests and benchmarks."""
    return file.suffix in SOURCE_ENDINGS and file.parts[0] not in ("tests", "bench", "build")


def changed_files(base):
    """Relative to the root. Those that were removed since are among them."""
    names = git("diff", "--name-only", "--no-renames", "-z", base) + git("ls-files", "--others", "--exclude-standard", "-z")
    return {pathlib.Path(name) for name in names.split("\0") if name}


def _included(file, known):
    """All files of ours that a file includes, directly or not, and itself. Includes are written from the root."""
    if file not in known:
        known[file] = {file}  # also ends a circle
        for name in INCLUDE.findall((root / file).read_text(encoding="utf-8")):
            for other in (pathlib.Path(name), pathlib.Path("include") / name):
                if (root / other).is_file():
                    known[file] |= _included(other, known)
    return known[file]


def touched_sources(sources, changed):
    """Of these source files, relative to the root, those that changed or include what changed, each with the changed files
    that it is made of."""
    known = {}
    made_of = {source: _included(source, known) & changed for source in sources}
    return {source: files for source, files in made_of.items() if files}


def covering(touched):
    """A few of the touched source files that together include every changed file that any of them includes."""
    chosen, seen = [], set()
    for source in sorted(touched, key=lambda each: (each not in touched[each], -len(touched[each]), each)):
        if source in touched[source] or not touched[source] <= seen:
            chosen.append(source)
            seen |= touched[source]
    return chosen
