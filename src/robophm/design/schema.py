"""The schema of a design file, key by key. ``robophm schema`` prints it as JSON Schema.

Only the schema files load pydantic; the rest of robophm sees the resolved ``Robot`` alone.
"""

from __future__ import annotations

from contextlib import suppress
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, ConfigDict, Field, WithJsonSchema, model_validator

from robophm.core.errors import RobophmError
from robophm.design.schema_blocks import DependsOn, Diagram
from robophm.design.schema_fields import LONGEST, Identity, Name, Repair, Strict, Written, quantity_in, share_in
from robophm.design.schema_task import AnyTask
from robophm.design.schema_thresholds import ModuleThresholds, PartThresholds, Thresholds
from robophm.design.schema_told_failures import ToldFailure as ToldFailure
from robophm.design.schema_told_failures import ToldFailures
from robophm.hazard.environments import ENVIRONMENTS, WORDS, environment
from robophm.hazard.qualities import QUALITIES, quality
from robophm.parts import completed
from robophm.parts import part as library_part

Clock = Literal["operating", "calendar", "kilometres", "cycles", "starts"]
"""The clocks that a failure mode can age on."""


class SignalBinding(Strict):
    """A model input that is measured: a field of a topic."""

    topic: str = Field(min_length=1, description="e.g. /power/temperature")
    field: str = Field(min_length=1, description="path of the number in the message, e.g. temperature or effort[elbow]")
    unit: str | None = Field(None, description="unit of the field; default: the unit that the model input has")
    range: tuple[float, float] | None = Field(None, description="what is outside, in that unit, is no sample")
    rated: float | None = Field(None, gt=0, description="what counts as 1, in that unit; of an input such as load")
    offset: Written | None = Field(None, description="added to the value, e.g. 15 K for a part hotter than its module")
    max_age: Annotated[float, quantity_in("s", "how long the last value holds", "5 s", 0.0, LONGEST)] = 5.0
    stale: Literal["conservative", "nominal", "hold", "worst"] = Field(
        "conservative", description="what applies when there is no value"
    )

    @model_validator(mode="after")
    def _range_ascends(self) -> SignalBinding:
        if self.range and not self.range[0] < self.range[1]:
            raise ValueError(f"range {list(self.range)} does not ascend; expected the lower end first")
        return self


class ClockBinding(Strict):
    """A clock that is measured: distance from positions or speed, cycles or starts from rising edges."""

    topic: str = Field(min_length=1)
    position: tuple[str, ...] | None = Field(None, min_length=1, max_length=3, description="coordinates, e.g. [x, y]")
    speed: str | None = Field(None, description="field with a speed; its magnitude counts")
    edge: str | None = Field(None, description="field whose rise through the threshold counts one")
    unit: str | None = Field(None, description="unit of the field; default m or m/s")
    threshold: float = Field(0.5, description="of an edge, in the field's unit")
    becomes: float | None = Field(
        None, description="in place of a threshold: the value that an edge's field has then, and had not before, e.g. "
        "3 of a lifecycle's goal_state.id, active",
    )  # fmt: skip
    max_age: Annotated[float, quantity_in("s", "how long the last speed holds", "5 s", 0.0, LONGEST)] = 5.0

    @model_validator(mode="after")
    def _one_kind(self) -> ClockBinding:
        if sum(kind is not None for kind in (self.position, self.speed, self.edge)) != 1:
            raise ValueError("expected exactly one of position, speed, edge")
        if self.becomes is not None and (self.edge is None or "threshold" in self.model_fields_set):
            raise ValueError("becomes is of an edge, in place of its threshold; expected one of both")
        return self


class PowerBinding(Strict):
    """The signal that says whether the robot is on: true above a half."""

    topic: str = Field(min_length=1)
    field: str = Field(min_length=1)


class FormulaVariable(Strict):
    """A number in a formula: its value by design, and the unit in which the formula takes it."""

    value: Written
    unit: str = Field("", description="in which the formula takes it, e.g. degC; default none")
    range: tuple[float, float] | None = Field(None, description="where the formula holds, in that unit")
    description: str = ""

    @model_validator(mode="after")
    def _range_ascends(self) -> FormulaVariable:
        if self.range and not self.range[0] < self.range[1]:
            raise ValueError(f"range {list(self.range)} does not ascend; expected the lower end first")
        return self


