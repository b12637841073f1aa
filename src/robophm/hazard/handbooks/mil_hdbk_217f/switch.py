"""MIL-HDBK-217F(2) §14.1, switches:  λp = λb · πL · πC · πQ · πE   failures/10⁶ h"""

from __future__ import annotations

from robophm.core.errors import ModelError
from robophm.core.table import Source, Table
from robophm.hazard.environments import environment_choice
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, per_million_hours
from robophm.hazard.handbooks.mil_hdbk_217f._contacts import LOAD, load_factor
from robophm.hazard.model import Array, Choice, Factor, Range, hazard_model

SOURCE = Source(
    TITLE,
    "14.1",
    "–",
    "two transcriptions agree; toggle checked against Appendix A but for CL: it prints 32, the equation gives 120",
)

STYLE = Table("switch λb", SOURCE, """
    centrifugal  3.4
    DIP          0.00012  dual in-line package
    limit        4.3
    liquid       2.3      liquid level
    microwave    1.7      waveguide
    pressure     2.8
    pushbutton   0.10
    reed         0.0010
    rocker       0.023
    rotary       0.11
    sensitive    0.49
    thermal      0.031
    thumbwheel   0.18
    toggle       0.10
""")  # fmt: skip

CONTACTS = Table("switch contacts Nc", SOURCE, """
    SPST  1
    DPST  2
    SPDT  2
    3PST  3
    4PST  4
    DPDT  4
    3PDT  6
    4PDT  8
    6PDT  12
""")  # fmt: skip

QUALITY = Table("switch πQ", SOURCE, """
    MIL-SPEC  1
    lower     2
""")  # fmt: skip

ENVIRONMENT = Table("switch πE", SOURCE, """
    GB   1
    GF   3
    GM   18
    NS   8
    NU   29
    AIC  10
    AIF  18
    AUC  13
    AUF  22
    ARW  46
    SF   0.5
    MF   25
    ML   67
    CL   1200  Appendix A prints a rate that needs 320
""")  # fmt: skip

WITH_CONTACT_FACTOR = ("toggle", "pushbutton")


@hazard_model(
    source=SOURCE,
    inputs={
        "style": Choice(STYLE, "type of switch", aliases={"button": "pushbutton", "micro": "sensitive"}),
        "contact_form": Choice(CONTACTS, "form of the contacts; toggle and pushbutton need it", required=False),
        "load": Choice(LOAD, "kind of load; resistive where the switch is rated by inductive load"),
        "load_current": Range(0.0, 1e3, "A", "current of the load", monotone=1, stress="current"),
        "rated_current": Range(1e-3, 1e3, "A", "rated resistive current", monotone=-1),
        "quality": Choice(QUALITY, "quality level", default="lower", aliases={"commercial": "lower"}),
        "environment": environment_choice(ENVIRONMENT),
    },
)
def hazard_rate(
    style: str,
    load: str,
    load_current: Array,
    rated_current: Array,
    quality: str,
    environment: str,
    contact_form: str | None = None,
) -> Factor:
    """λp = λb · πL · πC · πQ · πE"""
    if style not in WITH_CONTACT_FACTOR:
        contacts = Factor("πC", 1.0, "1 for every style but toggle and pushbutton")
    elif contact_form is None:
        raise ModelError(f"mil_hdbk_217f.switch: style {style} needs 'contact_form' (one of {', '.join(CONTACTS)})")
    else:
        contacts = Factor("πC", CONTACTS[contact_form] ** 0.33, f"{contact_form}: {CONTACTS[contact_form]:g} contacts")
    return (
        Factor("λb", STYLE[style], f"{style} {STYLE.notes[style]}".rstrip() + ", failures/10⁶ h")
        * load_factor(load, load_current, rated_current)
        * contacts
        * Factor("πQ", QUALITY[quality], f"quality {quality}")
        * Factor("πE", ENVIRONMENT[environment], f"environment {environment}")
        * per_million_hours()
    )
