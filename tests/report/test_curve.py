"""Curves: ranges and ticks with known answers, and the drawn path read back."""

from __future__ import annotations

import re
import time
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from robophm.report.curve import Line, curve_svg, sparkline, tick_texts, ticks


def drawn(*lines: Line, **options: bool) -> str:
    return curve_svg(lines, title="Reliability", x_label="time [h]", y_label="R", **options)


def paths(svg: str) -> list[str]:
    """The lines themselves, without those of the legend."""
    return [p.attrib["d"] for p in ET.fromstring(svg).findall("path") if "line" in p.get("class", "")]


def points(path: str) -> list[tuple[float, float]]:
    return [(float(x), float(y)) for x, y in re.findall(r"[ML](\S+?) ([\d.]+)", path)]


def texts(svg: str, kind: str) -> list[str]:
    return [t.text or "" for t in ET.fromstring(svg).iter("text") if t.get("class") == kind]


@pytest.mark.parametrize(
    ("low", "high", "expected"),
    [
        (0, 1, [0, 0.2, 0.4, 0.6, 0.8, 1]),
        (0, 10, [0, 2, 4, 6, 8, 10]),
        (3, 42, [10, 20, 30, 40]),
        (-1, 1, [-1, -0.5, 0, 0.5, 1]),
        (0.9998, 1, [0.9998, 0.99985, 0.9999, 0.99995, 1]),
        (0, 3e-5, [0, 1e-5, 2e-5, 3e-5]),
        (5, 5, [5]),
    ],
)
def test_ticks(low: float, high: float, expected: list[float]) -> None:
    assert ticks(low, high).tolist() == expected


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ([0, 0.5, 1], (["0.0", "0.5", "1.0"], "")),
        ([0, 1e-5, 2e-5], (["0", "1", "2"], "×10⁻⁵")),
        ([0, 5e-7, 1e-6], (["0.0", "0.5", "1.0"], "×10⁻⁶")),
        ([0.9998, 0.9999, 1], (["0.9998", "0.9999", "1.0000"], "")),
        ([0, 500, 1000], (["0", "500", "1000"], "")),
        ([0, 100_000], (["0", "1"], "×10⁵")),
        ([], ([], "")),
    ],
)
def test_tick_texts(values: list[float], expected: tuple[list[str], str]) -> None:
    assert tick_texts(values) == expected


def test_line_goes_where_the_data_are() -> None:
    (path,) = paths(drawn(Line("R", [0, 1, 2], [1.0, 0.5, 0.0])))
    (x0, y0), (x1, y1), (x2, y2) = points(path)
    assert x1 - x0 == pytest.approx(x2 - x1, abs=0.11)
    assert y1 - y0 == pytest.approx(y2 - y1, abs=0.11)
    assert y0 < y1  # up is up


def test_near_one_fills_the_plot() -> None:
    t = np.linspace(0, 100, 50)
    svg = drawn(Line("R", t, np.exp(-1e-6 * t)))
    heights = [y for _, y in points(paths(svg)[0])]
    assert max(heights) - min(heights) > 0.8 * 190
    assert "1.00000" in texts(svg, "right")


def test_one_minus_is_logarithmic() -> None:
    svg = drawn(Line("R", [1, 2, 3], [0.9, 0.99, 0.999]), one_minus=True)
    (_, y0), (_, y1), (_, y2) = points(paths(svg)[0])
    assert y1 - y0 == pytest.approx(y2 - y1, abs=0.11)
    assert {"10⁻³", "10⁻²", "10⁻¹"} <= set(texts(svg, "right"))
    assert "1 − R" in svg


def test_log_leaves_out_what_is_not_positive() -> None:
    assert len(points(paths(drawn(Line("F", [0, 1, 2, 3], [0, -1, 1e-5, 1e-4]), log_y=True))[0])) == 2


def test_gaps() -> None:
    nan, inf = np.nan, np.inf
    (path,) = paths(drawn(Line("R", range(8), [1, 2, nan, 4, inf, 6, 7, nan])))
    assert path.count("M") == 3
    assert path.count("h0") == 1  # the point alone
    assert len(points(path)) == 5


@pytest.mark.parametrize("lines", [[], [Line("R", [], [])], [Line("R", [1.0, 2.0], [np.nan, np.inf])]])
def test_nothing_to_draw_says_so(lines: list[Line]) -> None:
    assert "no data" in texts(drawn(*lines), "middle")


@pytest.mark.parametrize("y", [0.0, 1.0, -3.0, 1e-9, 1e300])
def test_constant_runs_through_the_middle(y: float) -> None:
    heights = {at for _, at in points(paths(drawn(Line("R", [0, 1], [y, y])))[0])}
    assert heights == {(48 + 240) / 2}


def test_nominal_is_solid_and_sensor_based_dashed() -> None:
    svg = drawn(Line("nominal", [0, 1], [1, 2]), Line("sensor-based", [0, 1], [1, 3], dashed=True))
    assert svg.count('class="line c0"') == 2  # the line and its legend
    assert svg.count('class="line c1 dashed"') == 2
    assert texts(svg, "legend") == ["nominal", "sensor-based"]


def test_legend_stands_where_the_lines_are_not() -> None:
    t = np.linspace(0, 1, 100)
    falling, rising = (ET.fromstring(drawn(Line("a", t, y), Line("b", t, y))).find("g/rect") for y in (1 - t, t))
    assert falling is not None
    assert rising is not None
    assert float(falling.attrib["x"]) > 230 > float(rising.attrib["x"])


def test_long_series_is_thinned_and_keeps_its_extremes() -> None:
    y = np.zeros(1_000_000)
    y[123_456], y[654_321] = 1, -1
    y[400_000:500_000] = np.nan
    start = time.process_time()
    (path,) = paths(drawn(Line("R", np.arange(y.size), y)))
    assert time.process_time() - start < 1
    assert len(points(path)) <= 2 * 460
    assert path.count("M") == 2
    heights = [at for _, at in points(path)]
    assert (min(heights), max(heights)) == pytest.approx((58.3, 229.7), abs=0.2)  # 6 % of the range from 48 and 240


def test_names_are_escaped() -> None:
    svg = curve_svg([Line("<b>", [0], [1]), Line("&", [0], [1])], title="<script>", x_label="<i>", y_label="<u>")
    ET.fromstring(svg)
    assert not {"<b>", "<script>", "<i>", "<u>"} & set(re.findall("<[a-z]+>", svg))


def test_shapes_must_agree() -> None:
    with pytest.raises(ValueError, match="line 'R'"):
        drawn(Line("R", [1, 2], [1]))


@pytest.mark.parametrize(
    ("values", "width", "expected"),
    [
        (range(8), 20, "▁▂▃▄▅▆▇█"),
        ([7, 0, 3], 20, "█▁▄"),
        ([5, 5, 5], 20, "▄▄▄"),
        ([0, np.nan, 7, np.inf], 20, "▁ █ "),
        ([0, 0, 7, 7], 2, "▁█"),
        ([0, np.nan, 7, 7], 2, "▁█"),
        ([], 20, ""),
        ([np.nan], 20, " "),
        ([1, 2], 0, ""),
    ],
)
def test_sparkline(values: list[float], width: int, expected: str) -> None:
    assert sparkline(values, width) == expected
