"""``robophm rate``: what a handbook's model takes, and the hazard rate that it gives."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from robophm.cli.output import console, print_json, print_table, table
from robophm.cli.unused import only
from robophm.core.errors import ModelError
from robophm.hazard.handbooks import handbook_model, handbook_models
from robophm.hazard.model import Choice
from robophm.report.words import number_text, rate_text


def run(model: str | None, said: Iterable[str], unit: str, *, explain: bool, as_json: bool) -> None:
    """List the models, say what one of them takes, or state the rate of what was said as INPUT=VALUE."""
    out = console()
    if model is None:
        only("the list of models", ())
        models = [(name, handbook_model(name)) for name in handbook_models()]
        if as_json:
            print_json({"models": [{"name": n, "formula": m.formula, "source": str(m.source)} for n, m in models]})
        else:
            rows = [(n, m.formula, str(m.source)) for n, m in models]
            print_table(out, table("Hazard models", ("model", "formula", "source"), rows))
        return
    chosen = handbook_model(model)
    given = {}
    for pair in said:
        name, equals, value = (word.strip() for word in pair.partition("="))
        if not equals:
            raise ModelError(f"--set {pair}: expected INPUT=VALUE")
        if name in given:
            raise ModelError(f"--set {pair}: '{name}' is given twice")
        given[name] = value
    if not given and any(
        getattr(entry, "required", True) and entry.default is None for entry in chosen.inputs.values()
    ):
        only(f"what {chosen.name} takes", ("model",))
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
    only("a hazard rate as JSON, in the model's unit" if as_json else "a hazard rate",
         ("model", "set_", "explain", *["unit"] * (not as_json)))  # fmt: skip
    inputs = chosen.settle(given)
    taken = [f"{name} '{word}' is taken as {inputs[name]}" for name, word in given.items()
             if isinstance(chosen.inputs[name], Choice) and inputs[name] != word]  # fmt: skip
    result = chosen.explain(inputs)
    answer = float(np.asarray(result.value))
    factors = [(f.symbol, float(np.asarray(f.value)), f.note) for f in result.leaves()]
    if as_json:
        listed = [{"symbol": s, "value": v, "note": n} for s, v, n in factors]
        units = {n: e.unit for n, e in chosen.numbers.items()}
        print_json({"model": chosen.name, "inputs": inputs, "units": units, "hazard_rate": answer, "unit": chosen.unit,
                    "formula": chosen.formula, "source": str(chosen.source), "factors": listed})  # fmt: skip
        return
    shown = rate_text(answer, unit) if chosen.unit == "1/h" else f"{number_text(answer)} {chosen.unit}"
    out.print(f"{chosen.name}: {shown}", markup=False)
    for note in taken:
        out.print(note, markup=False)
    if explain:
        out.print(f"{chosen.formula}\n{chosen.source} ({chosen.source.status})", markup=False)
        for symbol, number, note in factors:
            out.print(f"  {symbol:<6} {number:<12.6g} {note}", markup=False)
