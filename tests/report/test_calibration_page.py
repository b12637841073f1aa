"""The page about predictions: whole, escaped, without script; marks lie where the numbers say."""

import re
from html.parser import HTMLParser

import numpy as np
import pytest

from robophm.calibration.predictions import LEVELS, Lives, Predictions, Tasks
from robophm.calibration.score import score
from robophm.report.calibration_page import calibration_page
from robophm.report.calibration_svg import histogram_svg, reliability_svg

NAME = "<script>alert(1)</script> & co"


@pytest.fixture(scope="module")
def calibration():
    rng = np.random.default_rng(41)
    failure = np.exp(rng.normal(-4, 1, 8000)).clip(max=0.3)
    failed = rng.random(8000) < failure
    life = rng.exponential(100, 300)
    lives = Lives(np.arange(300), np.zeros(300), np.tile(-100 * np.log1p(-np.array(LEVELS)), (300, 1)),
                  -np.expm1(-life / 100), life, np.zeros(300, bool))  # fmt: skip
    tasks = {NAME: Tasks(failure, 1 - failure, failed), "thrice": Tasks(3 * failure, 1 - 3 * failure, failed)}
    return score(Predictions(tasks, {NAME: lives}))


class Page(HTMLParser):
    def __init__(self):
        super().__init__()
        self.tags, self.fetches, self.text, self.open = set(), [], "", []

    def handle_starttag(self, tag, attrs):
        self.tags.add(tag)
        self.fetches += [value for name, value in attrs if name in ("src", "href", "srcset", "action")]
        if tag not in {"meta", "path", "rect", "circle"}:
            self.open.append(tag)

    def handle_endtag(self, tag):
        if tag not in {"meta", "path", "rect", "circle"}:
            assert self.open.pop() == tag

    def handle_data(self, data):
        self.text += data


def test_it_is_whole_and_harmless(calibration):
    html = calibration_page(calibration, "<b>.csv")
    page = Page()
    page.feed(html)
    assert not page.open
    assert not page.fetches
    assert "script" not in page.tags
    assert NAME in page.text
    assert "Predictions in <b>.csv" in page.text
    assert html == calibration_page(calibration, "<b>.csv")


def test_it_says_what_the_scores_say(calibration):
    page = Page()
    page.feed(calibration_page(calibration, "p.csv"))
    for model in calibration.models:
        for verdict in (model.task_verdict, model.life_verdict):
            assert verdict is None or str(verdict) in page.text
    assert "Coverage of the predicted intervals" in page.text
    assert f"{calibration.models[0].tasks.failed:,}" in page.text


def marks(drawing, kind):
    return [tuple(map(float, found)) for found in re.findall(rf'class="{kind}" cx="([\d.]+)" cy="([\d.]+)"', drawing)]


def line_of_honesty(drawing):
    x0, y0, x1, y1 = map(float, re.search(r'class="honest" d="M([\d.]+) ([\d.]+)L([\d.]+) ([\d.]+)"', drawing).groups())
    return lambda x: y0 + (x - x0) / (x1 - x0) * (y1 - y0)


def test_an_honest_bin_lies_in_its_band_and_a_wrong_one_is_a_diamond(calibration):
    honest, thrice = (reliability_svg(model.tasks.bins, title="t") for model in calibration.models)
    assert len(marks(honest, "inside")) == len(calibration.models[0].tasks.bins)
    assert 'class="outside" d="M' not in honest
    assert thrice.count('class="outside" d="M') == sum(
        not one.band[0] <= one.failed <= one.band[1] for one in calibration.models[1].tasks.bins
    )
    assert thrice.count('class="outside" d="M') > 5


@pytest.mark.parametrize("size", [0.004, 0.4], ids=["logarithmic", "linear"])
def test_a_share_as_predicted_lies_on_the_line_whatever_the_axis(size):
    failure = np.repeat(np.array([1, 2]) * size, 1000)
    failed = np.concatenate([np.arange(1000) < 1000 * size, np.arange(1000) < 2000 * size])
    (model,) = score(Predictions({"m": Tasks(failure, 1 - failure, failed)})).models
    drawing = reliability_svg(model.tasks.bins, title="t")
    honest = line_of_honesty(drawing)
    found = marks(drawing, "inside")
    assert found
    for x, y in found:
        assert y == pytest.approx(honest(x), abs=0.2)


def test_a_bin_without_failures_is_hollow_and_on_the_edge():
    failure = np.full(500, 0.01)
    (model,) = score(Predictions({"m": Tasks(failure, 1 - failure, np.zeros(500, bool))})).models
    ((_, y),) = marks(reliability_svg(model.tasks.bins, title="t"), "none inside")
    assert y == pytest.approx(340)


def test_odd_histories_are_drawn(calibration):
    for q, failed in ((0.0, False), (0.0, True), (1.0, True), (1.0, False), (1e-300, False), (0.5, True)):
        model = score(Predictions({"m": Tasks(np.array([q]), np.array([1 - q]), np.array([failed]))})).models[0]
        drawing = reliability_svg(model.tasks.bins, title="t", standalone=True)
        assert "nan" not in drawing
        assert "inf" not in drawing.replace("info", "")
    one = Lives(
        np.zeros(1, int), np.zeros(1), np.arange(1.0, 10)[None], np.array([0.5]), np.array([5.0]), np.zeros(1, bool)
    )
    drawing = histogram_svg(score(Predictions({}, {"m": one})).models[0].lives, title="t")
    assert "nan" not in drawing


def test_bars_are_as_high_as_their_counts(calibration):
    lives = calibration.models[0].lives
    drawing = histogram_svg(lives, title="t")
    heights = [float(h) for h in re.findall(r'class="bar[^>]*height="([\d.]+)"', drawing)]
    assert np.array(heights) / heights[0] == pytest.approx(np.array(lives.histogram) / lives.histogram[0], rel=0.01)
