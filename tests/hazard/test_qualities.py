"""Today's circuits and qualities by ANSI/VITA 51.1, as a public account of it states its values."""

import json
from pathlib import Path

import pytest

from robophm.core.errors import ModelError
from robophm.design.file import parse
from robophm.hazard.answer import answer
from robophm.hazard.handbooks import handbook_model
from robophm.hazard.qualities import QUALITIES, level, quality

DATA = Path(__file__).parents[1] / "data"
VITA = json.loads((DATA / "vita_51_1.json").read_text(encoding="utf-8"))
MIL = "mil_hdbk_217f."
CHIP = {"package": "BGA", "pins": 64, "power": "0 W", "years_in_production": "2 year", "environment": "GB"}
KINDS = {
    "linear": ("linear", "transistors", "", {}),
    "programmable_bipolar": ("programmable", "gates", "", {"family": "TTL"}),
    "programmable_MOS": ("programmable", "gates", "", {"family": "CMOS"}),
    "processor_bipolar": ("processor", "bits", " bit", {"family": "TTL"}),
    "processor_MOS": ("processor", "bits", " bit", {"family": "CMOS"}),
}


def factor(model, given, symbol):
    return next(one.value for one in answer(handbook_model(MIL + model), given).factors if one.symbol == symbol)


@pytest.mark.parametrize(("kind", "limit"), [(kind, limit) for kind, row in VITA["c1"].items() for limit in row])
def test_dies_beyond_the_handbook(kind, limit):
    memory = {"style": kind} | ({"programming_cycles": "0 cycle"} if "EEPROM" in kind else {})
    model, name, unit, more = KINDS.get(kind, ("memory", "bits", " bit", memory))
    assert factor(f"microcircuit.{model}", {**CHIP, **more, name: f"{limit}{unit}"}, "C1") == VITA["c1"][kind][limit]


def test_flash_is_a_flotox_eeprom_and_many_pins_go_on_by_the_equation():
    flash = {**CHIP, "style": "flash", "bits": "8 Mbit", "programming_cycles": "0 cycle"}
    assert factor("microcircuit.memory", flash, "C1") == 0.0272  # 8 Mbit are more than 4 · 2^20
    many = {**CHIP, "family": "CMOS", "bits": "64 bit", "pins": 900}
    assert factor("microcircuit.processor", many, "C2") == pytest.approx(3.6e-4 * 900**1.08, rel=1e-12)


@pytest.mark.parametrize("part", VITA["quality"])
def test_known_pedigree(part):
    """πQ of each model's own level that the words are taken as."""
    name, _, style = part.partition(":")
    model = handbook_model(MIL + name)
    known = level(model, "known pedigree", {"style": style} if style else {})
    assert model.inputs["quality"].options[known] == VITA["quality"][part]


def test_what_the_rules_say_nothing_of_keeps_its_own_level():
    assert level(handbook_model(f"{MIL}coil"), "known pedigree", {}) is None
    assert level(handbook_model(f"{MIL}fuse"), "commercial", {}) is None
    assert level(handbook_model(f"{MIL}coil"), "military", {}) == "MIL-SPEC"


def test_the_quality_of_a_board_is_inherited_and_the_parts_own_wins():
    def rates(text):
        part = "hazard: {model: mil_hdbk_217f.microcircuit.linear, inputs: {transistors: 100, package: SO, pins: 8, "
        part += "power: 0 W, years_in_production: 2 year%s}}"
        more = f"{{A: {{{part % ''}}}, B: {{{part % ', quality: commercial'}}}}}"
        head = f"schema_version: 1\nname: R\nenvironment: GM\n{text}"
        return {mode.path: mode.rate for mode in parse(f"{head}components: {more}\n").modes}

    plain, said = rates(""), rates("quality: Known pedigree\n")
    assert plain["A"] == plain["B"] == said["B"]
    assert said["A"] == pytest.approx(plain["A"] / 10, rel=1e-12)  # πQ 10 and 1


def test_words_of_a_board():
    assert quality(" Known-Pedigree ") == "known pedigree"
    assert set(QUALITIES) == {"commercial", "known pedigree", "military", "unknown"}
    with pytest.raises(ModelError, match=r"'comercial' is no quality of a whole board; did you mean 'commercial'"):
        quality("comercial")
    found = answer(
        handbook_model(f"{MIL}filter"), {"style": "discrete-LC", "quality": "known pedigree", "environment": "GM"}
    )
    assert found.taken == {"quality": "MIL-SPEC"}
