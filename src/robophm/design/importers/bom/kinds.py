"""The kind of a part: from its words, or from the letters of its reference where words say no more."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass

from robophm.design.importers.bom.wide_band_gap_series import GAN_TRANSISTORS, SIC_DIODES, SIC_TRANSISTORS

KINDS: Mapping[str, str] = {
    # From the special to the general: the first whose words are in a row is what it is. English, German, French; and
    # of semiconductors the beginnings of usual part numbers, for many lists say nothing else of them.
    "no part": r"test ?points?|testpads?|measure?ment ?points?|(mounting|tooling|m[2-8](\.5)?) ?holes?|"
    r"fiducials?|logo|silkscreen|solder ?jumper|messpunkt",
    "hardware": r"m[1-9][0-9]?(\.5)? ?x ?([4-9]|[1-9][0-9]+)(\.[0-9]+)?( ?mm)?|(flat|socket|button|pan|hex)[ -]?heads?|"
    r"stand-?offs?|spacers?|screws?|bolts?|nuts?|washers?|rivets?|heat ?sinks?|schrauben?|muttern?|"
    r"abstandsbolzen|kühlkörper|labels?|etiketten?|zip ?ties?|heat ?shrink( tub(e|ing))?|cable ?ties?|fasteners?",
    "mechanical part": r"bearings?|(pillow|bearing) ?blocks?|bushings?|(wheel ?)?hubs?|wheels?|cast[eo]rs?|tyres?|"
    r"tires?|"
    r"gears?|gear ?box(es)?|pulleys?|sprockets?|chains?|belts?|shafts?|axles?|couplers?|couplings?|"
    r"springs?|brackets?|"
    r"plates?|chassis|enclosures?|housings?|lids?|hinges?|clamps?|extrusions?|horns?|magnets?|o-?rings?|bumpers?|"
    r"handles?|levers?|covers?|frames?|knobs?|holders?|"
    r"(caster ?)?balls?|(?<!panel )(?<!board )(?<!surface )(?<!chassis )(?<!hole )mounts?|"
    r"kugellager|wälzlager|zahnr[aä]d(er)?|räder|gehäuse|wellen?|federn?|roulements?|roues?|engrenages?|ressorts?",
    "whole device": r"\w*lidars?|jetson\w*|raspberry ?pi\w*|rpi ?(pico|zero|cm|[2-5])\w*|nucleo\w*|"
    r"daisy ?seed|arduino\w*|teensy\w*|beagle ?bone\w*|cameras?|webcams?|"
    r"kamera|real ?sense|kinect|robo ?claw|odrive|pixhawk|escs?|imus?|gps|computers?|laptops?|tablets?|routers?|"
    r"modems?|"
    r"\w* ?boards?(?![- ](?:mount|to|edge)\w*)|(dev(elopment)? ?)?kits?|shields?|hats?|breakouts?|sd ?cards?|"
    r"joysticks?|"
    r"gamepads?|power ?suppl(y|ies)|netzteile?|power ?banks?|chargers?|ladegeräte?|usb ?hubs?|"
    r"manipulators?|grippers?|"
    r"fans?|blowers?|lüfter|ventilat(or|eur)(en|s)?|"
    r"(relay|sensor|driver|gps|charger|converter|regulator|power|radio|wi-?fi|bluetooth) ?modules?",
    "cable": r"cables?|wires?|kabel|leitung(en)?|câbles?|cords?",
    "resettable fuse": r"mf-[a-z]{1,4}[0-9]\w*|r[xu]ef[0-9]+|(mini|micro|nano)smd[a-z]?[0-9]\w*|"
    r"pptcs?|poly-?fuses?|poly-?switch(es)?|res(e|et)tt?able( fuses?)?|restt?ble|ptc[ -]?fuses?",
    "thermistor": r"thermistors?|ntc|ptc|heißleiter|kaltleiter",
    "varistor": r"varistors?|mov",
    "optocoupler": r"opto-?couplers?|opto-?isolators?|photo-?couplers?|optokoppler|pc817\w*|"
    r"4n[23][0-9]|6n13[0-9]|(h11[a-z]|moc3|hcpl|tlp)[0-9]\w*",
    "solid state relay": r"solid[ -]?state[ -]?relays?|ssr|photomos",
    "oscillator": r"oscillators?|tcxo|ocxo|vcxo|oszillator(en)?|oscillateur",
    "resistor network": r"resistor ?(network|array|pack)s?|widerstandsnetzwerk",
    "sensor chip": r"accelerometers?|gyro(scope)?s?|magnetometers?|e?compass|imus?|inertial( (module|"
    r"measurement|unit)s?)*|"
    r"(board mount )?(pressure|humidity|barometric|altimeter) sensors?|barometers?|altimeters?|mems|"
    r"(mpu-?[69]|icm-?[0-9]{5}|bm[aegimpx][0-9]{3}|lsm[0-9]|lis[23]|l3g|adxl|ms5[568]|hmc5|qmc5|"
    r"ak[08]9|mma[78]|mmc[35]|"
    r"lps[23]|dps3|bno0|sht[0-9]|si70|hdc[12]|iam-?2)[0-9]*\w*",
    "microcontroller": r"microcontrollers?|mikrocontroller|microprocessors?|processors?|mcus?|cpus?|soc|"
    r"(stm(32|8)|at(mega|tiny|xmega|sam)|samd[0-9]|dspic|pic(1[0268]|24|32)|esp(32|8266)|rp2[0-9]|nrf5[0-9]|msp430|"
    r"lpc[0-9]{3}|mimxrt|gd32|ch32|efm32|xmc[0-9])\w*",
    "programmable logic": r"fpgas?|cplds?|(xc[2-7][acksvxz]|xc95|ep[1-5][cm]|10m0|lcmxo|lfe[0-9]|ice40)\w*",
    "analog circuit": r"op[ -]?amps?|txrx|(battery )?chargers?|charger front end|current sens(e|ing)|"
    r"load switch(es)?|"
    r"(power |source )?(selector|or|oring) ?(ctrlr|controllers?)|supervisors?|buck|boost|sepic|step-?(up|down)|pmic|"
    r"operational ?amplifiers?|amplifiers?|comparators?|v?reg|regulators?|\w*regler|ldo|"
    r"converters?|dc-?dc|(gate |motor |stepper |led |line )?drivers?|treiber|transceivers?|"
    r"voltage references?|adc|dac|"
    r"timers?|(lm|tl0|opa|ina|ne55|ams1117|tps|ltc|drv8|tmc[2-9]|mcp[136]|ad[58]|max[0-9]|mp[12]|uln|"
    r"l298|l?7[89][0lm]|l78[lmst]|xc6|ld1117|ap1117|az1117|mic[25]|acs7|bq|"
    r"sn[67]5|tja1|iso1|adum|lt[1-8]|tlv|lp[2-5]|tsc1|sip3|ref[0-9]|xtr|tca[78]|tcan|ap[1-9]|isl|"
    r"rt[4-9]|sy[68]|a4988|a49|mcp25|as5[06])"
    r"[0-9]*\w*",
    "memory": r"memory|speicher|eeproms?|eprom|flash|[sdf]?rams?|(ddr[0-9]?)|(24(lc|aa|fc|c)[0-9]|at2[45]c|"
    r"25(lc|aa)[0-9]|m24[cm]|w25[qn]|mx25|gd25|is25|is6[12]|as6c|cy6|mt4[178]|k4[abt])\w*",
    "logic": r"logic|gates?|flip-?flops?|buffers?|inverters?|(shift ?)?registers?|decoders?|latch(es)?|multiplexers?|"
    r"level ?(shifters?|translators?)|xlatr|translat(or|ing)\w*|(txs0|txb0|tca9|pca9|pcf857|mcp23|"
    r"lsf0)[0-9]+\w*|(sn|mc|cd|mm|nc)?([57]4[a-z]{1,6}[0-9]|[57]4[0-9]{2}|74[0-9]{3}|4[05][0-9]{2}b|"
    r"7s[a-z])\w*|(cd4|hef4)[0-9]{2}\w*",
    "photodetector": r"photo-?(diodes?|transistors?)|foto(dioden?|transistor(en)?)",
    "laser diode": r"laser ?diodes?",
    "liquid crystal or OLED display": r"lcds?|oleds?|tft",
    "display": r"7-?segment|seven ?segment|displays?|anzeigen?",
    "led": r"leds?|leuchtdioden?|light[ -]?emitting( diodes?)?|neopixel|ws2812\w*",
    "thyristor": r"thyristors?|scrs?|triacs?|diacs?|bt(a|b|1)[0-9]\w*|tic[0-9]{3}\w*",
    "fet": rf"{GAN_TRANSISTORS}|{SIC_TRANSISTORS}|"
    r"mosfets?|jfets?|fets?|[np]-?mos|[np]-?(channel|ch|kanal)|"
    r"(2n70|bss[18]|irf|irl|ao[0-9]{3}|si[0-9]{3}|dm[np][0-9]|csd[0-9]|fd[a-z]{1,2}[0-9]{3}|ntr[0-9])\w*",
    "bipolar transistor": r"bjts?|npn|pnp|bipolar|darlington|"
    r"(bc[3-8][0-9]{2}|2n[2-6][0-9]{3}|[mp]mbt|bd[0-9]{3}|bcp5|tip[0-9]|mje[0-9]|s8[05]50)\w*",
    "transistor": r"transistors?|transistoren|igbts?",
    "tvs diode": r"tvs|transient ?(voltage)? ?suppress\w*|esd[ -]?(protect\w*|diodes?|suppress\w*|"
    r"arrays?)|suppressordioden?|"
    r"(smaj|smbj|p6ke|1\.5ke|l?esd[0-9]|pesd|usblc|prtr5v|ip42[0-9]{2}|tpd[0-9]e)\w*",
    "zener diode": r"zener\w*|z-?dioden?|(bzx|bzt|mmsz)\w*",
    "schottky diode": rf"{SIC_DIODES}|"
    r"scho?tt?ky\w*|shottky|(bat[0-9]|bas(40|70|8[56])|1n58[12]|ss[1-5][2-6]|b[0-9]{3}a|mbr)\w*",
    "rectifier": r"rectifiers?|gleichrichter|redresseur|(1n400|1n540|db10|gbu)\w*",
    "diode": r"diodes?|dioden|(1n4[14]48|1n914|ll4148|ba[vwx][0-9]|bas[123][0-9])\w*",
    "crystal": r"crystals?|xtals?|quartz|quarze?|resonators?",
    "ferrite bead": r"ferrite ?(beads?)?|ferritperlen?",
    "transformer": r"transformers?|transformator(en)?|trafo|transformateur|\w*übertrager",
    "filter": r"(emi ?)?filters?",
    "inductor": r"inductors?|inductances?|coils?|chokes?|drosseln?|spulen?|induktivität(en)?|bobine",
    "potentiometer": r"potentiometers?|trim ?pots?|trimmer ?pots?|poti|potentiomètre",
    "resistor": r"resistors?|res|widerst[aä]nde?|widerstand|r[ée]sistances?|resistenza|resistencia|shunts?",
    "supercapacitor": r"super-?cap\w*|edlc|ultra-?cap\w*",
    "capacitor": r"capacitors?|caps?|mlcc|\w*kondensator(en)?|elko|kerko|condensateurs?|condensatore?|condensador",
    "circuit breaker": r"circuit ?breakers?|sicherungsautomat",
    "fuse": r"fuses?|\w*sicherung(en)?|fusibles?",
    "relay": r"relays?|relais",
    "encoder": r"encoders?|drehgeber",
    "switch": r"switch(es)?|(push)? ?buttons?|taster|\w*schalter|interrupteur",
    "socket": r"(ic|dip) ?sockets?",
    "connector": r"connectors?|conn|hdr|(pin)? ?headers?|terminal ?blocks?|terminals?|sockets?|"
    r"plugs?|jacks?|receptacles?|"
    r"usb|rj45|d-?sub|stecker|buchsen?|steckverbinder|\w*leisten?|\w*klemmen?|connecteurs?|borniers?",
    "battery": r"batter(y|ies)|batterien?|akku|coin ?cell",
    "motor": r"\w*motors?|\w*motoren|moteurs?|steppers?|nema ?[0-9]+|servos?",
    "lamp": r"lamps?|lampen?|incandescent",
    "buzzer": r"buzzers?|speakers?|lautsprecher",
    "antenna": r"antennas?|antennen?",
    "printed board": r"pcbs?|printed (circuit|wiring)? ?boards?|bare ?boards?|leiterplatten?|platine",
    "microcircuit": r"ics?|integrated ?circuits?|controllers?|schaltkreis(e)?",
}  # fmt: skip
"""Kinds of parts and the words that name them."""

DEVICE = "whole device"

OTHER = ("no part", "hardware", "mechanical part", DEVICE, "cable")
"""Kinds that no handbook's electronic part stands for."""

