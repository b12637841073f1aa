"""Reading predictions.csv: what is taken, and the one line that says why not."""

import numpy as np
import pytest

from robophm.calibration.predictions import LEVELS, MOST_ROWS, read_predictions
from robophm.calibration.score import score
from robophm.core.errors import SourceError
from robophm.transports.recordings.text import LONGEST_LINE

QUANTILES = ",".join(f"q{level:g}" for level in LEVELS)
LIFE = f"robot,kind,time,{QUANTILES},fraction,observed,censored"


def written(tmp_path, *lines):
    path = tmp_path / "predictions.csv"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def test_both_kinds_of_two_models(tmp_path):
    predictions = read_predictions(written(
        tmp_path,
        f"robot,model,kind,time,probability,failure,outcome,task,{QUANTILES},fraction,observed,censored",
        "r1,robophm,task,1700000000.123456789,0.9999999,1e-7,1,fetch" + "," * 12,
        "r1,paper R^d,task,1700000000,0.25,,0,fetch" + "," * 12,
        "r2,robophm,task,1700000000,0.1,0.9,0,fetch" + "," * 12,
        "r2,robophm,life,1700003600,,,,,1,2,3,4,5,6,7,8,9,0.5,5,1",
    ))  # fmt: skip
    assert list(predictions.tasks) == ["robophm", "paper R^d"]
    ours = predictions.tasks["robophm"]
    assert ours.failure.tolist() == [1e-7, 0.9]
    assert ours.completion.tolist() == [1 - 1e-7, 0.1]
    assert ours.failed.tolist() == [False, True]
    assert predictions.tasks["paper R^d"].failure.tolist() == [0.75]
    life = predictions.lives["robophm"]
    assert life.quantiles.tolist() == [list(range(1, 10))]
    assert (life.fraction[0], life.observed[0], life.censored[0]) == (0.5, 5, True)
    assert life.time[0] * 3600 == pytest.approx(1700003600)


def test_a_small_failure_keeps_its_digits(tmp_path):
    path = written(tmp_path, "robot,kind,time,probability,failure,outcome", "r,task,0,1,3e-20,1")
    predicted = read_predictions(path).tasks["the predictions"]
    assert (predicted.failure[0], predicted.completion[0]) == (3e-20, 1)
    assert score(read_predictions(path)).models[0].tasks.impossible == 0


HEAD = "robot,kind,time,probability,outcome"


