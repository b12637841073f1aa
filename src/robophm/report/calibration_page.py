"""Were the predictions honest? One page: verdicts, reliability diagrams, PIT histograms, coverage."""

from __future__ import annotations

from collections.abc import Iterable
from importlib.metadata import version
from typing import TYPE_CHECKING

from robophm.report.calibration_svg import histogram_svg, reliability_svg
from robophm.report.markup import Html
from robophm.report.page import figure, page, section, side_by_side, table_html, tile, tiles
from robophm.report.style import Tone
from robophm.report.words import duration_text, number_text

if TYPE_CHECKING:  # rooms on one floor do not need each other to run
    from robophm.calibration.lives import LifeScore
    from robophm.calibration.score import Calibration, ModelCalibration
    from robophm.calibration.tasks import TaskScore
    from robophm.calibration.verdict import Verdict

_TONES: dict[str, Tone] = {"calibrated": "ok", "not calibrated": "error", "too little data": "warn"}


def calibration_page(calibration: Calibration, source: str) -> Html:
    """The whole page as HTML; ``source`` says where the predictions are from."""
    return page("Calibration of predictions", _sections(calibration, source))


def _sections(calibration: Calibration, source: str) -> Iterable[Html | str]:
    yield f"Predictions in {source}, each model scored for itself."
    yield tiles(*(found for model in calibration.models for found in _tiles(model)))
    yield section("Models", _overview(calibration))
    for model in calibration.models:
        yield section(model.model, *_model(model))
    yield section(
        "How to read this",
        "Reliability diagram: tasks are grouped by their predicted probability of failure, with equal numbers of "
        "expected failures. Each mark is the share that failed; the bar behind it is where honest predictions leave "
        "it, for all groups together with 99 %. A diamond lies outside its bar; a hollow mark at the lower edge "
        "stands for no failure at all. Honest predictions lie on the dashed line.",
        "PIT: the predicted probability of a life no longer than the observed one. Honest predictions spread it "
        "evenly: bars too high at the left are lives shorter than predicted, at the right longer ones; at both ends, "
        "the intervals were too narrow. Where the end was not seen, it is drawn from what can still come. The shaded "
        "strip holds all bars of an honest model with 99 %.",
        f"A model is rejected where honest predictions would do so badly in less than 1 % of histories. "
        f"robophm {version('robophm')}.",
    )


def _tiles(model: ModelCalibration) -> Iterable[Html]:
    if model.tasks and model.task_verdict:
        yield _tile(f"{model.model}: tasks", model.task_verdict, model.tasks.p_value)
    if model.lives and model.life_verdict:
        yield _tile(f"{model.model}: remaining life", model.life_verdict, model.lives.p_value)


def _tile(title: str, verdict: Verdict, p: float) -> Html:
    return tile(title, verdict.finding.capitalize(), f"p = {number_text(p, 2)}", _TONES[verdict.finding])


def _overview(calibration: Calibration) -> Html:
    columns = (
        "model",
        "tasks",
        "failed",
        "expected",
        "Brier score",
        "log. score",
        "lives",
        "CRPS",
        "95 % interval holds",
    )
    rows = []
    for one in calibration.models:
        tasks, lives = one.tasks, one.lives
        rows.append((
            one.model,
            *((tasks.tasks, tasks.failed, tasks.expected, tasks.brier.score, tasks.logarithmic_score)
              if tasks else (None,) * 5),
            *((lives.lives, duration_text(lives.crps), f"{100 * lives.coverage[-1].share:.3g} %")
              if lives else (None,) * 3),
        ))  # fmt: skip
    return table_html(columns, rows, "Scores: less is better", "lrrrrrrrr")


def _model(model: ModelCalibration) -> Iterable[Html | str]:
    drawings = []
    if model.tasks and model.task_verdict:
        yield str(model.task_verdict)
        drawings.append(figure(reliability_svg(model.tasks.bins, title="Task completion"), _outside(model.tasks)))
    if model.lives and model.life_verdict:
        yield str(model.life_verdict)
        caption = f"{number_text(model.lives.lives)} lives, {number_text(model.lives.censored)} of them still going on"
        drawings.append(figure(histogram_svg(model.lives, title="Remaining life"), caption))
    yield side_by_side(*drawings)
    if model.tasks:
        yield _bins(model.tasks)
    if model.lives:
        yield from _lives(model.lives)


def _outside(score: TaskScore) -> str:
    out = sum(one.outside for one in score.bins)
    return f"{number_text(score.tasks)} tasks; {out} of {len(score.bins)} groups outside their bands"


def _bins(score: TaskScore) -> Html:
    rows = [
        (
            f"{number_text(one.lowest, 3)} – {number_text(one.highest, 3)}",
            one.tasks,
            one.expected,
            one.failed,
            f"{one.band[0]:,} – {one.band[1]:,}",
            number_text(one.p_value, 2),
        )
        for one in score.bins
    ]
    brier = score.brier
    caption = (
        f"Brier score {number_text(brier.score)} = reliability {number_text(brier.reliability)} − resolution "
        f"{number_text(brier.resolution)} + uncertainty {number_text(brier.uncertainty)} + within groups "
        f"{number_text(brier.within_bins)}"
    )
    columns = ("predicted probability of failure", "tasks", "expected", "failed", "99 % band", "p")
    return figure(table_html(columns, rows, caption, "lrrrrr"))


def _lives(score: LifeScore) -> Iterable[Html]:
    rows = [
        (f"{100 * one.level:g} %", f"{100 * one.share:.1f} %", f"{100 * one.low:.1f} – {100 * one.high:.1f} %")
        for one in score.coverage
    ]
    columns = ("central interval", "lives in it", "true coverage, 99 % together")
    yield figure(table_html(columns, rows, "Coverage of the predicted intervals", "lrr"))
    if found := score.prognosis:
        metrics = [
            ("prognostic horizon, median share of the whole life", f"{number_text(100 * found.horizon, 3)} %"),
            (
                f"predictions half way that meet α–λ, of {found.half_way_lives:,}",
                f"{number_text(100 * found.half_way, 3)} %",
            ),
            ("cumulative relative accuracy, median", number_text(found.relative_accuracy)),
            ("convergence, median", duration_text(found.convergence)),
        ]
        caption = (
            f"{found.lives:,} lives predicted at least twice; by the predicted medians, ± 20 % (Saxena et al. 2010)"
        )
        yield figure(table_html(("prognostic metric", "over the lives"), metrics, caption, "lr"))