NO_PARTS = ("no part", "hardware")
"""Things that stand on lists and fail no circuit."""

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
    "PCB": ("printed board",), **dict.fromkeys(("TP", "MH", "FID"), ("no part",)),
}  # fmt: skip
"""The meanings of a reference designator's letters. Where there are several, the words of the row decide."""

MICROCIRCUITS = (
    "microcircuit", "microcontroller", "programmable logic", "memory", "analog circuit", "logic", "sensor chip",
)  # fmt: skip

FAMILIES: tuple[frozenset[str], ...] = tuple(
    frozenset(kinds)
    for kinds in (
        ("diode", "led", "zener diode", "schottky diode", "rectifier", "tvs diode", "thyristor", "laser diode",
         "photodetector"),
        ("transistor", "fet", "bipolar transistor", "thyristor", "photodetector"),
        ("resistor", "resistor network", "thermistor", "potentiometer", "varistor"),
        ("inductor", "ferrite bead", "transformer", "filter"),
        ("crystal", "oscillator"),
        ("capacitor", "supercapacitor"),
        (*MICROCIRCUITS, "optocoupler", "oscillator", "solid state relay", "tvs diode", "filter"),
        ("led", "display", "liquid crystal or OLED display", "lamp"),
        ("connector", "socket", "no part"),
        ("switch", "encoder"),
        ("relay", "solid state relay"),
        ("fuse", "resettable fuse"),
    )
)  # fmt: skip
"""Kinds that share letters: other words in the row of a part with these letters speak of something else."""


