"""Nothing that runs with us is under the GPL, and what the page bundles has its licences with it."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Iterator
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from pathlib import Path

import pytest
from packaging.requirements import Requirement

ROOT = Path(__file__).parents[2]
NOT_AT_RUN_TIME = ("dev", "bench", "peers", "docs")
"""Extras of those who work on the project."""

OTHERWISE = {
    "pyphen": "may be had under the MPL 1.1 too, and is",
    "psycopg": "LGPL: used unchanged as a library, which an installation may exchange; an extra, of fleets alone",
    "psycopg-binary": "as psycopg, whose compiled half it is",
    "pymavlink": "of it only the generated table of messages is used, which is MIT; the rest is LGPL",
}
"""Packages that name a GPL, and why they may."""


def required() -> Iterator[Distribution]:
    """All that is installed here of what robophm needs at run time, with all that it may be extended by."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    extras = [
        one for name, needs in project["optional-dependencies"].items() if name not in NOT_AT_RUN_TIME for one in needs
    ]
    waiting, seen = [*map(Requirement, [*project["dependencies"], *extras])], set()
    while waiting:
        needed = waiting.pop()
        chosen = [{"extra": extra} for extra in needed.extras] or [{"extra": ""}]
        key = needed.name, tuple(sorted(needed.extras))
        if key in seen:
            continue
        seen.add(key)
        try:
            found = distribution(needed.name)
        except PackageNotFoundError:  # of another system, or of an extra that tests do not need
            continue
        yield found
        for one in map(Requirement, found.requires or ()):
            if one.marker is None or any(one.marker.evaluate(extra) for extra in chosen):
                waiting.append(one)


def licences(found: Distribution) -> str:
    """The names of a package's licences, as it states them."""
    about = found.metadata
    lines = (about.get("License-Expression") or about.get("License") or "").strip().splitlines()[:1]
    named = [one for one in about.get_all("Classifier") or () if one.startswith("License ::")]
    return " ".join([*lines, *named])


def is_gpl(names: str) -> bool:
    """Whether a GPL is among them, the Lesser and the Affero among those."""
    return bool(re.search(r"GPL|General Public", names))


@pytest.mark.parametrize(
    "names", ["GPL-3.0-only", "LGPLv3", "AGPL", "License :: OSI Approved :: GNU General Public License"]
)
def test_a_gpl_is_told(names: str) -> None:
    assert is_gpl(names)
    assert not is_gpl("EPL-2.0 OR BSD-3-Clause")


def test_nothing_that_runs_with_us_is_under_the_gpl() -> None:
    found = {one.name.lower(): licences(one) for one in required()}
    assert len(found) > 40
    assert {"numpy", "fastapi", "starlette", "weasyprint"} <= set(found)
    assert {name for name, names in found.items() if is_gpl(names)} <= set(OTHERWISE)
    assert {name for name, names in found.items() if not names} == set(), "states no licence"


def test_what_the_page_is_made_of_is_free_and_its_texts_come_with_it() -> None:
    packages = json.loads((ROOT / "ui" / "package-lock.json").read_text("utf-8"))["packages"]
    shipped = {
        name.rpartition("node_modules/")[2]: one for name, one in packages.items() if name and not one.get("dev")
    }
    assert {one.get("license") for one in shipped.values()} <= {"MIT", "ISC", "BSD-3-Clause", "0BSD", "Apache-2.0"}
    texts = ROOT / "src" / "robophm" / "web" / "static" / "licenses.md"
    if not texts.is_file():
        pytest.skip("the page is not built")
    told = re.split(r"^## ", texts.read_text("utf-8"), flags=re.M)[1:]
    assert {"react", "uplot", "@xyflow/react", "@codemirror/view"} <= {one.split(" - ")[0] for one in told}
    for one in told:
        assert one.split(" - ")[0] in shipped
        assert re.search("copyright|permission", one, re.I), one.split("\n")[0]
