"""``robophm rate``: what a handbook's model takes, and the hazard rate that it gives."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict
from typing import Annotated

import typer

from robophm.cli.shared.options import Json
from robophm.cli.shared.output import console, print_json, print_table, table
from robophm.cli.shared.unused import refuse_unused
from robophm.cli.shared.where_else import in_library
from robophm.core.errors import ModelError, PlugError
from robophm.core.units import in_unit
from robophm.hazard.answer import Answer, answer
from robophm.hazard.environments import explained
from robophm.hazard.handbooks import handbook_model, handbook_models
from robophm.hazard.model import Model, Range
from robophm.report.words import number_text


def command(
    model: Annotated[
        str | None, typer.Argument(help="name of a model, e.g. mil_hdbk_217f.capacitor; without it: a list")
    ] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="INPUT=VALUE", help="an input of the model, e.g. temperature='60 degC'"),
    ] = None,
    explain: Annotated[bool, typer.Option("--explain", help="show every input, assumption and factor")] = False,
    unit: Annotated[
        str | None, typer.Option(help="unit of the rate: FIT, FPMH, 1/h, or '/10^6 cycle' for a rate per cycle")
    ] = None,
    as_json: Json = False,
) -> None:
    """Compute the hazard rate of a part by a handbook's model."""
    if model is None:
        refuse_unused("the list of models", ())
        print_models(as_json=as_json)
        return
    try:
        chosen, given = handbook_model(model), pairs(set_ or [])
    except PlugError as error:
        raise PlugError(f"{error}{'' if 'did you mean' in str(error) else in_library(model)}") from None
    if unit is not None:
        in_unit(0.0, chosen.unit, unit)
    if not given and chosen.must_be_given:
        refuse_unused(f"what {chosen.name} takes", ("model",))
        print_inputs(chosen, as_json=as_json)
        return
    refuse_unused("a hazard rate", ("model", "set_", "explain", "unit"))
    found = answer(chosen, given)
    if as_json:
        _print_json(found, unit)
    else:
        _print(found, given, unit, explain=explain)


def pairs(texts: Sequence[str]) -> dict[str, str]:
    """Return the inputs that ``--set`` names. Raises ModelError where one is none, or is named twice."""
    given: dict[str, str] = {}
    for pair in texts:
        name, equals, value = (word.strip() for word in pair.partition("="))
        if not equals:
            raise ModelError(f"--set {pair}: expected INPUT=VALUE")
        if name in given:
            raise ModelError(f"--set {pair}: '{name}' is given twice")
        given[name] = value
    return given


def print_models(*, as_json: bool) -> None:
    """Print all models with their formulas."""
    models = [(name, handbook_model(name)) for name in handbook_models()]
    if as_json:
        print_json({"models": [{"name": n, "formula": m.formula, "source": str(m.source)} for n, m in models]})
    else:
        rows = [(n, m.formula, str(m.source)) for n, m in models]
        print_table(console(), table("Hazard models", ("model", "formula", "source"), rows))


def print_inputs(model: Model, *, as_json: bool) -> None:
    """Print the inputs that a model takes."""
    takes = [
        (name, model.expected(name), "" if e.default is None else str(e.default), e.description)
        for name, e in model.inputs.items()
    ]
    if as_json:
        keys = ("name", "expected", "default", "description")
        print_json({"model": model.name, "unit": model.unit, "formula": model.formula, "source": str(model.source),
                    "inputs": [dict(zip(keys, row, strict=True)) for row in takes]})  # fmt: skip
        return
    out = console()
    out.print(f"{model.name}: {model.formula}\n{model.source}", markup=False)
    for name, expected, default, description in takes:
        out.print(
            f"  {name}: {description}; {expected}" + (f"; default {default}" if default else ""),
            markup=False,
        )


def _print_json(found: Answer, unit: str | None) -> None:
    model = found.model
    print_json({
        "model": model.name, "inputs": found.inputs, "units": {n: e.unit for n, e in model.numbers.items()},
        "assumed": {name: asdict(one) for name, one in found.assumed.items()},
        "hazard_rate": _in(found, unit), "unit": unit or model.unit,
        "formula": model.formula, "source": str(model.source), "factors": [one._asdict() for one in found.factors],
    })  # fmt: skip


def _print(found: Answer, given: dict[str, str], unit: str | None, *, explain: bool) -> None:
    model, out = found.model, console()
    out.print(f"{model.name}: {number_text(_in(found, unit))} {(unit or model.unit).removeprefix('1')}", markup=False)
    for name, option in found.taken.items():
        meant = explained(option) if name == "environment" else option
        out.print(f"{name} '{given[name]}' is taken as {meant}", markup=False, soft_wrap=True)
    if explain:
        out.print(f"{model.formula}\n{model.source} ({model.source.status})", markup=False)
        for line in _inputs(found):
            out.print(f"  {line}", markup=False)
        for symbol, number, note in found.factors:
            out.print(f"  {symbol:<6} {number:<12.6g} {note}", markup=False)


def _in(found: Answer, unit: str | None) -> float:
    return found.value if unit is None else in_unit(found.value, found.model.unit, unit)


def _inputs(found: Answer) -> Iterator[str]:
    """The lines on what the rate is of, input by input, and which of it nobody said."""
    model, inputs, assumed = found.model, found.inputs, found.assumed
    width = max(map(len, model.inputs), default=0)
    for name, entry in model.inputs.items():
        if name not in inputs and name not in assumed:
            continue  # this choice of others does not use it
        value = assumed[name].value if name in assumed else inputs[name]
        text = entry.written(value) if isinstance(entry, Range) and isinstance(value, float | int) else value or "–"
        yield f"{name:<{width}}  {text}" + (f"   assumed: {assumed[name].why}" if name in assumed else "")
