"""The JSON Schema that an editor completes a design by: shipped as it is computed, and true of the examples."""

import json
import re
from importlib.resources import files

import pytest
from ruamel.yaml import YAML

from robophm.design.file import SCHEMA_VERSION, parse
from robophm.design.schema import RobotFile, json_schema

SCHEMA = json_schema()


def test_the_shipped_schema_is_the_computed_one():
    shipped = files("robophm.design").joinpath("robot.schema.json").read_text(encoding="utf-8")
    assert shipped == json.dumps(SCHEMA, indent=2, ensure_ascii=False) + "\n"


def test_it_is_a_schema():
    assert SCHEMA["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    assert SCHEMA["properties"]["schema_version"]["const"] == SCHEMA_VERSION
    assert SCHEMA["additionalProperties"] is False
    assert set(SCHEMA["required"]) == {"schema_version", "name"}
    assert set(SCHEMA["properties"]) == set(RobotFile.model_fields)
    for reference in re.findall(r'"#/\$defs/(\w+)"', json.dumps(SCHEMA)):
        assert reference in SCHEMA["$defs"]


def valid(value, schema):
    """Enough of JSON Schema for what ours uses; an unknown keyword fails."""
    known = {"$schema", "$defs", "title", "description", "default", "examples", "discriminator"}
    for word, says in sorted(schema.items(), key=lambda item: item[0] != "type"):
        match word:
            case "$ref":
                good = valid(value, SCHEMA["$defs"][says.rpartition("/")[2]])
            case "type":
                good = any(is_a(value, kind) for kind in (says if isinstance(says, list) else [says]))
            case "anyOf":
                good = any(valid(value, one) for one in says)
            case "oneOf":
                good = sum(valid(value, one) for one in says) == 1
            case "const":
                good = value == says
            case "enum":
                good = value in says
            case "properties":
                good = all(valid(value[key], inner) for key, inner in says.items() if key in value)
            case "required":
                good = set(says) <= set(value)
            case "additionalProperties":
                others = set(value) - set(schema.get("properties", {}))
                good = all(valid(value[key], says) for key in others) if isinstance(says, dict) else says or not others
            case "propertyNames":
                good = all(valid(key, says) for key in value)
            case "patternProperties":
                good = all(
                    valid(v, s) for pattern, s in says.items() for k, v in value.items() if re.search(pattern, k)
                )
            case "items":
                good = all(valid(item, says) for item in value)
            case "prefixItems":
                good = all(valid(item, inner) for item, inner in zip(value, says, strict=False))
            case "minItems" | "minLength":
                good = len(value) >= says
            case "maxItems" | "maxLength":
                good = len(value) <= says
            case "minimum":
                good = value >= says
            case "maximum":
                good = value <= says
            case "exclusiveMinimum":
                good = value > says
            case "exclusiveMaximum":
                good = value < says
            case "pattern":
                good = re.search(says, value) is not None
            case _:
                assert word in known, word
                good = True
        if not good:
            return False
    return True


def is_a(value, kind):
    python = {"string": str, "object": dict, "array": list, "boolean": bool, "null": type(None)}
    if kind in ("number", "integer"):
        return isinstance(value, int if kind == "integer" else (int, float)) and not isinstance(value, bool)
    return isinstance(value, python[kind])


def test_the_examples_are_valid(examples):
    found = [path for path in examples.rglob("*.yaml") if not path.name.startswith("tasks")]
    assert found
    for example in found:
        assert valid(YAML(typ="safe").load(example), SCHEMA), example


BROKEN = [
    "tresholds: {}",
    "components: {A: {rat: 1 FIT}}",
    "components: {A: {quantity: 0}}",
    "diagram: {serie: [A]}",
    "diagram: {series: []}",
    "signals: {temperature: {topic: /a}}",
    "usage: {operating: 2}",
    "max_gap: [1 s]",
    "acceleration: some",
    "components: {A: {hazard: {unit: FIT}}}",
    "components: {A: {rate: 1 FIT, depends_on: 3}}",
    "components: {A: {rate: 1 FIT, depends_on: {serie: [A]}}}",
    "common_causes: {heat: {of: [A, B], beta: 1}}",
    "common_causes: {heat: {of: [], beta: 0.1}}",
    "common_causes: {heat: {of: [A, B], beta: 0.1, testing: both}}",
    "components: {A: {hazard: {formula: 1 + 1, unit: FIT}}}",
    "components: {A: {hazard: {formula: 1 + 1, unit: FIT, source: x, model: general.constant}}}",
]


@pytest.mark.parametrize("text", BROKEN)
def test_what_the_reader_refuses_the_schema_refuses(text):
    design = YAML(typ="safe").load(f"{{schema_version: 1, name: R, {text}}}")
    assert not valid(design, SCHEMA)


EVERYTHING = """
schema_version: 1
name: R
identity: an earlier name
description: of everything
environment: GM
quality: known pedigree
powered: {topic: /on, field: data}
max_gap: 2 min
usage: {operating: 0.5, kilometres: 1 km/h, cycles: 3 cycle/h, starts: 0.1 start/h}
task:
  name: round
  legs:
    - {distance: 250 m, speed: 0.3 m/s, functions: [drive], stresses: {temperature: 40 degC}}
    - {duration: 5 min, cycles: 3, starts: 1}
duty: 0.5
repair: 8 h
thresholds:
  hazard_rate: {limit: 1000 FPMH, clear: 900 FPMH, delay: 10 s}
  reliability: 0.9
  remaining_life: 500 h
  completion: 0.99
  survival: 0.9
  signals: {/t.temperature: {above: 70 degC, below: {limit: -10 degC}}}
signals:
  temperature: {topic: /t, field: temperature, unit: degC, range: [-20, 80], offset: 5 K, max_age: 5 s, stale: worst}
  load: {topic: /joint_states, field: "effort[0]", unit: N*m, rated: 80}
clocks:
  kilometres: {topic: /odom, position: [x, y]}
  cycles: {topic: /arm, edge: busy, threshold: 0.5}
acceleration: [{model: arrhenius, activation_energy: 0.7 eV}]
modules:
  M:
    thresholds:
      reliability: 0.8
      warning: {hazard_rate: 50 FPMH, reliability: 0.9, remaining_life: 1 kh, completion: 0.9}
    uncertainty: {error_factor: 3}
    components:
      Motor:
        quantity: 4
        required: 3
        monitored: true
        offsets: {temperature: 10 K}
        failure_modes:
          wear: {rate: 1e-5 /km, clock: kilometres, life: {distribution: weibull, shape: 2}, source: maker}
          burn:
            {rate: 12 FIT, scaling: hazard, acceleration: none, initial_exposure: 100 h, uncertainty: {failures: 3}}
          crack: {rate: 5 FIT, uncertainty: {samples: [4 FIT, 6 FIT]}}
    diagram: Motor
    depends_on: [C, {parallel: [D, C]}]
common_causes:
  heat: {of: [Twin], beta: 0.1}
  software: {of: [Triple], mgl: [0.1, 0.3]}
  wear: {of: [Left, Right], alpha: [0.95, 0.05], testing: non-staggered}
components:
  Twin: {rate: 5 FIT, quantity: 2, required: 1}
  Book: {part: lidar_2d}
  Sheet: {failure_modes: {a: {mtbf: 20000 h}, b: {mttf: 1 year}, c: {l10: 3000 h}, d: {b10: 2e6 cycle, clock: cycles}}}
  Triple: {rate: 5 FIT, quantity: 3, depends_on: Twin}
  Left: {rate: 5 FIT}
  Lamp:
    rate: 5 FIT
    learned: {factor: 2, shape: 3, failures: 2, expected: 1, exposure: 1e6 h, low: 0.5, high: 4, prior: 1, note: odd}
    wear:
      {topic: /lamp, field: lux, unit: lx, range: [0, 1e4], reading: lowest, every: 2 h, threshold: 50 lx,
       threshold_deviation: 2 lx, share: 0.7, teachers: lamps.csv,
       ambient: {topic: /day, field: lux, range: [0, 1e4], max_age: 9 s}, load: {topic: /u, field: v, range: [11, 13]}}
  Pump: {rate: 5 FIT, quantity: 3}
  Lidar:
    rate: 5 FIT
    failed_when:
      - {log: /lidar, level: fatal, words: no data}
      - {lifecycle: /lidar}
      - {topic: /lidar/status, field: fault, values: [1], works: [0]}
      - {topic: /scan, field: range_min, silent: 10 s}
    clocks: {starts: {topic: /lidar/transition_event, edge: goal_state.id, becomes: 3}}
  Wheel: {rate: 5 FIT, quantity: 2}
  Axle: {rate: 5 FIT, quantity: 2}
  Right: {rate: 5 FIT, depends_on: {parallel: [C, D]}}
  C:
    hazard: {model: general.constant, inputs: {rate: 3 FIT}}
    life: {distribution: lognormal, log_deviation: 0.5}
  D:
    hazard:
      formula: 2 * x
      unit: FIT
      source: own test
      variables: {x: {value: 3 V, unit: V, range: [1, 5], description: supply}}
diagram:
  series:
    - parallel: [M, C, D]
    - k_of_n: {k: 1, of: ["M/Motor[1]", "/M/Motor[2]"]}
    - standby: {of: [Pump], active: 2, dormancy: 0.1, switch: 0.99}
    - load_sharing: {of: [Wheel], k: 1, exponent: 3}
    - Lidar
    - load_sharing: {of: [Axle], factors: [1, 2.5]}
    - network:
        from: in
        to: out
        junctions: [x, y]
        links: [[in, x, M, out], {between: [in, y], through: C}, {from: x, to: y}, {from: y, to: out, through: D}]
functions:
  drive: M
"""


def test_a_design_that_uses_every_key_is_valid_for_both():
    design = YAML(typ="safe").load(EVERYTHING)
    assert valid(design, SCHEMA)
    parse(EVERYTHING)
    used = set(re.findall(r"(\w+):", EVERYTHING))
    for name, model in {"": SCHEMA, **SCHEMA["$defs"]}.items():
        assert set(model.get("properties", {})) <= used, name
