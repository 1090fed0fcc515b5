"""A closed loop as data: which FMU, which plant, how they are wired, what is measured and demanded."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

from cosim import paths
from cosim.scenario import overrides
from cosim.scenario.injection import INJECTED, Injection
from cosim.scenario.ranges import COUNT, FINITE, NOT_NAN, NOT_NEGATIVE, NOT_NEGATIVE_COUNT, POSITIVE, limited
from cosim.scenario.schema import schema_of


@dataclass(frozen=True)
class Loop:
    """How the loop is run.

    Parameters
    ----------
    step
        Communication step in s; the controller is sampled at `k * step`.
    duration
        Simulated time in s, a multiple of `step`.
    substeps
        Plant steps in one communication step.
    seed
        Seed of all noise, a non-negative integer.
    order
        Who moves first in a step; the controller samples, computes and its command acts in the same step.
    compute_delay
        Steps by which commands act later; 1 is what standard FMI masters do.
    record_every
        Steps between two rows of the trace; metrics and `stop_when` see these rows.
    record_qpos
        Whether the trace holds MuJoCo's `qpos` as well, `plant.qpos.<joint>`, to show the run again.
    record_locals
        Whether the trace holds the local variables of the FMUs; where left out, those of an FMU with at most 256.
    stop_when
        Expression over the current row of the trace that ends the run early; empty never does.
    """

    step: float = limited(POSITIVE, unit="s")
    duration: float = limited(POSITIVE, unit="s")
    substeps: int = limited(COUNT, 1)
    seed: int = limited(NOT_NEGATIVE_COUNT, 1)
    order: Literal["controller_first"] = "controller_first"
    compute_delay: Literal[0, 1] = 1
    record_every: int = limited(COUNT, 1)
    record_qpos: bool = False
    record_locals: bool | None = None
    stop_when: str = ""

    @property
    def steps(self) -> int:
        """Number of communication steps."""
        return round(self.duration / self.step)

    @property
    def rows(self) -> int:
        """Rows of the trace of a run that does not end early."""
        return -(-self.steps // self.record_every)

    def every(self, step: float | None) -> int:
        """Communication steps in one of an FMU, whose own is `step` in s or, if that is None, the same."""
        return 1 if step is None else round(step / self.step)


@dataclass(frozen=True)
class Controller:
    """FMU by name or path, and start values of its variables by FMI name."""

    fmu: str
    parameters: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class FmuChoice:
    """One of several FMUs, and start values of its variables by FMI name.

    Parameters
    ----------
    name
        Name in wires, columns and overrides, as in `<name>.<variable>`.
    fmu
        FMU by name or path.
    step
        Its communication step in s, a whole multiple of `loop.step`, which it is where it is left out.
    """

    name: str
    fmu: str
    parameters: dict[str, Any] = field(default_factory=dict)
    step: float | None = limited(POSITIVE, None, unit="s")
    alone: bool = field(default=False, metadata={"key": ""})

    @property
    def who(self) -> str:
        """What messages call it."""
        return "the FMU" if self.alone else f"the FMU `{self.name}`"

    @property
    def shown(self) -> str:
        """What tells it from the others of the run."""
        return self.fmu if self.alone else self.name


ALONE = FmuChoice("controller", "", alone=True)
"""What the FMU of a table `[controller]` is called by."""


@dataclass(frozen=True)
class PlantChoice:
    """Plant by name or as `module:Class`, and its parameters; no name is no plant."""

    name: str
    parameters: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Wire:
    """One value carried from the plant to an FMU or back, or from one FMU to another.

    `noise`, `quantum`, `minimum` and `maximum` are in the unit of the plant's channel and default to the
    channel's own; `scale` and `offset` convert between the two: `to = scale * from + offset`. Between FMUs
    they are in the unit of the input and default to none.

    Parameters
    ----------
    source
        `plant.<reading>` or `controller.<output>`; of several FMUs the name of one stands for `controller`.
    to
        `controller.<input>` or `plant.<command>`.
    noise
        Standard deviation of white Gaussian noise, drawn anew in every step.
    quantum
        Resolution; 0 is continuous.
    delay
        Transport delay in steps, beside `loop.compute_delay`. A wire to an FMU that does not come after the
        one it is from needs at least 1.
    minimum, maximum
        Limits.
    """

    source: str = field(metadata={"key": "from"})
    to: str
    scale: float = limited(FINITE, 1.0)
    offset: float = limited(FINITE, 0.0)
    noise: float | None = limited(NOT_NEGATIVE, None)
    quantum: float | None = limited(NOT_NEGATIVE, None)
    delay: int = 0
    minimum: float | None = limited(NOT_NAN, None)
    maximum: float | None = limited(NOT_NAN, None)


@dataclass(frozen=True)
class Signal:
    """Stimulus: `values[i]` from `times[i]` (s) on, `times[0]` is 0; or a column of a file over its time.

    Parameters
    ----------
    file
        CSV or Parquet file, relative to the scenario; its time is the column `time`, else the first.
    column
        Name of the column; may be left out where there is only one beside the time.
    interpolation
        What is between two values: the former (`hold`) or a straight line (`linear`).
    """

    to: str
    times: tuple[float, ...] = ()
    values: tuple[Any, ...] = ()
    file: str = ""
    column: str = ""
    interpolation: Literal["hold", "linear"] = "hold"


@dataclass(frozen=True)
class Metric:
    """A number taken from the trace by an expression; without a `unit` it has that of its columns."""

    name: str
    value: str
    unit: str = ""
    description: str = ""


@dataclass(frozen=True)
class Criterion:
    """A demand on a metric: at least `minimum`, at most `maximum` or exactly `equals`.

    Parameters
    ----------
    paper
        What the paper says of it.
    source
        Where the limit comes from: the `paper`, a `prediction` of the models, or a `choice`; empty leaves it
        to what `paper` says.
    columns
        Columns on which plots draw the limit; one on a single value of a column, such as its largest, needs
        none.
    """

    id: str
    claim: str
    metric: str
    paper: str = ""
    source: Literal["", "paper", "prediction", "choice"] = ""
    unit: str | None = None
    minimum: float | None = limited(NOT_NAN, None)
    maximum: float | None = limited(NOT_NAN, None)
    equals: float | bool | None = limited(NOT_NAN, None)
    columns: tuple[str, ...] = ()


@dataclass(frozen=True)
class Panel:
    """One set of axes: columns drawn as `scale * column`, in `unit`; with `log` only what is above 0."""

    columns: tuple[str, ...]
    unit: str = ""
    scale: float = limited(FINITE, 1.0)
    title: str = ""
    log: bool = False


@dataclass(frozen=True)
class Chart:
    """A drawing of a run that is not over the time, for the page of `cosim report`.

    Parameters
    ----------
    kind
        `path` draws each `y` over `x`, row by row; `polar` does with `y` as the distance from the middle and
        `x` as the angle in rad; `spectrum` the amplitudes of each `y` by the frequency or,
        with an angle in rad as `x`, by the waves per turn, of the longest stretch of rows without a gap;
        `peaks` the largest absolute `y` of each value of `split`; `share` the share of rows in which `y` is
        at most that; `roc` for each threshold the share of rows of the second part in which `y` is above it,
        over that of the first; `array` the last row of the columns `y[1]`, `y[2]`, ... over those of `x`;
        `map` the sum of `weight` in each cell of the plane of `x` and the one `y`, in parts of the largest;
        `bode` the open loop of a measured frequency response with crossover and margins: the last row of the
        columns `y[1]`, `y[2]`, ... of two `y`, gain and phase in rad, over those of `x`;
        `field` the maps that a function of one's own makes of all `y`, in parts of the largest value.
    x, y
        Expressions over the columns; for `array` and `bode` the names of the columns without their numbers.
    parts
        Conditions: the rows of each make a line of their own, a `map` and a `field` take those in which all
        hold; none takes all rows.
    names
        Names of the lines: of each `y` all parts.
    weight
        Expression that a `map` sums up.
    function
        Function of a `field` as `module:name`: it takes the values of each `y` as an array, and gives for the
        name of each map the edges of its cells along x and along y and their values, shape (y, x).
    closed
        Whether the response of a `bode` is that of the closed loop T, whose open loop is T / (1 - T).
    error
        Expression, how far a `path` is to the left of where it should be, in the unit of `x` and `y`: the way
        that it should be is drawn, and beside it the error as many times larger as is needed to see it.
    split
        Expression; its values in turn make the lines of a `path` or `polar`, and the points of `peaks`.
    split_name
        What these lines are called, before the value.
    label, x_label
        What the axes show, before the units.
    title
        What is above it.
    unit, x_unit
        Units that the axes show.
    scale, x_scale
        Factors from the values of `y` and `x` to these.
    equal
        Whether both axes have the same scale.
    log, x_log
        Logarithmic axes.
    """

    kind: Literal["path", "polar", "spectrum", "peaks", "share", "roc", "array", "map", "bode", "field"]
    y: tuple[str, ...]
    title: str = ""
    x: str = ""
    parts: tuple[str, ...] = ()
    names: tuple[str, ...] = ()
    weight: str = "1"
    function: str = ""
    closed: bool = False
    error: str = ""
    split: str = ""
    split_name: str = ""
    label: str = ""
    unit: str = ""
    scale: float = limited(FINITE, 1.0)
    x_label: str = ""
    x_unit: str = ""
    x_scale: float = limited(FINITE, 1.0)
    equal: bool = False
    log: bool = False
    x_log: bool = False


@dataclass(frozen=True)
class Plot:
    """The plot of a run, from top to bottom.

    Parameters
    ----------
    panels
        The panels; none draws all columns that move, by unit.
    charts
        Drawings that are not over the time.
    zoom
        Condition; a second column of axes shows the time around the first row where it holds.
    before, after
        How much of it, s.
    """

    panels: tuple[Panel, ...] = ()
    charts: tuple[Chart, ...] = ()
    zoom: str = ""
    before: float = limited(FINITE, 0.01)
    after: float = limited(FINITE, 0.01)


@dataclass(frozen=True)
class Scenario:
    """A closed loop and what is demanded of it; load it with `cosim.load`.

    Parameters
    ----------
    controller
        The FMU, where there is one.
    fmu
        The FMUs, in the order in which they step, where there are several.
    idle
        `controller.<input>` and `plant.<command>` that nothing drives on purpose; others are warned of.
    """

    title: str
    loop: Loop
    controller: Controller = Controller("")
    fmu: tuple[FmuChoice, ...] = ()
    plant: PlantChoice = PlantChoice("")
    description: str = ""
    idle: tuple[str, ...] = ()
    wire: tuple[Wire, ...] = ()
    signal: tuple[Signal, ...] = ()
    inject: tuple[Injection, ...] = ()
    metric: tuple[Metric, ...] = ()
    criterion: tuple[Criterion, ...] = ()
    plot: Plot = Plot()
    name: str = field(default="", metadata={"key": ""})
    file: Path = field(default=Path(), metadata={"key": ""})
    origins: dict[str, str] = field(default_factory=dict, metadata={"key": ""}, repr=False, compare=False)

    @property
    def fmus(self) -> tuple[FmuChoice, ...]:
        """FMUs in the order in which they step; `[controller]` is one of that name."""
        only = self.controller
        return self.fmu or (replace(ALONE, fmu=only.fmu, parameters=only.parameters),)

    @property
    def folder(self) -> Path:
        """Folder of the scenario file; FMU paths are relative to it."""
        return self.file.parent

    def origin(self, key: str) -> str:
        """File or override that a key comes from, for messages; `NAME.fmu` is that of an FMU of several."""
        if any(key.startswith(f"{choice.name}.") for choice in self.fmu):
            key = f"fmu.{key}"
        return overrides.find_origin(self.origins, key) or f"`{paths.shown(self.file)}`"


def scenario_schema() -> dict[str, Any]:
    """JSON schema of a scenario file; one that extends another gives only what differs."""
    layered = {
        "extends": {"type": "string", "description": "Scenario that this one changes: its name or file."},
        "drop": {
            "type": "array",
            "items": {"type": "string"},
            "description": "What is not inherited, such as `criterion` or `criterion.<id>`.",
        },
    }
    found = schema_of(Scenario, "Scenario of cosim", **layered)
    parts = found["properties"]
    parts["inject"]["items"]["allOf"] = [one_of("from_time", "when"), one_of(*INJECTED)]
    alone = {
        "required": found.pop("required"),
        **one_of("controller", "fmu"),
        "properties": {
            name: {"required": parts[name].pop("required")} for name in ("loop", "controller", "plant")
        },
    }
    return {**found, "if": {"not": {"required": ["extends"]}}, "then": alone}


def one_of(*keys: str) -> dict[str, Any]:
    """JSON schema of a table that holds exactly one of some keys."""
    return {"oneOf": [{"required": [key]} for key in keys]}
