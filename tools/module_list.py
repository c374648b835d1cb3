"""The modules of the source tree, as the file tools/modules beside this one lists them."""
import os
import sys

FILE = os.path.join(os.path.dirname(os.path.realpath(__file__)), "modules")
PUBLIC = "include/simvis/"


def read_modules():
    """What each module may include, itself not named, in the order of the file; the modules of headers; the folders that are
    no modules; why a folder is large; what each module holds."""
    arrows, headers, folders, large, holds = {}, {}, set(), {}, {}
    with open(FILE, encoding="utf-8") as lines:
        for number, line in enumerate(lines, 1):
            words = line.split("#")[0].replace(":", " : ").split()
            try:
                if not words:
                    continue
                elif words[0] == "module" and words[2] == ":":
                    arrows[words[1]] = _expanded(words[3:], arrows)
                elif words[0] == "holds" and words[1:] and len(holds) < len(arrows):
                    holds[list(arrows)[-1]] = line.strip().removeprefix("holds").strip()
                elif words[0] == "header" and words[2] in arrows and len(words) == 3:
                    headers[PUBLIC + words[1] + ".h"] = words[2]
                elif words[0] == "folder" and len(words) == 2 and os.path.dirname(words[1]) in {*arrows, *folders}:
                    folders.add(words[1])
                elif words[0] == "large" and words[2] == ":" and words[3:]:
                    large[words[1]] = " ".join(words[3:])
                else:
                    raise IndexError
            except (IndexError, KeyError):
                sys.exit(f"simvis: {FILE}:{number}: expected \"module MODULE: MODULE...\", \"holds TEXT\", \"header NAME MODULE\", "
                         "\"folder FOLDER\" or \"large FOLDER: REASON\" with modules of the lines above")
    for module in arrows:
        if module not in holds:
            sys.exit(f"simvis: {FILE}: module {module}: expected a line \"holds TEXT\"")
    return arrows, headers, folders, large, holds


def top_arrows(arrows):
    """The folders at the top of the tree that each of them may include, itself not named."""
    tops = {}
    for module, may in arrows.items():
        top = tops.setdefault(module.split("/")[0], set())
        top |= {used.split("/")[0] for used in may} - {module.split("/")[0]}
    return tops


def _expanded(words, arrows):
    may = set()
    for word in words:
        if word == "*":
            may |= {module for module in arrows if module not in ("tests", "bench")}
        elif word.startswith("+"):
            may |= arrows[word[1:]] | {word[1:]}
        else:
            arrows[word]  # it exists
            may.add(word)
    return may
