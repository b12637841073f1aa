"""The page on life data: distributions, probability plots, and life at the stress of use."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

from robophm.report.markup import Html
from robophm.report.page import figure, page, section, side_by_side, table_html
from robophm.report.probability_plot import probability_svg
from robophm.report.words import number_text

if TYPE_CHECKING:
    from robophm.learning.life_data.distribution_fitting import Bounded, Fit
    from robophm.learning.life_data.life_stress import LifeStressFit

MOST_DRAWN = 4


def span_text(one: Bounded) -> str:
    """A figure with its interval: "607 (432 … 851)"."""
    if one.low != one.low:
        return number_text(one.value)
    return f"{number_text(one.value)} ({number_text(one.low, 3)} … {number_text(one.high, 3)})"


def parameters_text(parameters: Mapping[str, Bounded]) -> str:
    """Return parameters as text: 'scale 607 (432 … 851), shape 1.72 (1.06 … 2.78)'."""
    return ", ".join(f"{name} {span_text(one)}" for name, one in parameters.items())


def fit_page(fits: Sequence[Fit], refused: Mapping[str, str]) -> Html:
    """Distributions fitted to the same lives, the best first."""
    return page(f"Life data: {fits[0].data.source}", _sections(fits, refused))


def _sections(fits: Sequence[Fit], refused: Mapping[str, str]) -> Iterable[Html | str]:
    best = fits[0]
    yield f"{best.data.described()}. Intervals hold with {100 * best.level:g} %."
    columns = ("distribution", "parameters", "10 % fail by", "half fail by", "mean", "ln L", "AIC", "corrected", "R²")
    rows = [
        (one.name, parameters_text(one.parameters), span_text(one.quantiles[0.1]), span_text(one.quantiles[0.5]),
         one.mean, one.log_likelihood, one.aic, one.aic_corrected, number_text(one.straightness, 3))
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


def life_stress_page(found: LifeStressFit) -> Html:
    """Lives at several stresses, and what follows for the stress of use."""
    return page(f"Life and stress: {found.data.source}", _stress_sections(found))


def _stress_sections(found: LifeStressFit) -> Iterable[Html | str]:
    use = ", ".join(f"{name} {value:g}" for name, value in found.reference.items())
    yield f"{found.data.described()}. At {use}; intervals hold with {100 * found.level:g} %."
    rows: list[tuple[object, ...]] = [
        (f"{stress}: {found.laws[stress]}", span_text(one)) for stress, one in found.coefficients.items()
    ]
    rows += [(f"{name} at use", span_text(one)) for name, one in found.parameters.items()]
    rows += [(f"{100 * p:g} % fail by", span_text(one)) for p, one in found.quantiles.items()]
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
