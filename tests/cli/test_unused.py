"""An option that a command does not use for what it is asked is refused by its name, and nothing is written."""

import pytest

MODEL = (
    '<opsa-mef><define-fault-tree name="t"><define-gate name="g"><and><basic-event name="a"/><basic-event name="b"/>'
    '</and></define-gate></define-fault-tree><model-data><define-basic-event name="a"><float value="0.1"/>'
    '</define-basic-event><define-basic-event name="b"><float value="0.2"/></define-basic-event></model-data>'
    "</opsa-mef>"
)
SENSORS = "sensor,part,detects\nhot,Sensing/Camera,0.9\n"
PREDICTIONS = "model,id,predicted\n"


@pytest.mark.parametrize(
    ("words", "unused"),
    [
        ("show robot.yaml --seed 1", "--seed"),
        ("show robot.yaml --monte-carlo 10 --legacy --unit FIT --svg x.svg", "--unit, --svg, --legacy"),
        ("show robot.yaml --json --unit FIT", "--unit"),
        ("rate --explain", "--explain"),
        ("rate mil_hdbk_217f.capacitor --unit FIT", "--unit"),
        ("rate general.constant --set", None),
        ("models --reference --json", "--json"),
        ("models motor --reference", "WORDS"),
        ("predict robot.yaml --json --unit FIT", "--unit"),
        ("replay robot.yaml day.mcap --json --unit FIT", "--unit"),
        ("task robot.yaml tasks.yaml --topic /pose", "--topic"),
        ("task robot.yaml --threshold 0.5", "--threshold"),
        ("task robot.yaml --draws 0 --seed 3", "--seed"),
        ("task robot.yaml --skip-missing", "--skip-missing"),
        ("calibrate predictions.csv --controls --jobs 2", "--controls, --jobs"),
        ("fault-tree robot.yaml --top g", "--top"),
        ("fault-tree model.xml --function drive", "--function"),
        ("fault-tree model.xml --seed 3", "--seed"),
        ("fault-tree model.xml --monte-carlo 10 --order 2 --most 5 --to x.xml", "--order, --most, --to"),
        ("importance model.xml tasks.yaml --store past.db --failed a --working b --future last --function drive",
         "TASKS, --store, --failed, --working, --future, --function"),
        ("learn robot.yaml log.csv --force", "--force"),
        ("fmeca robot.yaml --force", "--force"),
        ("diagnose robot.yaml sensors.csv --within 5 --at 3 --function drive", "--within, --at, --function"),
        ("diagnose robot.yaml sensors.csv --alarm hot --quiet", "--quiet"),
        ("diagnose robot.yaml sensors.csv --quiet --store past.db --at 3", "--at"),
        ("wear robot.yaml signal.csv --part Sensing/Camera --skip-missing", "--skip-missing"),
        ("serve robot.yaml --speed 2", "--speed"),
        ("watch robot.yaml --no-publish --frame arm", "--frame"),
        ("watch robot.yaml --json --unit FIT", "--unit"),
        ("data find day.mcap --signal /a.b --above 3 --json --most 3", "--most"),
        ("data statistics day.mcap --signal /a.b --most 3 --force", "--force, --most"),
        ("data profile robot.yaml day.mcap --force", "--force"),
    ],
)  # fmt: skip
def test_refused_by_name(inside, design, tmp_path, words, unused):
    for name, text in (("model.xml", MODEL), ("sensors.csv", SENSORS), ("predictions.csv", PREDICTIONS)):
        (tmp_path / name).write_text(text)
    before = sorted(path.name for path in tmp_path.iterdir())
    refused = inside(*words.split())
    assert (refused.returncode, refused.stdout) == (2, "")
    if unused:
        assert f"Error: {unused}: not used for " in " ".join(refused.stderr.split())
    assert sorted(path.name for path in tmp_path.iterdir()) == before


@pytest.mark.parametrize(
    "words",
    [
        "show robot.yaml --unit FIT --at 10",
        "show robot.yaml --json --svg x.svg --unit FIT",
        "show robot.yaml --monte-carlo 10 --seed 2 --at 10",
        "rate general.constant --set rate=5FIT --unit FIT --explain",
        "fault-tree model.xml --order 2 --most 3",
        "fault-tree model.xml --monte-carlo 10 --seed 3",
        "importance model.xml --by raw --most 2",
        "diagnose robot.yaml sensors.csv --alarm hot --within 5 --at 3",
        "diagnose robot.yaml sensors.csv --quiet --within 5",
    ],
)
def test_taken_where_it_is_used(inside, design, tmp_path, words):
    for name, text in (("model.xml", MODEL), ("sensors.csv", SENSORS)):
        (tmp_path / name).write_text(text)
    done = inside(*words.split())
    assert (done.returncode, done.stderr) == (0, "")
