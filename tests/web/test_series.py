"""Silences as the service states them."""

import math

from robophm.core.signal import CLOCK, SECOND, Sample
from robophm.web import series
from robophm.web.series import MOST_GAPS, Board


def board_of(*heard, max_age=5, max_gap=60):
    board = Board({"/t.x": max_age * SECOND, "/t.y": max_age * SECOND}, max_gap * SECOND)
    for time, signal, value in heard:
        board.hear(Sample(time * SECOND, signal, value))
    return board


def test_a_silence_begins_when_the_last_value_no_longer_holds_and_ends_with_the_next():
    board = board_of((0, "/t.x", 1.0), (4, "/t.x", 1.0), (9, "/t.x", 1.0), (20, "/t.x", 1.0), (21, "/t.y", 2.0))
    assert board.gaps("/t.x") == [(14.0, 20.0)]
    assert board.gaps("/t.y") == []


def test_a_silence_of_now_has_no_end_and_is_heard_by_other_signals_and_by_clocks():
    board = board_of((0, "/t.x", 1.0), (4, "/t.y", 1.0))
    assert board.gaps("/t.x") == []
    board.hear(Sample(6 * SECOND, "/t.y", 1.0))
    assert board.gaps("/t.x") == [(5.0, None)]
    board.hear(Sample(30 * SECOND, CLOCK, 0.0))
    assert board.gaps("/t.y") == [(11.0, None)]
    board.hear(Sample(31 * SECOND, "/t.x", 1.0))
    assert board.gaps("/t.x") == [(5.0, 31.0)]


def test_what_is_no_number_ends_no_silence():
    board = board_of((0, "/t.x", 1.0), (8, "/t.x", math.nan), (9, "/t.x", 1.0))
    assert board.gaps("/t.x") == [(5.0, 9.0)]


def test_figures_stop_where_the_robot_was_off():
    night = 8 * 3600
    board = board_of((0, "/t.x", 1.0), (50, "/t.y", 1.0), (night, "/t.x", 1.0))
    assert board.gaps("reliability.nominal:") == [(110.0, float(night))]


def test_silences_are_kept_in_bounded_number():
    board = board_of(*((10 * i, "/t.x", 1.0) for i in range(3 * MOST_GAPS)))
    gaps = board.gaps("/t.x")
    assert len(gaps) == MOST_GAPS
    assert gaps[-1] == (10.0 * (3 * MOST_GAPS - 2) + 5, 10.0 * (3 * MOST_GAPS - 1))


def test_a_series_keeps_the_latest_points_as_far_as_all_together_have_room(monkeypatch):
    """Beside plain lists: one series comes first to its end, and two more grow beside each other in what is left."""
    monkeypatch.setattr(series, "FIRST", 4)
    monkeypatch.setattr(series, "KEPT", 32)
    monkeypatch.setattr(series, "KEPT_IN_ALL", 28 + 8)
    board, said = Board(), {}
    for i in range(100):
        for name in ("first", "second", "third") if i >= 32 else ("first",):
            board.add(name, i * SECOND, float(i))
            said.setdefault(name, []).append(float(i))
            found = board.get(name)
            assert board.last([name]) == {name: (float(i), float(i))}
            times, values = found.since(0)
            assert [*times] == [*values] == said[name][-len(values) :]
            assert len(values) == found.count if found.count <= found.kept else len(values) >= found.kept * 15 // 16
            assert [*found.since(max(0, found.count - 2)).values] == said[name][-2:]
    assert [board.get(name).kept for name in said] == [32, 8, 8]
