"""The power that makers usually rate parts for, by the size of a chip and by the package of a transistor."""

from __future__ import annotations

from robophm.design.importers.bom.kinds import any_of

CHIP_POWER = {
    "01005": "0.031 W", "0201": "0.05 W", "0402": "0.0625 W", "0603": "0.1 W", "0805": "0.125 W", "1206": "0.25 W",
    "1210": "0.5 W", "1218": "1 W", "2010": "0.75 W", "2512": "1 W",
}  # fmt: skip
"""The power that makers usually rate a chip resistor for, by size."""

PACKAGE_POWER = {
    "0.3 W": any_of(r"SOT-?(23|323|363|523)(-[0-9])?|SC-?(59|70)(-[0-9])?"),
    "0.6 W": any_of(r"TO-?92\w*"),
    "1 W": any_of(r"SOT-?89(-[0-9])?"),
    "1.5 W": any_of(r"SOT-?223(-[0-9])?"),
    "2 W": any_of(r"(SO|SOIC|SOP)-?8"),
    "20 W": any_of(r"TO-?126(-[0-9])?"),
    "50 W": any_of(r"D-?PAK|TO-?252(-[0-9])?"),
    "100 W": any_of(r"TO-?220\w*(-[0-9])?|D2-?PAK|TO-?263(-[0-9])?"),
    "200 W": any_of(r"TO-?247(-[0-9])?|TO-?3P?"),
}
"""The power that makers usually rate a transistor for, by package."""
