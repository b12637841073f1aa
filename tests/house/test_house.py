"""What holds for the project as a whole: its public face, what an import costs, what its files may not hold."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

import robophm

ROOT = Path(__file__).resolve().parents[2]
HEAVY = ("numpy", "scipy", "pydantic", "pint", "ruamel", "rosbags", "mcap", "typer", "rich", "sqlite3")


def loaded_by(statement: str) -> set[str]:
    """The packages that a new process has loaded after a statement."""
    code = f"{statement}\nimport sys\nprint(*{{name.partition('.')[0] for name in sys.modules}})"
    return set(subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split())


def test_the_public_names_are_the_namespace():
    assert sorted(robophm.__all__) == robophm.__all__
    public = {name for name in vars(robophm) if not name.startswith("_")} - {"annotations", "TYPE_CHECKING", "Any"}
    rooms = {path.stem for path in (ROOT / "src" / "robophm").iterdir()}
    assert public - rooms <= set(robophm.__all__)
    assert set(robophm.__all__) <= set(dir(robophm))
    with pytest.raises(AttributeError, match="has no attribute 'relibility'"):
        robophm.relibility  # noqa: B018


@pytest.mark.parametrize("name", robophm.__all__)
def test_every_public_name_resolves(name):
    value = getattr(robophm, name)
    assert value.__doc__
    assert value.__module__.startswith("robophm.")


def test_an_import_costs_nothing():
    assert not loaded_by("import robophm").intersection(HEAVY)


@pytest.mark.parametrize(
    ("statement", "spared"),
    [
        ("from robophm import Series", {"scipy", "pydantic", "pint", "rosbags", "typer"}),
        ("from robophm.cli import main", {"numpy", "scipy", "pydantic", "rosbags"}),
        ("from robophm import load", {"pydantic", "pint", "ruamel", "rosbags", "typer", "scipy"}),
    ],
)
def test_what_is_not_used_is_not_loaded(statement, spared):
    assert not loaded_by(statement) & spared


def tracked() -> list[Path]:
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=False)
    if listed.returncode:
        pytest.skip("not a git work tree")
    return [ROOT / name for name in listed.stdout.split("\0") if name and (ROOT / name).is_file()]


def test_no_file_holds_a_registry_or_somebodys_folder():
    """Clients know where their registries are, and paths of one machine are of no use on another."""
    words = ("py" + "pi.org", "files.python" + "hosted", "registry." + "npmjs", "/wo" + "rk/")
    found = [
        f"{path.relative_to(ROOT)}: {word}"
        for path in tracked()
        for word in words
        if word.encode() in path.read_bytes()
    ]
    assert found == []


def test_no_word_is_left_over_from_work():
    marks = re.compile(rb"<<<<<<<|>>>>>>>|\bbreakpoint\(\)|\bset_trace\b")
    found = [
        path
        for path in tracked()
        if path.suffix == ".py" and path != Path(__file__) and marks.search(path.read_bytes())
    ]
    assert found == []
