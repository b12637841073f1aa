"""Hazard models of handbooks. One file here is one section of one handbook; its path is its name in a design.

A plug ``mil_hdbk_217f/capacitor.py`` holds one ``hazard_rate`` declared with ``@hazard_model`` and is named
``mil_hdbk_217f.capacitor``.
"""

from __future__ import annotations

from robophm.core.errors import PlugError
from robophm.core.registry import load_plug, plugs
from robophm.hazard.model import Model


def handbook_models() -> list[str]:
    """Names of all hazard models, sorted."""
    return plugs(__name__)


def handbook_model(name: str) -> Model:
    """The hazard model of that name. Raises PlugError with the nearest known name."""
    model = getattr(load_plug(__name__, name, "hazard model"), "hazard_rate", None)
    if not isinstance(model, Model):
        raise PlugError(f"hazard model '{name}': its file declares no 'hazard_rate'")
    return model
