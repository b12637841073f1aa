"""Each command has its function, which answers what the command says as JSON; or there is a reason why it has none."""

import json
import shutil
from pathlib import Path

import pytest
from typer.testing import CliRunner

import robophm
from robophm.cli.app import COMMANDS, app

LEGACY = Path(__file__).parents[1] / "data" / "legacy_ota.yaml"
FUNCTIONS = {
    "check": "load", "show": "predict", "watch": "Monitor", "store": "open_store", "import-bom": "import_bom",
    "parts": "parts",
    **{name: name.replace("-", "_") for name in (
        "allocate", "availability", "bind", "calibrate", "cutsets", "demonstrate", "diagnose", "fault-tree", "fit",
        "fmeca", "import-legacy", "importance", "learn", "maintain", "models", "new", "predict", "rate", "replay",
        "service", "simulate", "task", "wear", "why",
    )},
}  # fmt: skip
OF_THE_TERMINAL = {
    "audit": "prints the log of who changed what, which is of the service",
    "alarms": "prints a log, which a program has from a store: alarm_log(robot.identity)",
    "data": "a program reads columns by robophm.measured, which the command prints",
    "demo": "shows the commands one after another",
    "doctor": "tells of this machine what `robophm` needs of it",
    "fleet": "is a service, and prints what its store has: robophm.fleet.questions",
    "history": "prints what a program has from a store: history(robot.identity) has figures, events and reports",
    "report": "writes a page: robophm.report.health_page makes its text",
    "schema": "prints robophm.design.schema.json_schema()",
    "serve": "is a service, which ends with Ctrl+C",
    "topics": "lists what a source offers: open_source(…).topics()",
    "users": "keeps who may use the service",
}
DESIGN = """
schema_version: 1
name: courier
usage: {operating: 0.5}
components:
  battery: {rate: 50 FPMH, uncertainty: {error_factor: 3}}
  motor: {quantity: 2, failure_modes: {winding: {rate: 8 FPMH}, bearing: {rate: 20 FPMH}}}
  lidar: {rate: 30 FPMH}
  camera: {rate: 90 FPMH, acceleration: {model: q10}, signals: {temperature: {topic: /c, field: t, unit: degC}}}
diagram: {series: [battery, motor, {parallel: [lidar, camera]}]}
functions: {drive: {series: [battery, motor]}}
task: {duration: 2 h}
"""
SENSORS = """sensor,part,detects,false alarm,price,fitted
vibration,motor/bearing,0.9,0.01,,
vibration,motor/winding,0.2,,,
self test,lidar,0.95,0.001,50,no
image check,camera,0.8,0.01,20,no
"""
STRESSED = "time [h],temperature [degC]\n" + "".join(
    f"{time},{level}\n" for level, times in {85: (900, 1300, 1750, 2100), 105: (400, 520, 690, 800)}.items()
    for time in times
)  # fmt: skip
TASKS = """schema_version: 1
tasks:
  - {name: short, legs: [{duration: 1 h}]}
  - {name: long, legs: [{duration: 9 h}]}
"""
MODES = "time [h],mode,censored\n10,wear,\n20,wear,\n33,surge,\n35,surge,\n28,wear,\n40,,yes\n"
NEVER = "time [h],censored,count\n5,no,1\n9,no,1\n14,no,1\n20,no,1\n31,no,1\n500,yes,20\n"
REPAIRED = "unit,time [h],censored\n" + "".join(f"a,{t},no\n" for t in (20, 90, 200, 410, 800)) + "a,1000,yes\n"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    files = {
        "robot.yaml": DESIGN, "sensors.csv": SENSORS, "stressed.csv": STRESSED, "modes.csv": MODES, "never.csv": NEVER,
        "repaired.csv": REPAIRED, "drive.csv": "time,/c.t\n0,40\n3600,40\n7200,45\n",
        "tasks.yaml": TASKS,
    }  # fmt: skip
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    return tmp_path


@pytest.fixture
def store(folder):
    with robophm.open_store("past.db") as kept:
        robophm.replay(robophm.load("robot.yaml"), "drive.csv", store=kept)
    return "past.db"


def told(*words):
    done = CliRunner().invoke(app, [*map(str, words), "--json"])
    assert done.exit_code in (0, 1), done.output
    return json.loads(done.stdout)


def plain(value):
    """As JSON has it."""
    from robophm.core.json_values import plain as values

    return json.loads(json.dumps(values(value)))


