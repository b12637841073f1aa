"""``robophm parts``: a list, a search, one entry in full, and as JSON; and which commands point to it."""

import json
from pathlib import Path

import pytest
from tests.cases import some
from typer.testing import CliRunner

from robophm.cli.app import app
from robophm.core.errors import PlugError
from robophm.design.file import parse
from robophm.parts import library, part


def said(*words):
    """What the command prints."""
    result = CliRunner().invoke(app, [*words], catch_exceptions=False)
    assert result.exit_code == 0
    return result.stdout


def test_all_are_listed_with_their_grade() -> None:
    listed = said("parts")
    assert all(f"\n{name} " in listed for name in library())
    assert {entry["name"] for entry in json.loads(said("parts", "--json"))["parts"]} == set(library())


def test_words_find_some() -> None:
    listed = said("parts", "harmonic", "drive")
    assert "strain_wave_gear " in listed
    assert "lidar" not in listed
    assert json.loads(said("parts", "GPS receiver", "--json"))["parts"][0]["name"] == "gnss_receiver"


@pytest.mark.parametrize("name", some(library()))
def test_one_in_full_says_all_and_its_yaml_is_a_component(name: str) -> None:
    printed = said("parts", name)
    flat = " ".join(printed.split())
    entry = part(name)
    for text in (entry.title, entry.statement.split()[0], f"grade {entry.grade}", entry.source.split()[-1]):
        assert text in flat
    block = printed.partition(f"{{part: {name}}} is\n")[2]
    copied = "".join(f"    {line}\n" for line in block.splitlines())
    head = "schema_version: 1\nname: R\nusage: {cycles: 1 cycle/h, kilometres: 1 km/h, starts: 1 start/h}\n"
    own = parse(f"{head}components:\n  A:\n{copied}").modes
    theirs = parse(f"{head}components:\n  A: {{part: {name}}}\n").modes
    assert [(one.path, one.rate, one.life, one.uncertainty) for one in own] == [
        (one.path, one.rate, one.life, one.uncertainty) for one in theirs
    ]


def test_where_nothing_fits_it_says_so() -> None:
    with pytest.raises(PlugError, match="no part 'pizza oven' in the library; expected other words: robophm parts"):
        said("parts", "pizza", "oven")


def test_models_point_to_the_library_where_they_know_nothing() -> None:
    with pytest.raises(PlugError) as raised:
        said("models", "cooling fan")
    expected = "no hazard model of 'cooling fan'; the library of parts has fan, fan_long_life, fan_sleeve: "
    assert str(raised.value) == expected + "robophm parts cooling fan"
    with pytest.raises(PlugError) as raised:
        said("models", "pizza")
    assert str(raised.value) == "no hazard model of 'pizza'"


def test_models_are_told_of_beside_the_library() -> None:
    assert "the library of parts has ball_bearing" in said("models", "bearing")


def test_check_says_which_rates_are_the_librarys(tmp_path: Path) -> None:
    design = tmp_path / "robot.yaml"
    parts = "  A: {part: lidar_2d}\n  B: {part: fan, mtbf: 3 kh}\n  C: {rate: 1 FIT}\n"
    design.write_text(f"schema_version: 1\nname: R\ncomponents:\n{parts}")
    result = CliRunner().invoke(app, ["check", str(design)], catch_exceptions=False)
    (note,) = [line for line in result.stderr.splitlines() if "library" in line]
    assert note == f"note: by the library of parts: A (lidar_2d, grade {part('lidar_2d').grade})"
    found = json.loads(said("check", str(design), "--json"))
    assert found["library"] == [{"path": "A", "source": part("lidar_2d").origin}]
