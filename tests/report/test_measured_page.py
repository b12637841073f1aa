"""The page of what was measured: gaps stay gaps, names are text, all of it is in one file."""

import math
import re
from collections import Counter

import numpy as np

from robophm.core.signal import SECOND
from robophm.measured.held_values import HeldValues
from robophm.measured.recordings import Signal
from robophm.measured.statistics import Look, Seen
from robophm.report.measured_page import statistics_page

START = 1_700_000_000 * SECOND


def seen(times, values, name="/motor/temperature.temperature"):
    look = Look.new(20)
    times, values = START + np.array(times) * SECOND, np.array(values, dtype=float)
    after = np.append(times[1:], times[-1])
    look.add(HeldValues(times, values, np.minimum(times + 5 * SECOND, after), after, np.append(values[1:], values[-1])))
    look.levels.finish()
    return Seen("day.mcap", Signal(name, *name.rsplit(".", 1), "degC"), look)


def course(page):
    (path,) = re.findall(r'<path class="line c0" d="([^"]*)"', page)
    return path


def test_nothing_is_drawn_where_nothing_is_known():
    at = [*range(3600), *range(30_000, 33_600)]
    page = statistics_page([seen(at, [20 + math.sin(t / 100) for t in at])], 5 * SECOND, [])
    assert course(page).count("M") == 2


def test_a_drive_without_a_gap_is_one_line_from_lowest_to_highest():
    at = list(range(20_000))
    values = [20 + 5 * math.sin(t / 900) for t in at]
    values[12_345] = 80.0  # one sample of twenty thousand is still seen
    one = seen(at, values)
    _, lowest, highest = one.look.series.columns
    assert (lowest.min(), highest.max()) == (min(values), 80.0)
    page = statistics_page([one], 5 * SECOND, [])
    assert course(page).count("M") == 1
    heights = [float(y) for y in re.findall(r"[ML][\d.]+ ([\d.]+)", course(page))]
    assert min(heights) < 80 < sorted(heights)[len(heights) // 2]


def test_names_are_text_and_nothing_is_loaded():
    page = statistics_page([seen(range(9), range(9), "/<script>alert(1)</script>.x")], 5 * SECOND, ["<b>note</b>"])
    assert "<script>" not in page
    assert "<b>" not in page
    assert not re.search(r'(src|href)="', page)
    assert Counter(re.findall(r"<(svg|h1)", page)) == {"svg": 2, "h1": 1}
