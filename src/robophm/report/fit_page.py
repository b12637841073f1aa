"""The page on life data: distributions, probability plots, and life at the stress of use."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

from robophm.report.markup import Html
from robophm.report.page import figure, page, section, side_by_side, table_html
from robophm.report.probability_plot import probability_svg
from robophm.report.words import number_text

if TYPE_CHECKING:
    from robophm.learning.life_data.distribution_fitting import Bounded, Fit
    from robophm.learning.life_data.failure_modes import ModesFit
    from robophm.learning.life_data.life_stress import LifeStressFit
    from robophm.life.distribution import LifeDistribution

MOST_DRAWN = 4


def figure_text(value: float, limit: float = math.inf, digits: int = 4) -> str:
    """A figure that is known up to a limit: "607", "beyond 5,000"."""
    return f"beyond {number_text(limit)}" if value > limit else number_text(value, digits)


def span_text(one: Bounded, limit: float = math.inf) -> str:
    """A figure with its interval, each known up to a limit: "607 (432 … 851)", "beyond 5,000"."""
    if one.low != one.low or one.value > limit:
        return figure_text(one.value, limit)
    return f"{number_text(one.value)} ({figure_text(one.low, limit, 3)} … {figure_text(one.high, limit, 3)})"


def parameters_text(
    parameters: Mapping[str, Bounded], life: LifeDistribution | None = None, limit: float = math.inf
) -> str:
    """'scale 607 (432 … 851), shape 1.72 (1.06 … 2.78)'; what is a time is known up to a limit."""
    times = {name for name, dimension in life.dimensions.items() if dimension == 1} if life else set()
    return ", ".join(
        f"{name} {span_text(one, limit if name in times else math.inf)}" for name, one in parameters.items()
    )


def fit_rows(fits: Sequence[Fit]) -> tuple[list[str], list[list[str]]]:
    """Return the columns of a table of fits to the same data, and its rows, the best first."""
    corrected = all(math.isfinite(one.aic_corrected) for one in fits)
    unit = f" [{fits[0].data.unit}]" if fits[0].data.unit else ""
    rows = [
        [one.name, parameters_text(one.parameters, one.life, one.known_until),
         figure_text(one.quantiles[0.1].value, one.known_until), figure_text(one.quantiles[0.5].value, one.known_until),
         figure_text(one.mean, one.known_until), number_text(one.aic_corrected if corrected else one.aic, 5),
         number_text(one.straightness, 3)]
        for one in fits
    ]  # fmt: skip
    return ["", f"parameters{unit}", "10 % by", "half by", "mean", "AICc" if corrected else "AIC", "R²"], rows


def fit_page(fits: Sequence[Fit], refused: Mapping[str, str]) -> Html:
    """Distributions fitted to the same lives, the best first."""
    return page(f"Life data: {fits[0].data.source}", _sections(fits, refused))


def _sections(fits: Sequence[Fit], refused: Mapping[str, str]) -> Iterable[Html | str]:
    best = fits[0]
    yield f"{best.data.described()}. Intervals hold with {100 * best.level:g} %."
    columns = ("distribution", "parameters", "10 % fail by", "half fail by", "mean", "ln L", "AIC", "corrected", "R²")
    rows = [
        (one.name, parameters_text(one.parameters, one.life, one.known_until),
         span_text(one.quantiles[0.1], one.known_until), span_text(one.quantiles[0.5], one.known_until),
         figure_text(one.mean, one.known_until), one.log_likelihood, one.aic,
         one.aic_corrected if math.isfinite(one.aic_corrected) else "–",
         number_text(one.straightness, 3))
        for one in fits
    ]  # fmt: skip
    yield section("Distributions", table_html(columns, rows, "The best by its corrected AIC first; two apart is little",
                                              "llrrrrrrr"))  # fmt: skip
    drawn = [figure(probability_svg(one, title=one.name)) for one in fits[:MOST_DRAWN]]
    yield section("Probability plots", side_by_side(*drawn))
    notes = [f"{one.name}: {note}" for one in fits for note in one.notes]
    notes += [f"{name}: {why}" for name, why in refused.items()]
    if notes:
        yield section("Notes", *notes)


def modes_page(found: ModesFit) -> Html:
    """A part that fails in several ways: each mode, and the part."""
    return page(f"Life data: {found.data.source}", _mode_sections(found))


def _mode_sections(found: ModesFit) -> Iterable[Html | str]:
    yield f"{found.data.described()}, by {len(found.modes)} failure modes; of each the others' failures are censored."
    limit = found.known_until
    rows = [
        (name, one.data.failures, one.name, parameters_text(one.parameters, one.life, one.known_until),
         span_text(one.quantiles[0.1], limit), span_text(one.quantiles[0.5], limit), figure_text(one.mean, limit),
         f"{100 * found.shares[name]:.3g} %")
        for name, one in found.modes.items()
    ]  # fmt: skip
    rows.append(("all together", found.data.failures, "product", "", figure_text(found.quantiles[0.1], limit),
                 figure_text(found.quantiles[0.5], limit), figure_text(found.mean, limit), "100 %"))  # fmt: skip
    columns = ("mode", "failures", "distribution", "parameters", "10 % fail by", "half fail by", "mean", "first in")
    yield section("Failure modes", table_html(columns, rows, "As if no mode depended on another", "lrllrrrr"))
    yield section("Probability plots", side_by_side(*(
        figure(probability_svg(one, title=name)) for name, one in found.modes.items() if len(one.plot.times) > 1
    )))  # fmt: skip
    if found.notes:
        yield section("Notes", *found.notes)


def life_stress_page(found: LifeStressFit) -> Html:
    """Lives at several stresses, and what follows for the stress of use."""
    return page(f"Life and stress: {found.data.source}", _stress_sections(found))


def _stress_sections(found: LifeStressFit) -> Iterable[Html | str]:
    use = ", ".join(f"{name} {value:g}" for name, value in found.reference.items())
    yield f"{found.data.described()}. At {use}; intervals hold with {100 * found.level:g} %."
    rows: list[tuple[object, ...]] = [
        (f"{stress}: {found.laws[stress]}", span_text(one)) for stress, one in found.coefficients.items()
    ]
    rows += [(f"{name} at use", parameters_text({name: one}, found.life, found.known_until).removeprefix(f"{name} "))
             for name, one in found.parameters.items()]  # fmt: skip
    rows += [(f"{100 * p:g} % fail by", span_text(one, found.known_until)) for p, one in found.quantiles.items()]
    yield section(f"{found.name} life", table_html(("", "value"), rows))
    if found.levels:
        tested = [
            (", ".join(f"{name} {value:g}" for name, value in stress.items()), parts, failures, factor,
             parameters_text(alone.parameters) if alone else "too few failures")
            for stress, parts, failures, factor, alone in found.levels
        ]  # fmt: skip
        yield section(
            "As tested", table_html(("stress", "parts", "failures", "acceleration", "alone"), tested, "", "lrrrl"),
            side_by_side(*(
                figure(probability_svg(alone, title=", ".join(f"{n} {v:g}" for n, v in stress.items())))
                for stress, _, _, _, alone in found.levels if alone
            )),
        )  # fmt: skip
    if found.notes:
        yield section("Notes", *found.notes)
