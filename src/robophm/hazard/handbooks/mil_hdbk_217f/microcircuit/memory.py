"""MIL-HDBK-217F(2) §5.2, memories:  λp = (C1 · πT + C2 · πE + λcyc) · πQ · πL   failures/10⁶ h

Up to 1 Mbit; 256 Mbit by ANSI/VITA 51.1, which takes flash memories for Flotox EEPROMs.
λcyc = (A1 · B1 + A2 · B2 / πQ) · πECC is the programming of EEPROMs, and 0 for all others.
A1 and A2 are taken from the printed bands, as the handbook's worked example does, not from the equation beside them.
That they grow with the life of the system is from one transcription; one would expect the inverse.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from robophm.core.errors import ModelError
from robophm.core.table import Source, Table, band
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, handbook_arrhenius, per_million_hours, steps
from robophm.hazard.handbooks.mil_hdbk_217f.microcircuit import (
    CASE,
    COMMON,
    EXTENDED,
    POWER,
    RESISTANCE,
    STATUS,
    VITA,
    environment_factor,
    junction_temperature,
    learning_factor,
    package_factor,
    quality_factor,
    temperature_factor,
)
from robophm.hazard.model import Array, Choice, Factor, Range, hazard_model

SOURCE = Source(
    TITLE,
    "5.2",
    "5-20 f. (example)",
    f"{STATUS}; {EXTENDED}; Flotox checked against a worked example; that an EEPROM of unknown kind is Flotox is from "
    "memory; that λcyc grows with the life of the system, by 10,000 h, is from a single transcription, and the inverse "
    "would be expected of physics",
)

STYLE = Table("memory C1 by bits, up to", SOURCE, """
    MOS-ROM              0.00065  0.0013   0.0026   0.0052
    MOS-PROM             0.00085  0.0017   0.0034   0.0068
    MOS-UVPROM           0.00085  0.0017   0.0034   0.0068
    MOS-EEPROM-flotox    0.00085  0.0017   0.0034   0.0068
    MOS-EEPROM-textured  0.00085  0.0017   0.0034   0.0068
    MOS-EAPROM           0.00085  0.0017   0.0034   0.0068
    MOS-DRAM             0.0013   0.0025   0.0050   0.010
    MOS-SRAM             0.0078   0.016    0.031    0.062
    bipolar-ROM          0.0094   0.019    0.038    0.075
    bipolar-PROM         0.0094   0.019    0.038    0.075
    bipolar-SRAM         0.0052   0.011    0.021    0.042
""", columns=("16384", "65536", "262144", "1048576"))  # fmt: skip

MORE = Table("memory C1 by bits, up to, extended", VITA, """
    MOS-ROM              0.0104   0.0208   0.0416   0.0832
    MOS-PROM             0.0136   0.0272   0.0544   0.1088
    MOS-UVPROM           0.0136   0.0272   0.0544   0.1088
    MOS-EEPROM-flotox    0.0136   0.0272   0.0544   0.1088
    MOS-EEPROM-textured  0.0136   0.0272   0.0544   0.1088
    MOS-EAPROM           0.0136   0.0272   0.0544   0.1088
    MOS-DRAM             0.020    0.040    0.080    0.160
    MOS-SRAM             0.124    0.248    0.496    0.992
    bipolar-ROM          0.150    0.300    0.600    1.20
    bipolar-PROM         0.150    0.300    0.600    1.20
    bipolar-SRAM         0.084    0.168    0.336    0.672
""", columns=("4194304", "16777216", "67108864", "268435456"))  # fmt: skip

_BANDS = tuple(float(bits) for bits in (*STYLE.columns, *MORE.columns))

CYCLING = Table("EEPROM A1, A2 by programming cycles over its life, up to", SOURCE, """
    0       0        0       0
    100     0.00070  0.0097  0
    200     0.0014   0.014   0
    500     0.0034   0.023   0
    1000    0.0068   0.033   0
    3000    0.020    0.061   0
    7000    0.049    0.14    0
    15000   0.10     0.30    0
    20000   0.14     0.30    0
    30000   0.20     0.30    0
    100000  0.68     0.30    0
    200000  1.3      0.30    0
    300000  2.7      0.30    0
    400000  2.7      0.30    1.1
    500000  3.4      0.30    2.3
