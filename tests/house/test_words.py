"""Words that only we would understand are not used for what the field has a name for."""

import ast
import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
MODULES = sorted(path for path in (ROOT / "src" / "robophm").rglob("*.py") if "static" not in path.parts)
OURS = {  # what it is called instead (docs/reference/glossary.md)
    "VirtualLife": "BlockMonitor", "Leaps": "ClockJumps", "Swapped": "WhatIfReplaced", "Witness": "IntervalObserver",
    "Bundle": "StressGroups", "Said": "SignalSamples", "Heard": "SignalColumns", "Hearing": "Receiver",
    "Course": "ReportHistory", "Went": "the value itself", "judging": "task_evaluation", "swapped": "what_if_replaced",
    "Fault": "LocatedError, a fault being one of the robot", "fault_of": "place_and_message", "Checked": "CheckResult",
    "takers": "inputs_of_stress", "driving": "sensor_inputs", "Driving": "ChannelBuilder", "Cover": "SensorCover",
    "told_apart": "distinguished_parts", "Holding": "ValueHolder", "InOrder": "SampleSorter, or OneActiveStandby",
    "Solved": "SolvedGroup", "Together": "SeriesOfParts", "Positions": "SeveralActiveStandby",
    "Sharing": "SharedLoad", "not_taken": "rejected_samples", "affordable": "check_draws", "Promise": "NominalFigures",
    "promises": "nominal_figures", "Deciding": "DecidingComponent", "deciding": "deciding_components",
    "Repaired": "RemovedJump", "unseen": "undetected_modes", "greedily": "choose_greedily", "Upkept": "MaintainedPart",
    "Return": "ReturnOnMonitoring", "return_on_watching": "return_on_monitoring", "by_block": "block_monitor",
    "lacking": "missing_signals", "Ear": "TopicReader", "Greeting": "PendingCaller", "Callee": "CalledNode",
    "told_in": "tasks_in", "Prepared": "PreparedRobot", "Shelf": "PreparedRobots", "speakable": "json_values",
    "paper_says": "paper_prediction", "found_out": "likelihood_ratio_p_value",
    "knowing": "rate_sensitivity", "ignorance": "state_of_knowledge", "far_out": "extrapolation_note",
    "heard_parts": "parts_by_topic", "ServiceInterval": "ExposureBetweenServices", "by_chance": "monte_carlo",
    "DrivenTask": "TaskFigures", "standstill": "downtime_by_repairs", "Reading": "TopicDecoder, or ColumnDecoder",
}  # fmt: skip


def test_names_are_those_of_the_field() -> None:
    found = {}
    for module in MODULES:
        nodes = ast.walk(ast.parse(module.read_text()))
        named = {node.name for node in nodes if isinstance(node, ast.ClassDef | ast.FunctionDef)} | {module.stem}
        found |= {f"{module.relative_to(ROOT)}: {name}": OURS[name] for name in named & OURS.keys()}
    assert found == {}


def test_the_glossary_says_each_word_once() -> None:
    rows = re.findall(
        r"^\| ([^|]+) \| ([^|]+) \|$", (ROOT / "docs" / "reference" / "glossary.md").read_text(), re.MULTILINE
    )
    words = [word.strip() for terms, _ in rows[2:] for word in terms.split(",")]
    assert len(words) > 30
    assert len(words) == len(set(words))