def test_every_command_has_its_function_or_a_reason_why_not():
    assert FUNCTIONS.keys() | OF_THE_TERMINAL.keys() == COMMANDS.keys()
    assert not FUNCTIONS.keys() & OF_THE_TERMINAL.keys()
    for name in FUNCTIONS.values():
        assert hasattr(robophm, name), name


def test_effects_of_failures(folder):
    said = told("fmeca", "robot.yaml", "--sensors", "sensors.csv", "--within", "500 h", "--severity", "drive=9")
    found = robophm.fmeca("robot.yaml", "sensors.csv", hours=500.0, severities={"drive": 9})
    assert plain(robophm.rows(found)) == said["modes"]
    assert plain(found.coverage) == said["coverage"]
    assert len(robophm.frame(found)) == 5
    assert repr(found) == "<Fmeca of 'courier': 5 failure modes within 500 h>"


def test_what_alarms_mean_and_which_sensors_tell_more(folder, store):
    said = told("diagnose", "robot.yaml", "sensors.csv", "--alarm", "vibration", "--at", "200 h")
    found = robophm.diagnose("robot.yaml", "sensors.csv", ["vibration"], age=200.0)
    assert plain(robophm.rows(found)) == said["suspects"]
    assert found.diagnosis.no_fault == said["no_fault"]
    assert list(found.unseen) == said["unseen"]
    assert repr(found) == "<Diagnosed 'courier': 3 sensors, 3 failure modes unseen, first suspect motor/bearing>"
    said = told("diagnose", "robot.yaml", "sensors.csv", "--add", "1", "--store", store)
    found = robophm.diagnose("robot.yaml", "sensors.csv", add=1, store=store)
    assert [one.name for one in found.added.chosen] == said["sensors"]["chosen"]
    assert list(found.added.choice.gains) == said["sensors"]["gains"]
    assert robophm.rows(found)[0] == {"failure_mode": "motor/winding", "sensor": "vibration", "detects": 0.2}


def test_cut_sets_and_fault_trees(folder):
    said = told("cutsets", "robot.yaml", "--at", "3000 h", "--most", "3")
    found = robophm.cutsets("robot.yaml", hours=3000.0, most=3)
    listed = said["cut_sets"]["listed"]
    assert [(one["parts"].split(", "), one["probability"]) for one in robophm.rows(found)] == [
        (one["parts"], one["probability"]) for one in listed
    ]
    assert robophm.fault_tree("robot.yaml", hours=3000.0).probability == said["unreliability"]
    paths = told("cutsets", "robot.yaml", "--paths", "--function", "drive")["path_sets"]
    assert robophm.cutsets("robot.yaml", "drive", paths=True).count == paths["count"]
    told("fault-tree", "robot.yaml", "--at", "100 h", "--to", "model.xml")
    model = told("fault-tree", "model.xml", "--at", "100 h")
    assert robophm.fault_tree("model.xml", hours=100.0).probability == model["probability"]


def test_lives_at_stress_failure_modes_some_that_never_fail_and_repaired_systems(folder):
    said = told("fit", "stressed.csv", "--use", "temperature=40 degC")
    found = robophm.fit_stress("stressed.csv", {"temperature": "40 degC"})
    assert found.log_likelihood == said["log_likelihood"]
    assert {str(share): one.value for share, one in found.quantiles.items() if one.value <= found.known_until} == {
        share: one["value"] for share, one in said["quantiles"].items() if one["value"] is not None
    }
    said = told("fit", "modes.csv", "--distribution", "weibull")
    modes = robophm.fit_modes("modes.csv", "weibull")
    assert {one["failure_mode"]: one["first_in"] for one in robophm.rows(modes)} == {
        name: one["first_in"] for name, one in said["modes"].items()
    }
    said = told("fit", "never.csv", "--some-never-fail")
    assert robophm.fit_limited("never.csv").share.value == said["share_that_fails"]["value"]
    said = told("fit", "repaired.csv", "--repairable")
    by = robophm.fit_repaired("repaired.csv")
    assert {name: one.shape.value for name, one in by.items()} == {
        name: one["beta"]["value"] for name, one in said["estimates"].items()
    }


