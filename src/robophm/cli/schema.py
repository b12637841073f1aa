"""``robophm schema``: the JSON Schema of the design file."""

from __future__ import annotations

import typer

from robophm.cli.shared.output import json_text
from robophm.design.schema import json_schema


def command() -> None:
    """Print the JSON Schema of the design file."""
    typer.echo(json_text(json_schema()))
