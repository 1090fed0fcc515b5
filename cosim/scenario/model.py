"""A closed loop as data: FMU, plant, wires, metrics and criteria."""

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
    """Settings of the simulation.

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
        Order within a step: the controller samples and computes, and its command acts in the same step.
    compute_delay
        Delay of commands in steps; 1 as in standard FMI masters.
    record_every
        Steps between two rows of the trace; metrics and `stop_when` use these rows.
    record_qpos
        Whether the trace also holds MuJoCo's `qpos`, `plant.qpos.<joint>`, for a replay of the run.
    record_locals
        Whether the trace holds the local variables of the FMUs; default: those of an FMU with at most 256.
    stop_when
        Condition over the current row of the trace that ends the run early; empty for none.
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
        """Rows of the trace of a complete run."""
        return -(-self.steps // self.record_every)

    def every(self, step: float | None) -> int:
        """Return the number of communication steps in one `step` (s) of an FMU; 1 for None."""
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
        Its communication step in s, an integer multiple of `loop.step`; default: `loop.step`.
    """

    name: str
    fmu: str
    parameters: dict[str, Any] = field(default_factory=dict)
    step: float | None = limited(POSITIVE, None, unit="s")
    alone: bool = field(default=False, metadata={"key": ""})

    @property
    def who(self) -> str:
        """Name of the FMU in messages."""
        return "the FMU" if self.alone else f"the FMU `{self.name}`"

    @property
    def label(self) -> str:
        """Name that distinguishes it from the other FMUs of the run."""
        return self.fmu if self.alone else self.name


ALONE = FmuChoice("controller", "", alone=True)
"""Name of the FMU of a table `[controller]`."""


@dataclass(frozen=True)
class PlantChoice:
    """Plant by name or as `module:Class`, and its parameters; no plant without a name."""

    name: str
    parameters: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Wire:
    """Connection of one value from the plant to an FMU or back, or between FMUs.

    `noise`, `quantum`, `minimum` and `maximum` are in the unit of the plant's channel and default to the
    channel's own; `scale` and `offset` convert between the two: `to = scale * from + offset`. Between FMUs
    they are in the unit of the input and default to none.

    Parameters
    ----------
    source
        `plant.<measurement>` or `controller.<output>`; with several FMUs their name in place of `controller`.
    to
        `controller.<input>` or `plant.<command>`.
    noise
        Standard deviation of white Gaussian noise, sampled in every step.
    quantum
        Resolution; 0 is continuous.
    delay
        Transport delay in steps, in addition to `loop.compute_delay`. A wire to an FMU that does not step
        after its source needs at least 1.
    minimum, maximum
        Limits.
    stream
        Name of the random stream of `noise`; default: `to`. A renamed target can keep its noise with it.
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
    stream: str = ""


@dataclass(frozen=True)
class Signal:
    """Stimulus: `values[i]` from `times[i]` (s) on, with `times[0]` = 0; or a column of a file over its time.

    Parameters
    ----------
    file
        CSV or Parquet file, relative to the scenario; its time is the column `time`, otherwise the first.
    column
        Name of the column; optional if there is only one in addition to the time.
    interpolation
        Value between two times: the last value (`hold`) or a straight line (`linear`).
    """

    to: str
    times: tuple[float, ...] = ()
    values: tuple[Any, ...] = ()
    file: str = ""
    column: str = ""
    interpolation: Literal["hold", "linear"] = "hold"


@dataclass(frozen=True)
class Metric:
    """A number computed from the trace by an expression; without a `unit` it has that of its columns."""

    name: str
    value: str
    unit: str = ""
    description: str = ""


@dataclass(frozen=True)
class Criterion:
    """A limit of a metric: at least `minimum`, at most `maximum` or exactly `equals`.

    Parameters
    ----------
    paper
        Statement of the paper about it.
    source
        Source of the limit: the `paper`, a `prediction` of the models, or a `choice`; by default derived
        from `paper`.
    columns
        Columns in whose plots the limit is shown; not needed for a limit on a single value of a column, such
        as its maximum.
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
    """One set of axes: columns plotted as `scale * column`, in `unit`; with `log` only positive values."""

    columns: tuple[str, ...]
    unit: str = ""
    scale: float = limited(FINITE, 1.0)
    title: str = ""
    log: bool = False