@dataclass(frozen=True)
class Spoken:
    """The cells of a row that may say what kind of part it is."""

    names: tuple[str, ...]
    """Cells that describe a part in words: description, library."""
    value: str = ""
    """A value is often a label: what a connector leads to."""
    part_number: str = ""
    note: str = ""
    footprint: str = ""
    measured: frozenset[str] = frozenset()
    """Kinds that its value can be of: 10u is a capacitance or an inductance."""
    stated: frozenset[str] = frozenset()
    """Kinds that the unit of its value states outright: 10uF is a capacitance."""
    coded: str = ""
    """The kind that its maker's number says by a published code."""


GUESS = "a guess, by its letters alone"
"""The reason given for a kind that nothing but the reference tells."""

GUESS_OF_BOARD = "a guess: its footprint is named after it and not after a package, and it may be a board"
"""Why what letters and words take for a circuit may be a whole board."""

GUESS_BY_VALUE = "a guess, by its value alone"
"""Why a part without letters that mean something is of a kind."""


def is_guess(why: str) -> bool:
    """Whether a kind is taken from what does not really tell it."""
    return why.startswith("a guess")


def kind_of(letters: str, row: Spoken) -> tuple[str, str, str]:
    """The kind of a part, why, unless its words and letters agree, and what speaks against it; '' where nothing does.

    Words that name what is no electronic part, or another kind, are believed before the letters, and so is a maker's
    number; of a value or a note, which may be a label, only names of parts are.
    """
    lettered = PREFIXES.get(letters, ())
    kinds = {kind for family in FAMILIES if not family.isdisjoint(lettered) for kind in family} | set(lettered)
    if other := _other_than_electronic(lettered, row):
        return other, "by its words", ""
    kind, why = _electronic(lettered, kinds, row)
    if kind in MICROCIRCUITS and not is_guess(why) and _named_after_itself(row):
        why = GUESS_OF_BOARD
    against = []
    if row.coded and kind and kind != row.coded and not _alike(kind, row.coded):
        against.append(f"its maker's number is of a {row.coded}")
    if row.stated and kind in _IN_UNITS and not any(_alike(kind, other) for other in row.stated):
        against.append(f"its value is of a {' or '.join(sorted(row.stated))}")
    if kind and len(lettered) == 1 and lettered[0] in _IN_UNITS and kind not in kinds:
        against.append(f"its reference is of a {lettered[0]}")
    if not kind and row.measured and len(lettered) == 1 and lettered[0] in _IN_UNITS:
        may = " or ".join(sorted(row.measured))
        return "", "", f"its value is of a {may}, its reference of a {lettered[0]}; neither is taken"
    return kind, why, f"{', '.join(against)}; taken for a {kind}" if against else ""


