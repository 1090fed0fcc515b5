"""Evaluation of the metrics and criteria of a scenario on a stored trace, without a run."""

from __future__ import annotations

import logging
from dataclasses import replace

from cosim import paths
from cosim.errors import ExpressionError, concerning
from cosim.loop import fmus
from cosim.loop.result import Result
from cosim.loop.session import located
from cosim.metrics import criteria
from cosim.metrics.expression import Expression
from cosim.scenario.model import Scenario
from cosim.trace.columns import Held
from cosim.trace.measure import measured
from cosim.trace.stored import StoredTrace
from cosim.units import ONE

log = logging.getLogger("cosim")
ENGINE = "stored"
"""Name of the engine in the result of a stored trace."""


def evaluate(scenario: Scenario, found: StoredTrace) -> Result:
    """Compute the metrics of a scenario on a stored trace and check its criteria.

    The numbers are those of the run that wrote the trace; only metrics and criteria of the scenario are used.

    Parameters
    ----------
    scenario
        The scenario, see `cosim.load`.
    found
        The trace, see `cosim.read_trace`.

    Raises
    ------
    CosimError
        A metric needs a column that the trace does not have, or cannot be computed.
    """
    shown = paths.shown(found.file)
    ran = str(found.about.get("scenario", scenario.name))
    seed, simulated = found.about.get("seed"), found.about.get("simulated_s")
    if ran.partition("/")[0] != scenario.name.partition("/")[0]:
        log.warning("`%s` is a trace of `%s`; it is evaluated as a trace of `%s`", shown, ran, scenario.name)
    with located(scenario):
        found = labeled(found, scenario)
        compiled = compile_metrics(scenario, found, shown)
        check_units(scenario, compiled, found, shown)
        metrics = measured(scenario.metric, compiled, found.data)
        verdicts = criteria.evaluate(scenario.criterion, metrics)
    return Result(
        scenario=scenario.name,
        title=scenario.title,
        seed=seed if isinstance(seed, int) else scenario.loop.seed,
        engine=ENGINE,
        metrics=metrics,
        criteria=verdicts,
        simulated_s=simulated if isinstance(simulated, float) else found.times[-1] + scenario.loop.step,
        wall_s=0.0,
        trace=found.data.table if isinstance(found.data, Held) else None,
        file=None if isinstance(found.data, Held) else found.file,
        units=found.units,
        items=found.items,
    )


def compile_metrics(scenario: Scenario, found: StoredTrace, shown: str) -> list[Expression]:
    """Compile the metrics against the columns of the trace; an error names the file of the trace."""
    columns = {"time": None, **{name: found.items.get(name) for name in found.columns}}
    try:
        return criteria.compile_metrics(scenario.metric, columns, {"time": "s", **found.units})
    except ExpressionError as error:
        error.message += f" `{shown}`" if error.message.endswith("the trace") else f", in `{shown}`"
        raise


def check_units(scenario: Scenario, compiled: list[Expression], found: StoredTrace, shown: str) -> None:
    """Reject limits of metrics whose unit would come from a column without unit: it may be another one."""
    without_unit = [name for name in found.columns if name not in found.units]
    if not without_unit:
        return
    as_if = replace(found, units=found.units | dict.fromkeys(without_unit, ONE))
    assumed = compile_metrics(scenario, as_if, shown)
    columns = zip(scenario.metric, compiled, assumed, strict=True)
    doubtful = {metric.name for metric, now, then in columns if not metric.unit and now.unit != then.unit}
    for criterion in scenario.criterion:
        if criterion.unit and criterion.metric in doubtful:
            with concerning(f"criterion.{criterion.id}.unit"):
                problem = f"`criterion.{criterion.id}.unit` is `{criterion.unit}`, `{shown}` has no units"
                metric = f"`metric.{criterion.metric}`"
                hint = f"Give {metric} a `unit`, or use a trace in `.npz` or `.parquet`."
                raise ExpressionError(f"{problem}: the unit of {metric} is unknown", hint)


def labeled(found: StoredTrace, scenario: Scenario) -> StoredTrace:
    """Trace with units and items; those of the FMUs' variables for files without them, such as CSV."""
    if found.units:
        return found
    files = fmus.open_files(scenario)
    variables = {f"{owner}.{name}": v for owner, file in files.items() for name, v in file.variables.items()}
    known = {name: variables[name] for name in found.columns if name in variables}
    return replace(
        found,
        units={name: variable.unit for name, variable in known.items()},
        items={name: dict(variable.items) for name, variable in known.items() if variable.items},
    )
