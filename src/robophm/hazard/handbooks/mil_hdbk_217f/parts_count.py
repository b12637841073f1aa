"""MIL-HDBK-217F(2) Appendix A, parts count:  λp = λg · πQ   failures/10⁶ h

Published generic rates at the appendix's default stresses and temperature of the environment, for a design of which no
more is known than its parts. Where the stresses are known, use the part's own section.
"""

from __future__ import annotations

import numpy as np

from robophm.core.errors import ModelError
from robophm.core.table import Source, Table
from robophm.hazard.environments import ENVIRONMENTS, environment_choice
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, per_million_hours
from robophm.hazard.model import Array, Choice, Factor, Range, hazard_model

SOURCE = Source(
    TITLE,
    "A",
    "–",
    "two unrelated transcriptions of what is printed, every row here reproduced from the equations; "
    "the rectangular connector and the toggle switch in CL are misprinted and left out",
)

RATES = Table("generic rate λg at πQ = 1", SOURCE, """
    diode-general              .0036  .028  .049  .043  .1    .092  .21   .2   .44  .17   .0018   .076  .23   1.5
    diode-switching            .00094 .0075 .013  .011  .027  .024  .054  .054 .12  .045  .00047  .02   .06   .4
    diode-power-rectifier      .0028  .022  .039  .034  .082  .073  .16   .16  .35  .13   .0014   .06   .18   1.2
    diode-transient-suppressor .0029  .023  .04   .035  .084  .075  .17   .17  .36  .14   .0015   .062  .18   1.2
    diode-voltage-reference    .0033  .024  .039  .035  .082  .066  .15   .13  .27  .12   .0016   .06   .16   1.3
    bjt-small-signal           .00015 .0011 .0017 .0017 .0037 .003  .0067 .006 .013 .0056 .000073 .0027 .0074 .056
    bjt-power                  .0057  .042  .069  .063  .15   .12   .26   .23  .5   .22   .0029   .11   .29   2.2
    fet-silicon-lf             .014   .099  .16   .15   .34   .28   .62   .53  1.1  .51   .0069   .25   .68   5.3
    resistor-rcr               .0022  .011  .051  .034  .13   .071  .091  .17  .23  .25   .0011   .12   .34   4.9
    resistor-rlr               .0037  .016  .07   .05   .18   .08   .11   .16  .22  .29   .0018   .16   .4    7.0
    resistor-rbr               .0024  .01   .044  .031  .11   .054  .069  .11  .15  .19   .0012   .1    .26   4.5
    resistor-rwr               .0085  .038  .16   .11   .41   .19   .25   .38  .52  .68   .0043   .36   .94   16
    resistor-rth               .0014  .0058 .023  .017  .061  .026  .033  .045 .062 .091  .0007   .054  .13   2.5
    capacitor-ck               .0017  .026  .064  .018  .048  .057  .071  .2   .24  .19   .00086  .064  .24   1.5
    capacitor-cdr              .0035  .053  .13   .037  .098  .12   .14   .41  .49  .38   .0017   .13   .48   3.0
    capacitor-csr              .0014  .017  .037  .012  .027  .026  .032  .068 .082 .087  .0007   .037  .11   .96
    capacitor-clr              .0022  .026  .057  .018  .042  .04   .05   .11  .13  .13   .0011   .057  .17   1.5
    capacitor-cu               .0013  .019  .047  .014  .036  .042  .052  .15  .18  .14   .00063  .047  .17   1.1
    capacitor-cm               .00057 .0088 .022  .0062 .016  .019  .024  .069 .082 .064  .00029  .022  .08   .5
    capacitor-ch               .00051 .0061 .013  .0043 .01   .0095 .012  .025 .03  .032  .00025  .013  .039  .35
    transformer-power          .053   .36   .77   .3    1.0   .44   .58   .6   .77  1.7   .026    .83   2.5   37
    transformer-audio          .015   .1    .22   .086  .29   .12   .17   .17  .22  .5    .0075   .24   .7    10
    relay-general              .049   .12   1.0   .5    1.9   .6    .77   1.3  1.4  3.9   .025    1.7   5.7   nan
    switch-toggle              .1     .3    1.8   .8    2.9   1.0   1.8   1.3  2.2  4.6   .05     2.5   6.7   nan
    circuit-breaker            .68    1.4   10    5.4   18    4.8   6.1   7.5  8.2  31    .34     17    45    nan
    connector-circular         .0011  .0013 .011  .0065 .018  .0049 .0082 .016 .025 .031  .00055  .014  .044  .64
    connector-card-edge        .044   .052  .45   .26   .73   .2    .33   .65  .98  1.3   .022    .56   1.8   25
    socket-ic                  .0035  .011  .049  .021  .063  .028  .042  .039 .046 .088  .0018   .049  .13   2.3
    fuse                       .01    .02   .08   .05   .11   .09   .12   .15  .18  .16   .009    .1    .21   2.3
""", columns=tuple(ENVIRONMENTS))  # fmt: skip

CONDITIONS = {
    "diode-general": "S = 0.7, bonded",
    "diode-switching": "S = 0.7, bonded",
    "diode-power-rectifier": "S = 0.7, bonded",
    "diode-transient-suppressor": "bonded",
    "diode-voltage-reference": "bonded",
    "bjt-small-signal": "switching, 0.5 W, S = 0.5",
    "bjt-power": "linear, 100 W, S = 0.8",
    "fet-silicon-lf": "MOSFET, switching",
    "resistor-rcr": "S = 0.5, 0.5 W",
    "resistor-rlr": "S = 0.5, 0.5 W",
    "resistor-rbr": "S = 0.5, 0.5 W",
    "resistor-rwr": "S = 0.5, 8 W",
    "resistor-rth": "thermistor, 0.5 W",
    "capacitor-ck": "S = 0.4, 2 µF",
    "capacitor-cdr": "S = 0.4, 2 µF",
    "capacitor-csr": "S = 0.4, 150 µF, 0.7 ohm/V",
    "capacitor-clr": "S = 0.4, 1000 µF",
    "capacitor-cu": "S = 0.4, 6000 µF",
    "capacitor-cm": "S = 0.4, 0.003 µF",
    "capacitor-ch": "S = 0.4, 3 µF",
    "relay-general": "SPST, S = 0.5 resistive, 10 cycles/h, rated 85 °C, πF 5",
    "switch-toggle": "1 contact, no load; the printed 32 of CL contradicts §14.1",
    "circuit-breaker": "2 poles",
    "connector-circular": "no warmer than ambient, 0.05 matings/1000 h",
    "connector-card-edge": "no warmer than ambient, 0.05 matings/1000 h",
    "socket-ic": "40 pins",
}
"""The default stresses behind a row; those without were printed at a default temperature alone."""


@hazard_model(
    source=SOURCE,
    inputs={
        "part": Choice(RATES, "generic part"),
        "quality_factor": Range(1e-3, 30.0, "", "πQ of the part's own section; 1 where λg is printed", monotone=1),
        "environment": environment_choice(ENVIRONMENTS),
    },
)
def hazard_rate(part: str, quality_factor: Array, environment: str) -> Factor:
    """λp = λg · πQ"""
    rate = RATES.cell(part, environment)
    if np.isnan(rate):
        raise ModelError(f"mil_hdbk_217f.parts_count: no published rate for {part} in {environment}")
    return (
        Factor("λg", rate, f"{part} in {environment}; {CONDITIONS.get(part, '')}".rstrip("; ") + ", failures/10⁶ h")
        * Factor("πQ", np.asarray(quality_factor), "of the part's own section")
        * per_million_hours()
    )
