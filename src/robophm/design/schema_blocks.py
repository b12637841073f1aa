"""The schema of diagrams in a design file: how parts are wired in blocks."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, Discriminator, Field, Tag, model_validator

from robophm.design.schema_fields import Strict

BLOCKS = ("series", "parallel", "k_of_n", "standby", "load_sharing", "network")
"""The kinds of blocks."""


class Series(Strict):
    """Works while all work."""

    series: list[Diagram] = Field(min_length=1)


class Parallel(Strict):
    """Works while any works."""

    parallel: list[Diagram] = Field(min_length=1)


class KOutOfNGroup(Strict):
    """k and the blocks it is chosen of."""

    k: int = Field(strict=True, ge=1)
    of: list[Diagram] = Field(min_length=1)


class KOutOfN(Strict):
    """Works while at least k work."""

    k_of_n: KOutOfNGroup


class StandbyGroup(Strict):
    """Parts of which the first work and the others wait."""

    of: list[str] = Field(min_length=1, description="parts or modules in the order of their use")
    active: int = Field(1, strict=True, ge=1, description="how many work at a time")
    dormancy: float = Field(
        0.0, ge=0, le=1, description="share of the speed at which a spare ages while it waits; 0 cold"
    )
    switch: float = Field(1.0, ge=0, le=1, description="probability that a spare takes over when it is called")


class Standby(Strict):
    """Works while a spare can take the place of each part that fails."""

    standby: StandbyGroup


class LoadSharingGroup(Strict):
    """Equal parts that share one load."""

    of: list[str] = Field(min_length=1, description="parts or modules")
    k: int = Field(1, strict=True, ge=1, description="how many must work")
    exponent: float | None = Field(None, ge=0, le=100, description="life goes down with this power of each one's share")
    factors: list[Annotated[float, Field(gt=0, le=1e12)]] | None = Field(
        None, description="instead: how many times as fast each ages with 0, 1, … failed, e.g. [1, 2.5]"
    )

    @model_validator(mode="after")
    def _one_law(self) -> LoadSharingGroup:
        if (self.exponent is None) == (self.factors is None):
            raise ValueError("expected either exponent, e.g. 3 for bearings, or factors")
        return self


class LoadSharing(Strict):
    """Works while at least k work; the fewer they are, the faster they age."""

    load_sharing: LoadSharingGroup


class NetworkLink(Strict):
    """A link that is not just a chain of names: one way only, or with something on it that may fail."""

    between: tuple[str, str] | None = Field(None, description="the nodes that it joins, both ways")
    start: str | None = Field(None, alias="from", description="where a one-way link starts")
    end: str | None = Field(None, alias="to", description="where a one-way link ends")
    through: Diagram | None = Field(None, description="what on it may fail, e.g. a cable; default nothing")

    @model_validator(mode="after")
    def _one_kind(self) -> NetworkLink:
        if (self.between is None) == (self.start is None) or (self.start is None) != (self.end is None):
            raise ValueError("expected between: [A, B], or from: A and to: B")
        return self


Links = Annotated[
    Annotated[list[str], Field(min_length=2), Tag("names")] | Annotated[NetworkLink, Tag("link")],
    Discriminator(
        lambda value: "names" if isinstance(value, list) else "link" if isinstance(value, dict | NetworkLink) else None,
        custom_error_type="link",
        custom_error_message="not a link; expected names, e.g. [A, B], or between: [A, B], or from: A and to: B",
    ),
]


class NetworkGroup(Strict):
    """Nodes and what joins them. A node is a part, a junction, or where the network begins and ends."""

    start: str = Field(alias="from", description="where it begins: a part, or any name that links have")
    end: str = Field(alias="to", description="where it ends, likewise")
    links: list[Links] = Field(min_length=1, description="[A, B, …] joins each name with the next, both ways")
    junctions: list[str] = Field(default_factory=list, description="nodes that are no parts and cannot fail")


class Network(Strict):
    """Works while a path of working parts leads from one node to another."""

    network: NetworkGroup


def _kind_of_block(value: object) -> str | None:
    if isinstance(value, str):
        return "part"
    kinds = value if isinstance(value, dict) else type(value).model_fields if isinstance(value, BaseModel) else ()
    return next((kind for kind in BLOCKS if kind in kinds), None)


Diagram = Annotated[
    Annotated[str, Tag("part")]
    | Annotated[Series, Tag("series")]
    | Annotated[Parallel, Tag("parallel")]
    | Annotated[KOutOfN, Tag("k_of_n")]
    | Annotated[Standby, Tag("standby")]
    | Annotated[LoadSharing, Tag("load_sharing")]
    | Annotated[Network, Tag("network")],
    Discriminator(
        _kind_of_block,
        custom_error_type="block",
        custom_error_message="not a block; expected a part's name, or one of " + ", ".join(BLOCKS),
    ),
]


def _one_or_list(value: object) -> str:
    return "list" if isinstance(value, list) else "one"


DependsOn = Annotated[
    Annotated[Diagram, Tag("one")] | Annotated[list[Diagram], Field(min_length=1), Tag("list")],
    Discriminator(_one_or_list),
]
"""A diagram, or a list of blocks all of which must work."""


for _model in (Series, Parallel, KOutOfNGroup, KOutOfN, NetworkLink, NetworkGroup, Network):
    _model.model_rebuild()
