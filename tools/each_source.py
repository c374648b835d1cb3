"""Runs a check over source files of SimVis, without tests and benchmarks, on all cores: what tools/check_clang and
tools/check_tidy share. Arguments: FILE... for these files only; --since REV for those that a change since REV touches."""
import concurrent.futures
import json
import os
import pathlib
import subprocess
import sys

from touched import changed_files, is_product, root, touched_sources

build = root / "build/clang"


def compile_commands():
    """By the file, relative to the root. A file that two targets compile is there once."""
    subprocess.run(["tools/build", "clang", "simvis_shaders"], cwd=root, check=True)
    entries = {pathlib.Path(entry["file"]): entry for entry in json.loads((build / "compile_commands.json").read_text())}
    return {file.relative_to(root): entries[file] for file in sorted(entries) if file.is_relative_to(root)}


def chosen(name, arguments, select):
    if arguments[:1] != ["--since"]:
        wanted = {pathlib.Path(name).resolve() for name in arguments}
        return [entry for file, entry in compile_commands().items()
                if (root / file in wanted if wanted else is_product(file))]
    changed = {file for file in changed_files(arguments[1]) if is_product(file)}
    if not changed:
        print(f"{name}: no source file of the product changed since {arguments[1][:12]}")
        sys.exit(0)
    entries = compile_commands()
    touched = touched_sources([file for file in entries if is_product(file)], changed)
    if not touched:
        print(f"{name}: no source file of the product is made of what changed since {arguments[1][:12]}")
        sys.exit(0)
    return [entries[file] for file in select(touched)]


def check_each(name, check, select=sorted):
    """`check` takes an entry of the compile commands and returns an exit status and a text. `select` takes what a change
    touches (touched_sources()) and returns the files to check. Ends the program."""
    entries = chosen(name, sys.argv[1:], select)
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        results = list(pool.map(check, entries))
    failed = [output for code, output in results if code != 0]
    sys.stdout.write("".join(failed))
    print(f"{name}: {len(failed)} of {len(entries)} files with errors or warnings")
    sys.exit(bool(failed) or not entries)
