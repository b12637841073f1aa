"""Series of parts and how their makers compose the numbers of them, as the "ordering codes" of data sheets say.

A row is a series; none is of one part.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import NamedTuple


class Series(NamedTuple):
    """A series of parts: a number that fits its pattern is of its kind, and the pattern's groups hold further facts."""

    kind: str
    pattern: re.Pattern[str]
    """Groups: size, tolerance, volts, dielectric, power; value, a code; ohms, a number with a letter for its point."""
    tables: Mapping[str, Mapping[str, str]]
    """The meaning of the characters of each group; a group without a table is taken as it is written."""
    facts: Mapping[str, str]
    """Facts that hold for every part of the series."""
    scale: float
    """The factor by which the number of the value's code is multiplied for the SI unit (F, ohm, H)."""


_METRIC = {
    "0402": "01005", "0603": "0201", "1005": "0402", "1608": "0603", "2012": "0805", "3216": "1206", "3225": "1210",
    "4532": "1812", "5025": "2010", "5750": "2220", "6432": "2512",
}  # fmt: skip
_EIA_VOLTS = {
    "0E": "2.5", "0G": "4", "0J": "6.3", "1A": "10", "1C": "16", "1D": "20", "1E": "25", "YA": "35", "1V": "35",
    "1H": "50", "1J": "63", "1K": "80", "2A": "100", "2C": "160", "2D": "200", "2E": "250", "2V": "350", "2G": "400",
    "2W": "450", "2H": "500", "2J": "630", "3A": "1000", "3D": "2000", "3F": "3150",
}  # fmt: skip
"""Rated voltages [V] by the codes of JIS C 5101 and EIA-198, which most makers of capacitors use."""

_SIZES = r"(?P<size>01005|0201|0402|0603|0805|1206|1210|1218|1808|1812|2010|2220|2225|2512)"
_PF = r"(?P<value>[0-9]{3}|[0-9]R[0-9]|R[0-9]{2})"
_OHM = r"(?P<value>[0-9]{3,4}|[0-9]*R[0-9]*)"
_RKM = r"(?P<ohms>[0-9]{1,3}(?:[RKM][0-9]{0,3})?|R[0-9]{1,3})"
_CODE = r"(?P<value>[0-9]{3}|[0-9]R[0-9]|R[0-9]{2})"
_TOL = r"(?P<tolerance>[A-Z])"


def _series(
    kind: str, pattern: str, scale: float = 1.0, facts: Mapping[str, str] | None = None, **tables: Mapping[str, str]
) -> Series:
    return Series(kind, re.compile(pattern), tables, facts or {}, scale)


def _sizes(**codes: str) -> Mapping[str, str]:
    return {code.strip("_"): size for code, size in codes.items()}


_CERAMIC, _TANTALUM = {"type": "ceramic"}, {"type": "tantalum"}
_PICO, _MICRO, _NANO = 1e-12, 1e-6, 1e-9
_CHIP = {"type": "thick film"}
_MURATA = {
    "02": "01005", "03": "0201", "15": "0402", "18": "0603", "21": "0805", "31": "1206", "32": "1210", "42": "1808",
    "43": "1812", "55": "2220",
}  # fmt: skip
_KOA = {
    "1H": "0201",
    "1E": "0402",
    "1J": "0603",
    "2A": "0805",
    "2B": "1206",
    "2E": "1210",
    "2H": "2010",
    "3A": "2512",
}
_PANASONIC = {"1": "0201", "2": "0402", "3": "0603", "6": "0805", "8": "1206", "14": "1210", "12": "2010"}