@dataclass(frozen=True)
class Chart:
    """A chart of a run that is not a time series, for `cosim report`.

    Parameters
    ----------
    kind
        `path`: each `y` over `x`, row by row. `polar`: `y` as the radius over the angle `x` in rad.
        `spectrum`: amplitudes of each `y` over the frequency or, with an angle in rad as `x`, over the waves
        per revolution, of the longest interval without a gap. `peaks`: largest absolute `y` for each value of
        `split`. `share`: cumulative fraction of the rows over `y`. `roc`: for each threshold the fraction of
        rows of the second part above it, over that of the first part. `array`: last row of the columns
        `y[1]`, `y[2]`, ... over those of `x`. `map`: sum of `weight` in each cell of the plane of `x` and
        one `y`, relative to the largest sum. `bode`: open loop of a measured frequency response with
        crossover and margins, from the last row of the columns `y[1]`, `y[2]`, ... of two `y` (gain, and
        phase in rad) over those of `x`. `field`: maps of a user function of all `y`, relative
        to the largest value.
    x, y
        Expressions over the columns; for `array` and `bode` the names of the columns without their numbers.
    parts
        Conditions: the rows of each make a separate line; a `map` and a `field` use the rows that meet all
        conditions. Default: all rows.
    names
        Names of the lines: for each `y` all parts.
    weight
        Expression summed by a `map`.
    function
        Function of a `field` as `module:name`. Its arguments are the values of each `y` as an array. It
        returns for each map, by name, the edges of its cells along x and y and their values, shape (y, x).
    closed
        Whether the response of a `bode` is that of the closed loop T, whose open loop is T / (1 - T).
    error
        Expression of the distance of a `path` to the left of its nominal path, in the unit of `x` and `y`.
        The chart shows the nominal path and the enlarged error.
    split
        Expression; each of its values makes a line of a `path` or `polar`, and a point of `peaks`.
    split_name
        Name of these lines, before the value.
    label, x_label
        Labels of the axes, before the units.
    title
        Title of the chart.
    unit, x_unit
        Units of the axes.
    scale, x_scale
        Factors from the values of `y` and `x` to these units.
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
        The panels; default: all changing columns, by unit.
    charts
        Charts that are not time series.
    zoom
        Condition; a second column of axes shows the time around the first row that meets it.
    before, after
        Shown time before and after that row, s.
    """

    panels: tuple[Panel, ...] = ()
    charts: tuple[Chart, ...] = ()
    zoom: str = ""
    before: float = limited(FINITE, 0.01)
    after: float = limited(FINITE, 0.01)


@dataclass(frozen=True)
class Scenario:
    """A closed loop with metrics and criteria; load it with `cosim.load`.

    Parameters
    ----------
    controller
        The only FMU.
    fmu
        Several FMUs, in the order of their steps.
    undriven
        Intentionally undriven `controller.<input>` and `plant.<command>`; others cause a warning.
    """

    title: str
    loop: Loop
    controller: Controller = Controller("")
    fmu: tuple[FmuChoice, ...] = ()
    plant: PlantChoice = PlantChoice("")
    description: str = ""
    undriven: tuple[str, ...] = ()
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
        """FMUs in the order of their steps; `[controller]` is one of that name."""
        only = self.controller
        return self.fmu or (replace(ALONE, fmu=only.fmu, parameters=only.parameters),)

    @property
    def folder(self) -> Path:
        """Folder of the scenario file; FMU paths are relative to it."""
        return self.file.parent

    def origin(self, key: str) -> str:
        """File or override that set a key, for messages; `NAME.fmu` is that of one of several FMUs."""
        if any(key.startswith(f"{choice.name}.") for choice in self.fmu):
            key = f"fmu.{key}"
        return overrides.find_origin(self.origins, key) or f"`{paths.shown(self.file)}`"


def scenario_schema() -> dict[str, Any]:
    """JSON schema of a scenario file; a file that extends another gives only the differences."""
    layered = {
        "extends": {"type": "string", "description": "Name or file of the scenario that this one extends."},
        "drop": {
            "type": "array",
            "items": {"type": "string"},
            "description": "Items that are not inherited, such as `criterion` or `criterion.<id>`.",
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
