"""Groups of alike parts, some of whose failures have a common cause: what each part keeps, and what they share."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace

from robophm.blocks.common_cause import Shares, alpha_factor, beta_factor, multiple_greek_letter, shared_causes
from robophm.core.errors import StructureError
from robophm.design import schema
from robophm.design.located_error import LocatedError, Path
from robophm.design.robot import Component

MOST_CAUSES = 10_000
"""The most common causes of a robot; a group of eight parts has 247, one for each set of them."""


class CommonCauses:
    """The common causes of a robot, as its groups are taken in one by one."""

    def __init__(self, components: dict[str, Component], modules: Mapping[str, str]) -> None:
        self.components = components
        """Components by path; members of groups keep the failure modes that are their own."""
        self.modules = modules
        """Identities of modules, by path."""
        self.causes: list[Component] = []
        self.groups: dict[str, str] = {}
        """Members of each group and how often they fail together, in words; by path of the group."""
        self.of: dict[str, list[str]] = {}
        """The causes that fail each unit."""
        self._grouped: set[str] = set()
        self._taken = {*components, *modules}

    def add(self, level: str, name: str, place: Path, said: schema.CommonCause, paths: Sequence[str]) -> None:
        """Add a group of the components or units at ``paths``, as many as ``said.of`` names. Raises LocatedError."""
        members: dict[str, Path] = {}  # unit → where it is named
        for i, path in enumerate(paths):
            for unit in self.components[path].units if path in self.components else (path,):
                if unit in members:
                    raise LocatedError((*place, "of", str(i)), f"{unit} is there twice; expected each part once")
                members[unit] = (*place, "of", str(i))
        parts: dict[str, list[str]] = {}
        for unit in members:
            parts.setdefault(unit.partition("[")[0], []).append(unit)
        for path, units in parts.items():
            self._check(members[units[0]], self.components[path], units, self.components[next(iter(parts))])
        shares = _shares(place, said, len(members))
        below = f"{level}/" if level else ""
        self.groups[below + name] = _words([unit.removeprefix(below) for unit in members], shares)
        for numbers, share in shared_causes(shares):
            together = [list(members)[i] for i in numbers]
            self._add_cause(level, (name, said.identity), place, together, share, len(together) == len(members))
        for path in parts:
            part = self.components[path]
            self.components[path] = replace(part, modes=tuple(replace(mode, share=shares[0]) for mode in part.modes))
        self._grouped |= parts.keys()

    def _check(self, place: Path, part: Component, units: Sequence[str], first: Component) -> None:
        if part.path in self._grouped:
            raise LocatedError(
                place, f"{part.path} is in another group of common causes too; expected one for each part"
            )
        if part.unknown:
            raise LocatedError(place, f"{part.path} is of unknown rate, of which nothing is a share; expected a rate")
        if len(units) < len(part.units):
            raise LocatedError(
                place, f"{len(units)} of the {len(part.units)} equal parts of {part.path}; expected all of them"
            )
        mine, others = _likeness(part), _likeness(first)
        if unlike := next((what for what in mine if mine[what] != others[what]), None):
            raise LocatedError(
                place, f"{part.path} is not like {first.path}: its {unlike} differs; expected parts all alike"
            )

    def _add_cause(
        self, level: str, named: tuple[str, str | None], place: Path, units: Sequence[str], share: float, everyone: bool
    ) -> None:  # fmt: skip
        below, kept_below = (f"{one}/" if one else "" for one in (level, self.modules[level]))
        names = [unit.removeprefix(below) for unit in units]
        path = below + _cause_name(named[0], names, everyone)
        kept = [self._identity(unit).removeprefix(kept_below) for unit in units]
        identity = _cause_name(named[1] or kept_below + named[0], kept, everyone)
        if path in self._taken:
            raise LocatedError(place, f"duplicate name '{path}': a part has it too")
        if len(self.causes) == MOST_CAUSES:
            raise LocatedError(place, f"the robot has more than {MOST_CAUSES:,} common causes; expected smaller groups")
        # It ages as its members do: its hazard is the share of the mean of theirs.
        modes = tuple(
            replace(
                mode,
                path=f"{path}/{mode.path.removeprefix(below)}",
                share=share * count / len(units),
                member=mode.path,
                wear=None,
                failed_when=(),
                identity=f"{identity}/{mode.identity.removeprefix(kept_below)}",
            )
            for part, count in Counter(unit.partition("[")[0] for unit in units).items()
            for mode in self.components[part].modes
        )
        says = f"{share * 100:.3g} % of the failures of {', '.join(names)}, all at once"
        longest = max(self.components[unit.partition("[")[0]].repair for unit in units)  # until all are back
        self.causes.append(Component(path, 1, 1, False, modes, (path,), description=says, members=tuple(units),
                                     identity=identity, repair=longest))  # fmt: skip
        self._taken.add(path)
        for unit in units:
            self.of.setdefault(unit, []).append(path)

    def _identity(self, unit: str) -> str:
        path, bracket, number = unit.partition("[")
        return self.components[path].identity + bracket + number


def _cause_name(name: str, units: Sequence[str], everyone: bool) -> str:
    """The name of a cause that takes these members of a group, or everyone in it."""
    plain = ", ".join(units).translate(str.maketrans("/[", "  ", "]"))
    return name if everyone else f"{name} ({plain})"


def _shares(place: Path, said: schema.CommonCause, parts: int) -> Shares:
    try:
        if said.beta is not None:
            return beta_factor(said.beta, parts)
        if said.mgl is not None:
            return multiple_greek_letter(said.mgl, parts)
        return alpha_factor(said.alpha or (), parts, staggered=said.testing == "staggered")
    except StructureError as error:
        raise LocatedError(place, str(error)) from None


def _words(names: Sequence[str], shares: Shares) -> str:
    listed = [*names[:_MOST_NAMED], *(["…"] if len(names) > _MOST_NAMED else [])]
    taken = [
        f"{share * 100:.3g} % in {'each' if k < len(names) else 'the'} set of {k}"
        for k, share in enumerate(shares[1:], 2)
        if share > 0
    ]
    return f"{', '.join(listed)} may fail together: of the failures of each, {', '.join(taken) or 'none'}"


_MOST_NAMED = 8


def _likeness(part: Component) -> dict[str, object]:
    """The properties that alike parts must share; their place, and what they have behind them, may differ."""
    names = [mode.path.removeprefix(part.path) for mode in part.modes]
    stresses = [
        [(stress.model.name, stress.model.formula, sorted(stress.design.items())) for stress in mode.stresses]
        for mode in part.modes
    ]
    return {
        "set of failure modes": names,
        "clock": [mode.clock for mode in part.modes],
        "model or design stress": stresses,
        "rate": [mode.rate for mode in part.modes],
        "life": [mode.life for mode in part.modes],
        "scaling": [mode.scaling for mode in part.modes],
    }
