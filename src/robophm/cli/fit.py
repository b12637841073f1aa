"""``robophm fit``: what life data say of a part, in words, as a plot, and into a design."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import typer
from rich.console import Console

from robophm.cli.shared.fit_results import (
    bounded_json,
    fit_json,
    limited_json,
    modes_json,
    show_limited,
    show_modes,
    show_notes,
)
from robophm.cli.shared.options import Json
from robophm.cli.shared.output import console, may_make, may_write, print_json, print_table, table, write
from robophm.cli.shared.unused import refuse_unused
from robophm.core.errors import RobophmError
from robophm.design import file
from robophm.learning.life_data.distribution_fitting import (
    MOST_BELOW_ZERO,
    Fit,
    Goodness,
    How,
    as_good_as_best,
    can_be_corrected,
    fit,
    fit_all,
    goodness,
)
from robophm.learning.life_data.failure_modes import edited_modes, fit_modes
from robophm.learning.life_data.fit_in_design import edited_design, snippet
from robophm.learning.life_data.life_stress import LifeStressFit, fit_life_stress
from robophm.learning.life_data.limited_failures import fit_limited
from robophm.learning.life_data.observed_lives import LifeData, read_life_data, written_quantity
from robophm.learning.life_data.repairable_systems import PowerLaw, power_laws
from robophm.report.fit_page import fit_page, fit_rows, life_stress_page, modes_page, parameters_text, span_text
from robophm.report.probability_plot import probability_text
from robophm.report.words import number_text


@dataclass(frozen=True)
class Wishes:
    """The options of a fit."""

    distribution: str | None
    how: How
    level: float
    use: tuple[str, ...]
    laws: tuple[str, ...]
    repairable: bool
    some_never: bool
    refits: int
    seed: int
    report: Path | None
    to: Path | None
    part: str | None
    as_json: bool


def command(
    lives: Annotated[
        Path, typer.Argument(help="a table of lives: time [h], censored, count, stresses …", metavar="LIVES.CSV")
    ],
    distribution: Annotated[
        str | None,
        typer.Option(
            help="distribution: exponential, weibull, weibull3, lognormal, normal, gamma, loglogistic, gumbel"
        ),
    ] = None,
    by: Annotated[
        Literal["likelihood", "ranks"], typer.Option(help="method: likelihood, or ranks (a line through median ranks)")
    ] = "likelihood",
    use: Annotated[
        list[str] | None, typer.Option(metavar="STRESS=VALUE", help="stress in use, e.g. temperature='40 degC'")
    ] = None,
    law: Annotated[
        list[str] | None,
        typer.Option(metavar="STRESS=LAW", help="law of life and stress: arrhenius, eyring, q10, inverse_power"),
    ] = None,
    repairable: Annotated[
        bool, typer.Option("--repairable", help="items are repaired and continue: fit the power law")
    ] = False,
    some_never: Annotated[
        bool, typer.Option("--some-never-fail", help="also fit the share of parts that ever fails")
    ] = False,
    level: Annotated[float, typer.Option(help="confidence level of the intervals", min=0.01, max=0.999)] = 0.9,
    refits: Annotated[
        int, typer.Option(help="number of simulated fits that show how well the best one fits", min=0, max=10_000)
    ] = 0,
    seed: Annotated[int, typer.Option(help="random seed of --refits", min=0)] = 0,
    report: Annotated[Path | None, typer.Option(help="write an HTML page with probability plots")] = None,
    to: Annotated[Path | None, typer.Option(help="write the life into this design, with --part")] = None,
    part: Annotated[str | None, typer.Option(help="path of the part, or of its failure mode")] = None,
    as_json: Json = False,
) -> None:
    """Fit life data: distributions, lives at stress, repaired systems (needs robophm[fit])."""
    wishes = Wishes(
        distribution, by, level, tuple(use or ()), tuple(law or ()), repairable, some_never, refits, seed, report,
        to, part, as_json,
    )  # fmt: skip
    run(lives, wishes)


def run(path: Path, wishes: Wishes) -> None:
    """Fit, print, draw and write, as the options ask."""
    _only(wishes)
    if (wishes.to is None) != (wishes.part is None):
        raise RobophmError("--to names a design and --part the part in it; expected both")
    may_make(wishes.report, path, force=True, suffixes=(".html",))
    may_write(wishes.to, path)
    named = [
        name for texts, option in ((wishes.use, "--use"), (wishes.laws, "--law")) for name, _ in _pairs(texts, option)
    ]
    data = read_life_data(path, named)
    if wishes.repairable:
        _show_power_law(power_laws(data, level=wishes.level), data, wishes)
    elif data.stresses or wishes.use or wishes.laws:
        _only(wishes, stress=True)
        _stress(data, wishes)
    elif wishes.some_never:
        _limited(data, wishes)
    elif data.modes:
        _modes(data, wishes)
    else:
        _plain(data, wishes)


def _only(wishes: Wishes, *, stress: bool = False) -> None:
    """Refuse what is not used for what is asked, as far as that can be told; ``stress``: the data have stresses."""
    drawn = ["seed"] * (wishes.refits > 0)
    if wishes.repairable:
        refuse_unused("repaired systems (--repairable), whose power law is no life of a part", ("repairable", "level"))
    elif wishes.some_never:
        refuse_unused("lives of which some never end (--some-never-fail)", ("some_never", "distribution", "level"))
    elif stress or wishes.use or wishes.laws:
        refuse_unused("lives at stress", ("distribution", "use", "law", "level", "report", "to", "part"))
    else:
        refuse_unused(f"lives{'' if drawn else ' that are not fitted again (--refits)'}",
             ("distribution", "by", "use", "law", "level", "refits", "report", "to", "part", *drawn))  # fmt: skip


def _limited(data: LifeData, wishes: Wishes) -> None:
    if data.modes:
        raise RobophmError(f"{data.source}: has failure modes, each of which may never come; expected a table of one")
    found = fit_limited(data, wishes.distribution or "weibull", level=wishes.level)
    if wishes.as_json:
        print_json(limited_json(found))
    else:
        show_limited(found)


def _modes(data: LifeData, wishes: Wishes) -> None:
    refuse_unused("failure modes (a column 'mode')", ("distribution", "level", "report", "to", "part"))
    found = fit_modes(data, wishes.distribution, level=wishes.level)
    design = edited_modes(found, wishes.to, wishes.part) if wishes.to and wishes.part else None
    if wishes.as_json:
        print_json(modes_json(found))
    else:
        show_modes(found)
    if wishes.report:
        write(wishes.report, modes_page(found))
    if wishes.to and design is not None:
        file.write(wishes.to, design)
        if not wishes.as_json:
            console().print(f"{wishes.to}: the failure modes of {wishes.part} have these lives now; as it was: "
                            f"{wishes.to.name}.bak", markup=False, soft_wrap=True)  # fmt: skip


def _plain(data: LifeData, wishes: Wishes) -> None:
    refused: dict[str, str] = {}
    if wishes.distribution or wishes.how == "ranks":
        fits = [fit(data, wishes.distribution or "weibull", how=wishes.how, level=wishes.level)]
    else:
        fits, refused = fit_all(data, level=wishes.level)
    best = fits[0]
    design = _changed(best, wishes)  # what cannot be is said before anything else
    tested = goodness(best, wishes.refits, wishes.seed) if wishes.refits else None
    if wishes.as_json:
        print_json({
            "data": data.described(), "unit": data.unit, "level": wishes.level,
            "fits": [fit_json(one) for one in fits],
            "refused": refused, "anderson_darling": tested and {"statistic": tested.statistic, "p": tested.p_value},
        })  # fmt: skip
    else:
        _show(data, fits, refused, tested, wishes)
    if wishes.report:
        write(wishes.report, fit_page(fits, refused))
    _into_design(best, design, wishes)


def _stress(data: LifeData, wishes: Wishes) -> None:
    reference = {name: written_quantity(text, name) for name, text in _pairs(wishes.use, "--use")}
    found = fit_life_stress(
        data, wishes.distribution or "weibull", reference=reference, laws=dict(_pairs(wishes.laws, "--law")),
        level=wishes.level,
    )  # fmt: skip
    design = _changed(found, wishes)
    if wishes.as_json:
        print_json(_stress_json(found))
    else:
        _show_stress(found)
    if wishes.report:
        write(wishes.report, life_stress_page(found))
    _into_design(found, design, wishes)


def _pairs(texts: Sequence[str], option: str) -> list[tuple[str, str]]:
    pairs = []
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals or not name.strip() or not value.strip():
            raise RobophmError(f"{option} {text[:60]!r}; expected e.g. temperature='40 degC'")
        pairs.append((name.strip(), value.strip()))
    return pairs


def _changed(found: Fit | LifeStressFit, wishes: Wishes) -> str | None:
    """The text of the design with this life in it; None where none is to be changed."""
    return edited_design(found, wishes.to, wishes.part) if wishes.to and wishes.part else None


def _into_design(found: Fit | LifeStressFit, design: str | None, wishes: Wishes) -> None:
    out = console()
    if wishes.to and design is not None:
        file.write(wishes.to, design)
        if not wishes.as_json:
            out.print(f"{wishes.to}: {wishes.part} has this life now; as it was: {wishes.to.name}.bak", markup=False)
    elif not wishes.as_json:
        try:
            lines = snippet(found)
        except RobophmError as error:
            out.print(f"Not for a design: {error}", markup=False, soft_wrap=True)
            return
        out.print("\nIn a design (or --to ROBOT.YAML --part PART):", markup=False)
        for line in lines:
            out.print(f"  {line}", markup=False, soft_wrap=True)


def _show(
    data: LifeData, fits: Sequence[Fit], refused: Mapping[str, str], tested: Goodness | None, wishes: Wishes
) -> None:
    out = console()
    columns, rows = fit_rows(fits)
    print_table(out, table(f"{data.source}: {data.described()}", columns, rows, figures=range(2, len(columns))))
    best, limit = fits[0], fits[0].known_until
    out.print(
        f"In brackets: {100 * wishes.level:g} % intervals. {columns[5]}: less is better, two apart is little. R² "
        "of the probability plot", markup=False,
    )  # fmt: skip
    if not can_be_corrected(fits) and len(fits) > 1:
        out.print(
            f"{data.parts} parts are too few to correct AIC for them: ranked without", style="yellow", markup=False
        )
    if below := [one.name for one in fits if one.below_zero > MOST_BELOW_ZERO]:
        out.print(f"Last, as some of their lives would be below zero: {', '.join(below)}", markup=False, soft_wrap=True)
    close = [one.name for one in as_good_as_best(fits)]
    if len(fits) > 1:
        also = f"; {', '.join(close)} cannot be told from it" if close else ""
        out.print(f"Best: {best.name}{also}", style="bold", markup=False, soft_wrap=True)
    out.print(
        f"{best.name}: 1 % fail by {span_text(best.quantiles[0.01], limit)}, 10 % by "
        f"{span_text(best.quantiles[0.1], limit)}, half by {span_text(best.quantiles[0.5], limit)}",
        markup=False, soft_wrap=True,
    )  # fmt: skip
    if tested:
        fits_well = "it does not fit" if tested.doubtful else "no reason to doubt it"
        statistic, p = number_text(tested.statistic, 3), number_text(tested.p_value, 2)
        out.print(f"Anderson–Darling {statistic}, p = {p}: {fits_well}", markup=False)
    for one in fits:
        show_notes(out, [f"{one.name}: {note}" for note in one.notes])
    show_notes(out, [f"{name} was not fitted: {why}" for name, why in refused.items()])
    _draw(out, best)


def _draw(out: Console, found: Fit) -> None:
    if len(found.plot.times) < 2:
        return
    out.print(f"\n{found.name} probability plot: o failures, · the fit", markup=False)
    for line in probability_text(found):
        out.print(line, markup=False, soft_wrap=True)


def _show_stress(found: LifeStressFit) -> None:
    out, unit = console(), found.data.unit
    use = ", ".join(f"{name} {value:g}" for name, value in found.reference.items())
    rows = [[f"{stress}: {found.laws[stress]}", span_text(one)] for stress, one in found.coefficients.items()]
    limit = found.known_until
    rows += [[f"{name} at {use}", parameters_text({name: one}, found.life, limit).removeprefix(f"{name} ")]
             for name, one in found.parameters.items()]  # fmt: skip
    rows += [[f"{100 * p:g} % fail by [{unit}]" if unit else f"{100 * p:g} % fail by", span_text(one, limit)]
             for p, one in found.quantiles.items()]  # fmt: skip
    print_table(out, table(f"{found.data.source}: {found.data.described()}; {found.name} life", ["", "value"], rows))
    if found.levels:
        tested = [
            [", ".join(f"{name} {value:g}" for name, value in stress.items()), str(parts), str(failures),
             number_text(factor, 3), parameters_text(alone.parameters) if alone else "too few failures"]
            for stress, parts, failures, factor, alone in found.levels
        ]  # fmt: skip
        columns = ["tested at", "parts", "failed", "times as fast", "alone"]
        print_table(out, table("", columns, tested, figures=(1, 2, 3)))
    if found.separate:
        ratio, freedom, p = found.separate
        out.print(f"One law for all against each alone: likelihood ratio {number_text(ratio)} on {freedom} degrees of "
                  f"freedom, p = {number_text(p, 2)}", markup=False)  # fmt: skip
    out.print(f"ln L {number_text(found.log_likelihood, 6)}, AIC {number_text(found.aic, 6)}; intervals hold with "
              f"{100 * found.level:g} %", markup=False)  # fmt: skip
    show_notes(out, found.notes)


def _show_power_law(by: Mapping[str, PowerLaw], data: LifeData, wishes: Wishes) -> None:
    """Show the power law by each estimate; for systems not watched equally long there is no unbiased one."""
    found = next(iter(by.values()))
    if wishes.as_json:
        print_json({
            "systems": found.systems, "failures": found.failures, "estimate": found.estimate, **_power_law(found),
            "until": found.until, "ended_with_failure": found.at_failure, "trend_p": found.p_value, "unit": data.unit,
            "estimates": {name: _power_law(one) for name, one in by.items()},
        })  # fmt: skip
        return
    out = console()
    trend = {None: "no trend is shown", "improving": "they improve", "wearing": "they wear"}[found.trend]
    out.print(f"{found.failures} failures of {found.systems} repaired system{'s' * (found.systems > 1)}: {trend} "
              f"(p = {number_text(found.p_value, 2)})", style="bold", markup=False)  # fmt: skip
    rows = [
        [name, f"{number_text(one.scale)} · t^{number_text(one.shape.value)}", span_text(one.shape),
         span_text(one.mean_time)]
        for name, one in by.items()
    ]  # fmt: skip
    unit = f" [{data.unit}]" if data.unit else ""
    columns = ["power law by", "failures by t", "exponent β", f"between failures at {number_text(found.until)}{unit}"]
    print_table(out, table("", columns, rows, figures=(1, 2, 3)))
    out.print(f"In brackets: {100 * wishes.level:g} % intervals. Unbiased: Crow's, with n − 1 in the place of n; "
              "maximum likelihood: MIL-HDBK-189's, too high on average where failures are few",
              markup=False, soft_wrap=True)  # fmt: skip
    if found.at_failure:
        out.print("Taken as watched until the last failure, which ended it: n − 2 in the place of n − 1, and bounds of "
                  "such a test. If it was watched on, a row with censored: yes says until when",
                  style="yellow", markup=False, soft_wrap=True)  # fmt: skip
    if len(by) == 1:
        out.print("Systems were not watched equally long: of these there is no unbiased estimate", markup=False)


def _power_law(found: PowerLaw) -> dict[str, Any]:
    return {
        "beta": bounded_json(found.shape), "lambda": found.scale,
        "mean_time_between_failures": bounded_json(found.mean_time),
    }  # fmt: skip


def _stress_json(found: LifeStressFit) -> dict[str, Any]:
    return {
        "distribution": found.name, "laws": dict(found.laws), "use": dict(found.reference), "unit": found.data.unit,
        "coefficients": {name: bounded_json(one) for name, one in found.coefficients.items()},
        "parameters": {name: bounded_json(one) for name, one in found.parameters.items()},
        "quantiles": {str(p): bounded_json(one, found.known_until) for p, one in found.quantiles.items()},
        "known_until": found.known_until,
        "log_likelihood": found.log_likelihood, "aic": found.aic, "step_stress": found.steps,
        "levels": [
            {"stress": dict(stress), "parts": parts, "failures": failures, "acceleration": factor}
            for stress, parts, failures, factor, _ in found.levels
        ],
        "separate": found.separate and dict(zip(("ratio", "freedom", "p"), found.separate, strict=True)),
        "notes": list(found.notes),
    }  # fmt: skip
