"""The reference, made of the code: commands, the Python interface, the fields of the design file."""

from __future__ import annotations

import inspect
import json
import re
from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import Any

import typer
from typer.cli import get_docs_for_click

import robophm
from robophm.cli.app import GROUPS, app
from robophm.design.schema import json_schema


def commands() -> str:
    """All commands with their options, grouped as their help is."""
    group = typer.main.get_command(app)
    context = typer.Context(group, info_name="robophm")
    parts = ["# Commands\n\nMade of the commands' own help, `robophm COMMAND --help`.\n"]
    for purpose, names in GROUPS.items():
        parts.append(f"## {purpose}\n")
        for name in names:
            command = group.get_command(context, name)  # type: ignore[attr-defined]
            command.name = name
            parts.append(get_docs_for_click(obj=command, ctx=context, indent=2, name=name, call_prefix="robophm"))
    return "\n".join(parts)


def api() -> str:
    """The public names of ``robophm`` with their signatures and docstrings."""
    parts = ["# Python\n\nThe public names of `robophm` and what they do. [Examples](../guides/python.md).\n"]
    for name in robophm.__all__:
        value = getattr(robophm, name)
        parts.append(f"## {name}\n\n{_signed(name, value)}{_text(value)}\n")
        if inspect.isclass(value):
            parts += [f"### {name}.{one}\n\n{said}\n" for one, said in _members(value)]
    return "\n".join(parts)


def _members(kind: type) -> Iterator[tuple[str, str]]:
    for name, value in vars(kind).items():
        if name.startswith("_"):
            continue
        if isinstance(value, property | cached_property):
            function = value.fget if isinstance(value, property) else value.func
            yield name, _text(function)
        elif inspect.isroutine(value) or isinstance(value, classmethod | staticmethod):
            function = getattr(value, "__func__", value)
            yield name, _signed(name, function) + _text(function)


def _signed(name: str, value: Any) -> str:
    try:
        signature = str(inspect.signature(value))
    except (TypeError, ValueError):
        return ""
    return f"```python\n{name}{signature}\n```\n\n"


def _text(value: Any) -> str:
    """A docstring in Markdown: its code in single ticks, its examples as blocks."""
    text = (inspect.getdoc(value) or "").replace("``", "`")
    return re.sub(r"((?:^(?:>>>|\.\.\.) .*\n?)+)", r"```python\n\1\n```\n", text, flags=re.M)


def design_file() -> str:
    """Every field of the design file, by the JSON Schema that editors and the engine use."""
    whole = json_schema()
    parts = [
        "# Fields of the design file\n\nMade of the JSON Schema, `robophm schema`. With examples: "
        "[the design file](design-file.md).\n",
        _object("Robot", whole),
        *(_object(name, one) for name, one in sorted(whole["$defs"].items())),
    ]
    return "\n".join(parts)


def _object(name: str, one: Mapping[str, Any]) -> str:
    if "properties" not in one:
        return f"## {name}\n\n{one.get('description', '')}\n\nTakes {_kind(one)}.\n"
    needed = set(one.get("required", ()))
    rows = [
        f"| `{field}` | {_kind(about)} | {_default(field, about, needed)} | {_cell(_description(about))} |"
        for field, about in one["properties"].items()
    ]
    head = ["| field | takes | default | meaning |", "|---|---|---|---|"]
    return "\n".join([f"## {name}", "", one.get("description", ""), "", *head, *rows, ""])


def _default(field: str, about: Mapping[str, Any], needed: set[str]) -> str:
    if field in needed:
        return "required"
    default = about.get("default")
    return "" if default is None or default in ({}, []) else f"`{json.dumps(default)}`"


def _description(about: Mapping[str, Any]) -> str:
    said = [about.get("description"), *(one.get("description") for one in about.get("anyOf", ()))]
    return next((one for one in said if one), "")


def _kind(about: Mapping[str, Any]) -> str:
    """What a field takes, in words."""
    if "$ref" in about:
        name = about["$ref"].rpartition("/")[2]
        return f"[{name}](#{name.lower()})"
    if "enum" in about:
        return ", ".join(f"`{one}`" for one in about["enum"])
    if "const" in about:
        return f"`{about['const']}`"
    if some := about.get("anyOf") or about.get("oneOf"):
        return " or ".join(dict.fromkeys(_kind(one) for one in some if one.get("type") != "null"))
    kinds = about.get("type", "anything")
    if kinds == "array":
        return f"list of {_kind(about.get('items', {}))}"
    if kinds == "object":
        inside = about.get("additionalProperties")
        return f"names with {_kind(inside)}" if isinstance(inside, dict) else "names with values"
    return " or ".join(kinds) if isinstance(kinds, list) else str(kinds)


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|").replace("<", "&lt;")
