"""A fitted life as a design says it: its mean as a rate, its shape, how sure it is, and what speeds it up."""

from __future__ import annotations

import math
from pathlib import Path

from robophm.core.errors import DataError
from robophm.design.file import load, read
from robophm.design.naming import quoted
from robophm.design.robot import CLOCK_UNITS, FailureMode
from robophm.learning.failure_mode_edits import edited, named_mode
from robophm.learning.life_data.distribution_fitting import FAMILIES, UNKNOWN, Fit
from robophm.learning.life_data.life_stress import LAWS, LifeStressFit
from robophm.parts import FIGURES

_REFERENCES = {"temperature": "degC", "voltage": "V", "temperature_swing": "K"}


def design_keys(found: Fit | LifeStressFit, mode: FailureMode | None = None) -> dict[str, str | None]:
    """The keys of a failure mode that say a fitted life; None for those that give way.

    Raises DataError where a design cannot say it, or where the mode ages on another clock than the data count.
    """
    unit = found.data.unit
    if not unit:
        raise DataError(f"{found.data.source}: states no unit of life; expected it in the heading, e.g. 'time [h]'")
    if mode is not None and CLOCK_UNITS[mode.clock] != unit:
        raise DataError(
            f"'{mode.path}' ages by {CLOCK_UNITS[mode.clock]} ({mode.clock} clock), but {found.data.source} counts "
            f"{unit}; expected another clock in the design, or lives in its unit"
        )
    mean = found.life.mean()
    if not 0 < mean < math.inf:
        raise DataError(f"a {found.name} of these parameters has no mean life, so that a design has no rate for it")
    if mean > found.known_until:
        raise DataError(
            f"a {found.name} life whose mean would lie beyond {found.known_until:g} {unit}, {UNKNOWN:g} times the "
            "longest time seen, is not known; expected another distribution, or longer lives"
        )
    family = FAMILIES[found.name]
    scale = found.life.scale_parameter
    shape = {
        name: f"{one.value:.6g}{f' {unit}' if found.life.dimensions[name] == 1 else ''}"
        for name, one in found.parameters.items()
        if name != scale
    }
    keys: dict[str, str | None] = {"rate": f"{1 / mean:.6g} /{unit}"}
    if family.ours == "exponential":
        keys["life"] = "{distribution: exponential}"
    else:
        keys["life"] = "{" + ", ".join([f"distribution: {family.ours}", *(f"{k}: {v}" for k, v in shape.items())]) + "}"
    median = found.quantiles[0.5]
    spread = math.log(median.high / median.low) / (2 * _z(found.level)) if median.low > 0 else math.nan
    keys["uncertainty"] = f"{{failures: {1 / spread**2:.4g}}}" if spread > 0 else None
    keys["source"] = quoted(f"{found.data.source.rpartition('/')[2]}: {found.data.described()}")
    if isinstance(found, LifeStressFit):
        keys["acceleration"] = _acceleration(found)
    return keys | dict.fromkeys([key for key in (*FIGURES, "hazard", "learned") if key not in keys])


def edited_design(found: Fit | LifeStressFit, design: Path, part: str) -> str:
    """The text of a design file with this life of a part, or failure mode, by its path; nothing is written.

    Raises DesignError where there is no such part, and DataError as ``design_keys``.
    """
    mode = named_mode(load(design), part)
    return edited(read(design), str(design), {mode.path: design_keys(found, mode)})


def snippet(found: Fit | LifeStressFit) -> list[str]:
    """The same as lines to be put into a design."""
    return [f"{key}: {value}" for key, value in design_keys(found).items() if value is not None]


def _acceleration(found: LifeStressFit) -> str:
    texts = []
    temperature = found.laws.get("temperature")
    if set(found.laws) == {"temperature", "humidity"} and temperature == "arrhenius":
        values = {
            "model": "peck",
            "activation_energy": f"{found.coefficients['temperature'].value:.6g} eV",
            "exponent": f"{found.coefficients['humidity'].value:.6g}",
            "reference_temperature": f"{found.reference['temperature']:g} degC",
            "reference_humidity": f"{found.reference['humidity']:g} percent",
        }
        return "{" + ", ".join(f"{key}: {value}" for key, value in values.items()) + "}"
    for stress, law in found.laws.items():
        one = found.coefficients[stress]
        model = LAWS[law].acceleration
        if stress == "temperature_swing":
            model = "coffin_manson"
        elif law == "inverse_power" and stress != "voltage":
            raise DataError(
                f"a design knows no power law of '{stress}'; expected voltage, humidity with temperature, "
                "temperature_swing, or a `hazard` by your own formula"
            )
        if one.value <= (1 if law == "q10" else 0):
            raise DataError(f"life grows with {stress}, which is no acceleration")
        unit = f" {LAWS[law].unit}" if LAWS[law].unit else ""
        texts.append(
            f"{{model: {model}, {LAWS[law].coefficient}: {one.value:.6g}{unit}, "
            f"reference_{stress}: {found.reference[stress]:g} {_REFERENCES[stress]}}}"
        )
    return texts[0] if len(texts) == 1 else f"[{', '.join(texts)}]"


def _z(level: float) -> float:
    from scipy.special import ndtri

    return float(ndtri((1 + level) / 2))
