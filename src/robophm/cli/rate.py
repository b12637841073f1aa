"""``robophm rate``: what a handbook's model takes, and the hazard rate that it gives."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict
from typing import Annotated

import numpy as np
import typer

from robophm.cli.shared.options import Json
from robophm.cli.shared.output import console, print_json, print_table, table
from robophm.cli.shared.unused import refuse_unused
from robophm.core.errors import ModelError
from robophm.core.units import in_unit
from robophm.hazard.handbooks import handbook_model, handbook_models
from robophm.hazard.model import Assumed, Choice, Model, Range
from robophm.report.words import number_text


def command(
    model: Annotated[str | None, typer.Argument(help="e.g. mil_hdbk_217f.capacitor; none lists them")] = None,
    set_: Annotated[
        list[str] | None, typer.Option("--set", metavar="INPUT=VALUE", help="e.g. temperature='60 degC'")
    ] = None,
    explain: Annotated[
        bool, typer.Option("--explain", help="show every input, what is assumed, and every factor")
    ] = False,
    unit: Annotated[
        str | None, typer.Option(help="of the rate: FIT, FPMH, 1/h, or '/10^6 cycle' of a rate per cycle")
    ] = None,
    as_json: Json = False,
) -> None:
    """The hazard rate that a handbook gives for a part."""
    out = console()
    if model is None:
        refuse_unused("the list of models", ())
        models = [(name, handbook_model(name)) for name in handbook_models()]
        if as_json:
            print_json({"models": [{"name": n, "formula": m.formula, "source": str(m.source)} for n, m in models]})
        else:
            rows = [(n, m.formula, str(m.source)) for n, m in models]
            print_table(out, table("Hazard models", ("model", "formula", "source"), rows))
        return
    chosen = handbook_model(model)
    given = {}
    for pair in set_ or []:
        name, equals, value = (word.strip() for word in pair.partition("="))
        if not equals:
            raise ModelError(f"--set {pair}: expected INPUT=VALUE")
        if name in given:
            raise ModelError(f"--set {pair}: '{name}' is given twice")
        given[name] = value
    if unit is not None:
        in_unit(0.0, chosen.unit, unit)
    if not given and any(
        getattr(entry, "required", True) and entry.default is None for entry in chosen.inputs.values()
    ):
        refuse_unused(f"what {chosen.name} takes", ("model",))
        takes = [
            (name, chosen.expected(name), "" if e.default is None else str(e.default), e.description)
            for name, e in chosen.inputs.items()
        ]
        if as_json:
            keys = ("name", "expected", "default", "description")
            print_json({"model": chosen.name, "unit": chosen.unit, "formula": chosen.formula,
                        "source": str(chosen.source),
                        "inputs": [dict(zip(keys, row, strict=True)) for row in takes]})  # fmt: skip
            return
        out.print(f"{chosen.name}: {chosen.formula}\n{chosen.source}", markup=False)
        for name, expected, default, description in takes:
            out.print(
                f"  {name}: {description}; {expected}" + (f"; default {default}" if default else ""),
                markup=False,
            )
        return
    refuse_unused("a hazard rate", ("model", "set_", "explain", "unit"))
    inputs = chosen.settle(given)
    taken = [f"{name} '{word}' is taken as {inputs[name]}" for name, word in given.items()
             if isinstance(chosen.inputs[name], Choice) and inputs[name] != word]  # fmt: skip
    result = chosen.explain(inputs)
    rate = float(np.asarray(result.value))
    answer = rate if unit is None else in_unit(rate, chosen.unit, unit)
    assumed = chosen.assumed(given, inputs)
    factors = [(f.symbol, float(np.asarray(f.value)), f.note) for f in result.leaves()]
    if as_json:
        listed = [{"symbol": s, "value": v, "note": n} for s, v, n in factors]
        units = {n: e.unit for n, e in chosen.numbers.items()}
        print_json({"model": chosen.name, "inputs": inputs, "units": units,
                    "assumed": {name: asdict(one) for name, one in assumed.items()},
                    "hazard_rate": answer, "unit": unit or chosen.unit,
                    "formula": chosen.formula, "source": str(chosen.source), "factors": listed})  # fmt: skip
        return
    shown = (unit or chosen.unit).removeprefix("1")
    out.print(f"{chosen.name}: {number_text(answer)} {shown}", markup=False)
    for note in taken:
        out.print(note, markup=False)
    if explain:
        out.print(f"{chosen.formula}\n{chosen.source} ({chosen.source.status})", markup=False)
        for line in _inputs(chosen, inputs, assumed):
            out.print(f"  {line}", markup=False)
        for symbol, number, note in factors:
            out.print(f"  {symbol:<6} {number:<12.6g} {note}", markup=False)


def _inputs(model: Model, inputs: Mapping[str, str | float], assumed: Mapping[str, Assumed]) -> Iterator[str]:
    """What the rate is of, input by input, and which of it nobody said."""
    width = max(map(len, model.inputs), default=0)
    for name, entry in model.inputs.items():
        if name not in inputs and name not in assumed:
            continue  # this choice of others does not use it
        value = assumed[name].value if name in assumed else inputs[name]
        text = entry.written(value) if isinstance(entry, Range) and isinstance(value, float | int) else value or "–"
        yield f"{name:<{width}}  {text}" + (f"   assumed: {assumed[name].why}" if name in assumed else "")
