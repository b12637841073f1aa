"""The levels of a new robot: what is taken from the robot before an edit is what would be worked out anew."""

import pytest

from robophm.core.yaml_values import values
from robophm.design.build import build
from robophm.design.known_parts import KnownParts
from robophm.design.schema import RobotFile
from robophm.health.levels_when_new import levels_when_new
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant

TEXT = """\
schema_version: 1
name: pair
usage: {operating: 0.5, cycles: 10 cycle/h}
modules:
  one:
    components: {a: {rate: 2e-6 /h}, b: {rate: 3e-6 /h}}
  two:
    components: {c: {rate: 5e-6 /h}, d: {rate: 1e-7 /cycle, clock: cycles}}
  spared:
    diagram: {standby: {of: [e, f]}}
    components: {e: {rate: 1e-5 /h}, f: {rate: 1e-5 /h}}
"""


class Edited:
    """A robot that is edited again and again."""

    def __init__(self):
        self.known, self.levels = KnownParts(), {}

    def to(self, text):
        """The levels after an edit, and the paths of those that were worked out for it."""
        said, _ = values(text, "design")
        robot = build(RobotFile.model_validate(said), said, self.known)
        plant = Plant(robot, {path: one.prepared for path, one in self.levels.items()})
        before, self.levels = self.levels, levels_when_new(as_designed(plant), self.levels)
        return self.levels, {path for path, one in self.levels.items() if one is not before.get(path)}


@pytest.mark.parametrize(
    ("old", "new", "worked_out", "path", "rate"),
    [
        ("2e-6 /h", "7e-6 /h", {"", "one"}, "one", 7e-6 + 3e-6),
        ("operating: 0.5", "operating: 0.6", {"", "one", "two"}, "two", 5e-6 + 1e-7 * 10),
        ("cycles: 10", "cycles: 20", {"", "one", "two"}, "two", 5e-6 + 1e-7 * 20),
        ("  one:\n", "  one:\n    diagram: {parallel: [a, b]}\n", {"", "one"}, "one", 0.0),
        ("  two:\n", "  other:\n", {"", "other"}, "other", 5e-6 + 1e-7 * 10),
    ],
)
def test_a_level_is_worked_out_where_something_is_other_in_it(old, new, worked_out, path, rate):
    edited = Edited()
    edited.to(TEXT)
    levels, anew = edited.to(TEXT.replace(old, new))
    assert anew == worked_out | {"spared"}  # what depends on each other is worked out each time
    assert levels[path].hazard_rate == pytest.approx(rate, rel=1e-12)


def test_a_diagram_is_prepared_once_while_only_rates_change():
    edited = Edited()
    before, _ = edited.to(TEXT)
    after, _ = edited.to(TEXT.replace("2e-6", "4e-6"))
    assert all(after[path].prepared is one.prepared for path, one in before.items())
    moved, _ = edited.to(TEXT.replace("one:", "another:"))
    assert moved[""].prepared is not after[""].prepared
