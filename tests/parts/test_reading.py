"""Whatever is wrong with a file of the library: one line with file, line, place, and what was expected."""

import re
import subprocess
import sys

import pytest

from robophm.core.errors import DesignError, PlugError
from robophm.parts import library, part
from robophm.parts.entries import read_entries

GOOD = """\
# Things.
test_part:
  title: A part
  words: [part, "608"]
  grade: A
  statement: 3 h.
  source: A maker
  part:
    mtbf: 3 h
"""


def read(text):
    return list(read_entries(text, "things.yaml", "things"))


def test_an_entry_is_what_it_says():
    (entry,) = read(GOOD)
    assert (entry.name, entry.kind, entry.words, entry.reasoning) == ("test_part", "things", ("part", "608"), "")
    assert entry.part == {"mtbf": "3 h"}
    assert entry.origin == "library: test_part, grade A: A maker"


FAULTS = {
    "no YAML": ("a: [", "things.yaml:1: is not YAML"),
    "empty": ("# nothing\n", "things.yaml:1: expected keys with values, not None"),
    "a list": ("- a\n", "things.yaml:1: expected keys with values, not ['a']"),
    "name": (GOOD.replace("test_part:", "Test Part:"), "things.yaml:2: Test Part: is no name of an entry"),
    "key": (
        GOOD.replace("title", "titel"),
        ":3: test_part/titel: unknown key 'titel'; did you mean 'title'?",
    ),
    "missing": (GOOD.replace("  source: A maker\n", ""), "things.yaml:2: test_part: needs 'source'"),
    "grade": (GOOD.replace("grade: A", "grade: D"), "things.yaml:5: test_part/grade: 'D'; expected one of A, B, C"),
    "estimate": (GOOD.replace("grade: A", "grade: C"), "things.yaml:2: test_part: needs 'reasoning'"),
    "number": (GOOD.replace('"608"', "608"), "things.yaml:4: test_part/words/1: 608; expected text, in quotes where"),
    "no words": (GOOD.replace('[part, "608"]', "part"), "things.yaml:4: test_part/words: expected a list"),
    "no text": (GOOD.replace("A maker", "''"), "things.yaml:7: test_part/source: ''; expected text"),
    "key of part": (
        GOOD.replace("mtbf: 3 h", "clok: x"),
        ":9: test_part/part/clok: unknown key 'clok'; did you mean",
    ),
    "no figure": (GOOD.replace("mtbf: 3 h", "life: {}"), "things.yaml:8: test_part/part: expected exactly one of rate"),
    "two": (GOOD.replace("mtbf: 3 h", "{mtbf: 3 h, rate: 1 FIT}"), "things.yaml:8: test_part/part: expected exactly"),
    "of a robot": (GOOD.replace("mtbf: 3 h", "{mtbf: 3 h, quantity: 2}"), "test_part/part/quantity: unknown key"),
    "beside modes": (
        GOOD.replace("mtbf: 3 h", "{failure_modes: {a: {rate: 1 FIT}}, clock: calendar}"),
        "test_part/part/clock: unknown key 'clock'",
    ),
    "of a mode": (
        GOOD.replace("mtbf: 3 h", "{failure_modes: {a: {life: {}}}}"),
        "test_part/part/failure_modes/a: expected exactly one of",
    ),
    "twice": (GOOD + GOOD, "duplicate name 'test_part'"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_what_is_wrong_is_said_with_its_line(name):
    text, said = FAULTS[name]
    with pytest.raises(DesignError, match=re.escape(said)) as raised:
        read(text)
    assert "\n" not in str(raised.value)


def test_a_name_that_is_none_is_told_with_the_nearest():
    some = next(iter(library()))
    assert part(some) is library()[some]
    with pytest.raises(PlugError, match="no part 'bal_bearing' in the library; did you mean 'ball_bearing'"):
        part("bal_bearing")
    with pytest.raises(PlugError, match="no part 'lidar' in the library; expected one of lidar_2d, lidar_"):
        part("lidar")
    with pytest.raises(PlugError, match="no part 'pizza' in the library; `robophm parts` lists all"):
        part("pizza")
    with pytest.raises(PlugError, match="no part '3' in the library"):
        part(3)


@pytest.fixture
def other(tmp_path):
    """Runs a program where another package is installed that brings entries of its own."""

    def run(text, code, value="others.parts"):
        folder = tmp_path / "others" / "parts"
        folder.mkdir(parents=True, exist_ok=True)
        for init in (folder, folder.parent):
            (init / "__init__.py").write_text("")
        (folder / "things.yaml").write_text(text)
        info = tmp_path / "others-1.0.dist-info"
        info.mkdir(exist_ok=True)
        (info / "METADATA").write_text("Metadata-Version: 2.1\nName: others\nVersion: 1.0\n")
        (info / "entry_points.txt").write_text(f"[robophm.parts]\nothers = {value}\n")
        program = f"import sys; sys.path.insert(0, {str(tmp_path)!r})\n{code}"
        return subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)

    return run


CODE = """
from robophm.parts import library, part, search
from robophm.design.file import parse
(mode,) = parse("schema_version: 1\\nname: R\\ncomponents: {A: {part: test_part}}").modes
print(1 / mode.rate, part("test_part").kind, [entry.name for entry in search("bespoke parts")], len(library()))
"""


def test_another_package_brings_entries_of_its_own(other):
    done = other(GOOD.replace("[part,", "[bespoke part,"), CODE)
    assert done.stdout.split(" ", 3) == ["3.0", "things", "['test_part']", f"{len(library()) + 1}\n"], done.stderr


@pytest.mark.full
@pytest.mark.parametrize(
    ("text", "value", "said"),
    [
        (GOOD.replace("test_part:", "ball_bearing:"), "others.parts", "'ball_bearing' is in .*bearings.yaml too"),
        (GOOD.replace("grade: A", "grade: 1"), "others.parts", "things.yaml:5: test_part/grade: 1; expected text"),
        (GOOD, "nobody.parts", r"A/part: parts of 'others' \(nobody.parts\) cannot be had: No module named"),
    ],
)
def test_what_is_wrong_with_anothers_entries_is_said(other, text, value, said):
    done = other(text, CODE, value)
    assert re.search(said, done.stderr), done.stderr