def _electronic(lettered: tuple[str, ...], kinds: set[str], row: Spoken) -> tuple[str, str]:
    said = " ".join((*row.names, row.value, row.part_number))
    if lettered and (found := _first(kinds, said, numbers_first=True) or _first(kinds, row.note)):
        if found == "ferrite bead" and "inductor" in row.measured:  # beads have ohms: it has a core of ferrite
            return "inductor", ""
        sure = len(lettered) == 1 and _ORDER.index(lettered[0]) < _ORDER.index(found) and found != "microcircuit"
        return (lettered[0] if sure else found), ""  # RN is a network, also where its words say resistor
    if row.coded:
        return row.coded, "" if row.coded in kinds else "by its maker's number"
    bare = re.fullmatch(r"[0-9]*\.?[0-9]+", row.value)  # ohms, in a column of values
    of_value = [kind for kind in lettered if kind in row.measured or (kind == "resistor" and bare)]
    if len(of_value) == 1:
        return of_value[0], ""
    if found := _named(lettered, row):
        return found, "by its words"
    land = row.footprint.rpartition(":")[2]
    footprint = land if lettered and _SHAPE.match(land) else row.footprint  # a fuse may be on a land for resistors
    if found := _first(kinds if not _CONNECTS.isdisjoint(lettered) else _ELECTRONIC, footprint):
        return found, "" if found in lettered else "by its footprint"
    if "inductor" in lettered and "resistor" in row.measured:  # beads are sold by their ohms at 100 MHz
        return "ferrite bead", GUESS_BY_VALUE
    if not lettered or (row.stated and lettered[0] in (*_IN_UNITS, *MICROCIRCUITS)):
        return _by_shape_or_value(row)
    if lettered[0] in _IN_UNITS and row.measured and not any(_alike(lettered[0], kind) for kind in row.measured):
        return "", ""
    return (lettered[0], GUESS) if len(lettered) == 1 else ("", "")


