"""Whatever is wrong with a design file: one line with file, line, place, what is wrong and what was expected."""

import re
import time

import pytest

from robophm.core.errors import DesignError
from robophm.design.file import parse

HEAD = "schema_version: 1\nname: R\n"
PART = "{rate: 1 FIT}"
TWO = HEAD + "components:\n  A: {rate: 1 FIT}\n  B: {rate: 1 FIT}\n"
HOT = HEAD + "acceleration: {model: q10}\ncomponents: {A: {rate: 1 FIT}}\n"
CAPACITOR = "model: mil_hdbk_217f.capacitor, inputs: {style: CDR, capacitance: 1 uF, temperature: 40 degC, "
CAPACITOR += "dc_voltage: 5 V, rated_voltage: 10 V, environment: GM}"


def part(text):
    return f"{HEAD}components:\n  A: {{{text}}}\n"


def signal(text):
    return HOT + f"signals:\n  temperature: {{{text}}}\n"


# name: (the design, the line of the fault, what the error says after it)
FAULTS = {
    "no version": ("name: R\n", 1, "schema_version: not stated; expected 1"),
    "another version": ("schema_version: 2\n", 1, "schema_version: 2; expected 1"),
    "version as text": ("name: R\nschema_version: '1'\n", 2, "schema_version: '1'; expected 1"),
    "version true": ("schema_version: true\n", 1, "schema_version: True; expected 1"),
    "no name": ("schema_version: 1\ncomponents: {A: {rate: 1 FIT}}\n", 1, "needs 'name'"),
    "no parts": (HEAD, 1, "has no parts; expected modules or components"),
    "empty module": (HEAD + "modules:\n  M: {}\n", 4, "modules/M: has no parts; expected modules or components"),
    "unknown key": (TWO + "tresholds: {}\n", 6, "tresholds: unknown key 'tresholds'; did you mean 'thresholds'?"),
    "unknown key of a part": (
        part("rate: 1 FIT,\n    quantitty: 3"),
        5,
        "components/A/quantitty: unknown key 'quantitty'; did you mean 'quantity'?",
    ),
    "unknown key of a module": (
        HEAD + "modules:\n  M:\n    komponents: {}\n",
        5,
        "modules/M/komponents: unknown key 'komponents'; did you mean 'components'?",
    ),
    "misspelt before missing": (
        signal("topic: /a, feld: x"),
        6,
        "signals/temperature/feld: unknown key 'feld'; did you mean 'field'? (and 1 more)",
    ),
    "duplicate key": (HEAD + "name: S\n", 3, "duplicate name 'name'; names of one level must differ"),
    "duplicate part": (TWO + "  A: {rate: 2 FIT}\n", 6, "components: duplicate name 'A'"),
    "module and part of one name": (
        TWO + "modules:\n  A: {components: {X: {rate: 1 FIT}}}\n",
        4,
        "components/A: duplicate name 'A': a module here has it too",
    ),
    "no rate": (part(""), 4, "components/A: has no rate; expected rate, mtbf, l10, hazard, part, failure_modes, or"),
    "part of nothing": (HEAD + "components:\n  A:\n", 4, "components/A: expected keys with values, not None"),
    "parts as list": (HEAD + "components: [A]\n", 3, "components: expected keys with values, not ['A']"),
    "negative rate": (part("rate: -1 FIT"), 4, "components/A/rate: hazard rate -1 FIT; expected above zero"),
    "zero rate": (part("rate: 0 /h"), 4, "components/A/rate: hazard rate 0 /h; expected above zero"),
    "vanishing rate": (part("rate: 1e-400 /h"), 4, "components/A/rate: hazard rate 1e-400 /h; expected above zero"),
    "nan rate": (part("rate: .nan"), 4, "components/A/rate: nan is not a finite number"),
    "infinite rate": (part("rate: .inf"), 4, "components/A/rate: inf is not a finite number"),
    "nan in words": (part("rate: nan /h"), 4, "components/A/rate: 'nan /h' is not a number with a unit"),
    "overflowing rate": (part("rate: 1e400 /h"), 4, "components/A/rate: 1e400 is not a finite number"),
    "endless integer": (part("rate: " + "9" * 400), 4, "components/A/rate: inf is not a finite number"),
    "rate without unit": (part("rate: 1e-6"), 4, "components/A/rate: '1e-06' has no unit; expected e.g. '1e-06 1/h'"),
    "rate of another kind": (part("rate: 3 h"), 4, "components/A/rate: unit 'h' does not measure what '1/h' does"),
    "rate of another clock": (part("rate: 3 /km"), 4, "components/A/rate: unit '/km' does not measure what '1/h'"),
    "rate is true": (part("rate: true"), 4, "components/A/rate: expected a quantity with its unit, e.g. '12 FIT'"),
    "rate is a list": (part("rate: [1 FIT]"), 4, "components/A/rate: expected a quantity with its unit"),
    "zero rate of a model": (
        part("hazard: {model: general.constant, inputs: {rate: 0 FIT}}"),
        4,
        "components/A/hazard: hazard rate 0; expected above zero",
    ),
    "rate and hazard": (part(f"rate: 1 FIT, hazard: {{{CAPACITOR}}}"), 4, "components/A/rate: both 'rate' and 'haz"),
    "modes and rate": (
        part("rate: 1 FIT, failure_modes: {open: {rate: 1 FIT}}"),
        4,
        "components/A: has failure_modes and its own rate; expected one of the two",
    ),
    "mode without rate": (part("failure_modes: {open: {}}"), 4, "components/A/failure_modes/open: has no rate"),
    "unknown model": (part("hazard: {model: mil_hdbk_217f.capacitr}"), 4, "did you mean 'mil_hdbk_217f.capacitor'?"),
    "model input missing": (
        part("hazard: {model: mil_hdbk_217f.capacitor, inputs: {style: CDR}}"),
        4,
        "components/A/hazard/inputs: mil_hdbk_217f.capacitor needs the input 'capacitance' (1e-06 … 120000 uF)",
    ),
    "model choice": (
        part(f"hazard: {{{CAPACITOR.replace('CDR', 'CDDR')}}}"),
        4,
        "components/A/hazard/inputs/style: mil_hdbk_217f.capacitor: style 'CDDR' is not one of its choices; did you",
    ),
    "number for a choice": (part(f"hazard: {{{CAPACITOR.replace('CDR', '5')}}}"), 4, "style '5' is not one of its"),
    "model input unit": (
        part(f"hazard: {{{CAPACITOR.replace('40 degC', '40')}}}"),
        4,
        "components/A/hazard/inputs/temperature: mil_hdbk_217f.capacitor: temperature: '40' has no unit",
    ),
    "model input range": (part(f"hazard: {{{CAPACITOR.replace('40 degC', '400 degC')}}}"), 4, "is outside -55 … 150"),
    "overstress": (
        part(f"hazard: {{{CAPACITOR.replace('5 V', '50 V')}}}"),
        4,
        "the applied voltage 50 V is more than the rated voltage 10 V",
    ),
    "model of another clock": (
        HEAD + f"usage: {{kilometres: 1 km/h}}\ncomponents:\n  A: {{clock: kilometres, hazard: {{{CAPACITOR}}}}}\n",
        5,
        "components/A: mil_hdbk_217f.capacitor gives 1/h, but its clock 'kilometres' counts km",
    ),
    "quantity zero": (
        part("rate: 1 FIT, quantity: 0"),
        4,
        "components/A/quantity: expected greater than or equal to 1",
    ),
    "quantity broken": (part("rate: 1 FIT, quantity: 1.5"), 4, "components/A/quantity: expected a valid integer"),
    "quantity true": (part("rate: 1 FIT, quantity: true"), 4, "components/A/quantity: expected a valid integer"),
    "quantity endless": (part(f"rate: 1 FIT, quantity: {10**9}"), 4, "less than or equal to 100000"),
    "more required than there are": (
        part("rate: 1 FIT, quantity: 2, required: 3"),
        4,
        "components/A/required: required 3 of quantity 2; expected at most that",
    ),
    "clock without usage": (
        part("rate: 1e-6 /km, clock: kilometres"),
        1,
        "usage: says nothing of 'kilometres', on which A ages; expected e.g. kilometres: 1 km/h",
    ),
    "unknown clock": (part("rate: 1 FIT, clock: days"), 4, "components/A/clock: expected 'operating', 'calendar',"),
    "negative past": (part("rate: 1 FIT, initial_exposure: -1 h"), 4, "components/A/initial_exposure: -1 h is negat"),
    "past of another clock": (part("rate: 1 FIT, initial_exposure: 1 km"), 4, "initial_exposure: unit 'km' does not"),
    "unknown life": (part("rate: 1 FIT, life: {distribution: weibul}"), 4, "did you mean 'weibull'?"),
    "life parameter": (
        part("rate: 1 FIT, life: {distribution: weibull, shap: 2}"),
        4,
        "components/A/life/shap: weibull has no parameter 'shap'; did you mean 'shape'?",
    ),
    "life without shape": (part("rate: 1 FIT, life: {distribution: weibull}"), 4, "'shape' is missing"),
    "life and rate both scale": (
        part("rate: 1 FIT, life: {distribution: weibull, shape: 2, scale: 100 h}"),
        4,
        "components/A/life/scale: a rate and the life's own scale are given; expected one of the two",
    ),
    "life with a negative shape": (part("rate: 1 FIT, life: {distribution: weibull, shape: -2}"), 4, "shape = -2.0"),
    "life with nan": (part("rate: 1 FIT, life: {distribution: weibull, shape: .nan}"), 4, "shape: nan is not a fin"),
    "life without mean": (part("rate: 1 FIT, life: {distribution: loglogistic, shape: 1}"), 4, "the mean is infinite"),
    "life begins after its mean": (
        part("rate: 0.01 /h, life: {distribution: weibull, shape: 2, location: 200 h}"),
        4,
        "components/A/life: Weibull: mean − location = -100",
    ),
    "life as a word": (part("rate: 1 FIT, life: weibull"), 4, "components/A/life: expected keys with values, not 'we"),
    "unknown part": (
        TWO + "diagram:\n  series: [A, Bb]\n",
        7,
        "diagram/series/1: unknown part 'Bb'; did you mean 'B'?",
    ),
    "unknown part of a function": (
        TWO + "functions:\n  drive: {series: [A, X]}\n",
        7,
        "functions/drive/series/1: unknown part 'X'; known: A, B",
    ),
    "k above n": (TWO + "diagram: {k_of_n: {k: 3, of: [A, B]}}\n", 6, "k = 3 of n = 2 blocks; expected 1 ≤ k ≤ n"),
    "network of unknown parts": (
        TWO + "diagram:\n  network:\n    from: in\n    to: out\n    links: [[in, A, out], [in, b, out]]\n",
        10,
        "diagram/network/links: 'b' is neither a part nor in junctions; did you mean 'B'?",
    ),
    "network without a path": (
        TWO + "diagram:\n  network: {from: in, to: out, links: [[in, A], [B, out]]}\n",
        7,
        "diagram/network: no path leads from 'in' to 'out'",
    ),
    "network with a spur": (
        TWO + "diagram: {network: {from: in, to: out, links: [[in, A, out], [A, B]]}}\n",
        6,
        "no path from 'in' to 'out' passes 'B'",
    ),
    "network that joins a part with itself": (
        TWO + "diagram: {network: {from: in, to: out, links: [[in, A, A, out]]}}\n",
        6,
        "joins 'A' with itself",
    ),
    "network of one name": (
        TWO + "diagram: {network: {from: in, to: out, links: [[in]]}}\n",
        6,
        "links/0: has 1; expected at least 2",
    ),
    "network with half a link": (
        TWO + "diagram: {network: {from: in, to: out, links: [{from: in}]}}\n",
        6,
        "links/0: expected between: [A, B], or from: A and to: B",
    ),
    "network whose junction is a part": (
        TWO + "diagram: {network: {from: in, to: out, junctions: [A], links: [[in, A, B, out]]}}\n",
        6,
        "junctions: 'A' is a part, which may fail",
    ),
    "network whose junction is nowhere": (
        TWO + "diagram: {network: {from: in, to: out, junctions: [x], links: [[in, A, B, out]]}}\n",
        6,
        "junctions: no link joins 'x' to anything",
    ),
    "network with an unknown key": (
        TWO + "diagram: {network: {form: in, to: out, links: [[in, A, B, out]]}}\n",
        6,
        "unknown key 'form'; did you mean 'from'?",
    ),
    "k zero": (TWO + "diagram: {k_of_n: {k: 0, of: [A, B]}}\n", 6, "k_of_n/k: expected greater than or equal to 1"),
    "empty group": (TWO + "diagram: {series: []}\n", 6, "diagram/series: is empty; expected at least one"),
    "two kinds of block": (
        TWO + "diagram: {series: [A], parallel: [B]}\n",
        6,
        "diagram/series/parallel: 'parallel' stands beside another kind of block; expected one of series, parallel",
    ),
    "not a block": (TWO + "diagram: [A, B]\n", 6, "diagram: not a block; expected a part's name, or one of series"),
    "nothing in a block": (TWO + "diagram: {series: [A, null]}\n", 6, "diagram/series/1: not a block"),
    "member out of range": (
        part("rate: 1 FIT, quantity: 2") + "diagram: {parallel: ['A[1]', 'A[3]']}\n",
        5,
        "diagram/parallel/1: 'A[3]': A has quantity 2; expected [1] … [2]",
    ),
    "member zero": (part("rate: 1 FIT, quantity: 2") + "diagram: {parallel: ['A[0]', 'A[1]']}\n", 5, "'A[0]': A has"),
    "member not closed": (part("rate: 1 FIT, quantity: 2") + "diagram: 'A[1'\n", 5, "'A[1': A has quantity 2"),
    "module in itself": (
        HEAD + "modules:\n  M: {components: {A: {rate: 1 FIT}}, diagram: {series: [A, /M]}}\n",
        4,
        "modules/M/diagram: cycle: M → M contains itself",
    ),
    "modules in each other": (
        HEAD + f"modules:\n  M: {{components: {{A: {PART}}}, diagram: {{series: [A, /N]}}}}\n"
        f"  N: {{components: {{A: {PART}}}, diagram: {{series: [A, /M]}}}}\n",
        5,
        "modules/N/diagram: cycle: M → N → M contains itself",
    ),
    "robot in itself": (TWO + "diagram: {series: [A, /]}\n", 6, "diagram: cycle: the robot → the robot contains its"),
    "unknown acceleration": (HOT.replace("q10", "q11"), 4, "no acceleration 'q11'; known: arrhenius, "),
    "acceleration in words": (HOT.replace("{model: q10}", "q10"), 3, "acceleration: expected keys with values, not"),
    "acceleration parameter": (HOT.replace("q10", "q10, Q: 2"), 4, "q10 has no input 'Q'; did you mean 'q'?"),
    "acceleration of a fixed input": (
        HOT.replace("q10", "q10, temperature: 40 degC"),
        4,
        "components/A/acceleration/temperature: 'temperature' is what is measured; expected reference_temperature here",
    ),
    "acceleration without its energy": (HOT.replace("q10", "arrhenius"), 4, "needs the input 'activation_energy'"),
    "double: model and factor": (
        part(f"hazard: {{{CAPACITOR}}}, acceleration: {{model: q10}}"),
        4,
        "components/A/acceleration: double acceleration: mil_hdbk_217f.capacitor answers to 'temperature' itself",
    ),
    "double: two factors": (
        part("rate: 1 FIT, acceleration: [{model: q10}, {model: arrhenius, activation_energy: 0.7 eV}]"),
        4,
        "components/A/acceleration: double acceleration: two factors of 'temperature'",
    ),
    "worst of an endless range": (
        signal("topic: /a, field: x, stale: worst"),
        6,
        "signals/temperature: stale: worst needs a 'range'; expected e.g. range: [-20, 80]",
    ),
    "range turned round": (signal("topic: /a, field: x, range: [80, -20]"), 6, "range [80.0, -20.0] does not ascend"),
    "range of nothing": (signal("topic: /a, field: x, range: [5, 5]"), 6, "does not ascend; expected the lower end"),
    "range with nan": (signal("topic: /a, field: x, range: [.nan, 5]"), 6, "range/0: expected a finite number"),
    "range to infinity": (signal("topic: /a, field: x, range: [0, .inf]"), 6, "range/1: expected a finite number"),
    "signal of another kind": (signal("topic: /a, field: x, unit: V"), 6, "unit 'V' does not measure what 'degC' do"),
    "signal of an unknown unit": (signal("topic: /a, field: x, unit: degcc"), 6, "did you mean 'degC'?"),
    "field that is none": (signal("topic: /a, field: 'x['"), 6, "field 'x[' of topic '/a' is not a field path"),
    "topic with a dot": (signal("topic: /a.b, field: x"), 6, "signals/temperature: '/a.b' is not a topic; expected"),
    "topic with a blank": (signal("topic: '/a b', field: x"), 6, "'/a b' is not a topic; expected e.g. '/power/tem"),
    "endless patience": (signal("topic: /a, field: x, max_age: 1e300 s"), 6, "max_age: 1e300 s is too large; expected"),
    "infinite patience": (signal("topic: /a, field: x, max_age: 1e400 s"), 6, "max_age: 1e400 is not a finite number"),
    "negative patience": (TWO + "max_gap: -1 s\n", 6, "max_gap: -1 s is too small; expected at least 0 s"),
    "patience without unit": (TWO + "max_gap: 5\n", 6, "max_gap: '5' has no unit; expected e.g. '5 s'"),
    "rated of what is no share": (
        signal("topic: /a, field: x, rated: 80"),
        6,
        "signals/temperature: 'rated' is given, but this input is measured in degC, not as a share",
    ),
    "rated at nothing": (signal("topic: /a, field: x, rated: 0"), 6, "rated: expected greater than 0, not 0"),
    "offset of no signal": (
        HOT.replace("FIT", "FIT, offsets: {temprature: 5 K}") + "signals: {temperature: {topic: /a, field: x}}\n",
        4,
        "components/A/offsets/temprature: no signal 'temprature' is bound here or above; did you mean 'temperature'?",
    ),
    "offset in degrees": (
        signal("topic: /a, field: x, offset: 15 degC"),
        6,
        "a difference of temperatures is in 'K'",
    ),
    "offset without unit": (signal("topic: /a, field: x, offset: 15"), 6, "'15' has no unit; expected e.g. '15 K'"),
    "powered by no field": (TWO + "powered: {topic: /a, field: 'x y'}\n", 6, "powered: field 'x y' of topic '/a' is"),
    "a clock for time": (TWO + "clocks: {operating: {topic: /a, speed: x}}\n", 6, "clocks/operating: the operating c"),
    "a clock of edges": (TWO + "clocks: {kilometres: {topic: /a, edge: x}}\n", 6, "driven by position or speed, not"),
    "a clock of both": (TWO + "clocks: {kilometres: {topic: /a, speed: x, edge: y}}\n", 6, "expected exactly one of p"),
    "a clock of nothing": (TWO + "clocks: {kilometres: {topic: /a}}\n", 6, "expected exactly one of position, speed"),
    "a clock in a wrong unit": (TWO + "clocks: {kilometres: {topic: /a, speed: x, unit: m}}\n", 6, "unit 'm' does not"),
    "a clock without threshold": (TWO + "clocks: {starts: {topic: /a, edge: x, threshold: .nan}}\n", 6, "finite num"),
    "usage above all time": (TWO + "usage: {operating: 2}\n", 6, "usage/operating: expected less than or equal to 1"),
    "usage never": (TWO + "usage: {operating: 0}\n", 6, "usage/operating: expected greater than 0"),
    "usage without end": (TWO + "usage: {kilometres: 1e400 km/h}\n", 6, "usage/kilometres: 1e400 is not a finite"),
    "task of nothing": (TWO + "task: {}\n", 6, "task: expected a distance with a speed above zero, or a duration"),
    "task said thrice": (TWO + "task: {distance: 5 m, speed: 1 m/s, duration: 1 h}\n", 6, "expected two of them"),
    "task at rest": (TWO + "task: {distance: 5 m, speed: 0 m/s}\n", 6, "expected a distance with a speed above zero"),
    "task for ever": (TWO + "task: {distance: 1e308 m, speed: 1e-308 m/s}\n", 6, "task: 1e+308 m at 1e-308 m/s is"),
    "task backwards": (TWO + "task: {duration: -1 h}\n", 6, "task/duration: -1 h is too small; expected at least 0"),
    "threshold of nan": (TWO + "thresholds: {reliability: .nan}\n", 6, "thresholds/reliability: expected a finite"),
    "threshold above all": (TWO + "thresholds: {completion: 99}\n", 6, "thresholds/completion: expected less than 1"),
    "name with a stroke": (HEAD + "components: {a/b: {rate: 1 FIT}}\n", 3, "'a/b' is not a name; expected text with"),
    "name with brackets": (HEAD + "components: {'a[1]': {rate: 1 FIT}}\n", 3, "'a[1]' is not a name"),
    "name with a line break": (HEAD + 'components: {"a\\nb": {rate: 1 FIT}}\n', 3, "'a\\nb' is not a name"),
    "name with a terminal code": (HEAD + 'components: {"a\\x9bb": {rate: 1 FIT}}\n', 3, "'a\\x9bb' is not a name"),
    "name of nothing": (HEAD + "components: {'': {rate: 1 FIT}}\n", 3, "at least 1 character"),
    "name without end": (HEAD + "components: {? " + "a" * 10**6 + " : {rate: 1 FIT}}\n", 3, "at most 200 characters"),
    "half a character": (HEAD + 'components: {"\\ud800": {rate: 1 FIT}}\n', 3, "is no text; expected whole characters"),
    "line break in a value": (part('rate: "1 x\\ny"'), 4, "components/A/rate: unknown unit 'x'"),
    "line break in a key": (TWO + '"a\\nb": 1\n', 6, "a b: unknown key 'a b'"),
    "python object": (part("rate: !!python/object/apply:os.system [exit]"), 4, "python/object/apply:os.system' is not"),
    "python object as mapping": (HEAD + "components: !!python/object:x.y {A: {rate: 1 FIT}}\n", 3, "' is not taken"),
    "python tuple": (TWO + "diagram: {series: !!python/tuple [A]}\n", 6, "python/tuple' is not taken; expected plain"),
    "binary": (part("rate: !!binary aGVsbG8="), 4, "tag 'tag:yaml.org,2002:binary' is not taken; expected plain val"),
    "set": (HEAD + "components: !!set {A}\n", 3, "tag 'tag:yaml.org,2002:set' is not taken"),
    "own tag": (HEAD + "components: !mine {A: {rate: 1 FIT}}\n", 3, "components: tag '!mine' is not taken"),
    "list as key": (HEAD + "components: {? [a, b] : {rate: 1 FIT}}\n", 3, "a key is a list or mapping; expected a n"),
    "merge key": (HEAD + "components:\n  A: &a {rate: 1 FIT}\n  B: {<<: *a}\n", 5, "components/B/<<: unknown key '<<'"),
    "unknown alias": (HEAD + "components: *x\n", 3, "is not YAML: found undefined alias 'x'"),
    "alias of itself": (HEAD + "components: &a\n  A: *a\n", 3, "is nested too deeply; expected at most 100 levels"),
    "list in itself": (HEAD + "diagram: &a {series: [*a]}\n", 3, "is nested too deeply; expected at most 100 levels"),
    "two documents": (TWO + "---\nx: 1\n", 6, "is not YAML: but found another document"),
    "tab": (HEAD + "components:\n\tA: {rate: 1 FIT}\n", 4, "is not YAML: found character '\\t'"),
    "not closed": (HEAD + "components: {A: {rate: 1 FIT}\n", 4, "is not YAML: expected ',' or '}'"),
    "unknown escape": (HEAD + 'description: "\\q"\n', 3, "is not YAML: found unknown escape character 'q'"),
}


