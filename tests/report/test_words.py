from __future__ import annotations

import math

import pytest
from tests.cases import each_case

from robophm.core.errors import UnitError
from robophm.report.words import (
    duration_text,
    failure_text,
    number_text,
    percent_texts,
    probability_text,
    rate_text,
    share_text,
)

INF, NAN = math.inf, math.nan


@each_case(
    ("value", "text"),
    [
        (0, "0"),
        (-0.0, "0"),
        (1, "1"),
        (0.5, "0.5"),
        (1.23456, "1.235"),
        (10250, "10,250"),
        (1234567, "1.235e6"),
        (999_999, "1e6"),
        (0.001, "0.001"),
        (5.8e-6, "5.8e-6"),
        (-0.25, "-0.25"),
        (NAN, "–"),
        (INF, "∞"),
        (-INF, "-∞"),
        (1e300, "1e300"),
        (5e-324, "4.941e-324"),
    ],
)
def test_number(value: float, text: str) -> None:
    assert number_text(value) == text


@each_case(
    ("p", "failure", "text"),
    [
        (1 - 1 / 4700, 1 / 4700, "99.98 % (fails 1 in 4,700)"),
        (1.0, 1e-9, "99.9999999 % (fails 1 in 1,000,000,000)"),
        (1 - 1e-9, None, "99.9999999 % (fails 1 in 1,000,000,000)"),
        (1.0, 2e-13, "> 99.9999999999 % (fails 1 in 5e12)"),
        (1.0, 1e-300, "> 99.9999999999 % (fails 1 in 1e300)"),
        (0.95, None, "95 % (fails 1 in 20)"),
        (0.9995, 5e-4, "99.95 % (fails 1 in 2,000)"),
        (1.0, None, "100 %"),
        (0.5, None, "50 %"),
        (0.0, None, "0 %"),
        (1e-9, None, "1e-7 %"),
        (NAN, None, "–"),
        (1.0, NAN, "–"),
    ],
)
def test_probability(p: float, failure: float | None, text: str) -> None:
    assert probability_text(p, failure) == text


@each_case(
    ("failure", "text"), [(1 / 4700, "1 in 4,700"), (0.05, "1 in 20"), (0.5, "50 %"), (0.0, "0 %"), (1.0, "100 %")]
)
def test_failure(failure: float, text: str) -> None:
    assert failure_text(failure) == text


@each_case(
    ("share", "text"),
    [
        (0.1234, "12.3 %"),
        (1.0, "100 %"),
        (0.0, "0 %"),
        (NAN, "–"),
        (0.99999, "99.999 %"),
        (0.9996, "99.96 %"),
        (1 - 1e-6, "99.9999 %"),
    ],
)
def test_share(share: float, text: str) -> None:
    assert share_text(share) == text


def test_less_than_certain_never_reads_as_certain() -> None:
    for i in range(1, 170):
        failure = 10 ** (-i / 10)
        assert not probability_text(1 - failure, failure).startswith("100")


@each_case(
    ("rate", "unit", "text"),
    [
        (5.8e-6, "1/h", "5.8e-6 /h"),
        (4e-8, "FIT", "40 FIT"),
        (5.8e-6, "FIT", "5,800 FIT"),
        (4e-8, "FPMH", "0.04 FPMH"),
        (0, "1/h", "0 /h"),
        (NAN, "FIT", "–"),
        (INF, "1/h", "∞ /h"),
    ],
)
def test_rate(rate: float, unit: str, text: str) -> None:
    assert rate_text(rate, unit) == text


def test_a_rate_as_one_in_so_many_hours() -> None:
    assert [rate_text(rate, "MTBF") for rate in (5.8e-6, 1.25, 0.0, math.nan)] == [
        "1 in 172,400 h",
        "1 in 0.8 h",
        "0 /h",
        "–",
    ]


def test_unknown_unit_of_rate() -> None:
    with pytest.raises(UnitError, match="did you mean 'FIT'"):
        rate_text(1e-6, "fits")


@each_case(
    ("hours", "text"),
    [
        (1e6 / 3600, "11.6 days"),
        (3.2 * 8766, "3.2 years"),
        (0.75, "45 min"),
        (24, "24 h"),
        (48, "2 days"),
        (30 / 3600, "30 s"),
        (59.999 / 3600, "1 min"),
        (59.999 / 60, "1 h"),
        (47.99, "2 days"),
        (729.99 * 24, "2 years"),
        (0, "0 h"),
        (-0.5, "-30 min"),
        (INF, "∞"),
        (-INF, "-∞"),
        (NAN, "–"),
        (1e9, "114,000 years"),
        (1e-9, "3.6e-6 s"),
    ],
)
def test_duration(hours: float, text: str) -> None:
    assert duration_text(hours) == text


@each_case(
    ("one", "other", "texts"),
    [
        (1 / 7400, 1 / 7900, ("99.986 %", "99.987 %")),
        (1 / 7400, 1 / 7400.1, ("99.9865 %", "99.9865 %")),  # as good as equal
        (0.05, 0.04, ("95 %", "96 %")),
        (0.5, 0.05, ("50 %", "95 %")),
        (0.0, 1e-9, ("100 %", "99.9999999 %")),
    ],
)
def test_two_probabilities_that_differ_read_so(one, other, texts):
    assert percent_texts((1 - one, one), (1 - other, other)) == texts