class Hazard(Strict):
    """A hazard rate by a handbook model, or by the user's own formula."""

    model_config = ConfigDict(
        json_schema_extra={"oneOf": [{"required": ["model"]}, {"required": ["formula", "unit", "source"]}]}
    )

    model: str | None = Field(None, description="e.g. mil_hdbk_217f.capacitor; `robophm rate` lists them")
    inputs: dict[str, Written] = Field(default_factory=dict, description="design-time stresses and choices")
    formula: str | None = Field(
        None, description="e.g. base * exp(0.05 * (temperature - 25)), of numbers, variables and exp log sqrt …"
    )
    unit: str | None = Field(None, description="of the formula's result, e.g. 1/h or FPMH")
    variables: dict[str, FormulaVariable] = Field(
        default_factory=dict, description="of the formula; each may be measured"
    )
    source: str | None = Field(None, min_length=1, max_length=500, description="where the formula is from")

    @model_validator(mode="after")
    def _model_or_formula(self) -> Hazard:
        if (self.model is None) == (self.formula is None):
            raise ValueError("expected either model or formula")
        if self.model is not None and (self.unit is not None or self.variables or self.source is not None):
            raise ValueError("a model has inputs; unit, variables and source are of a formula")
        if self.formula is not None and (self.inputs or self.unit is None or self.source is None):
            raise ValueError("a formula needs its unit and source, and has variables in place of inputs")
        return self


class Life(Strict):
    """How hazard depends on age; the scale follows from the rate unless it is given."""

    model_config = ConfigDict(extra="allow", frozen=True)
    distribution: str = Field("exponential", description="e.g. weibull, lognormal; parameters as further keys")


class Acceleration(Strict):
    """How stress shortens life: a model and its parameters as further keys."""

    model_config = ConfigDict(extra="allow", frozen=True)
    model: str = Field(description="q10, arrhenius, eyring, peck, coffin_manson, cubic_load or inverse_power")


Accelerations = Acceleration | list[Acceleration] | Literal["none"]


class Uncertainty(Strict):
    """How sure a rate is: exactly one of the three. Its mean is the stated rate."""

    error_factor: float | None = Field(None, gt=1, le=1e6, description="lognormal: 95th percentile over the median")
    failures: float | None = Field(None, gt=0, le=1e9, description="gamma: as sure as if so many had been seen")
    samples: list[Written] | None = Field(None, min_length=2, max_length=100_000, description="equally likely rates")

    @model_validator(mode="after")
    def _one_kind(self) -> Uncertainty:
        if sum(kind is not None for kind in (self.error_factor, self.failures, self.samples)) != 1:
            raise ValueError("expected exactly one of error_factor, failures, samples")
        return self


class Learned(Strict):
    """Field evidence on a stated rate; `robophm learn` writes it, from all that was seen so far."""

    factor: float = Field(gt=0, le=1e12, description="the rate is so many times what is stated")
    shape: float = Field(gt=0, le=1e12, description="gamma: as sure as if so many failures had been seen")
    failures: float = Field(ge=0, description="that were seen")
    expected: float = Field(ge=0, description="failures by the stated rate in the same exposure")
    exposure: Written | None = Field(None, description="of all parts together, e.g. 120000 h")
    low: float | None = Field(None, ge=0, description="the factor is above this with 95 %")
    high: float | None = Field(None, gt=0, description="the factor is below this with 95 %")
    prior: float | None = Field(None, ge=0, description="failures that the stated rate counted as")
    note: str = Field("", max_length=500)


class WearGauge(Strict):
    """A second signal, measured beside a signal of wear."""

    topic: str = Field(min_length=1)
    field: str = Field(min_length=1, description="path of the number in the message")
    range: tuple[float, float] | None = Field(None, description="as recorded; of a load: within which samples count")
    max_age: Annotated[float, quantity_in("s", "how long the last value holds", "5 s", 0.0, LONGEST)] = 5.0

    @model_validator(mode="after")
    def _range_ascends(self) -> WearGauge:
        if self.range and not self.range[0] < self.range[1]:
            raise ValueError(f"range {list(self.range)} does not ascend; expected the lower end first")
        return self