def _by_shape_or_value(row: Spoken) -> tuple[str, str]:
    """What a land pattern such as R0603 says, where the value can be of it; else the unit of the value."""
    shape = _SHAPE.match(row.footprint.rpartition(":")[2])
    kinds = PREFIXES.get(shape[1].upper(), ()) if shape else ()
    if len(kinds) == 1 and (not row.measured or kinds[0] in row.measured):
        return kinds[0], "by its footprint"
    if len(row.stated) == 1:
        return next(iter(row.stated)), "by its value"
    return (next(iter(row.measured)), GUESS_BY_VALUE) if len(row.measured) == 1 else ("", "")


def _alike(kind: str, other: str) -> bool:
    """Whether two kinds are measured alike or share their letters."""
    return kind == other or any({kind, other} <= family for family in FAMILIES)


def _named_after_itself(row: Spoken) -> bool:
    """Whether a footprint is called after the part that stands on it, as those of bought boards are."""
    footprint = row.footprint.rpartition(":")[2]
    name = re.match(r"[A-Za-z]+[0-9]\w*", row.value)
    return bool(name and footprint.casefold().startswith(name[0].casefold()) and not _PACKAGE.search(row.footprint))


def _named(lettered: tuple[str, ...], row: Spoken) -> str:
    """The kind that words name, against the letters or without any."""
    circuit = not _CIRCUITS.isdisjoint(lettered)
    for said in row.names if lettered else (*row.names, row.value, row.note):
        cell = _BUS.sub("", said) if circuit else said  # a circuit for USB is no plug
        if found := _first(_ELECTRONIC, _beginning(cell)) or _first(_ELECTRONIC, cell):
            board = not row.footprint and not lettered and found in MICROCIRCUITS and _ON_BOARDS.search(cell)
            return DEVICE if board and not _by_number(found, f"{cell} {row.value} {row.part_number}") else found
    if lettered and not _CONNECTS.isdisjoint(lettered):
        return ""
    return next((kind for kind in _ELECTRONIC if _by_number(kind, f"{row.value} {row.part_number}")), "")


