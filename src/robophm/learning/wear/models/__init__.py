"""Models of degradation. One file here is one model; the file's name is the model's name.

A model is one file with a function ``candidates(course)``: the model at a grid of its parameters, weighted by a
prior, each of which says how well it foretold the unit's own past and when the threshold is reached
(``candidates.py``; None where the readings cannot be of such wear). Those of a Wiener process on another scale of time
or wear share ``scaled_wiener.py``. A new model is one new file, or such a module in somebody else's package under the
entry-point group ``robophm.learning.wear.models``.
"""

from __future__ import annotations

from functools import cache

from robophm.core.errors import PlugError
from robophm.core.registry import load_plug, plugs
from robophm.learning.wear.models.candidates import Candidates, DegradationPath

NOT_PLUGS = ("candidates", "scaled_wiener")  # the interface, and what several share


@cache
def degradation_models() -> tuple[str, ...]:
    """Names of all degradation models that can be had here, sorted; looked for once."""
    return tuple(plugs(__name__))


def candidates_of(name: str, course: DegradationPath) -> Candidates | None:
    """A model's candidates for a course of wear; None where the model does not apply. Raises PlugError for no model."""
    module = load_plug(__name__, name, "degradation model")
    made = getattr(module, "candidates", None)
    if not callable(made):
        raise PlugError(f"degradation model '{name}': {module.__name__} has no function candidates(course)")
    found: Candidates | None = made(course)
    return found
