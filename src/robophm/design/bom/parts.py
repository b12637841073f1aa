"""What a row of a parts list is, and what is known of it: read from its reference, value, footprint and words.

Nothing here knows hazard models. What a row does not say is not in ``facts``; what is concluded from something that
merely suggests it is said in ``because``.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field

from robophm.design.bom.columns import Decimal
from robophm.design.bom.references import prefix

KINDS: Mapping[str, str] = {
    # From the special to the general: the first whose words are in a row is what it is. English, German, French.
    "no part": r"test ?points?|testpads?|mounting ?holes?|fiducials?|logo|solder ?jumper|tooling ?hole|messpunkt",
    "thermistor": r"thermistors?|ntc|ptc|heißleiter|kaltleiter",
    "varistor": r"varistors?|mov",
    "optocoupler": r"opto-?couplers?|opto-?isolators?|photo-?couplers?|optokoppler",
    "solid state relay": r"solid[ -]?state[ -]?relays?|ssr|photomos",
    "oscillator": r"oscillators?|tcxo|ocxo|vcxo|oszillator(en)?|oscillateur",
    "resistor network": r"resistor ?(network|array|pack)s?|widerstandsnetzwerk",
    "microcircuit": r"ics?|integrated circuits?|microcontrollers?|microprocessors?|mikrocontroller|mcu|cpu|fpga|cpld|"
    r"controllers?|drivers?|treiber|converters?|regulators?|\w*regler|ldo|transceivers?|op-?amps?|amplifiers?|comparators?|"
    r"eeprom|flash|s?ram|adc|dac|logic|schaltkreis",
    "photodetector": r"photo-?diodes?|photo-?transistors?|fotodioden?|fototransistor(en)?",
    "laser diode": r"laser ?diodes?",
    "display": r"7-?segment|seven ?segment|displays?|lcd|oled",
    "led": r"leds?|leuchtdioden?|light[ -]?emitting( diodes?)?",
    "thyristor": r"thyristors?|scrs?|triacs?|diacs?",
    "fet": r"mosfets?|jfets?|fets?|[np]-?mos|[np]-?channel|[np]-?kanal",
    "bipolar transistor": r"bjts?|npn|pnp|bipolar|darlington",
    "transistor": r"transistors?|transistoren|igbts?",
    "tvs diode": r"tvs|transient ?(voltage)? ?suppress\w*|esd (protection|diode)|suppressordioden?",
    "zener diode": r"zener\w*|z-?dioden?",
    "schottky diode": r"schottky\w*",
    "rectifier": r"rectifiers?|gleichrichter|redresseur",
    "diode": r"diodes?|dioden",
    "crystal": r"crystals?|xtals?|quartz|quarze?|resonators?",
    "ferrite bead": r"ferrite ?(beads?)?|ferritperlen?",
    "transformer": r"transformers?|transformator(en)?|trafo|transformateur",
    "filter": r"filters?",
    "inductor": r"inductors?|inductances?|coils?|chokes?|drosseln?|spulen?|induktivität(en)?|bobine",
    "potentiometer": r"potentiometers?|trim ?pots?|trimmer ?pots?|poti|potentiomètre",
    "resistor": r"resistors?|res|widerst[aä]nde?|widerstand|r[ée]sistances?|resistenza|resistencia|shunts?",
    "supercapacitor": r"super-?cap\w*|edlc|ultra-?cap\w*",
    "capacitor": r"capacitors?|caps?|mlcc|\w*kondensator(en)?|elko|kerko|condensateurs?|condensatore?|condensador",
    "circuit breaker": r"circuit ?breakers?|sicherungsautomat",
    "fuse": r"fuses?|polyfuse|poly-?switch|\w*sicherung(en)?|fusibles?",
    "relay": r"relays?|relais",
    "encoder": r"encoders?|drehgeber",
    "switch": r"switch(es)?|(push)? ?buttons?|taster|\w*schalter|interrupteur",
    "socket": r"(ic|dip) ?sockets?",
    "connector": r"connectors?|conn|(pin)? ?headers?|terminal ?blocks?|terminals?|sockets?|plugs?|jacks?|receptacles?|"
    r"usb|rj45|d-?sub|stecker|buchsen?|steckverbinder|\w*leisten?|\w*klemmen?|connecteurs?|borniers?",
    "battery": r"batter(y|ies)|batterien?|akku|coin ?cell",
    "motor": r"motors?|motoren|moteurs?",
    "lamp": r"lamps?|lampen?|incandescent",
    "buzzer": r"buzzers?|speakers?|lautsprecher",
    "antenna": r"antennas?|antennen?",
}  # fmt: skip
"""Kinds of parts and the words that name them."""

PREFIXES: Mapping[str, tuple[str, ...]] = {
    # IEEE 315 as schematic editors use it. Where IEC 81346 or habit has another meaning, both are here: words decide.
    **dict.fromkeys(("R", "RS"), ("resistor",)), **dict.fromkeys(("RN", "RA"), ("resistor network",)),
    **dict.fromkeys(("RT", "TH", "NTC"), ("thermistor",)), **dict.fromkeys(("VR", "POT"), ("potentiometer",)),
    "RP": ("resistor network", "potentiometer"), "RV": ("potentiometer", "varistor"),
    **dict.fromkeys(("VDR", "MOV"), ("varistor",)), **dict.fromkeys(("C", "CP", "CE"), ("capacitor",)),
    "L": ("inductor",), "FB": ("ferrite bead",), "FL": ("filter",), "TR": ("transformer",),
    "T": ("transformer", "transistor"), "V": ("diode", "transistor"),
    **dict.fromkeys(("D", "CR"), ("diode",)), **dict.fromkeys(("DZ", "ZD"), ("zener diode",)), "TVS": ("tvs diode",),
    **dict.fromkeys(("LED", "LD"), ("led",)), "DS": ("led", "display", "lamp"), "BR": ("rectifier",),
    "Q": ("transistor",), "SCR": ("thyristor",), **dict.fromkeys(("OK", "OC"), ("optocoupler",)),
    **dict.fromkeys(("U", "IC"), ("microcircuit",)), "X": ("connector", "crystal"), "H": ("no part", "connector"),
    **dict.fromkeys(("J", "P", "CN", "CON", "CONN", "XS", "XP", "TB"), ("connector",)), "JP": ("connector",),
    **dict.fromkeys(("Y", "XTAL"), ("crystal",)), "OSC": ("oscillator",), "F": ("fuse",), "CB": ("circuit breaker",),
    **dict.fromkeys(("K", "RY", "RL"), ("relay",)), **dict.fromkeys(("S", "SW", "BTN"), ("switch",)),
    **dict.fromkeys(("BT", "BAT"), ("battery",)), "M": ("motor", "microcircuit"),
    **dict.fromkeys(("LS", "BZ"), ("buzzer",)), **dict.fromkeys(("AE", "ANT"), ("antenna",)),
    **dict.fromkeys(("TP", "MH", "FID"), ("no part",)),
}  # fmt: skip
"""What the letters of a reference designator mean. Of one with several meanings the words of its row decide."""

FAMILIES = (
    {
        "diode",
        "led",
        "zener diode",
        "schottky diode",
        "rectifier",
        "tvs diode",
        "thyristor",
        "laser diode",
        "photodetector",
    },
    {"transistor", "fet", "bipolar transistor", "thyristor", "photodetector"},
    {"resistor", "resistor network", "thermistor", "potentiometer", "varistor"},
    {"inductor", "ferrite bead", "transformer", "filter"},
    {"crystal", "oscillator"},
    {"capacitor", "supercapacitor"},
    {"microcircuit", "optocoupler", "oscillator", "solid state relay"},
    {"connector", "socket", "no part"},
    {"switch", "encoder"},
    {"relay", "solid state relay"},
)
"""Kinds that share letters: other words in the row of a part with these letters speak of something else."""


@dataclass(frozen=True)
class Described:
    """What a row says of its part, cell by cell."""

    value: str = ""
    footprint: str = ""
    description: str = ""
    library: str = ""
    part_number: str = ""
    voltage: str = ""
    tolerance: str = ""
    power: str = ""
    material: str = ""
    note: str = ""


@dataclass(frozen=True)
class Recognised:
    """A kind of part and what is known of it: quantities as texts with a unit ('100 nF'), and words."""

    kind: str
    """One of KINDS, or '' where nothing tells, or letters have several meanings and no words decide."""
    facts: Mapping[str, str] = field(default_factory=dict)
    because: tuple[str, ...] = ()
    """What was concluded from something that only suggests it."""


def recognise(references: tuple[str, ...], row: Described, decimal: Decimal = ".") -> Recognised:
    """The kind of a part and what is known of it."""
    said = _Said(row, decimal)
    because: list[str] = []
    kind = _kind(prefix(references[0]) if references else "", said.words, because)
    return Recognised(kind, said.facts(kind, because), tuple(because))


def _words(words: str) -> re.Pattern[str]:
    return re.compile(rf"(?<![^\W_])(?:{words})(?![^\W_])", re.IGNORECASE)


_KIND_WORDS = {kind: _words(words) for kind, words in KINDS.items()}


def _kind(letters: str, words: str, because: list[str]) -> str:
    lettered = PREFIXES.get(letters, ())
    words = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", words).replace("_", " ")  # PinHeader_1x04
    family = {kind for family in FAMILIES if family & set(lettered) for kind in family} | set(lettered)
    for kind, pattern in _KIND_WORDS.items():
        if (not lettered or kind in family) and pattern.search(words):
            if kind not in lettered:
                because.append(f"{kind} by its words")
            return kind
    return lettered[0] if len(lettered) == 1 else ""


_NUMBER = r"(?<![\w.])([0-9]{1,9}(?:\.[0-9]{1,6})?)"
_END = r"(?![^\W_])"
_CAPACITANCE = re.compile(rf"{_NUMBER}\s?([pnuµμm]?)F{_END}"), re.compile(rf"{_NUMBER}\s?([pnuµμ]){_END}")
_RESISTANCE = (
    re.compile(rf"{_NUMBER}\s?([mkKMG]?)\s?(?:Ω|\u2126|[oO]hms?|OHMS?){_END}"),
    re.compile(rf"{_NUMBER}([kKMGR]){_END}"),
)
_INDUCTANCE = re.compile(rf"{_NUMBER}\s?([pnuµμm])H{_END}"), re.compile(rf"{_NUMBER}([nuµμ]){_END}")
_VOLTAGE = (re.compile(rf"{_NUMBER}\s?(k?)V(?:DC|dc)?{_END}"),)
_CURRENT = (re.compile(rf"{_NUMBER}\s?([mu]?)A{_END}"),)
_FREQUENCY = (re.compile(rf"{_NUMBER}\s?([kKMG]?)[hH][zZ]{_END}"),)
_POWER = (re.compile(rf"(?<![\w./])([0-9]{{1,9}}(?:\.[0-9]{{1,6}})?(?:/[0-9]{{1,2}})?)\s?(m?)W{_END}"),)
_TOLERANCE = re.compile(r"(?<![\w.])([0-9]{1,2}(?:\.[0-9]{1,3})?)\s?%")
_SCALE = {"µ": "u", "μ": "u", "K": "k", "R": ""}
_LETTER_AS_POINT = re.compile(r"(?<![\w.])([0-9]{1,4})([pnuµμmkKMGRV])([0-9]{1,3})(?=[FHΩ]?(?![^\W_]))")  # 4u7, 6V3

_CHIP = re.compile(r"(?<![0-9])(01005|0201|0402|0603|0805|1206|1210|1218|1806|1808|1812|2010|2220|2225|2512)(?![0-9])")
_METRIC = re.compile(r"_[0-9]{4,5}Metric")
_DIELECTRIC = _words("C0G|COG|NP0|NPO|X5R|X7R|X7S|X7T|X6S|X8R|X5S|X8L|Y5V|Z5U|U2J")
_ROWS_OF_PINS = re.compile(r"(?<![0-9])0?([0-9])x0?([0-9]{1,3})(?![0-9])")
_PACKAGE_PINS = re.compile(
    r"(?<![A-Za-z])(?:[A-Z]{0,3}SOP|[A-Z]?SOIC|SO|[A-Z]?SOT-?23|SC-?70|P?DIP|[A-Z]{0,2}QFN|[A-Z]?DFN|[A-Z]?SON|[A-Z]?QFP|"
    r"[A-Z]{0,2}BGA|LGA|WLCSP|PLCC|TO-?220|TO-?263)-?([0-9]{1,4})(?![0-9.])",
)
_POSITIONS = re.compile(rf"{_NUMBER}[ -]?(?:pins?|pos(?:itions?)?|ways?|pol(?:ig)?|contacts?|p){_END}", re.IGNORECASE)
_THROUGH_HOLE = re.compile(r"tht|through.?hole|radial|axial|C_Disc|C_Rect|bedrahtet|leaded|traversant", re.IGNORECASE)

CAPACITOR_TYPES = {
    "polymer": _words(r"polymer\w*|os-?con|poscap|hybrid"),
    "niobium": _words(r"niob\w*"),
    "tantalum": _words(r"tantal\w*|tant"),
    "electrolytic": _words(
        r"electrolytic|elec|alu\w*|elko|elektrolyt\w*|électrolytique|electrolytique|CP_Radial|CP_Elec|CP_Axial"
    ),
    "film": _words(r"film|folie\w*|mk[tps][0-9]?|fkp[0-9]?|polyester|polypropyl[eè]ne|pet|pps"),
    "paper": _words(r"paper|papier"),
    "mica": _words(r"mica|glimmer"),
    "variable": _words(r"trimmer|trim ?cap|variable"),
    "ceramic": _words(r"ceramic|mlcc|keramik\w*|kerko|c[ée]ramique|C_Disc"),
}
RESISTOR_TYPES = {
    "wirewound": _words(r"wire.?wound|draht\w*|bobin[ée]e?"),
    "metal film": _words(r"metal[- ]?(?:film|oxide)|metall(?:film|schicht)\w*|couche métal\w*"),
    "carbon film": _words(r"carbon[- ]?film|kohleschicht\w*|couche carbone"),
    "carbon composition": _words(r"carbon comp\w*"),
    "thin film": _words(r"thin[- ]?film|dünnschicht\w*"),
    "thick film": _words(r"thick[- ]?film|dickschicht\w*"),
}
CHIP_POWER = {
    "01005": "0.031 W", "0201": "0.05 W", "0402": "0.0625 W", "0603": "0.1 W", "0805": "0.125 W", "1206": "0.25 W",
    "1210": "0.5 W", "1218": "1 W", "2010": "0.75 W", "2512": "1 W",
}  # fmt: skip
"""What makers usually rate a chip resistor of a size for."""


class _Said:
    """What the cells of a row say, with points and letters made decimal points."""

    def __init__(self, row: Described, decimal: Decimal) -> None:
        def plain(text: str) -> str:
            return _LETTER_AS_POINT.sub(r"\1.\3\2", with_points(text, decimal))

        self.value = plain(row.value)
        self.rest = plain(" ".join((row.description, row.library, row.note, row.part_number)))
        self.column = {name: plain(getattr(row, name)) for name in ("voltage", "tolerance", "power")}
        self.footprint = row.footprint
        self.words = " ".join((row.description, row.library, row.footprint, row.value, row.material, row.note))

    def facts(self, kind: str, because: list[str]) -> dict[str, str]:
        found: dict[str, str | None] = {}
        if kind in ("capacitor", "supercapacitor"):
            found = self.capacitor(because)
        elif kind in ("resistor", "resistor network", "potentiometer", "thermistor"):
            found = self.resistor(because)
        elif kind in ("inductor", "ferrite bead"):
            found["inductance"] = self.first(_INDUCTANCE, "H", self.value, self.rest)
        elif kind in ("crystal", "oscillator"):
            found["frequency"] = self.first(_FREQUENCY, "Hz", self.value, self.rest)
        elif kind in ("connector", "socket", "microcircuit", "optocoupler"):
            found["pins"] = self.pins()
        if kind in ("capacitor", "supercapacitor", "fuse", "varistor", "tvs diode", "zener diode"):
            found["rated_voltage"] = self.first(
                _VOLTAGE, "V", _unit(self.column["voltage"], "V"), self.value, self.rest
            )
        if kind in ("fuse", "inductor"):
            found["rated_current"] = self.first(_CURRENT, "A", self.value, self.rest)
        if kind:
            found["size"] = self.chip()
            through = _THROUGH_HOLE.search(self.words)
            surface = found["size"] or re.search(r"sm[dt]", self.words, re.IGNORECASE)
            found["mounting"] = "through hole" if through else "surface" if surface else None
        return {name: text for name, text in found.items() if text}

    def capacitor(self, because: list[str]) -> dict[str, str | None]:
        value = re.sub(r"(?<=[0-9]) (?=[pnuµμ]$)", "", self.value)  # 100 n
        kind = next((name for name, words in CAPACITOR_TYPES.items() if words.search(self.words)), None)
        dielectric = _DIELECTRIC.search(self.words)
        if not kind and (dielectric or self.chip()):
            kind = "ceramic"
            because.append(f"ceramic by its {'dielectric' if dielectric else f'size {self.chip()}'}")
        said = dielectric[0].upper() if dielectric else None
        return {
            "capacitance": self.first(_CAPACITANCE, "F", value, self.rest),
            "dielectric": "C0G" if said in ("COG", "NP0", "NPO") else said,
            "type": kind,
        }

    def resistor(self, because: list[str]) -> dict[str, str | None]:
        value = _unit(re.sub(r"(?<=[0-9]) (?=[kKMR]$)", "", self.value), "ohm")  # 100 in a column of values is ohms
        power = self.first(_POWER, "W", _unit(self.column["power"], "W"), self.value, self.rest)
        size = self.chip()
        if not power and size in CHIP_POWER and size:
            power = CHIP_POWER[size]
            because.append(f"{power} by its size {size}")
        tolerance = _TOLERANCE.search(" ".join((_unit(self.column["tolerance"], "%"), self.value, self.rest)))
        return {
            "resistance": self.first(_RESISTANCE, "ohm", value, self.rest),
            "rated_power": power,
            "tolerance": f"{tolerance[1]} %" if tolerance else None,
            "type": next((name for name, words in RESISTOR_TYPES.items() if words.search(self.words)), None),
        }

    @staticmethod
    def first(patterns: tuple[re.Pattern[str], ...], unit: str, *texts: str) -> str | None:
        """The first quantity of a kind, as '4.7 uF'."""
        for text in texts:
            for pattern in patterns:
                if match := pattern.search(text):
                    number, _, below = match[1].partition("/")  # 1/10 W
                    if below and float(below):
                        number = f"{float(number) / float(below):.4g}"
                    scale = match[2]
                    return f"{number} {_SCALE.get(scale, scale)}{unit}"
        return None

    def chip(self) -> str | None:
        for text in (self.footprint, self.words):
            if match := _CHIP.search(_METRIC.sub("", text)):
                return match[1]
        return None

    def pins(self) -> str | None:
        texts = (self.footprint, self.value, self.rest)
        for text in texts:
            if rows := _ROWS_OF_PINS.search(text):
                return str(int(rows[1]) * int(rows[2]))
            if package := _PACKAGE_PINS.search(text):
                return package[1]
        positions = next((found for text in texts if (found := _POSITIONS.search(text))), None)
        return positions[1] if positions else None


def _unit(text: str, unit: str) -> str:
    """A bare number of a column whose unit is clear, with it."""
    return f"{text} {unit}" if re.fullmatch(r"[0-9]{1,9}(\.[0-9]{1,6})?", text) else text


def with_points(text: str, decimal: Decimal) -> str:
    """A text whose numbers have points and no thousands: 4,7 and 1.000 in a list with commas, 1,000 in another."""
    if decimal == "," or re.fullmatch(r"[0-9]{1,3},[0-9]{1,2}\s?[A-Za-zµμΩ]+", text):
        text = re.sub(
            r"(?<![\w.,])[1-9][0-9]{0,2}(?:\.[0-9]{3})+(?![0-9.])", lambda match: match[0].replace(".", ""), text
        )
        return re.sub(r"(?<![\w.,])(0|[1-9][0-9]{0,3}),([0-9]{1,6})(?![0-9,])", r"\1.\2", text)
    return re.sub(r"(?<![\w.,])[1-9][0-9]{0,2}(?:,[0-9]{3})+(?![0-9,])", lambda match: match[0].replace(",", ""), text)
