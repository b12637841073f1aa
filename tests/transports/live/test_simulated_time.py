"""The time of /clock against what its words say: as told where it follows on the past, else by its differences."""

from __future__ import annotations

from robophm.core.signal import SECOND
from robophm.health.clock_jumps import CLOCK_JUMP
from robophm.transports.live.simulated_time import ANEW, SimulatedTime


class Watch:
    """A clock that nobody sets, in seconds."""

    def __init__(self) -> None:
        self.at = 0.0

    def __call__(self) -> float:
        return self.at


def simulated(known_to: int | None) -> tuple[SimulatedTime, Watch, list[str]]:
    steady, notes = Watch(), list[str]()
    return SimulatedTime(lambda: known_to, notes.append, steady=steady), steady, notes


def test_without_a_past_it_is_as_told() -> None:
    clock, _, notes = simulated(None)
    assert clock.now == 0
    for said in (5, 6, 6, 60):
        clock.hear(said * SECOND)
        assert clock.now == said * SECOND
    assert notes == []


def test_after_a_past_that_it_follows_it_is_as_told() -> None:
    clock, _, notes = simulated(100 * SECOND)
    clock.hear(160 * SECOND)
    assert (clock.now, clock.offset, notes) == (160 * SECOND, 0, [])


def test_a_second_run_goes_on_from_the_first() -> None:
    clock, _, notes = simulated(1000 * SECOND)
    clock.hear(3 * SECOND)
    clock.hear(83 * SECOND)
    assert clock.now == 1080 * SECOND + 1
    assert len(notes) == 1


def test_a_time_far_ahead_of_the_past_does_not_count_as_rest() -> None:
    clock, _, _ = simulated(1000 * SECOND)
    clock.hear(1000 * SECOND + CLOCK_JUMP + 1)
    assert clock.now == 1000 * SECOND + 1


def test_a_simulator_that_begins_anew_is_followed_when_it_has_gone_on_so_for_a_second() -> None:
    clock, steady, notes = simulated(None)
    clock.hear(100 * SECOND)
    for said in (1, 2):
        clock.hear(said * SECOND)
        assert clock.now == 100 * SECOND
    steady.at += ANEW
    clock.hear(3 * SECOND)
    assert clock.now == 100 * SECOND
    clock.hear(13 * SECOND)
    assert clock.now == 110 * SECOND
    assert len(notes) == 2


def test_of_two_simulators_the_one_is_followed() -> None:
    clock, steady, notes = simulated(None)
    for step in range(10_000):
        for ahead in (500, 20):
            clock.hear(ahead * SECOND + step * SECOND // 100)
            steady.at += 0.005
        assert clock.now == 500 * SECOND + step * SECOND // 100
    assert len({*notes}) == 1