@pytest.mark.parametrize(("text", "line", "says"), FAULTS.values(), ids=FAULTS.keys())
def test_fault(text, line, says):
    with pytest.raises(DesignError) as error:
        parse(text, "robot.yaml")
    message = str(error.value)
    assert message.startswith(f"robot.yaml:{line}: ")
    assert says in message
    assert len(message.splitlines()) == 1
    assert len(message) <= 1100


LAUGHS = "a: &a [x,x,x,x,x,x,x,x,x]\n" + "".join(
    f"{new}: &{new} [{','.join([f'*{old}'] * 9)}]\n" for old, new in zip("abcdefghi", "bcdefghij", strict=True)
)
BOMBS = {
    "billion laughs": (LAUGHS, "unfolds to more than 300,000 values"),
    "brackets": ("x: " + "[" * 20_000, "is nested too deeply"),
    "closed brackets": ("x: " + "[" * 3_000 + "]" * 3_000, "is nested too deeply"),
    "blocks": ("".join(" " * i + "a:\n" for i in range(2_000)), "is nested too deeply"),
    "a hundred and twenty levels": ("diagram: " + "{series: [" * 60 + "A" + "]}" * 60, "expected at most 100 levels"),
    "NUL": (HEAD + "description: a\0b\n", "is not YAML: unacceptable character #x0000"),
    "bell": (HEAD + "description: a\x07b\n", "is not YAML: unacceptable character #x0007"),
}