SERIES: tuple[Series, ...] = (
    # Ceramic capacitors.
    _series(  # Murata GRM, GCM, GRT, GJM …
        "capacitor",
        rf"G[A-Z][A-Z0-9](?P<size>[0-9]{{2}})[0-9A-Z](?P<dielectric>[A-Z0-9]{{2}})"
        rf"(?P<volts>[0-9Y][A-Z]){_PF}{_TOL}[A-Z0-9]*",
        _PICO,
        _CERAMIC,
        size=_MURATA,
        volts=_EIA_VOLTS,
        dielectric={
            "5C": "C0G",
            "R7": "X7R",
            "R6": "X5R",
            "C7": "X7S",
            "C8": "X6S",
            "D7": "X7T",
            "F5": "Y5V",
            "L8": "X8L",
        },
    ),
    _series(  # Yageo CC, AC, CQ
        "capacitor",
        rf"(?:CC|AC|CQ){_SIZES}{_TOL}[A-Z](?P<dielectric>NPO|COG|X[5-8][RST]|Y5V)(?P<volts>[0-9A-Z])B[A-Z]{_PF}",
        _PICO,
        _CERAMIC,
        volts={
            "4": "4",
            "5": "6.3",
            "6": "10",
            "7": "16",
            "8": "25",
            "G": "35",
            "9": "50",
            "0": "100",
            "A": "200",
            "Y": "250",
            "B": "500",
            "Z": "630",
            "C": "1000",
        },
    ),
    _series(  # Samsung CL
        "capacitor",
        rf"CL(?P<size>[0-9]{{2}})(?P<dielectric>[A-Z]){_PF}{_TOL}(?P<volts>[A-Z])[A-Z0-9]*",
        _PICO,
        _CERAMIC,
        size=_sizes(
            _02="01005", _03="0201", _05="0402", _10="0603", _21="0805", _31="1206", _32="1210", _43="1812", _55="2220"
        ),
        dielectric={"C": "C0G", "A": "X5R", "B": "X7R", "F": "Y5V", "X": "X6S", "Y": "X7S", "Z": "X7T"},
        volts={
            "S": "2.5",
            "R": "4",
            "Q": "6.3",
            "P": "10",
            "O": "16",
            "A": "25",
            "L": "35",
            "B": "50",
            "C": "100",
            "D": "200",
            "E": "250",
            "F": "350",
            "G": "500",
            "H": "630",
            "I": "1000",
            "J": "2000",
            "K": "3000",
        },
    ),
    _series(  # TDK C
        "capacitor",
        rf"C(?P<size>[0-9]{{4}})(?P<dielectric>C0G|CH|JB|X[5-8][RST]|Y5V|NP0)(?P<volts>[0-9][A-Z])"
        rf"{_PF}{_TOL}[A-Z0-9]*",
        _PICO,
        _CERAMIC,
        size=_METRIC,
        volts=_EIA_VOLTS,
    ),
    _series(  # TDK CGA
        "capacitor",
        rf"CGA(?P<size>[1-9])[A-Z][0-9](?P<dielectric>C0G|NP0|X[5-8][RST])(?P<volts>[0-9][A-Z]){_PF}{_TOL}[A-Z0-9]*",
        _PICO,
        _CERAMIC,
        volts=_EIA_VOLTS,
        size={"1": "0201", "2": "0402", "3": "0603", "4": "0805", "5": "1206", "6": "1210", "8": "1812", "9": "2220"},
    ),
    _series(  # Kyocera AVX
        "capacitor",
        rf"{_SIZES}(?P<volts>[46ZYP3D51279])(?P<dielectric>[ACDGWZ]){_PF}{_TOL}[A-Z][TZJ7][0-9][A-Z]",
        _PICO,
        _CERAMIC,
        volts={
            "4": "4",
            "6": "6.3",
            "Z": "10",
            "Y": "16",
            "3": "25",
            "D": "35",
            "5": "50",
            "1": "100",
            "2": "200",
            "7": "500",
        },
        dielectric={"A": "C0G", "C": "X7R", "D": "X5R", "G": "Y5V", "W": "X6S", "Z": "X7S"},
    ),
    _series(  # KEMET C
        "capacitor",
        rf"C{_SIZES}[CXFSTY]{_PF}{_TOL}(?P<volts>[0-9A-D])(?P<dielectric>[GRPVU])[A-Z0-9]*",
        _PICO,
        _CERAMIC,
        volts={
            "7": "4",
            "9": "6.3",
            "8": "10",
            "4": "16",
            "3": "25",
            "6": "35",
            "5": "50",
            "1": "100",
            "2": "200",
            "A": "250",
            "C": "500",
            "B": "630",
            "D": "1000",
        },
        dielectric={"G": "C0G", "R": "X7R", "P": "X5R", "V": "Y5V", "U": "Z5U"},
    ),
    _series(  # Taiyo Yuden
        "capacitor",
        rf"(?P<volts>[PAJLETGUHQ])[MV]K(?P<size>063|105|107|212|316|325|432)[A-Z]?"
        rf"(?P<dielectric>BJ|B7|CG|C6|F|LD){_PF}{_TOL}[A-Z0-9-]*",
        _PICO,
        _CERAMIC,
        size=_sizes(_063="0201", _105="0402", _107="0603", _212="0805", _316="1206", _325="1210", _432="1812"),
        volts={
            "P": "2.5",
            "A": "4",
            "J": "6.3",
            "L": "10",
            "E": "16",
            "T": "25",
            "G": "35",
            "U": "50",
            "H": "100",
            "Q": "250",
        },
        dielectric={"BJ": "X5R", "B7": "X7R", "CG": "C0G", "C6": "X6S", "F": "Y5V", "LD": "X5R"},
    ),
    _series("capacitor", r"885(?:012|342|352|362|382)[0-9]{6}", facts=_CERAMIC),  # Würth; a running number
    # Tantalum, polymer and electrolytic capacitors.
    _series(  # Kyocera AVX
        "capacitor",
        rf"T(?:AJ|PS|AC|RJ|CJ)[A-Z]{_CODE}{_TOL}(?P<volts>[0-9]{{3}})[A-Z0-9#]*",
        _PICO,
        _TANTALUM,
        volts={
            "002": "2.5",
            "004": "4",
            "006": "6.3",
            "010": "10",
            "016": "16",
            "020": "20",
            "025": "25",
            "035": "35",
            "050": "50",
        },
    ),
    _series(  # KEMET T4
        "capacitor",
        rf"T4[0-9]{{2}}[A-Z]{_CODE}{_TOL}(?P<volts>[0-9R]{{3}})[A-Z0-9]*",
        _PICO,
        _TANTALUM,
        volts={
            "2R5": "2.5",
            "004": "4",
            "006": "6.3",
            "6R3": "6.3",
            "010": "10",
            "016": "16",
            "020": "20",
            "025": "25",
            "035": "35",
            "050": "50",
        },
    ),
    _series(
        "capacitor", rf"T5[0-9]{{2}}[A-Z]{_CODE}{_TOL}[0-9R]{{3}}[A-Z0-9]*", _PICO, {"type": "polymer"}
    ),  # KEMET T5
    _series(  # Vishay 293D, 593D, TR3
        "capacitor",
        rf"(?:[25]9[345]D|TR3[A-Z]){_CODE}(?:X[0-9]|[KM])(?P<volts>[0-9R]{{3}})[A-Z0-9]*",
        _PICO,
        _TANTALUM,
        volts={"004": "4", "6R3": "6.3", "010": "10", "016": "16", "020": "20", "025": "25", "035": "35", "050": "50"},
    ),
    _series(  # Vishay TMC
        "capacitor", rf"TMC[A-Z]{{1,2}}(?P<volts>[01][A-Z]){_CODE}{_TOL}[A-Z0-9]*", _PICO, _TANTALUM, volts=_EIA_VOLTS
    ),
    _series(  # Panasonic EEE, ECA, EEU
        "capacitor",
        rf"(?:EEE|EEV|EEU|ECA|EEA)-?[A-Z]{{1,2}}(?P<volts>[0-9][A-Z]){_CODE}[A-Z0-9]*",
        _MICRO,
        {"type": "electrolytic"},
        volts=_EIA_VOLTS,
    ),
    _series(  # Nichicon U
        "capacitor",
        rf"U[A-Z]{{2}}(?P<volts>[0-9][A-Z]){_CODE}M[A-Z0-9]*",
        _MICRO,
        {"type": "electrolytic"},
        volts=_EIA_VOLTS,
    ),
    # Resistors.
    _series(  # Yageo RC, RT, RL …
        "resistor",
        rf"(?:RC|RT|RL|AC|PA|PE|PT|AF|RV){_SIZES}{_TOL}[A-Z][A-Z-](?:0?7|10|13|7[A-Z])[A-Z]?{_RKM}L?",
        1.0,
        _CHIP,
    ),
    _series(
        "resistor", rf"RC(?P<size>[0-9]{{4}})(?P<tolerance>[DFGJ]){_OHM}[A-Z]{{2}}", 1.0, _CHIP, size=_METRIC
    ),  # Samsung
    _series("resistor", rf"(?:CRCW|TNPW|RCS|RCA|RCG|PNM){_SIZES}{_RKM}{_TOL}[A-Z0-9]*", 1.0, _CHIP),  # Vishay
    _series("resistor", rf"MC[TAUS]{_SIZES}[0-9][A-Z]{_OHM}{_TOL}[A-Z0-9]*", 1.0, {"type": "thin film"}),  # Vishay
    _series("resistor", rf"WS[LKR]P?{_SIZES[:-1]}|2726|2817|4026)(?P<value>[0-9]*[LR][0-9]+){_TOL}[A-Z0-9]*"),  # Vishay
    _series(  # Panasonic ERJ
        "resistor",
        rf"ERJ-?(?P<size>14|12|[1-8])[A-Z]{{1,3}}?(?P<tolerance>[BDFGJ])?{_OHM}[A-Z]?",
        1.0,
        _CHIP,
        size=_PANASONIC,
    ),
    _series(
        "resistor", rf"ERA-?(?P<size>[1-8])[A-Z]{{2}}{_TOL}{_OHM}[A-Z]?", 1.0, {"type": "thin film"}, size=_PANASONIC
    ),
    _series(  # KOA, TE
        "resistor",
        rf"(?:RK|RN|SG|SR)73[A-Z](?P<size>[123][A-Z])(?:[A-Z]{{2,4}})?(?P<value>[0-9]+[RKM]?[0-9]*){_TOL}[A-Z0-9]*",
        size=_KOA,
    ),
    _series("resistor", rf"RMC[FP]{_SIZES}{_TOL}[TRG]{_RKM}", 1.0, _CHIP),  # Stackpole
    _series("resistor", rf"CSRN?{_SIZES}[A-Z]{{1,2}}(?P<value>[0-9]*R[0-9]+){_TOL}?[A-Z0-9]*"),  # Stackpole
    _series("resistor", rf"CFM?(?P<power>12|14|18){_TOL}T{_RKM}", 1.0, {"type": "carbon film"}),  # Stackpole
    _series("resistor", rf"RN(?:F|MF)(?P<power>12|14|18){_TOL}T[A-Z]?{_RKM}", 1.0, {"type": "metal film"}),  # Stackpole
    _series(
        "resistor", rf"CFR-?(?P<power>12|25|50){_TOL}[A-Z]-?[0-9]{{2}}-{_RKM}", 1.0, {"type": "carbon film"}
    ),  # Yageo
    _series("resistor", rf"MFR-?(?P<power>12|25|50){_TOL}[A-Z]{{2}}-?[0-9]{{2}}-{_RKM}", 1.0, {"type": "metal film"}),
    _series(
        "resistor",
        rf"WR(?P<size>02|04|06|08|12)X{_OHM}{_TOL}T[A-Z]",
        1.0,
        _CHIP,  # Walsin
        size={"02": "0201", "04": "0402", "06": "0603", "08": "0805", "12": "1206"},
    ),
    _series(
        "resistor", rf"{_SIZES}[WSD][A-Z0-9]{_TOL}(?P<value>[0-9]{{3}}[0-9JKL])[A-Z0-9]{{3}}", 1.0, _CHIP
    ),  # Royal Ohm
    _series("resistor", rf"TC[0-9]{{4}}{_TOL}(?P<value>[0-9]{{4}})T[0-9][A-Z]"),  # Royal Ohm
    _series("resistor", rf"RMC{_SIZES}{_RKM}(?:1|5)%N"),  # Tyohm
    _series(
        "resistor",
        rf"MCR(?P<size>01|03|10|18)[A-Z]{{3}}(?P<tolerance>[FJ])[A-Z]?{_OHM}",
        1.0,
        _CHIP,  # Rohm
        size={"01": "0402", "03": "0603", "10": "0805", "18": "1206"},
    ),
    _series("resistor", rf"(?:PMR|PML|UCR)[0-9]+[A-Z]{{3}}{_TOL}[A-Z]?(?P<value>[0-9]*[LR][0-9]+)"),  # Rohm
    _series("resistor", rf"CR{_SIZES}-?(?P<tolerance>[FJ])[A-Z]?-?{_OHM}[A-Z]*", 1.0, _CHIP),  # Bourns
    _series(
        "resistor",
        rf"RR(?P<size>0510|0816|1220)[PR]-?{_OHM}-?(?P<tolerance>[BD])",
        1.0,
        {"type": "thin film"},  # Susumu
        size={"0510": "0402", "0816": "0603", "1220": "0805"},
    ),
    _series("resistor", rf"CRG(?:CQ|P|H)?{_SIZES}{_TOL}{_RKM}", 1.0, _CHIP),  # TE
    _series("resistor network", rf"EXB-?[0-9A-Z]{{2,3}}?V(?P<value>[0-9]{{3}}){_TOL}[A-Z]"),  # Panasonic
    _series("resistor network", rf"YC[0-9]{{3}}-?{_TOL}R-?07{_RKM}L?"),  # Yageo
    _series("resistor network", rf"CA[TY]16-?(?P<value>[0-9]{{3,4}}){_TOL}[0-9][A-Z]*"),  # Bourns
    _series(
        "thermistor", rf"NCP(?P<size>[0-9]{{2}})[A-Z]{{2}}(?P<value>[0-9]{{3}}){_TOL}[A-Z0-9]*", size=_MURATA
    ),  # Murata
    _series("thermistor", rf"ERT-?J[0-9][A-Z]{{2}}(?P<value>[0-9]{{3}}){_TOL}[A-Z]?"),  # Panasonic
    # Inductors and beads.
    _series("inductor", rf"(?:SD[ER]|SR[NPRU])[0-9]{{4}}[A-Z]{{0,3}}-{_CODE}[A-Z]+", _MICRO),  # Bourns
    _series("inductor", rf"NR[A-Z]{{0,2}}[0-9]{{4}}T{_CODE}[A-Z]+", _MICRO),  # Taiyo Yuden
    _series("inductor", rf"MLZ[0-9]{{4}}[A-Z]{_CODE}[A-Z0-9]*", _MICRO),  # TDK
    _series("inductor", rf"(?:VLS|VLF|SLF|CLF|SPM)[0-9]{{4,6}}[A-Z]{{0,3}}-{_CODE}[A-Z0-9-]*", _MICRO),  # TDK
    _series(
        "inductor", r"(?:XAL|XFL|XEL|XGL|MSS|LPS|DO|MOS|SER)[0-9]{4}[A-Z]?-(?P<value>[0-9]{3})[A-Z]*", _NANO
    ),  # Coilcraft
    _series("inductor", rf"IHLP-?[0-9]{{4}}[A-Z]{{4}}{_CODE}[A-Z0-9]*", _MICRO),  # Vishay
    _series(
        "inductor", rf"LQ[HM](?P<size>[0-9]{{2}})[A-Z]{{1,2}}{_CODE}[A-Z][A-Z0-9]*", _MICRO, size=_MURATA
    ),  # Murata
    _series(
        "inductor", r"LQ[GPW](?P<size>[0-9]{2})[A-Z]{1,2}(?P<value>[0-9]+N[0-9]*)[A-Z][A-Z0-9]*", _MICRO, size=_MURATA
    ),
    _series("inductor", r"744[0-9]{5,9}[A-Z]?"),  # Würth; a running number
    _series("ferrite bead", r"BLM(?P<size>[0-9]{2})[A-Z]{2}[0-9]{3}[A-Z0-9]*", size=_MURATA),  # Murata
    _series("ferrite bead", r"(?:MPZ|MMZ)(?P<size>[0-9]{4})[A-Z][0-9]{3}[A-Z0-9]*", size=_METRIC),  # TDK
    _series("ferrite bead", r"7427[0-9]{4,7}"),  # Würth
    _series("ferrite bead", r"25[0-9]{8}[YZ][0-9]"),  # Fair-Rite
)