class Wear(Strict):
    """A signal that shows how worn a part is, and how worn is too much; whatever lives through its samples reads it."""

    topic: str = Field(min_length=1, description="e.g. /joint_states")
    field: str = Field(min_length=1, description="path of the number in the message, e.g. effort[elbow]")
    unit: str | None = Field(None, description="of the field; default: bare numbers, as recorded")
    range: tuple[float, float] | None = Field(None, description="what is outside, in that unit, is no sample")
    reading: Literal["mean", "rms", "kurtosis", "highest", "lowest"] = Field(
        "mean", description="what is made of the samples of each stretch of time; rms is about their mean"
    )
    every: Annotated[float, quantity_in("s", "how long such a stretch is", "1 h", 1.0, LONGEST)] = 3600.0
    ambient: WearGauge | None = Field(None, description="is taken off each sample, e.g. the temperature of the air")
    load: WearGauge | None = Field(None, description="samples count only while this is within its range")
    threshold: Written = Field(description="at which the part is worn out, e.g. 6 A; a signal that falls falls to it")
    threshold_deviation: Written | None = Field(
        None, description="how well that is known, a standard deviation, e.g. 0.3 A; default exactly"
    )
    share: float = Field(
        1.0, gt=0, le=1, description="of the mode's hazard, what wear stands for; the rest comes by chance"
    )
    teachers: str | None = Field(
        None, pattern=r"^[^/\\\x00-\x1f]+\.csv$", max_length=200,
        description="a table beside the design, unit, time, value: such readings of others that wore out or still run",
    )  # fmt: skip

    @model_validator(mode="after")
    def _load_has_a_range(self) -> Wear:
        if self.range and not self.range[0] < self.range[1]:
            raise ValueError(f"range {list(self.range)} does not ascend; expected the lower end first")
        if self.load and not self.load.range:
            raise ValueError("load has no range; expected within which samples count, e.g. range: [2, 3]")
        return self


class FailureMode(Strict):
    """One way to fail; the modes of a component are in series."""

    rate: Written | None = Field(
        None, description="e.g. 12 FIT, 0.3 FPMH, 5.8e-6 /h, 2e-5 /km by its clock; or the word unknown"
    )
    mtbf: Written | None = Field(
        None, description="in place of a rate: mean life, e.g. 20000 h, or by its clock 5e6 km"
    )
    mttf: Written | None = Field(None, description="the same as mtbf")
    l10: Written | None = Field(None, description="in place of a rate: by when a tenth have failed, by the life below")
    b10: Written | None = Field(None, description="the same as l10, e.g. 2e6 cycle")
    hazard: Hazard | None = None
    life: Life = Field(default_factory=lambda: Life.model_validate({}))
    clock: Clock = "operating"
    scaling: Literal["age", "hazard"] = Field("age", description="what stress scales: the age or the hazard")
    acceleration: Accelerations | None = None
    initial_exposure: Written | None = Field(None, description="what a used part has behind it, e.g. 1200 h")
    source: str | None = Field(None, description="where the rate is from")
    uncertainty: Uncertainty | None = Field(None, description="how sure the rate is; inherited, default exact")
    learned: Learned | None = Field(None, description="what the field says of it, and how sure it is then")
    wear: Wear | None = Field(None, description="a signal that shows it coming")
    failed_when: ToldFailures | None = Field(None, description="what software says when it has failed: any of these")
    identity: Identity | None = None


def _in_library(name: str) -> str:
    try:
        return library_part(name).name
    except RobophmError as error:
        raise ValueError(str(error)) from None


def _of_table_3_2(said: str) -> str:
    try:
        return environment(said)
    except RobophmError as error:
        raise ValueError(str(error)) from None


Environment = Annotated[
    str,
    AfterValidator(_of_table_3_2),
    WithJsonSchema(
        {"type": "string", "description": "where it works, a symbol or word", "examples": [*ENVIRONMENTS, *WORDS]}
    ),
]
"""The symbol of MIL-HDBK-217F Table 3-2 for the environment of parts; unknown words are refused even where no model of
these parts asks for an environment."""


def _of_a_board(said: str) -> str:
    try:
        return quality(said)
    except RobophmError as error:
        raise ValueError(str(error)) from None


Quality = Annotated[
    str,
    AfterValidator(_of_a_board),
    WithJsonSchema({"type": "string", "description": "of all parts that state no level", "examples": [*QUALITIES]}),
]
"""How well all parts of a level are made that state no level of their own."""

PartName = Annotated[str, AfterValidator(_in_library), WithJsonSchema({"type": "string", "examples": ["lidar_2d"]})]
"""The name of an entry of the library of parts."""

Duty = Annotated[
    float, Field(ge=0, le=1), share_in("share at which parts age in a leg that does not need them", "30 %", zero=True)
]


class Component(FailureMode):
    """A part, with its only failure mode written inline, or several under failure_modes, or as the library has it."""

    part: PartName | None = Field(None, description="of the library, e.g. lidar_2d; the component's own keys win")
    description: str | None = None
    quantity: int = Field(1, strict=True, ge=1, le=100_000, description="that many separate parts")
    required: int | None = Field(None, strict=True, ge=1, description="how many of them must work; default all")
    environment: Environment | None = None
    quality: Quality | None = None
    monitored: bool = Field(False, description="known to work until reported failed")
    duty: Duty | None = None
    repair: Repair | None = None
    depends_on: DependsOn | None = Field(None, description="works only while this does: a part, a block, or a list")
    signals: dict[str, SignalBinding] = Field(default_factory=dict)
    offsets: dict[str, Written] = Field(default_factory=dict, description="added to inherited signals, e.g. 15 K")
    thresholds: PartThresholds | None = None
    clocks: dict[Clock, ClockBinding] = Field(default_factory=dict)
    failure_modes: dict[Name, FailureMode] = Field(default_factory=dict)

    @model_validator(mode="before")
    @classmethod
    def _of_the_library(cls, said: object) -> object:
        if isinstance(said, dict) and isinstance(said.get("part"), str):
            with suppress(RobophmError):  # which the key itself is told of
                return completed(said)
        return said