""", columns=("flotox A1", "textured A1", "textured A2"))  # fmt: skip

CORRECTION = Table("EEPROM πECC", SOURCE, """
    none       1.0   no error correction on the chip
    hamming    0.72  Hamming code on the chip
    redundant  0.68  two-needs-one redundant cell
""")  # fmt: skip

ACTIVATION_ENERGY = 0.6  # eV
SYSTEM_LIFE = 10_000.0  # h, of the printed A1 and A2


@hazard_model(
    source=SOURCE,
    inputs={
        "style": Choice(
            STYLE,
            "technology and kind",
            aliases={
                "rom": "MOS-ROM",
                "prom": "MOS-PROM",
                "eprom": "MOS-UVPROM",
                "eeprom": "MOS-EEPROM-flotox",
                "dram": "MOS-DRAM",
                "sdram": "MOS-DRAM",
                "sram": "MOS-SRAM",
                "flash": "MOS-EEPROM-flotox",
                "nvsram": "MOS-SRAM",
            },
        ),
        "bits": Range(1, 268435456, "bit", "size", whole=True, monotone=1),
        **COMMON,
        # textured-poly cells wear less when warm
        "case_temperature": replace(CASE, monotone=0),
        "thermal_resistance": replace(RESISTANCE, monotone=0),
        "power": replace(POWER, monotone=0),
        "programming_cycles": Range(
            0.0,
            5e5,
            "cycle",
            "times it is programmed in its life; EEPROMs need it",
            whole=True,
            required=False,
            monotone=1,
        ),
        "system_life": Range(
            1.0,
            1e6,
            "h",
            "operating hours of the system's life; A1 and A2 are scaled by it",
            default=SYSTEM_LIFE,
            monotone=1,
        ),
        "error_correction": Choice(CORRECTION, "error correction of an EEPROM", default="none"),
    },
)
def hazard_rate(
    style: str,
    bits: Array,
    package: str,
    die: str,
    pins: Array,
    power: Array,
    years_in_production: Array,
    quality: str,
    environment: str,
    system_life: Array,
    error_correction: str,
    case_temperature: Array | None = None,
    thermal_resistance: Array | None = None,
    screening_points: Array | None = None,
    programming_cycles: Array | None = None,
) -> Factor:
    """λp = (C1 · πT + C2 · πE + λcyc) · πQ · πL"""
    junction = junction_temperature(package, die, power, environment, case_temperature, thermal_resistance)
    quality_of_part = quality_factor(quality, screening_points)
    rate = (
        Factor("C1", band(bits, (*_BANDS[:-1], np.inf), (*STYLE.rows[style], *MORE.rows[style])), f"{style} by bits")
        * temperature_factor(junction, ACTIVATION_ENERGY)
    ) + package_factor(package, pins) * environment_factor(environment)
    if "EEPROM" in style:
        if programming_cycles is None:
            raise ModelError(
                f"mil_hdbk_217f.microcircuit.memory: {style} needs 'programming_cycles' (of its whole life)"
            )
        rate = rate + cycling_rate(
            style.rpartition("-")[2], bits, junction, programming_cycles, system_life, quality_of_part
        ) * Factor("πECC", CORRECTION[error_correction], CORRECTION.notes[error_correction])
    return rate * quality_of_part * learning_factor(years_in_production) * per_million_hours()


def cycling_rate(cell: str, bits: Array, junction: Array, cycles: Array, system_life: Array, quality: Factor) -> Factor:
    """λcyc but for πECC: A1 · B1, and for textured-poly cells A2 · B2 / πQ more."""
    life = np.asarray(system_life) / SYSTEM_LIFE
    bits = np.maximum(bits, 0.0)
    first = Factor("A1", steps(CYCLING, cycles, f"{cell} A1") * life, f"{cell} by cycles, times life / 10,000 h")
    if cell == "flotox":
        return first * Factor("B1", (bits / 16000) ** 0.5 * handbook_arrhenius(junction, 0.15, 333.0), "Ea = 0.15 eV")
    size = (bits / 64000) ** 0.25
    return first * Factor("B1", size * handbook_arrhenius(junction, 0.12, 303.0), "Ea = 0.12 eV") + (
        Factor("A2", steps(CYCLING, cycles, "textured A2") * life, "textured by cycles, times life / 10,000 h")
        * Factor("B2", size * handbook_arrhenius(junction, -0.1, 303.0), "Ea = -0.1 eV")
        * Factor("1/πQ", 1 / quality.value, "A2 B2 do not depend on quality")
    )
