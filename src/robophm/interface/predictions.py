"""Whether predictions were honest, and robots that really fail: ``robophm.calibrate`` and ``robophm.simulate``."""

from __future__ import annotations

import os

from robophm.calibration.fleet import CONTROLS, OURS, predict_fleet
from robophm.calibration.predictions import Predictions, read_predictions
from robophm.calibration.score import Calibration, score
from robophm.core.argument_checks import instance, number, path
from robophm.core.errors import DesignError, RobophmError, SourceError
from robophm.parts import completed
from robophm.simulation import fleet


def calibrate(
    predictions: Predictions | str | os.PathLike[str], *, controls: bool = False, jobs: int = 1
) -> Calibration:
    """Whether predictions were honest: of a table of what was predicted and what happened, or of a fleet's folder.

    ``controls``: of a fleet, also models that are wrong, which must be found out; ``jobs``: processes that share the
    work. Raises SourceError or DesignError for what is neither.
    """
    shared = int(number(jobs, "jobs", low=1, high=256, whole=True))
    if isinstance(predictions, Predictions):
        return score(predictions)
    given = path(predictions, "predictions", SourceError)
    if not given.is_dir():
        if controls:
            raise RobophmError(f"{given}: controls are of a fleet's folder; a table has the models that it has")
        return score(read_predictions(given))
    return score(predict_fleet(given, OURS | CONTROLS if controls else OURS, jobs=shared))


def simulate(
    design: str | os.PathLike[str], folder: str | os.PathLike[str], *, robots: int = 20, tasks: int = 10,
    seed: int = 0, uncertain_rates: bool = False,
) -> fleet.Fleet:  # fmt: skip
    """Let robots of a design work and really fail, and write their recordings, tasks and failures into a folder.

    The one function that writes: a folder that is not there yet, or empty. ``uncertain_rates``: each robot draws its
    true rates from the design's uncertainty. Raises RobophmError, nothing written, for what cannot be simulated.
    """
    many, done, begin = (
        int(number(value, name, low=low, whole=True))
        for name, value, low in (("robots", robots, 1), ("tasks", tasks, 1), ("seed", seed, 0))
    )
    instance(uncertain_rates, bool, "uncertain_rates", "True or False")
    file, to = path(design, "design", DesignError), path(folder, "folder", RobophmError)
    return fleet.simulate(file, to, many, done, begin, uncertain_rates=uncertain_rates, library=completed)