def test_tasks_and_what_decides(folder, store):
    said = told("task", "robot.yaml", "tasks.yaml", "--store", store, "--failed", "lidar", "--draws", "200")
    found = robophm.task("robot.yaml", "tasks.yaml", store, failed=["lidar"], draws=200)
    assert plain(found.to_json()) == said
    assert [one["task"] for one in robophm.rows(found)] == ["short", "long"]
    assert (
        repr(found)
        == f"<TaskReport of 'courier': 2 tasks, completed with {found.together['sensor_based'].probability:.6g}>"
    )
    assert robophm.task("robot.yaml", robophm.Task((robophm.Leg(9.0),))).tasks[0].task.duration == 9.0
    said = told("why", "robot.yaml", "--store", store)
    why = robophm.why("robot.yaml", store)
    assert repr(why).startswith("<Explanation: works on for ")
    assert (why.works_for, why.median) == (said["works_for"], said["median"])
    assert [one["share"] for one in robophm.rows(why)] == [one["share"] for one in said["parts"]]


def test_services_are_kept_in_the_store(folder, store):
    assert robophm.service("robot.yaml", "camera", store) == []
    made = robophm.service("robot.yaml", "camera", store, repaired=0.5, failed=True)
    assert (
        plain([one._asdict() for one in made])
        == told("service", "robot.yaml", "camera", "--store", store, "--history")["services"]
    )


def test_robots_that_fail_and_predictions_that_are_judged(folder):
    of_one_each = DESIGN.replace("quantity: 2, ", "") + "powered: {topic: /on, field: data}\n"
    (folder / "robot.yaml").write_text(of_one_each)
    fleet = robophm.simulate("robot.yaml", "fleet", robots=4, tasks=5, seed=3)
    said = told("simulate", "robot.yaml", "--to", "again", "--robots", "4", "--tasks", "5", "--seed", "3")
    assert (fleet.tasks, fleet.failed, fleet.parts_failed) == (said["tasks"], said["failed"], said["parts_failed"])
    made = [path.relative_to(folder / "fleet") for path in (folder / "fleet").rglob("*") if path.is_file()]
    assert all((folder / "again" / path).read_bytes() == (folder / "fleet" / path).read_bytes() for path in made)
    said = told("calibrate", "fleet")
    assert {"schema_version": 1, **plain(robophm.calibrate("fleet").to_json())} == said
    assert [one["model"] for one in robophm.rows(robophm.calibrate("fleet"))] == [
        one["model"] for one in said["models"]
    ]


def test_another_fleet_in_the_same_folder_is_judged_by_its_own_design(folder):
    """As in a notebook, where a cell is run again after an edit."""
    for topic in ("/one", "/two"):
        of_one_each = DESIGN.replace("quantity: 2, ", "") + f"powered: {{topic: {topic}, field: data}}\n"
        (folder / "robot.yaml").write_text(of_one_each)
        if (folder / "fleet").exists():
            shutil.rmtree(folder / "fleet")
        robophm.simulate("robot.yaml", "fleet", robots=2, tasks=3, seed=3)
        assert robophm.calibrate("fleet").models[0].tasks.tasks >= 6


def test_a_file_of_the_2020_tool(folder):
    told("import-legacy", LEGACY, "ota.yaml")
    assert robophm.import_legacy(LEGACY).text == (folder / "ota.yaml").read_text()


def test_wear_by_an_index_by_conditions_and_beside_others(folder):
    (folder / "readings.csv").write_text(
        "time [h],value\n" + "".join(f"{10 * i},{1 + 0.004 * i + 0.01 * (-1) ** i}\n" for i in range(60))
    )
    (folder / "others.csv").write_text(
        "unit,time [h],value\n"
        + "".join(
            f"u{k},{10 * i},{1 + (0.003 + 0.001 * k) * i + 0.01 * (-1) ** i}\n" for k in range(3) for i in range(90)
        )
    )
    words = ("wear", "robot.yaml", "readings.csv", "--part", "lidar", "--threshold", "2.5", "--fleet", "others.csv")
    said = told(*words, "--baseline", "40")
    options = robophm.WearOptions(baseline=40)
    found = robophm.wear("robot.yaml", "readings.csv", "lidar", threshold=2.5, fleet="others.csv", options=options)
    assert said["remaining_life"]["lidar"]["fused"]["median"] == found.lives["lidar"].with_wear.life.median
    with pytest.raises(robophm.RobophmError, match="from whom is an index of health learned"):
        robophm.wear("robot.yaml", "readings.csv", "lidar", index=True)
    with pytest.raises(robophm.RobophmError, match="threshold beside recordings"):
        robophm.wear("robot.yaml", "drive.bag", threshold=2.5)
