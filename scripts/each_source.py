"""Runs a check over each source file of SimVis, without tests and benchmarks, on all cores: what scripts/check_clang and
scripts/check_tidy share. Arguments: FILE... for these files only; --part K/N for only every N-th file, from the K-th on."""
import concurrent.futures
import json
import os
import pathlib
import subprocess
import sys

root = pathlib.Path(__file__).resolve().parent.parent
build = root / "build/clang"


def is_product(file):
    return file.is_relative_to(root) and file.relative_to(root).parts[0] not in ("tests", "bench", "build")


def chosen(entries, arguments):
    part, parts = 0, 1
    if arguments[:1] == ["--part"]:
        part, parts = map(int, arguments[1].split("/"))
        arguments = arguments[2:]
    wanted = {pathlib.Path(name).resolve() for name in arguments}
    files = {pathlib.Path(entry["file"]): entry for entry in entries}  # a file that two targets compile is checked once
    return [files[file] for file in sorted(files) if file in wanted or (not wanted and is_product(file))][part::parts]


def check_each(name, check):
    """`check` takes an entry of the compile commands and returns an exit status and a text. Ends the program."""
    subprocess.run(["scripts/build", "clang", "simvis_shaders"], cwd=root, check=True)
    entries = chosen(json.loads((build / "compile_commands.json").read_text()), sys.argv[1:])
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        results = list(pool.map(check, entries))
    failed = [output for code, output in results if code != 0]
    sys.stdout.write("".join(failed))
    print(f"{name}: {len(failed)} of {len(entries)} files with errors or warnings")
    sys.exit(bool(failed) or not entries)
