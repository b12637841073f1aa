"""Results of ``robophm fit`` as tables and as JSON: competing failure modes, and parts some of which never fail."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

from rich.console import Console

from robophm.cli.shared.option_hints import with_options
from robophm.cli.shared.output import console, print_table, table
from robophm.learning.life_data.distribution_fitting import Bounded, Fit
from robophm.learning.life_data.failure_modes import ModesFit
from robophm.learning.life_data.limited_failures import LimitedFit
from robophm.report.fit_page import figure_text, parameters_text, span_text
from robophm.report.words import number_text, percent_text


def known(value: float, limit: float) -> float | None:
    """A figure, or None where it lies beyond what is known."""
    return value if value <= limit else None


def bounded_json(one: Bounded, limit: float = math.inf) -> dict[str, float | None]:
    """A figure with its interval; None beyond a limit."""
    return {name: known(value, limit) if value == value else value for name, value in one._asdict().items()}


def fit_json(one: Fit) -> dict[str, Any]:
    """One distribution; figures beyond ``known_until`` are none."""
    limit = one.known_until
    return {
        "distribution": one.name, "parameters": {name: bounded_json(value) for name, value in one.parameters.items()},
        "log_likelihood": one.log_likelihood, "aic": one.aic,
        "aic_corrected": one.aic_corrected if math.isfinite(one.aic_corrected) else None,
        "mean": known(one.mean, limit), "known_until": limit,
        "quantiles": {str(p): bounded_json(value, limit) for p, value in one.quantiles.items()},
        "r_squared": one.straightness, "notes": list(one.notes),
    }  # fmt: skip


def modes_json(found: ModesFit) -> dict[str, Any]:
    """Each mode, and the part."""
    limit = found.known_until
    return {
        "data": found.data.described(), "unit": found.data.unit,
        "modes": {
            name: {"failures": one.data.failures, "first_in": found.shares[name], **fit_json(one)}
            for name, one in found.modes.items()
        },
        "mean": known(found.mean, limit), "known_until": limit,
        "quantiles": {str(p): known(value, limit) for p, value in found.quantiles.items()},
        "notes": list(found.notes),
    }  # fmt: skip


def show_modes(found: ModesFit) -> None:
    """Print a table of the fitted failure modes, one in each row, and of the part as a whole in the last."""
    limit, unit = found.known_until, f" [{found.data.unit}]" if found.data.unit else ""
    rows = [
        [name, str(one.data.failures), f"{one.name}: {parameters_text(one.parameters, one.life, one.known_until)}",
         figure_text(one.quantiles[0.1].value, limit), figure_text(one.quantiles[0.5].value, limit),
         figure_text(one.mean, limit), percent_text(found.shares[name])]
        for name, one in found.modes.items()
    ]  # fmt: skip
    rows.append(["all together", str(found.data.failures), "the product", figure_text(found.quantiles[0.1], limit),
                 figure_text(found.quantiles[0.5], limit), figure_text(found.mean, limit), ""])  # fmt: skip
    columns = ["", "failed", f"life{unit}", "10 % by", "half by", "mean", "first in"]
    print_table(
        console(), table(f"{found.data.source}: {found.data.described()}", columns, rows, figures=(1, 3, 4, 5, 6))
    )
    out = console()
    out.print("Each mode with the others' failures as censored; together as if none depended on another, which such "
              "data cannot tell", markup=False, soft_wrap=True)  # fmt: skip
    show_notes(out, found.notes)


def show_notes(out: Console, notes: Iterable[str]) -> None:
    """Print notes on a fit, a line each, with the options of the command that give what they ask for."""
    for note in notes:
        out.print(with_options(note), style="yellow", markup=False, soft_wrap=True)


def limited_json(found: LimitedFit) -> dict[str, Any]:
    """The share that ever fails, and the life of those."""
    limit = found.known_until
    return {
        "data": found.data.described(), "unit": found.data.unit, "distribution": found.name, "level": found.level,
        "share_that_fails": bounded_json(found.share), "p": found.p_value,
        "parameters": {name: bounded_json(one) for name, one in found.parameters.items()},
        "log_likelihood": found.log_likelihood, "log_likelihood_if_all_fail": found.plain.log_likelihood,
        "quantiles": {str(p): known(value, limit) for p, value in found.quantiles.items()}, "known_until": limit,
    }  # fmt: skip


def show_limited(found: LimitedFit) -> None:
    """Print a table of the share of parts that ever fails, and of the life of those that do."""
    out, limit, unit = console(), found.known_until, f" [{found.data.unit}]" if found.data.unit else ""
    share = Bounded(*(100 * one for one in found.share))
    rows = [["share that ever fails [%]", span_text(share)]]
    rows += [[f"{name} of those", parameters_text({name: one}, found.life, limit).removeprefix(f"{name} ")]
             for name, one in found.parameters.items()]  # fmt: skip
    rows += [
        [f"{100 * p:g} % of all fail by{unit}",
         "never so many" if p >= found.share.value else figure_text(value, limit)]
        for p, value in found.quantiles.items()
    ]  # fmt: skip
    title = f"{found.data.source}: {found.data.described()}; {found.name} life, some never fail"
    print_table(out, table(title, ["", "value"], rows))
    shown = "that some never fail is shown" if found.shown else "that some never fail is not shown"
    out.print(f"ln L {number_text(found.log_likelihood, 6)}, {number_text(found.plain.log_likelihood, 6)} if all fail: "
              f"{shown} (p = {number_text(found.p_value, 2)}); intervals hold with {100 * found.level:g} %",
              markup=False, soft_wrap=True)  # fmt: skip
    if not found.shown:
        out.print("as well as by this the data are explained by parts that all fail, if late", style="yellow")
    out.print("Not for a design, whose parts all fail in the end", markup=False)
