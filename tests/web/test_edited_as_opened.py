"""What an edited design is said to be is what it is said to be when it is opened anew, to the last bit."""

from __future__ import annotations

import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from robophm.core.errors import DesignError
from robophm.web.drawing import drawing
from robophm.web.routes.design import apply
from robophm.web.service import Service, Settings
from robophm.web.shapes import Edits

from .conftest import OTA, ROOT

ARM = ROOT / "examples" / "arm" / "robot.yaml"

DEPENDENT = """\
schema_version: 1
name: dependent
environment: ground_mobile
modules:
  supply:
    components:
      battery: {quantity: 2, required: 1, rate: 5 FPMH}
      fuse: {rate: 40 FIT}
  drive:
    depends_on: supply
    signals: {temperature: {topic: /drive/temperature, field: data, range: [-20, 90]}}
    common_causes: {heat: {of: [left, right], beta: 0.1}}
    diagram: {series: [{parallel: [left, right]}, hub]}
    components:
      left: {rate: 8 FPMH, acceleration: {model: q10, reference_temperature: 40 degC}}
      right: {rate: 8 FPMH, acceleration: {model: q10, reference_temperature: 40 degC}}
      hub: {rate: unknown}
  see:
    diagram: {standby: {of: [lidar, spare], dormancy: 0.1}}
    components:
      lidar: {l10: 20000 h}
      spare: {rate: 30 FPMH}
      frame: {rate: 1 FIT}
"""

VALUES: dict[str, tuple[object, ...]] = {
    "rate": ("3 FPMH", "12 FIT", "0 FIT", "unknown", 1, True, 1.0, "1e-6 /h"),
    "quantity": (1, 2, 3, 0),
    "required": (1, 2),
    "life": ({"distribution": "weibull", "shape": 1.5}, {"distribution": "exponential"}),
    "identity": ("kept", "kept too"),
    "monitored": (True, False),
    "duty": (0.5, 1),
    "environment": ("ground_fixed", "naval_sheltered"),
    "quality": ("unknown",),
    "ambient": ("30 degC", "60 degC"),
    "acceleration": ({"model": "q10", "reference_temperature": "20 degC"}, "none"),
    "uncertainty": ({"error_factor": 2},),
    "signals": ({"temperature": {"topic": "/t", "field": "data", "range": [0, 80]}}, {"load": {"topic": "/l"}}),
    "offsets": ({"temperature": "5 K"}, {"load": 1}),
    "thresholds": ({"hazard_rate": "1 FPMH"},),
    "description": ("as seen",),
    "usage": ({"operating": 0.5}, {"cycles": "10 cycle/h"}),
    "task": ({"duration": "2 h"}, {"distance": "1 km", "speed": "1 m/s"}),
}


def levels(document: Any, place: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Any]]:
    yield place, document
    for name, module in (document.get("modules") or {}).items():
        if isinstance(module, dict):
            yield from levels(module, (*place, "modules", name))


def edit(document: Any, chance: random.Random) -> dict[str, Any]:
    """One edit of any kind, which may be a mistake."""
    every = list(levels(document))
    place, level = chance.choice(every)
    parts = [(*place, "components", name) for name in level.get("components") or {}]
    part = chance.choice(parts) if parts else place
    here = chance.choice((part, part, part, place))
    members = chance.sample([one[-1] for one in parts], min(len(parts), 2))
    match chance.choice(("put", "put", "put", "add", "delete", "key", "rename", "move", "group", "ungroup", "wire")):
        case "put":
            key = chance.choice(list(VALUES))
            return {"op": "put", "path": [*here, key], "value": chance.choice(VALUES[key])}
        case "add":
            name = f"new {chance.randrange(9)}"
            return {"op": "put", "path": [*place, "components", name], "value": {"rate": "7 FIT"}}
        case "delete" if here:
            return {"op": "delete", "path": list(here)}
        case "rename" if here:
            return {"op": "rename", "path": list(here), "name": f"other {chance.randrange(9)}"}
        case "move" if here:
            return {"op": "move", "path": list(here), "to": list(chance.choice(every)[0])}
        case "group" if len(members) == 2:
            kind = chance.choice(("series", "parallel", "k_of_n", "standby", "load_sharing"))
            return {"op": "group", "path": list(place), "members": members, "kind": kind, "k": 1}
        case "ungroup" if members:
            return {"op": "ungroup", "path": list(place), "members": members}
        case "wire":
            return {"op": "wire", "path": list(place), "diagram": None}
        case _:
            key = chance.choice(
                [one for one in document if one not in ("schema_version", "name", "modules")] or ["task"]
            )
            return {"op": "delete", "path": [key]}


def step(service: Service, chance: random.Random) -> None:
    """An edit, an undo or a redo; one that cannot be made leaves all as it is."""
    workspace = service.workspace
    checked = workspace.checked.of(workspace.draft().text)
    revision, document = workspace.revision, checked.document
    way = chance.random()
    try:
        if way < (0.12 if checked.robot else 0.6):  # mistakes are mended more often than made worse
            workspace.undo(revision)
        elif way < 0.16:
            workspace.redo(revision)
        else:
            (one,) = Edits.model_validate({"revision": revision, "operations": [edit(document, chance)]}).operations
            put = (one.path, one.value) if one.op == "put" and chance.random() < 0.5 else None
            workspace.edit(revision, lambda values: apply(values, one), one.op, put)
    except DesignError:
        pass


def said(service: Service) -> list[object]:
    """All that the page is told of a design, and all that its robot is."""
    state = service.design_state().model_dump(mode="json")
    told = [{key: state[key] for key in ("name", "document", "valid", "problems", "levels", "unknown")}]
    try:
        prepared, drawn = service.to_draw()
    except DesignError as error:
        return [*told, str(error)]
    shown = [drawing(prepared, drawn, path, 1000.0, "1/h").model_dump() for path in prepared.modules]
    robot = prepared.robot
    return [
        *told, *shown, *map(repr, robot.all_components()), repr(robot.diagram), repr(robot.functions),
        robot.design_hash, robot.warnings, robot.notes,
    ]  # fmt: skip


@pytest.mark.parametrize("seed", [2, *(pytest.param(seed, marks=pytest.mark.full) for seed in range(3, 12))])
@pytest.mark.parametrize("begun", ["ota", *(pytest.param(one, marks=pytest.mark.full) for one in ("arm", "dependent"))])
def test_edited_as_opened(tmp_path: Path, begun: str, seed: int) -> None:
    chance = random.Random(f"{begun} {seed}")
    path = tmp_path / "robot.yaml"
    path.write_text(DEPENDENT if begun == "dependent" else {"ota": OTA, "arm": ARM}[begun].read_text())
    edited = Service(Settings(path))
    seen, valid = {edited.workspace.draft().text}, 0
    for i in range(12):
        step(edited, chance)
        text = edited.workspace.draft().text
        if text in seen:
            continue
        seen.add(text)
        anew = tmp_path / str(i) / "robot.yaml"
        anew.parent.mkdir()
        anew.write_text(text)
        opened = Service(Settings(anew))
        assert said(edited) == said(opened), text
        valid += opened.design_state().valid
        opened.close()
    edited.close()
    assert len(seen) > 3
    assert valid
