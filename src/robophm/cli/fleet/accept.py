"""``robophm fleet accept``: a person takes a proposal."""

from __future__ import annotations

from robophm.cli.shared.fleet import FleetStorePath
from robophm.cli.shared.options import Design, Json
from robophm.cli.shared.proposed import By, Number, decided
from robophm.fleet.proposals import ACCEPTED


def command(number: Number, design: Design, store: FleetStorePath, by: By, as_json: Json = False) -> None:
    """Take a proposal: put its design into the file, and keep who did."""
    decided(number, design, store, by, ACCEPTED, as_json=as_json)
