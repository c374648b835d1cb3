"""Settings of Sphinx for the site of the documents, which tools/site makes from the files as they stand here."""
import re
from pathlib import Path

from pygments.lexers.special import TextLexer

ROOT = Path(__file__).resolve().parent.parent
START, CONTENTS = "README", "docs/index"  # the first page, and the list of all documents
# Documents that list others of their folder, which the contents do not.
LISTS = {"docs/decisions/README": "0*", "bench/README": "results/*"}

project = "SimVis"
html_title = "SimVis " + re.search(r"^version: (\S+)", (ROOT / "CITATION.cff").read_text(), re.MULTILINE)[1]
html_theme = "furo"
html_copy_source = False
html_show_copyright = html_use_index = False
extensions = ["myst_parser"]
myst_heading_anchors = 6  # links name headings as GitHub does
root_doc = START
include_patterns = ["*.md", "docs/**.md", "bench/**.md", "scenes/*.md"]


def toctree(entries: list[str], *options: str) -> str:
    return "\n".join(["\n```{toctree}", ":hidden:", *options, "", *entries, "```\n"])


def navigation() -> str:
    """The documents of CONTENTS, under its headings."""
    text = toctree([f"All documents </{CONTENTS}>"])
    folder = (ROOT / CONTENTS).parent
    listed = {START}
    for section in (ROOT / f"{CONTENTS}.md").read_text().split("\n## "):
        heading, _, body = section.partition("\n")
        entries = []
        for label, target in re.findall(r"\[([^]]+)\]\(([^)#]+)\)", body):
            file = (folder / target / "README.md" if target.endswith("/") else folder / target).resolve()
            name = str(file.relative_to(ROOT).with_suffix(""))
            if name not in listed:
                listed.add(name)
                entries.append(f"{label[0].upper()}{label[1:]} </{name}>")
        text += toctree(entries, ":caption: " + heading.replace("# Documentation", "Begin"))
    return text + toctree(["/bench/README"])


def without_folder(name: str, link: re.Match[str]) -> str:
    """A link to a folder leads to its README; of one to a folder without README the text stays."""
    target = (ROOT / name).parent / link[2]
    if not target.is_dir():
        return link[0]
    return f"[{link[1]}]({link[2].rstrip('/')}/README.md)" if (target / "README.md").exists() else link[1]


def change(app, name: str, source: list[str]) -> None:
    """Fits what Sphinx has read of a document to the site."""
    source[0] = re.sub(r"\[([^]]+)\]\(([^):#]+)\)", lambda link: without_folder(name, link), source[0])
    if name == START:
        source[0] += navigation()
    elif name in LISTS:
        source[0] += toctree([LISTS[name]], ":glob:")


def widen(app, name: str, template: str, context: dict[str, str], tree) -> None:
    """The tables are wider than the theme's text."""
    context["metatags"] = context.get("metatags", "") + "<style>.main .content { width: 60em; max-width: 100%; }</style>"


def setup(app) -> None:
    app.connect("source-read", change)
    app.connect("html-page-context", widen)
    for language in ("mermaid", "csv"):  # Pygments does not know these
        app.add_lexer(language, TextLexer)
