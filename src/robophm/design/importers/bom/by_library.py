"""Parts of a list that no handbook rates and the library has: sensors in chips, gallium nitride, silicon carbide."""

from __future__ import annotations

from robophm.core.units import quantity
from robophm.design.importers.bom.parts import Recognised
from robophm.design.importers.bom.wide_band_gap import DIODES
from robophm.parts import Entry

BY_LIBRARY = ("mems_sensor_chip", "gan_transistor", "sic_transistor", "sic_diode")
"""The entries that parts of a list are rated as; each states one rate or mean life."""


def of_library(part: Recognised) -> tuple[str, str] | None:
    """The entry that a part is rated as, and why; None where a handbook has its kind."""
    if part.kind == "sensor chip":
        return "mems_sensor_chip", "no handbook has micromechanics"
    if "semiconductor" not in part.facts:
        return None
    if part.facts["semiconductor"] == "GaN":
        return "gan_transistor", "no handbook has gallium nitride power transistors"
    return "sic_diode" if part.kind in DIODES else "sic_transistor", "no handbook has silicon carbide"


def stated_rate(entry: Entry) -> float:
    """The hazard rate that an entry of ``BY_LIBRARY`` states [1/h]."""
    said = entry.part
    return float(quantity(said["rate"], "1/h") if "rate" in said else 1 / quantity(said["mtbf"], "h"))