@pytest.mark.parametrize(
    ("lines", "says"),
    [
        ([], "is empty; expected a header"),
        (["", ""], "is empty; expected a header"),
        ([HEAD], "holds no predictions"),
        (["robot,kind,probability,outcome", "r,task,1,1"], "line 1: no column 'time'"),
        (["robt,kind,time,probability,outcome"], "line 1: no column 'robot'; did you mean 'robt'?"),
        (["robot,kind,time,time"], "line 1, column 4: 'time' is there twice"),
        (["robot,kind,time,probabilty,outcome", "r,task,0,1,1"], "no column 'probability'; did you mean 'probabilty'?"),
        ([HEAD, "r,task,0,1.2,1"], "line 2, column 4 (probability): 1.2 is out of range; expected 0 … 1"),
        ([HEAD, "r,task,0,-1e-9,1"], "line 2, column 4 (probability): -1e-9 is out of range"),
        ([HEAD, "", "r,task,0,nan,1"], "line 3, column 4 (probability): nan is out of range"),
        ([HEAD, "r,task,inf,0.5,1"], "line 2, column 3 (time): inf is out of range; expected a finite number"),
        ([HEAD, "r,task,0,half,1"], "line 2, column 4 (probability): 'half' is not a number"),
        ([HEAD, "r,task,0,0.5,2"], "line 2, column 5 (outcome): 2 is neither 0 nor 1"),
        ([HEAD, "r,task,0,0.5,"], "line 2, column 5 (outcome): is empty"),
        ([HEAD, ",task,0,0.5,1"], "line 2, column 1 (robot): is empty"),
        ([HEAD, "r" * 1001 + ",task,0,0.5,1"], "line 2, column 1 (robot): is longer than 1000"),
        ([HEAD, "r,tsk,0,0.5,1"], "line 2: kind 'tsk'; did you mean 'task'?"),
        ([HEAD, "r,task,0,0.5"], "line 2: 4 cells; expected 5"),
        ([HEAD, "r,life,0,0.5,1"], "line 2: kind life, but no column 'q0.025'"),
        ([HEAD, "r,task,0,0.5,1", "s,task,0,0.5,1", "r,task,0.0,0.7,0"], "line 4: kind task, robot and time are those"),
        ([HEAD, '"r,task,0,0.5,1'], "line 2: unexpected end of data"),
        ([HEAD + ",failure", "r,task,0,0.9,1,0.2"], "(failure): 0.2 and probability 0.9 do not add up to 1"),
        ([LIFE, "r,life,0,1,2,3,4,5,4,7,8,9,0.5,5,0"], "column 9 (q0.75): 4 is below the quantile before it, 5"),
        ([LIFE, "r,life,0,-1,2,3,4,5,6,7,8,9,0.5,5,0"], "column 4 (q0.025): -1 is out of range; expected ≥ 0"),
        ([LIFE, "r,life,0,1,2,3,4,5,6,7,8,inf,0.5,5,0"], "column 12 (q0.975): inf is out of range"),
        ([LIFE, "r,life,0,1,2,3,4,5,6,7,8,9,0.9,4.5,0"], "(fraction): 0.9 contradicts 4.5 h observed, below q0.5 = 5"),
        ([LIFE, "r,life,0,1,2,3,4,5,6,7,8,9,0.1,4.5,0"], "(fraction): 0.1 contradicts 4.5 h observed, above q0.25 = 4"),
        ([LIFE, "r,life,0,1,2,3,4,5,6,7,8,9,0.5,5,maybe"], "(censored): 'maybe' is not a number"),
    ],
)  # fmt: skip
def test_what_is_refused(tmp_path, lines, says):
    with pytest.raises(SourceError) as error:
        read_predictions(written(tmp_path, *lines))
    assert says in str(error.value)
    assert "predictions.csv" in str(error.value)
    assert "\n" not in str(error.value)


def test_a_missing_file_a_folder_and_no_text(tmp_path):
    written(tmp_path, HEAD)
    with pytest.raises(SourceError, match=r"no such file; did you mean 'predictions\.csv'"):
        read_predictions(tmp_path / "prediction.csv")
    with pytest.raises(SourceError, match="cannot be read"):
        read_predictions(tmp_path)
    (tmp_path / "zip.csv").write_bytes(b"robot,kind,time\n\xff\xfe\x00,task,0\n")
    with pytest.raises(SourceError, match="line 2: not UTF-8 text"):
        read_predictions(tmp_path / "zip.csv")


def test_a_line_of_100_megabytes_is_refused_before_it_is_read(tmp_path):
    path = tmp_path / "long.csv"
    with path.open("wb") as file:
        file.write(HEAD.encode() + b"\n")
        file.truncate(100_000_000)  # one line of zero bytes, which takes no room on disk
    with pytest.raises(SourceError, match=f"line 2: longer than {LONGEST_LINE} bytes"):
        read_predictions(path)


def test_too_many_rows_and_models_are_refused(tmp_path, monkeypatch):
    assert MOST_ROWS == 1_000_000
    monkeypatch.setattr("robophm.calibration.predictions.MOST_ROWS", 3)
    rows = [f"r{i},task,0,0.5,1" for i in range(4)]
    assert read_predictions(written(tmp_path, HEAD, *rows[:3])).tasks
    with pytest.raises(SourceError, match="line 5: more than 3 predictions"):
        read_predictions(written(tmp_path, HEAD, *rows))
    monkeypatch.undo()
    models = [f"r,task,0,0.5,1,m{i}" for i in range(300)]
    with pytest.raises(SourceError, match="more than 100 models"):
        read_predictions(written(tmp_path, HEAD + ",model", *models))


def test_spreadsheets_marks_are_taken(tmp_path):
    path = tmp_path / "sheet.csv"
    path.write_bytes(
        f'\ufeff{HEAD}\r\n "r, one" ,task, 0 ,0.5,1.0\r\n'.replace(' "r', '"r').replace('" ,', '",').encode()
    )
    assert np.array_equal(read_predictions(path).tasks["the predictions"].failed, [False])
