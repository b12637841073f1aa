"""``python -m book.gallery`` runs the pages of the gallery and draws their pictures anew."""

from __future__ import annotations

import io
import re
import runpy
import sys
import tempfile
from contextlib import chdir, redirect_stdout
from pathlib import Path

import matplotlib as mpl
from matplotlib import pyplot as plt

from book.pages import ROOT

GALLERY = ROOT / "docs" / "gallery"
_FILE = re.compile(r'```\w+ title="([^"]+)"\n(.*?)```', re.S)
_CODE = re.compile(r"```python\n(.*?)```", re.S)
_PRINTED = re.compile(r"```text\n(.*?)```", re.S)


def pages() -> list[Path]:
    """The pages that have code, by name."""
    return sorted(page for page in GALLERY.glob("*.md") if _CODE.search(page.read_text("utf-8")))


def printed(page: Path) -> str:
    """What the page says that its code prints."""
    return "".join(_PRINTED.findall(page.read_text("utf-8")))


def run(page: Path, picture: Path) -> str:
    """Run the code of a page beside the files that it states, and draw its figure; return what was printed.

    With one version of matplotlib the picture has the same bytes each time.
    """
    text, said = page.read_text("utf-8"), io.StringIO()
    style = {
        "svg.hashsalt": "robophm",
        "font.size": 11,
        "figure.figsize": (7, 3.8),
        "axes.grid": True,
        "grid.alpha": 0.3,
    }
    with tempfile.TemporaryDirectory() as folder, chdir(folder), mpl.rc_context(style):
        for name, content in _FILE.findall(text):
            Path(name).write_text(content, "utf-8")
        plt.close("all")
        code = Path(f"{page.stem}.py")
        code.write_text("".join(_CODE.findall(text)), "utf-8")
        with redirect_stdout(said):
            runpy.run_path(str(code), run_name="__main__")
        plt.gcf().savefig(picture, metadata={"Date": None})
        plt.close("all")
    return said.getvalue()


def main() -> int:
    """Draw all; the exit code is 1 where a page prints something else than it says."""
    mpl.use("svg")
    wrong = 0
    for page in pages():
        found = run(page, page.with_suffix(".svg"))
        if found != printed(page):
            print(f"{page.name} prints\n{found}")
            wrong = 1
    return wrong


if __name__ == "__main__":
    sys.exit(main())
