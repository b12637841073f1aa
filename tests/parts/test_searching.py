"""What people type finds the part that they mean, in any spelling; what is no part finds nothing."""

import time

import pytest

from robophm.parts import library, search
from robophm.parts.entries import Entry


def names(words):
    return [entry.name for entry in search(words)]


@pytest.mark.parametrize(
    ("words", "name"),
    [
        ("harmonic drive", "strain_wave_gear"), ("Harmonic-Drives", "strain_wave_gear"),
        ("harmonik drive", "strain_wave_gear"),
        ("GPS receiver", "gnss_receiver"), ("gps recievers", "gnss_receiver"), ("ESC", "esc"), ("escs", "esc"),
        ("LiPo battery", "battery_lipo"), ("li-po batteries", "battery_lipo"), ("Li Po Battery", "battery_lipo"),
        ("ball bearing", "ball_bearing"), ("BALL_BEARINGS", "ball_bearing"), ("ballbearing", "ball_bearing"),
        ("ball bearing 608", "ball_bearing"), ("cooling fans", "fan"), ("coling fan", "fan"),
        ("e-stop", "emergency_stop"), ("estop", "emergency_stop"), ("a fan for the motor", "fan"),
        ("lidar sensor", "lidar_2d"),
    ],
)  # fmt: skip
def test_what_people_type_finds_what_they_mean(words, name):
    assert names(words)[0] == name


@pytest.mark.parametrize(
    "words",
    ["", " ", "a", "an", "the", "-", "pizza", "coffee machine", "flux capacitor", "case", "zzzz", "1", "\0", "of"],
)
def test_what_is_no_part_finds_nothing(words):
    assert names(words) == []


def test_a_kind_is_not_found_by_what_it_is_for():
    """A wheel bearing is no wheel, though a bearing may be called so."""
    assert "ball_bearing" in names("wheel bearing")
    assert "ball_bearing" not in names("wheel")


def test_who_says_all_that_is_asked_goes_before_who_says_some():
    both = names("lidar")
    assert both[0] == "lidar_2d"
    assert "lidar_3d" in both
    assert names("3d lidar")[0] == "lidar_3d"
    assert "lidar_2d" not in names("3d lidar")


def test_whatever_the_words_it_ends_soon_and_gives_entries():
    begun = time.monotonic()
    for words in ("x" * 5000, "lidar " * 2000, "ü ß ﬁ Ⅷ 電池", "%s{}[](*+?"):
        assert all(isinstance(entry, Entry) for entry in search(words))
    assert time.monotonic() - begun < 20


@pytest.mark.full
def test_one_slip_in_a_long_word_is_forgiven_wherever_it_is():
    """Each letter but the first of the first words of the library, left out, finds the entry still."""
    said = " ".join(f"{entry.title} {' '.join(entry.words)}".casefold() for entry in library().values())
    long = [entry for entry in library().values() if len(entry.words[0]) > 7 and entry.words[0].isalpha()]
    assert long
    for entry in long:
        word = entry.words[0]
        for i in range(1, len(word)):
            slipped = word[:i] + word[i + 1 :]
            assert slipped in said or entry in search(slipped)  # what is left may be another word


def plural(word):
    """More than one of a thing, as English has it."""
    if word.endswith("y") and word[-2] not in "aeiou":
        return word[:-1] + "ies"
    return word + ("es" if word.endswith(("s", "x", "z", "ch", "sh")) else "s")


def test_more_than_one_of_a_thing_is_found_as_one_is():
    """Fuses, hoses, buses, lenses, switches, batteries: the plural of each entry's first words finds it first too."""
    first = {entry.words[0]: name for name, entry in library().items() if entry.words[0].isascii()}
    missed = {plural(word) for word, name in first.items() if names(plural(word))[:1] != [name]}
    assert not missed - {"gpus", "cans"}


@pytest.mark.parametrize(
    ("words", "name"),
    [
        ("motor with encoder", "bldc_motor"), ("camera with microphone", "camera"),
        ("cable for lidar", "drag_chain_cable"),
        ("wheel with motor", "drive_wheel"), ("zzyzx with fuse", "fuse"),
    ],
)  # fmt: skip
def test_what_a_thing_has_or_is_for_is_another_thing(words, name):
    """But where nobody knows what is in front, what stands behind is found."""
    assert names(words)[:1] == [name]
