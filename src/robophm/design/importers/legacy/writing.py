"""Blocks of the 2020 tool's file as the text of a design, each with the remarks on what is odd in it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from robophm.design.importers.legacy.blocks import Block, Drawing
from robophm.design.naming import printable, quoted


def design_lines(system: Block, source: str) -> Iterator[str]:
    """The lines of the design file."""
    yield f"# Made of {source:.80} by `robophm import-legacy`; lines named below are that file's,"
    yield "# and so are the rates: per hour, already multiplied by quantity."
    yield from _remarks(system, "")
    yield "schema_version: 1"
    yield f"name: {quoted(system.name)}"
    yield ""
    yield "# What the 2020 tool does with temperature: twice the rate for every 10 K above 25 °C. Bind it by"
    yield "# signals: {temperature: {topic: /power/temperature, field: temperature, unit: degC, range: [-40, 125]}}"
    yield "acceleration: {model: q10, reference_temperature: 25 degC, q: 2}"
    yield ""
    yield from _members(system, "")


def _members(level: Block, pad: str) -> Iterator[str]:
    kept = [member for member in level.members.values() if member.fails]
    modules = [member for member in kept if member.drawing is not None]
    components = [member for member in kept if member.drawing is None]
    if modules:
        yield f"{pad}modules:"
    for module in modules:
        yield f"{pad}  {quoted(module.name)}:  # line {module.line}"
        yield from _remarks(module, f"{pad}    ")
        yield from _members(module, f"{pad}    ")
    if components:
        yield f"{pad}components:"
    for component in components:
        yield from _remarks(component, f"{pad}  ")
        by = f", by the formula {component.formula:.100} (not evaluated)" if component.formula else ""
        yield f"{pad}  {quoted(component.name)}: {{rate: {component.stored!r} /h}}  # line {component.line}{by}"
    for member in level.members.values():
        if not member.fails:
            yield f"{pad}# Left out: {printable(member.place)}, line {member.line}"
            yield from _remarks(member, pad)
    drawing = level.drawing
    if drawing and not (drawing.kind == "series" and drawing.parts() == len(drawing.blocks) == len(kept)):
        names = {name: member.name for name, member in level.members.items()}
        yield f"{pad}diagram:" + (f"  # {printable(level.drawn_from)}" if level.drawn_from else "")
        yield from _diagram(drawing, names, f"{pad}  ")


def _remarks(block: Block, pad: str) -> Iterator[str]:
    yield from (f"{pad}# {finding.text}" for finding in block.findings)


def _diagram(drawing: Drawing, names: Mapping[str, str], pad: str) -> Iterator[str]:
    yield f"{pad}{drawing.kind}:"
    for block in drawing.blocks:
        if isinstance(block, str):
            yield f"{pad}  - {quoted(names[block])}"
        else:
            lines = list(_diagram(block, names, f"{pad}    "))
            yield f"{pad}  - {lines[0].strip()}"
            yield from lines[1:]
