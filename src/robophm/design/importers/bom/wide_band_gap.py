"""Semiconductors of gallium nitride and silicon carbide, told by words and by the beginnings of makers' part numbers.

A part of these that is named in neither way cannot be told from one of silicon.
"""

from __future__ import annotations

from robophm.design.importers.bom.kinds import MICROCIRCUITS, any_of
from robophm.design.importers.bom.wide_band_gap_series import (
    GAN_POWER_STAGES,
    GAN_TRANSISTORS,
    SIC_DIODES,
    SIC_TRANSISTORS,
)

TRANSISTORS = frozenset({"transistor", "fet", "bipolar transistor"})
DIODES = frozenset({"diode", "schottky diode", "rectifier"})

_GAN = any_of(rf"e?gan|e?gan ?(fets?|hemts?)|gallium ?nitride|{GAN_TRANSISTORS}|{GAN_POWER_STAGES}")
_SIC = any_of(rf"sic|sic ?(mos)?fets?|sil(icon)? ?carb(ide)?|{SIC_TRANSISTORS}|{SIC_DIODES}")
_GAN_POWER_STAGES = any_of(GAN_POWER_STAGES)
_STAGE_IN_WORDS = any_of(r"e?gan (integrated )?(power stages?|half[ -]?bridges?|power ics?|switch(es)?)")
_DRIVER = any_of(r"(gate ?)?drivers?")


def semiconductor(kind: str, words: str) -> str | None:
    """Return what a part of this kind is made of, "GaN" or "SiC"; None where nothing tells that it is not silicon.

    A circuit that only drives such transistors is of silicon itself; one that has them inside is a power stage.
    """
    if kind in TRANSISTORS | DIODES:
        return "GaN" if _GAN.search(words) and kind in TRANSISTORS else "SiC" if _SIC.search(words) else None
    if kind in MICROCIRCUITS:
        inside = _GAN_POWER_STAGES.search(words) or (_STAGE_IN_WORDS.search(words) and not _DRIVER.search(words))
        return "GaN" if inside else None
    return None
