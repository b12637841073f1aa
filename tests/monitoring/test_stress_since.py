"""Since when a stress has been beyond its design value, beside plain loops over all means that were kept."""

from __future__ import annotations

import itertools
import random

import pytest

from robophm.health.why import DecidingPart, Explanation, ObservedStress, Since
from robophm.monitoring.stress_since import with_since
from robophm.report.why import reasons
from robophm.stores import open_store

SECOND = 10**9
MINUTE, DAY = 60 * SECOND, 86_400 * SECOND
BEGIN = 1_700_006_400 * SECOND


def asked(value: float, designed: float = 25.0, signal: str = "/t.x") -> Explanation:
    stress = ObservedStress("temperature", signal, "degC", value, designed, designed, value > designed)
    part = DecidingPart("motor", 1, 1.0, 2.0, (stress,), silent=False, wear=(), relieved=None)
    return Explanation(0.9, 1.0, 1.0, 1.0, 1.0, (part,))


def told(values: dict[int, float], value: float, now: int) -> Since | None:
    """What is said of a stress whose signal had these values in the reports of these times."""
    with open_store("memory:") as store:
        reports = [{"time": time, "subjects": [], "signals": {"/t.x": one}} for time, one in values.items()]
        for first in range(0, len(reports), 5000):
            store.save("R", {}, (), reports[first : first + 5000])
        return with_since(asked(value), store.history("R"), now).parts[0].stresses[0].since


def expected(values: dict[int, float], *, higher: bool) -> Since:
    """The same by a plain loop."""
    after, since = None, None
    for time, one in values.items():
        if one > 25 if higher else one < 25:
            since = time if since is None else since
        else:
            after, since = time, None
    return Since(since, after)


@pytest.mark.parametrize("seed", range(6))
def test_it_is_the_first_of_the_means_since_which_all_were_beyond(seed: int) -> None:
    draw, higher = random.Random(seed), seed % 2 == 0
    step, count = draw.choice([MINUTE, 10 * MINUTE]), draw.randrange(2, 1500)
    values = {BEGIN + i * step: draw.gauss(25, 3) for i in range(count)}
    for time in itertools.islice(values, draw.randrange(count - 1), None):
        values[time] = 25 + abs(values[time] - 25) * (1 if higher else -1)
    last = max(values)
    assert told(values, 30.0 if higher else 20.0, last) == expected(values, higher=higher)


def test_what_a_history_cannot_tell_is_said() -> None:
    values = {BEGIN + i * MINUTE: 30.0 for i in range(1500)}
    assert told(values, 30.0, max(values)) == Since(BEGIN)
    cold = dict.fromkeys(values, 20.0)
    assert told(cold, 30.0, max(values) + 7) == Since(max(values) + 7, max(values))  # since its last report
    assert told({}, 30.0, BEGIN) == Since(None)
    assert with_since(asked(30.0), None, BEGIN).parts[0].stresses[0].since == Since(None)
    assert with_since(asked(25.0), None, BEGIN).parts[0].stresses[0].since is None  # it is as designed


def test_of_long_ago_the_hour_is_said() -> None:
    """Two years ago it went beyond, at 2:30 of a day; of then the lowest of each hour is kept."""
    values = {BEGIN + i * 10 * MINUTE: 30.0 for i in range(40 * 144)}
    values |= {BEGIN + i * DAY: 30.0 for i in range(40, 730)}
    crossed = BEGIN - BEGIN % DAY + 20 * DAY + 150 * MINUTE
    values |= dict.fromkeys([time for time in values if time < crossed], 20.0)
    assert told(values, 30.0, max(values)) == Since(crossed + 30 * MINUTE, crossed - 30 * MINUTE)


def test_it_is_said_in_words() -> None:
    stress = asked(30.0).parts[0].stresses[0]
    for since, words in (
        (
            Since(BEGIN, BEGIN - 60 * SECOND),
            "above that since 2023-11-15 00:00:00 UTC, not yet at 2023-11-14 23:59:00 UTC",
        ),
        (Since(BEGIN), "above that since 2023-11-15 00:00:00 UTC at least, the first time that is kept"),
        (Since(None), "since when is not known"),
    ):
        said = type(stress)(*(getattr(stress, name) for name in list(vars(stress))[:-1]), since=since)
        part = DecidingPart("motor", 1, 1.0, 2.0, (said,), silent=False, wear=(), relieved=None)
        line = list(reasons(Explanation(0.9, 1.0, 1.0, 1.0, 1.0, (part,))))[1]
        assert line == f"  temperature 30 °C, designed for 25 °C (/t.x); {words}"
