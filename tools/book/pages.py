"""The pages of the site, laid out as in the repository, so that a link between them holds in both."""

from __future__ import annotations

import re
import shutil
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from book.reference import api, commands, design_file

ROOT = Path(__file__).resolve().parents[2]
CONFIG = ROOT / "zensical.toml"
GENERATED: dict[str, Callable[[], str]] = {
    "docs/reference/commands.md": commands,
    "docs/reference/api.md": api,
    "docs/reference/design-file-fields.md": design_file,
}
"""Pages made of the code, each with what makes it: none is kept, so none is ever stale."""

UNSEARCHED = ("docs/adr/", "docs/status.md", "docs/benchmarks.md", "docs/calibration.md", "docs/fresh-machines.md")
"""Pages that the search leaves out: they are long and for those who work on the project, and each reader loads all."""

ADDED = ("accessible.js", "contrast.css", "search_when_asked.js")
"""Files of ours beside the theme: each says in its first line what the theme leaves out."""

_LINK = re.compile(r"\]\(([^)#:\s]+)(?:#[^)]*)?\)")
_PICTURE = re.compile(r"(!\[[^]]*\]\([^)\s]+\))(?!\{)")


def navigated() -> list[str]:
    """The pages that the site's navigation names, in its order."""

    def leaves(entry: Any) -> Iterator[str]:
        if isinstance(entry, str):
            yield entry
        else:
            for one in entry.values() if isinstance(entry, dict) else entry:
                yield from leaves(one)

    return list(leaves(tomllib.loads(CONFIG.read_text("utf-8"))["project"]["nav"]))


def lay_out(folder: Path) -> None:
    """Copy into ``folder`` all pages, what they link to, and what is generated."""
    shutil.rmtree(folder, ignore_errors=True)
    pages = [ROOT / name for name in ("README.md", "CONTRIBUTING.md", "SECURITY.md", "CHANGELOG.md")]
    pages += sorted([*ROOT.glob("docs/**/*.md"), *ROOT.glob("examples/**/*.md")])
    for page in pages:
        linked = (page.parent / target for target in _LINK.findall(page.read_text("utf-8")))
        for source in {page, *(one.resolve() for one in linked if one.is_file())}:
            target = folder / source.relative_to(ROOT)
            target.parent.mkdir(parents=True, exist_ok=True)
            _copy(source, target)
    for name in ADDED:
        shutil.copyfile(Path(__file__).with_name(name), folder / name)
    for name, make in GENERATED.items():
        (folder / name).write_text(make(), "utf-8")
    with (folder / "docs/adr/README.md").open("a", encoding="utf-8") as index:
        index.write("\n" + "".join(f"- [{title(page)}]({page.name})\n" for page in sorted(ROOT.glob("docs/adr/0*.md"))))


def _copy(source: Path, target: Path) -> None:
    """Copy a file; a page's pictures are fetched only when one comes near to them."""
    if source.suffix != ".md":
        shutil.copyfile(source, target)
        return
    head = "---\nsearch:\n  exclude: true\n---\n\n"
    unsearched = source.relative_to(ROOT).as_posix().startswith(UNSEARCHED)
    text = _PICTURE.sub(r"\1{ loading=lazy }", source.read_text("utf-8"))
    target.write_text((head if unsearched else "") + text, "utf-8")


def title(page: Path) -> str:
    """The first heading of a page."""
    return page.read_text("utf-8").partition("\n")[0].lstrip("# ")
