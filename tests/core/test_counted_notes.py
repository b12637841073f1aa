"""What was noted, and how often, in words: nothing is told a thousand times, and no signal is left out."""

from robophm.core.counted_notes import said


def test_how_often_is_told_where_it_is_more_than_once() -> None:
    assert said({"a jump": 1, "receipt time used for /t": 1234}) == [
        "a jump",
        "receipt time used for /t (1,234 times)",
    ]
    assert said({"a jump": 1}, "drive.bag") == ["drive.bag: a jump"]
    assert said({}) == []


def test_a_thousand_files_are_one_line() -> None:
    notes = {f"drive_{n}.mcap: {n * 7:,} bytes of a file that is cut at byte {n} lost": 1 for n in range(1000)}
    notes |= {f"lost: /bags/other_{n}.db3 is not there": 1 for n in range(3)}
    (first, *others) = said(notes)
    assert first == "drive_0.mcap: 0 bytes of a file that is cut at byte 0 lost (and 999 more like it)"
    assert others == [f"lost: /bags/other_{n}.db3 is not there" for n in range(3)]


def test_signals_that_differ_in_a_number_are_all_told() -> None:
    notes = {f"no element for /joints.effort[{n}]": 2 for n in range(7)}
    assert said(notes) == [f"no element for /joints.effort[{n}] (2 times)" for n in range(7)]
