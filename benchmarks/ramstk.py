"""RAMSTK, another program with the formulas of MIL-HDBK-217F, as a peer: parts that both know, and where they differ.

``python -m benchmarks.ramstk`` prints the differences. RAMSTK wants a graphical interface, a database and an old NumPy,
so only its formulas are imported, from a folder of their own (`make bench` puts them there), without the packages
around them: they need nothing but pubsub. Its capacitors, resistors, coils, relays, switches, connectors and boards are
those of the handbook before Notice 2; its crystals, fuses, lamps and filters fail with a TypeError.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from robophm.hazard.handbooks import handbook_model
from robophm.hazard.handbooks.mil_hdbk_217f.optoelectronic import KIND as OPTOELECTRONICS
from robophm.hazard.model import Model

FOLDER = Path(sys.prefix, "peers")
ENVIRONMENTS = ("GB", "GF", "GM", "NS", "NU", "AIC", "AIF", "AUC", "AUF", "ARW", "SF", "MF", "ML", "CL")
Part = tuple[Model, dict[str, Any], dict[str, Any]]
"""Our model and its settled inputs, and RAMSTK's attributes."""


def formulas() -> Callable[..., float] | None:
    """RAMSTK's active hazard rate of attributes [1/10⁶ h], or None where it is not there."""
    if not (FOLDER / "ramstk").is_dir():
        return None
    sys.path.append(str(FOLDER))
    for name in ("ramstk", "ramstk.analyses"):  # without what their __init__ brings
        package = ModuleType(name)
        package.__path__ = [str(FOLDER / name.replace(".", "/"))]
        sys.modules[name] = package
    found: Callable[..., float] = import_module("ramstk.analyses.milhdbk217f.milhdbk217f").do_predict_active_hazard_rate
    return found


BLANK = {
    "hazard_rate_method_id": 2, "hardware_id": 1, "type_id": 1, "application_id": 1, "construction_id": 1,
    "matching_id": 1, "package_id": 1, "quality_id": 1, "environment_active_id": 1, "frequency_operating": 1.0,
    "power_operating": 0.0, "power_rated": 1.0, "n_elements": 1, "temperature_case": 25.0, "theta_jc": 1.0,
    "voltage_ratio": 0.5, "current_operating": 1.0, "current_rated": 1.0, "power_ratio": 0.5, "duty_cycle": 50.0,
    "temperature_junction": 0.0, "n_active_pins": 1, "years_in_production": 2.0, "technology_id": 1, "family_id": 1,
}  # fmt: skip
"""Everything that its formulas look at."""
SEMICONDUCTOR_QUALITY = ("JANTXV", "JANTX", "JAN", "lower", "plastic")


def part(kind: str, given: Mapping[str, Any], category: int, subcategory: int, **attributes: Any) -> Part:
    model = handbook_model(f"mil_hdbk_217f.{kind}")
    environment = 1 + ENVIRONMENTS.index(given["environment"])
    ids = {"category_id": category, "subcategory_id": subcategory, "environment_active_id": environment}
    return model, dict(model.settle(given)), BLANK | ids | attributes


def parts(each: int, environments: Sequence[str] = ENVIRONMENTS[:11]) -> list[Part]:
    """Of seven kinds of which both have the formula, ``each`` parts, drawn from a fixed seed."""
    draw = np.random.default_rng(17)
    kinds = (_diode, _bipolar, _fet, _unijunction, _thyristor, _optoelectronic, _laser)
    return [kind(draw, str(draw.choice(environments))) for kind in kinds for _ in range(each)]


def _common(
    draw: np.random.Generator, environment: str, hottest: float = 120.0
) -> tuple[dict[str, Any], dict[str, Any]]:
    """A semiconductor's junction temperature, quality and environment, for us and for RAMSTK."""
    celsius, quality = round(draw.uniform(25.0, hottest), 1), int(draw.integers(5))
    given = {"temperature": f"{celsius} degC", "power": "0 W", "quality": SEMICONDUCTOR_QUALITY[quality]}
    given["environment"] = environment
    return given, {"temperature_case": celsius, "quality_id": quality + 1}


def _stress(draw: np.random.Generator) -> tuple[dict[str, str], dict[str, float]]:
    share = round(draw.uniform(0.05, 1.0), 3)
    return {"voltage": f"{share} V", "rated_voltage": "1 V"}, {"voltage_ratio": share}


def _diode(draw: np.random.Generator, environment: str) -> Part:
    (given, attributes), (volts, ratio) = _common(draw, environment), _stress(draw)
    kinds = {1: "general_purpose_analog", 2: "switching", 4: "power_rectifier_schottky", 6: "transient_suppressor"}
    kinds |= {7: "current_regulator", 8: "voltage_reference"}
    number = int(draw.choice(list(kinds)))
    kind = {"transient_suppressor": "transient_suppressor_varistor"}.get(kinds[number], kinds[number])
    bonded = int(draw.integers(2))
    given |= volts | {"kind": kind, "contact": ("bonded", "spring")[bonded]}
    return part("diode_low_frequency", given, 2, 1, type_id=number, construction_id=bonded + 1, **attributes, **ratio)


def _bipolar(draw: np.random.Generator, environment: str) -> Part:
    (given, attributes), (volts, ratio) = _common(draw, environment), _stress(draw)
    watts, application = round(draw.uniform(0.11, 20.0), 2), int(draw.integers(2))
    given |= volts | {"application": ("linear", "switching")[application], "rated_power": f"{watts} W"}
    return part(
        "transistor_bipolar_low_frequency", given, 2, 3, application_id=application + 1, power_rated=watts,
        **attributes, **ratio,
    )  # fmt: skip