def _other_than_electronic(lettered: tuple[str, ...], row: Spoken) -> str:
    """A kind that is no electronic part, where the words of a cell end in its name: a button head screw."""
    label = row.footprint or not _CONNECTS.isdisjoint(lettered)
    for cell in (*row.names, *(() if label else (row.value,))):
        words = _beginning(cell)
        if _CATALOGUE.match(words):
            return ""
        ends = {
            kind: match.end()
            for kind, pattern in _KIND_WORDS.items()
            for match in pattern.finditer(words)
            if kind in OTHER or not re.search("[0-9]", match[0])
        }
        if ends:  # a number that follows is of it, and not what it is: linear bearing LM8UU
            last = max(ends, key=lambda kind: (ends[kind], kind in OTHER))
            return last if last in OTHER and not (last == DEVICE and _PACKAGE.search(row.footprint)) else ""
    marked = f"{row.value} {row.footprint}" if row.footprint else ""
    if "no part" in (found := _first(OTHER, spread(row.value)), _first(OTHER, spread(marked))):
        return "no part"
    stands = _first({DEVICE}, row.footprint.rpartition(":")[2])  # RPi_Pico
    return DEVICE if stands and (found == DEVICE or not _CIRCUITS.isdisjoint(lettered)) else ""


def _first(kinds: Collection[str], words: str, *, numbers_first: bool = False) -> str:
    """The most special of some kinds that words name, by the number of a part before all others where that is asked."""
    if numbers_first and (found := next((one for one in _ORDER if one in kinds and _by_number(one, words)), "")):
        return found
    words = spread(words)
    return next((kind for kind in _ORDER if kind in kinds and _KIND_WORDS[kind].search(words)), "")


def _by_number(kind: str, words: str) -> bool:
    """Whether words name a kind by the number of a part."""
    return any(re.search(r"[0-9]", match[0]) for match in _KIND_WORDS[kind].finditer(spread(words)))


def _beginning(cell: str) -> str:
    """The beginning of a cell, which names the part, without what it is for, with or of."""
    return _APART.split(spread(cell), maxsplit=1)[0]


def spread(words: str) -> str:
    """Words that were written together apart: PinHeader_1x04 has three."""
    return re.sub(r"(?<=[a-z])(?=[A-Z])", " ", words).replace("_", " ")


def any_of(words: str) -> re.Pattern[str]:
    """Return a pattern for any of these words, whole, in upper or lower case."""
    return re.compile(rf"(?<![^\W_])(?:{words})(?![^\W_])", re.IGNORECASE)


_KIND_WORDS = {kind: any_of(words) for kind, words in KINDS.items()}
_ORDER = tuple(KINDS)
_ELECTRONIC = tuple(kind for kind in KINDS if kind not in OTHER)
_CONNECTS = frozenset({"connector", "socket"})
_CIRCUITS = frozenset(MICROCIRCUITS)
_IN_UNITS = frozenset({"resistor", "capacitor", "inductor", "crystal"})
_BUS = re.compile(r"(?<![^\W_])usb(?![^\W_])", re.IGNORECASE)
"""A word by which connectors are called, and circuits that only serve them."""

_SHAPE = re.compile(r"(R|C|L|CP|LED|FB)[_-]?(?:0[1-9][0-9]{2,3}|1[0-9]{3}|2[0-9]{3})(?![0-9])", re.IGNORECASE)
"""Land patterns that say by a letter what stands on them: R0603, C_0805_2012Metric."""

_APART = re.compile(
    r"[,;:(]|\s[-–]\s|(?<=\w)\s+(?:for|with|w/?|without|to|from|of|incl|für|mit|pour|avec)(?=\s|$|/)", re.IGNORECASE
)
_CATALOGUE = re.compile(
    r"(?:res|cap|conn|ic|ind|fixed ind|diode|mosfet|trans|transistor|ferrite|crystal|inductor|resistor|capacitor|"
    r"header|"
    r"term|terminal|thermistor|filter|mcu)(?![^\W_])",
    re.IGNORECASE,
)
_ON_BOARDS = re.compile(
    r"accelerometers?|gyro\w*|magnetometers?|compass|imus?|\w+ sensors?|amplifiers?|drivers?|v?reg|regulators?|"
    r"\w*regler|controllers?|converters?|dc-?dc|treiber",
    re.I,
)
"""Words for circuits that are also sold as whole boards.

A part with such a word is taken for a board unless reference letters, a package or a part number tell of a circuit.
"""

_PACKAGE = re.compile(r"(?<![A-Za-z])(?:[A-Z]*QF[NP]|LGA|[A-Z]*BGA|SO[TP]?|[A-Z]*SOP|SOIC|DFN|LCC|WLCSP)-?[0-9]")