@pytest.mark.full
@pytest.mark.parametrize(("text", "says"), BOMBS.values(), ids=BOMBS.keys())
def test_bombs_are_defused_quickly(text, says):
    begun = time.process_time()
    with pytest.raises(DesignError, match=re.escape(says)) as error:
        parse(text, "robot.yaml")
    assert time.process_time() - begun < 20  # seconds on a slow machine; unfolding would take hours
    assert len(str(error.value).splitlines()) == 1


@pytest.mark.parametrize("text", ["", "# nothing\n", "null\n", "- 1\n", "robot\n", "3\n"])
def test_no_design_at_all(text):
    with pytest.raises(
        DesignError, match=r"^r: holds no design; expected a mapping that starts with 'schema_version: 1'$"
    ):
        parse(text, "r")


def test_nothing_in_a_file_is_run(tmp_path):
    for tag in ("apply:os.mkdir", "new:os.mkdir"):
        with pytest.raises(DesignError):
            parse(f"{HEAD}description: !!python/object/{tag} ['{tmp_path}/made']\n")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("place", ["", "modules: {M: {components: {b: {rate: 1 FIT}}, environment: moon}}\n"])
def test_an_environment_that_the_handbook_does_not_have_is_refused_also_where_no_model_asks(place):
    text = "schema_version: 1\nname: R\n" + (place or "environment: moon\n") + "components: {a: {rate: 1 FIT}}\n"
    with pytest.raises(
        DesignError,
        match=r"environment: 'moon' is no environment of .* Table 3-2; known: .*GB \(indoor\), .*GM \(vehicle",
    ):
        parse(text)
    assert parse(text.replace("moon", "GF")).name == "R"
