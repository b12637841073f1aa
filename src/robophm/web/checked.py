"""Texts of a design checked: what is wrong or odd in each, and the robot that it describes."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Sequence
from dataclasses import replace

from robophm.core.yaml_nodes import uncollected
from robophm.design.drawable import Drawable, drawable
from robophm.design.known_parts import KnownParts
from robophm.design.problems import CheckResult, Problem, check
from robophm.health.refusal import refusal
from robophm.web.prepared_robot import PreparedRobots

_KEPT, _MOST_KEPT = 6, 12_000_000
"""Texts that are remembered, and their characters: an edit needs the two before and after it, whatever their size."""


class CheckedTexts:
    """The latest few texts that were checked; for any number of threads."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._found: OrderedDict[str, CheckResult] = OrderedDict()
        self._drawn: tuple[str, Drawable | None] = "", None
        self._known = KnownParts()
        self.prepared = PreparedRobots()
        """The robots of the texts, prepared."""

    def of(self, text: str) -> CheckResult:
        """Return all that can be said of a text, found now or remembered."""
        with self._lock:
            if text not in self._found:
                self._found[text] = self._checked(text)
                while len(self._found) > max(2, min(_KEPT, _MOST_KEPT // (len(text) or 1))):
                    self._found.popitem(last=False)
            self._found.move_to_end(text)
            return self._found[text]

    def problems(self, text: str) -> Sequence[Problem]:
        """Return all that is wrong or odd in a text, mistakes that only show once others are left out among them."""
        drawn = None if self.of(text).robot else self.drawn(text)
        return drawn.problems if drawn else self.of(text).problems

    def drawn(self, text: str) -> Drawable | None:
        """Return the robot of a text for its drawing, what is wrong left out; None where there is nothing to draw."""
        checked = self.of(text)
        if checked.robot:
            refused = [one.message for one in checked.problems if one.level == "error"]
            return Drawable(checked.robot, {"": refused} if refused else {})
        with self._lock:
            if self._drawn[0] != text:
                self._drawn = text, drawable(checked.document, checked.lines)
            return self._drawn[1]

    @uncollected()
    def _checked(self, text: str) -> CheckResult:
        """A check of a text that includes why no figures can be given for the robot that it describes."""
        found = check(text, self._known)
        if found.robot is None:
            return found
        prepared = self.prepared.of(found.robot)
        says = refusal(found.robot, lambda _: prepared.new, lambda _: prepared.when_new)
        if says is None:
            return found
        return replace(found, problems=(Problem("error", (), says, None), *found.problems))
