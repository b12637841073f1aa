"""``robophm fleet roll-back``: a person undoes a proposal that was accepted."""

from __future__ import annotations

from robophm.cli.shared.fleet import FleetStorePath
from robophm.cli.shared.options import Design, Json
from robophm.cli.shared.proposed import By, Number, decided
from robophm.fleet.proposals import ROLLED_BACK


def command(number: Number, design: Design, store: FleetStorePath, by: By, as_json: Json = False) -> None:
    """Undo a proposal that was accepted: put the design before it into the file, and keep who did."""
    decided(number, design, store, by, ROLLED_BACK, as_json=as_json)
