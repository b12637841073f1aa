"""The calibration of each model: its scores and the verdicts on them."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from robophm.calibration.lives import LifeScore, score_lives
from robophm.calibration.predictions import OWN, Predictions
from robophm.calibration.tasks import TaskScore, score_tasks
from robophm.calibration.verdict import Verdict, judge_lives, judge_tasks
from robophm.core.json_values import plain


@dataclass(frozen=True)
class ModelCalibration:
    """The scores and verdicts of one model; None for a kind of prediction that it did not make."""

    model: str
    tasks: TaskScore | None
    task_verdict: Verdict | None
    lives: LifeScore | None
    life_verdict: Verdict | None

    @property
    def rejected(self) -> bool:
        """Whether any verdict is "not calibrated"."""
        verdicts = (self.task_verdict, self.life_verdict)
        return any(verdict is not None and verdict.finding == "not calibrated" for verdict in verdicts)


@dataclass(frozen=True)
class Calibration:
    """The models of a history of predictions, in the order of the file, those with tasks first."""

    models: tuple[ModelCalibration, ...]

    @property
    def rejected(self) -> bool:
        """Whether our own model is rejected, or the only one: others may be there to be found out."""
        return any(one.rejected and (one.model == OWN or len(self.models) == 1) for one in self.models)

    def to_json(self) -> dict[str, Any]:
        """Return plain lists and dictionaries for JSON: what is infinite or not a number becomes None."""
        document: dict[str, Any] = plain(asdict(self))
        for entry, model in zip(document["models"], self.models, strict=True):
            entry["rejected"] = model.rejected
        return document


def score(predictions: Predictions) -> Calibration:
    """Score every model for itself."""
    models = []
    for name in dict.fromkeys((*predictions.tasks, *predictions.lives)):
        tasks = score_tasks(predictions.tasks[name]) if name in predictions.tasks else None
        lives = score_lives(predictions.lives[name]) if name in predictions.lives else None
        models.append(
            ModelCalibration(
                name, tasks, judge_tasks(tasks) if tasks else None, lives, judge_lives(lives) if lives else None
            )
        )
    return Calibration(tuple(models))
