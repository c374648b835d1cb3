"""Types text into an interactive shell and prints the arguments that simvis-run, a stand-in, gets.

usage: type_in_shell.py SHELL SCRIPT FOLDER TEXT...

SHELL is bash, zsh or fish, SCRIPT the completion for it, FOLDER an empty folder, TEXT what is typed behind "simvis-run ",
with tabs. Keys are handled in order, so nothing waits between them. Prints one line of arguments for each TEXT.
"""
import os
import pty
import select
import sys
import time

PATIENCE_S = 60
shell, script, folder = sys.argv[1:4]
got = os.path.join(folder, "arguments")

programs = os.path.join(folder, "bin")
os.mkdir(programs)
stand_in = os.path.join(programs, "simvis-run")
with open(stand_in, "w", encoding="utf-8") as file:
    file.write(f'#!/bin/sh\nprintf "%s\\n" "$*" > {got}.new && mv {got}.new {got}\n')
os.chmod(stand_in, 0o755)

COMMANDS = {"bash": ["bash", "--norc", "--noprofile", "-i"], "zsh": ["zsh", "-f", "-i"], "fish": ["fish", "--no-config"]}
SETUP = {
    "bash": f"source {script}",
    "zsh": f"fpath=({os.path.join(folder, 'functions')} $fpath); autoload -Uz compinit; compinit -u -D",
    "fish": f"source {script}",
}
if shell == "zsh":
    os.mkdir(os.path.join(folder, "functions"))
    os.symlink(os.path.abspath(script), os.path.join(folder, "functions", "_simvis-run"))

process, terminal = pty.fork()
if process == 0:
    os.environ.update(HOME=folder, PATH=programs + ":" + os.environ["PATH"], TERM="xterm", LC_ALL="C.UTF-8")
    os.execvp(COMMANDS[shell][0], COMMANDS[shell])

shown = b""


def read_until(done):
    """Reads what the shell shows until done() is true."""
    global shown
    end = time.monotonic() + PATIENCE_S
    while not done():
        if time.monotonic() > end:
            sys.exit(f"{shell} does not answer; it has shown:\n{shown.decode(errors='replace')}")
        if select.select([terminal], [], [], 0.02)[0]:
            shown += os.read(terminal, 65536)


# "ready" stands in the answer alone, not in the echo of what is typed.
os.write(terminal, f"{SETUP[shell]}\nprintf 'rea%s\\n' dy\n".encode())
read_until(lambda: b"ready" in shown)
for text in sys.argv[4:]:
    os.write(terminal, f"simvis-run {text}\n".encode())
    read_until(lambda: os.path.exists(got))
    with open(got, encoding="utf-8") as file:
        print(file.read(), end="")
    os.remove(got)
os.write(terminal, b"exit\n")
