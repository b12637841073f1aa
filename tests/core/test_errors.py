"""The text of every error is one line, whatever the names in it hold."""

import inspect
import re
import time
from difflib import SequenceMatcher

import pytest

from robophm.core import errors
from robophm.core.errors import RobophmError, nearest

KINDS = [kind for name, kind in inspect.getmembers(errors, inspect.isclass) if name.endswith("Error")]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("text", ["a\nb", "a\r\nb", "a\x1b\x00b", "a\u2028b", "a\x9b\x85b"])
def test_one_line_without_terminal_codes(kind, text):
    assert str(kind(text)) == "a b"


def test_a_megabyte_is_not_repeated_but_both_ends_are_kept():
    text = str(RobophmError("file: " + "x" * 1_000_000 + " expected y"))
    assert len(text) < 1100
    assert text.startswith("file: x")
    assert text.endswith(" expected y")


def test_the_tree_in_the_docstring_is_the_tree():
    assert all(issubclass(kind, RobophmError) and kind.__name__ in errors.__doc__ for kind in KINDS)


def test_nearest():
    assert nearest("tresholds", ["thresholds", "task"]) == "; did you mean 'thresholds'?"
    assert nearest("GMM", ["gm", "GB"]) == "; did you mean 'gm'?"
    assert nearest("x", ["b", "a"]) == "; known: a, b"
    assert nearest("x", []) == ""
    assert nearest("motor_3", ["motor_1", "motor_2"]) == "; known: motor_1, motor_2"  # another one, no slip
    assert nearest("power rectifer", ["power_rectifier", "Power-Rectifier"]) == "; did you mean 'power_rectifier'?"


def test_a_word_of_a_name_may_be_what_is_meant():
    assert nearest("lidr", ["lidar_2d", "camera", "lidar_3d"]) == "; did you mean 'lidar_2d' or 'lidar_3d'?"
    assert nearest("an", ["fan_axial", "heater"]) == "; known: fan_axial, heater"


@pytest.mark.parametrize(
    ("said", "meant"),
    [
        ("capaciter", "mil_hdbk_217f.capacitor"), ("batery", "Power/Battery"), ("mil_217f.capacitor",
         "mil_hdbk_217f.capacitor"), ("temprature", "temperature"), ("motro", "motor"), ("switching", "switch"),
        ("FITT", "FIT"), ("stile", "style"), ("tpo", "top"), ("bta", "beta"), ("pmp", "pump"), ("fits", "FIT"),
        ("efort[0]", "effort[]"), ("rack panle", "rack-panel"),
    ],
)  # fmt: skip
def test_a_slip_of_the_hand_is_understood(said, meant):
    assert nearest(said, [meant, "quite another"]) == f"; did you mean '{meant}'?"


@pytest.mark.parametrize(
    ("said", "other"),
    [
        ("lidar", "linear"), ("fan", "an"), ("belt", "bolt"), ("lamp", "clamp"), ("gear", "ear"), ("coil", "coin"),
        ("converter", "inverter"), ("encoder", "decoder"), ("camera", "cam"), ("nut", "unit"),
        ("resistor", "transistor"), ("arm", "alarm"), ("pump", "lamp"), ("sensor", "servo"), ("rotor", "motor"),
        ("winch", "switch"), ("disc", "discrete"),
        ("lead", "led"), ("slip", "sip"),
    ],
)  # fmt: skip
def test_two_words_of_robots_are_not_taken_for_each_other(said, other):
    assert nearest(said, [other]) == f"; known: {other}"


def test_of_many_names_the_likest_are_listed():
    """Always a hint or a list, and never more of it than can be read."""
    assert nearest("qq", map(str, range(13))) == "; known: " + ", ".join(sorted(map(str, range(13))))
    many = nearest("Kitchen", (f"/topic/{n}" for n in range(5000)))
    assert re.match(r"; 30 of 5000 known: /topic/\d+, ", many)
    assert len(many) < 600
    assert nearest("Kitchen", ["Kitschen sink", *"abcdefghijklmnop" * 3, *("x" * 500 for _ in range(3))]).startswith(
        "; "
    )


@pytest.mark.full
def test_a_hint_out_of_many_names_does_not_keep_anyone_waiting():
    """Also where all are equally near: 30,000 modules with a motor each."""
    began = time.process_time()
    said = nearest("gearbox/motr", [f"module {i}/motor" for i in range(30_000)])
    assert "of 30000 known" in said
    assert time.process_time() - began < 5


def test_what_is_listed_has_most_letters_in_common():
    """As Python's own difflib ranks it."""
    known = [f"m{i % 10}ot{i}" for i in range(2000)]
    some = re.search("of 2000 known: (.*)", nearest("m7/otor", known))[1].split(", ")
    ranked = sorted(sorted(known), key=lambda one: -SequenceMatcher(None, "m7/otor", one).quick_ratio())
    assert some == sorted(ranked[: len(some)])
