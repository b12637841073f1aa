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

MICROCIRCUITS = Table("generic rate λg of microcircuits at πQ = πL = 1", SOURCE, """
    pla-bipolar-200              0.0061 .016  .029  .027  .040  .032  .037  .044  .061  .054  .0061 .034  .076  1.2
    pla-bipolar-1000             .011  .028  .048  .046  .065  .054  .063  .077  .10   .089  .011  .057  .12   1.9
    pla-bipolar-5000             .022  .052  .087  .082  .12   .099  .11   .14   .19   .16   .022  .10   .22   3.3
    pla-mos-500                  .0046 .018  .035  .035  .052  .035  .044  .044  .070  .070  .0046 .044  .10   1.9
    pla-mos-1000                 .0056 .021  .042  .042  .062  .042  .052  .053  .084  .083  .0056 .052  .12   2.3
    pla-mos-5000                 .0061 .022  .043  .042  .063  .043  .054  .055  .086  .084  nan   .053  .13   2.3
    pla-mos-20000                .0095 .033  .064  .063  .094  .065  .080  .083  .13   .13   .0095 .079  .19   3.3
    logic-bipolar-100            .0036 .012  .024  .024  .035  .025  .030  .032  .049  .047  .0036 .030  .069  1.2
    logic-bipolar-1000           .0060 .020  .038  .037  .055  .039  .048  .051  .077  .074  .0060 .046  .11   1.9
    logic-bipolar-3000           .011  .035  .066  .065  .097  .070  .085  .091  .14   .13   .011  .082  .19   3.3
    logic-bipolar-10000          .033  .12   .22   .22   .33   .23   .28   .30   .46   .44   .033  .28   .65   12
    logic-bipolar-30000          .052  .17   .33   .33   .48   .34   .42   .45   .68   .65   .052  .41   .95   17
    logic-bipolar-60000          .075  .23   .44   .43   .63   .46   .56   .61   .90   .85   .075  .53   1.2   21
    logic-mos-100                .0057 .015  .027  .027  .039  .029  .035  .039  .056  .052  .0057 .033  .074  1.2
    logic-mos-1000               .010  nan   .045  .043  .062  .049  .057  .068  .092  .083  .010  .053  .12   1.9
    logic-mos-3000               .019  .047  .080  .077  .11   .088  .10   .12   .17   .15   .019  .095  .21   3.3
    logic-mos-10000              .049  .14   .25   .24   .36   .27   .32   .36   .51   .48   .049  .30   .69   12
    logic-mos-30000              .084  .22   .39   .37   .54   .42   .49   .56   .79   .72   .084  .46   1.0   17
    logic-mos-60000              .13   .31   .53   .51   .73   .59   .69   .82   1.1   .98   .13   nan   1.4   21
    linear-100                   .0095 .024  .039  .034  .049  .057  .062  .12   .13   .076  .0095 .044  .096  1.1
    linear-300                   .017  .041  .065  .054  .078  .10   .11   .22   .24   .13   .017  .072  .15   1.4
    linear-1000                  .033  .074  .11   .092  .13   .19   .19   .41   .44   .22   .033  .12   .26   2.0
    linear-10000                 .050  .12   .18   .15   .21   .30   .30   .63   .67   .35   .050  .19   .41   3.4
    processor-bipolar-8          .028  .061  .098  .091  .13   .12   .13   .17   .22   .18   .028  .11   .24   3.3
    processor-bipolar-16         .052  .11   .18   .16   .23   .21   .24   .32   .39   .31   .052  .20   .41   5.6
    processor-bipolar-32         .11   .23   .36   .33   .47   .44   .49   .65   .81   .65   .11   .42   .86   12
    processor-mos-8              .048  .089  .13   .12   .16   .16   .17   .24   .28   .22   .048  .15   .28   3.4
    processor-mos-16             .093  .17   .24   .22   .29   .30   .32   .45   .52   .40   .093  .27   .50   5.6
    processor-mos-32             .19   .34   .49   .45   .60   .61   .66   .90   1.1   .82   .19   .54   1.0   12
    memory-mos-rom-16384         .0047 .018  .036  .035  .053  .037  .045  .048  .074  .071  .0047 .044  .11   1.9
    memory-mos-rom-65536         .0059 .022  .043  .042  .063  .045  .055  .060  .090  .086  .0059 .053  .13   2.3
    memory-mos-rom-262144        .0067 .023  .045  .044  .066  .048  .059  .068  .099  .089  .0067 .055  .13   2.3
    memory-mos-rom-1048576       .011  .036  .068  .066  .098  .075  .090  .11   .15   .14   .011  .083  .20   3.3
    memory-mos-prom-16384        .0049 .018  .036  .036  .053  .037  .046  .049  .075  .072  .0048 .045  .11   1.9
    memory-mos-prom-65536        .0061 .022  .044  .043  .064  .046  .056  .062  .093  .087  .0062 .054  .13   2.3
    memory-mos-prom-262144       .0072 .024  .048  .045  .067  .051  .061  .073  .10   .092  .0072 .057  .13   2.3
    memory-mos-prom-1048576      .012  .038  .071  .068  .10   .080  .095  .12   nan   .14   .012  .086  .20   3.3
    memory-mos-dram-16384        .0040 .014  .027  .027  .040  .029  .035  .040  .059  .055  .0040 .034  .080  1.4
    memory-mos-dram-65536        .0055 .019  nan   .034  .051  .039  .047  .056  .079  .070  .0055 .043  .10   1.7
    memory-mos-dram-262144       .0074 .023  .043  .040  .060  .049  .058  .076  .10   .084  .0074 .051  .12   1.9
    memory-mos-dram-1048576      .011  .032  .057  .053  .077  .070  .080  .12   .15   .11   .011  .067  .15   2.3
    memory-mos-sram-16384        .0079 .022  .038  .034  .050  .048  .054  .083  .10   .073  .0079 .044  .098  1.4
    memory-mos-sram-65536        .014  .034  .057  .050  .073  .077  .085  .14   .17   .11   .014  .065  .14   1.8
    memory-mos-sram-262144       .023  .053  .084  .071  .10   .12   .13   .25   .27   .16   .023  .092  .19   1.9
    memory-mos-sram-1048576      .043  .092  .14   .11   .16   .22   .23   .46   .49   .26   .043  .15   .30   2.3
    memory-bipolar-rom-16384     .010  .028  .050  .046  .067  .062  .070  .10   .13   .096  .010  .058  .13   1.9
    memory-bipolar-rom-65536     .017  .043  .071  .063  .091  .095  .11   .18   .21   .14   .017  .081  .18   2.3
    memory-bipolar-rom-262144    .028  .065  .10   .085  .12   .15   nan   .30   .33   .19   .028  .11   .23   2.3
    memory-bipolar-rom-1048576   .053  .12   .18   .15   .21   .27   .29   .56   .61   .33   .053  .19   .39   3.4
    memory-bipolar-sram-16384    .0075 .023  .043  .041  .060  .050  .058  .077  .10   .084  .0075 .052  .12   1.9
    memory-bipolar-sram-65536    .012  .033  .058  .054  .079  .072  .083  .12   .15   .11   .012  .069  .15   2.3
    memory-bipolar-sram-262144   .018  .045  .074  .065  .095  .10   .11   .19   .22   .14   .018  .084  .18   2.3
    memory-bipolar-sram-1048576  .033  .079  .13   .11   .16   .18   .20   .35   .39   .24   .033  .14   .30   3.4
    gaas-mmic-100                .019  .034  .046  .039  .052  .065  .068  .11   .12   .076  .019  .049  .086  .61
    gaas-mmic-1000               .025  .047  .067  .058  .079  .091  .097  .15   .17   .11   .025  .073  .14   1.3
    gaas-digital-1000            .0085 .030  .057  .057  .084  .060  .073  .080  .12   .11   .0085 .071  .17   3.0
    gaas-digital-10000           .014  .053  .10   .10   .15   .11   .13   .14   .22   .21   .014  .13   .31   5.5
""", columns=tuple(ENVIRONMENTS))  # fmt: skip
"""Generic rates λg of microcircuits [failures/10⁶ h] by environment.

A row is a kind, a technology, and the largest number of gates, transistors, bits or elements. Six misprinted cells are
left out.
"""

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
        "part": Choice((*RATES, *MICROCIRCUITS), "generic part"),
        "quality_factor": Range(
            1e-3,
            30.0,
            "",
            "πQ of the part's own section, times πL of a microcircuit; 1 where λg is printed",
            monotone=1,
        ),
        "environment": environment_choice(ENVIRONMENTS),
    },
)
def hazard_rate(part: str, quality_factor: Array, environment: str) -> Factor:
    """λp = λg · πQ"""
    rate = (MICROCIRCUITS if part in MICROCIRCUITS else RATES).cell(part, environment)
    if np.isnan(rate):
        raise ModelError(f"mil_hdbk_217f.parts_count: no published rate for {part} in {environment}")
    return (
        Factor("λg", rate, f"{part} in {environment}; {CONDITIONS.get(part, '')}".rstrip("; ") + ", failures/10⁶ h")
        * Factor("πQ", np.asarray(quality_factor), "of the part's own section")
        * per_million_hours()
    )