class CommonCause(Strict):
    """Alike parts that may fail together, and how often: exactly one of beta, mgl, alpha."""

    of: list[str] = Field(min_length=1, description="parts of this level, below it, or from the robot down after /")
    beta: float | None = Field(None, ge=0, lt=1, description="share of all failures that takes all of them")
    mgl: list[float] | None = Field(None, description="beta, gamma, delta …: one fewer than parts")
    alpha: list[float] | None = Field(None, description="share of failure events that take 1, 2 … of them; as many")
    testing: Literal["staggered", "non-staggered"] = Field("staggered", description="how alpha was found")
    identity: Identity | None = None

    @model_validator(mode="after")
    def _one_kind(self) -> CommonCause:
        if sum(kind is not None for kind in (self.beta, self.mgl, self.alpha)) != 1:
            raise ValueError("expected exactly one of beta, mgl, alpha")
        if "testing" in self.model_fields_set and self.alpha is None:
            raise ValueError("testing is of alpha; expected none here")
        return self


class _Group(Strict):
    identity: Identity | None = None
    description: str | None = None
    environment: Environment | None = None
    quality: Quality | None = None
    ambient: Written | None = Field(
        None, description="temperature around the parts as designed, e.g. 40 degC; default: as parts here state it"
    )
    signals: dict[str, SignalBinding] = Field(default_factory=dict)
    clocks: dict[Clock, ClockBinding] = Field(default_factory=dict)
    acceleration: Accelerations | None = Field(None, description="of the constant-rate parts below")
    uncertainty: Uncertainty | None = Field(None, description="of the rates below")
    duty: Duty | None = None
    repair: Repair | None = None
    modules: dict[Name, Module] = Field(default_factory=dict)
    components: dict[Name, Component] = Field(default_factory=dict)
    diagram: Diagram | None = Field(None, description="how the blocks of this level are wired; default series")
    common_causes: dict[Name, CommonCause] = Field(default_factory=dict, description="groups that may fail together")


class Module(_Group):
    """A module or sub-module, to any depth."""

    thresholds: ModuleThresholds = Field(default_factory=ModuleThresholds)
    depends_on: DependsOn | None = Field(None, description="works only while this does: a part, a block, or a list")


def _or_operating_alone(schema: dict[str, Any]) -> None:
    whole = dict(schema)
    schema.clear()
    schema["anyOf"] = [whole, *whole["properties"]["operating"]["anyOf"]]


class Usage(Strict):
    """Nominal use: the share of calendar time in operation, and the progress of other clocks in an hour of operation.

    A text alone, `8 h/day`, is that share.
    """

    model_config = ConfigDict(json_schema_extra=_or_operating_alone)

    operating: Annotated[
        float, Field(gt=0, le=1), share_in("share of calendar time that the robot works", "8 h/day", zero=False)
    ] = 1.0
    kilometres: Annotated[float, quantity_in("km/h", "driven per operating hour", "1.2 km/h", 0.0)] | None = None
    cycles: Annotated[float, quantity_in("cycle/h", "cycles per operating hour", "40 cycle/h", 0.0)] | None = None
    starts: Annotated[float, quantity_in("start/h", "starts per operating hour", "0.1 start/h", 0.0)] | None = None

    @model_validator(mode="before")
    @classmethod
    def _hours_of_a_day_alone(cls, said: object) -> object:
        return {"operating": said} if isinstance(said, str | int | float) and not isinstance(said, bool) else said


class RobotFile(_Group):
    """A robot's design."""

    schema_version: Literal[1]
    name: Name
    usage: Usage = Field(default_factory=Usage)
    powered: PowerBinding | None = None
    max_gap: Annotated[float, quantity_in("s", "after so long a silence the robot is off", "60 s", 0.0, LONGEST)] = 60.0
    task: AnyTask | None = None
    functions: dict[Name, Diagram] = Field(default_factory=dict, description="what the robot can do, each a diagram")
    thresholds: Thresholds = Field(default_factory=Thresholds)


for _model in (Module, RobotFile):
    _model.model_rebuild()


def json_schema() -> dict[str, Any]:
    """The JSON Schema of a design file, for an editor's completion and checks."""
    schema = RobotFile.model_json_schema()
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema, "title": "robophm design"}