def _fet(draw: np.random.Generator, environment: str) -> Part:
    given, attributes = _common(draw, environment)
    watts = round(draw.uniform(0.1, 300.0), 1)
    kind, application = int(draw.integers(2)), int(draw.integers(2))
    by_power = next((number for number, upto in ((3, 5), (4, 50), (5, 250)) if watts < upto), 6)
    given |= {
        "kind": ("MOSFET", "JFET")[kind], "application": ("linear", "switching")[application],
        "rated_power": f"{watts} W",
    }  # fmt: skip
    return part(
        "transistor_fet_low_frequency", given, 2, 4, type_id=kind + 1,
        application_id=application + 1 if watts < 2 else by_power, **attributes,
    )  # fmt: skip


def _unijunction(draw: np.random.Generator, environment: str) -> Part:
    given, attributes = _common(draw, environment)
    return part("transistor_unijunction", given, 2, 5, **attributes)


def _thyristor(draw: np.random.Generator, environment: str) -> Part:
    (given, attributes), (volts, ratio) = _common(draw, environment), _stress(draw)
    amperes = round(draw.uniform(0.5, 50.0), 1)
    given |= volts | {"rated_current": f"{amperes} A"}
    return part("thyristor", given, 2, 10, current_rated=amperes, **attributes, **ratio)


def _optoelectronic(draw: np.random.Generator, environment: str) -> Part:
    given, attributes = _common(draw, environment)
    number = int(draw.integers(len(OPTOELECTRONICS)))
    given |= {"kind": list(OPTOELECTRONICS)[number]}
    return part("optoelectronic", given, 2, 11, type_id=number + 1, **attributes)


def _laser(draw: np.random.Generator, environment: str) -> Part:
    given, attributes = _common(draw, environment, hottest=75.0)
    kind, amperes = int(draw.integers(2)), round(draw.uniform(0.01, 2.0), 3)
    share, percent = round(draw.uniform(0.1, 0.95), 3), int(draw.integers(1, 101))
    quality = int(draw.integers(3))
    given |= {
        "kind": ("GaAs_AlGaAs", "InGaAs_InGaAsP")[kind], "current": f"{amperes} A", "application": "pulsed",
        "duty": percent / 100, "required_optical_power": f"{share} W", "rated_optical_power": "1 W",
        "quality": ("hermetic", "nonhermetic_coated", "nonhermetic_uncoated")[quality],
    }  # fmt: skip
    attributes |= {"quality_id": quality + 1}
    return part(
        "laser_diode", given, 2, 13, type_id=kind + 1, current_operating=amperes, application_id=2,
        duty_cycle=percent, power_ratio=share, **attributes,
    )  # fmt: skip


def ours(model: Model, settled: Mapping[str, Any]) -> float:
    """Failures/10⁶ h."""
    return float(model.evaluate(settled).value) * 1e6


JUNCTION = {"temperature": "60 degC", "power": "0 W", "quality": "JANTX", "environment": "GM"}
HALF = {"voltage": "0.5 V", "rated_voltage": "1 V", "contact": "bonded"}
LINEAR = {
    "package": "SMT-plastic", "pins": 100, "power": "0 W", "case_temperature": "60 degC", "quality": "B",
    "years_in_production": "1 year", "environment": "GM",
}  # fmt: skip
AT_60 = {"temperature_case": 60.0, "quality_id": 2}
CHIP = AT_60 | {"package_id": 7, "n_active_pins": 100, "years_in_production": 1.0}
DIFFERENT: dict[str, Callable[[], Part]] = {
    "fast-recovery diode: λb 0.069 of before Notice 2, for 0.025": lambda: part(
        "diode_low_frequency", JUNCTION | HALF | {"kind": "fast_recovery_power_rectifier"}, 2, 1, type_id=3, **AT_60
    ),
    "high-voltage stack at half its voltage: πS 1": lambda: part(
        "diode_low_frequency", JUNCTION | HALF | {"kind": "high_voltage_stack", "junctions": 1},
        2, 1, type_id=5, **AT_60,
    ),
    "PIN diode of 5 W: πR 0.326 ln P − 0.25, for 0.5 up to 10 W": lambda: part(
        "diode_high_frequency", JUNCTION | {"kind": "pin", "rated_power": "5 W"},
        2, 2, type_id=4, power_rated=5.0, application_id=3, **AT_60,
    ),
    "diode array of 7 characters: λb of segments": lambda: part(
        "display", JUNCTION | {"kind": "diode_array", "characters": 7, "logic_chip": "without"},
        2, 12, n_elements=7, application_id=4, **AT_60,
    ),
    "linear circuit of 100 transistors: πT is 0.1 at 296 K, for 298": lambda: part(
        "microcircuit.linear", LINEAR | {"transistors": 100}, 1, 1, n_elements=100, **CHIP
    ),
    "linear circuit of 450 transistors: C1 of the nearest row, for the next": lambda: part(
        "microcircuit.linear", LINEAR | {"transistors": 450}, 1, 1, n_elements=450, **CHIP
    ),
    "linear circuit made for 10 years: πL goes on falling": lambda: part(
        "microcircuit.linear", LINEAR | {"transistors": 100, "years_in_production": "10 year"},
        1, 1, n_elements=100, **CHIP | {"years_in_production": 10.0},
    ),
}  # fmt: skip
"""Where the two are known to differ: what RAMSTK 0.19 takes, for what the handbook has."""


def main() -> int:
    peer = formulas()
    if peer is None:
        print(f"no RAMSTK in {FOLDER}; make bench puts it there")
        return 1
    print("| part | ours / RAMSTK |\n| --- | --- |")
    for why, made in DIFFERENT.items():
        model, settled, attributes = made()
        print(f"| {why} | {ours(model, settled) / peer(**attributes):.3g} |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
