"""One run of a study: its key data, the check of its scenario, and everything that affects its results."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import Any

from cosim.errors import concerning
from cosim.fmu import stale
from cosim.fmu.archive import FmuFile
from cosim.fmu.values import expand
from cosim.loop import fmus, plant, time_series
from cosim.loop.session import located
from cosim.scenario.model import Scenario
from cosim.scenario.toml import toml_value
from cosim.study.run_hash import digest, plant_of, project


@dataclass(frozen=True, slots=True)
class Run:
    """One run of a study.

    Parameters
    ----------
    number, case
        Number of the run, and of its case in the design; both start at 0.
    changes
        Keys that the design varies, with their values.
    hash
        SHA-256, in hexadecimal, of everything that affects its results.
    """

    number: int
    case: int
    seed: int
    changes: dict[str, Any] = field(compare=False)
    hash: str


def things(scenario: Scenario, files: dict[str, FmuFile], plant_hash: str) -> dict[str, str]:
    """Hashes of everything that affects the results of a run, except the values of its scenario."""
    signals = {f"signal.{to}": digest(path) for to, path in time_series.files(scenario).items()}
    digests = {f"fmu.{name}": digest(file.path) for name, file in files.items()}
    return {**project(), **signals, **digests, "plant": plant_hash}


def text(value: Any) -> str:
    """Value as `--set` reads it."""
    if isinstance(value, str):
        return value if toml_value(value, "") == value else json.dumps(value)
    if isinstance(value, list | tuple):
        return f"[{', '.join(json.dumps(item) if isinstance(item, str) else text(item) for item in value)}]"
    return str(value) if isinstance(value, float) else json.dumps(value)


def check(scenario: Scenario) -> tuple[dict[str, FmuFile], Any, str]:
    """Check names, types and ranges of all parameters without running.

    Returns
    -------
    (dict of str to FmuFile, type, str)
        The FMUs by their names, the plant's class and its hash.

    Raises
    ------
    CosimError
        An error of the run.
    """
    with located(scenario):
        files = fmus.open_files(scenario)
        stale.warn_of(scenario.fmus, scenario.folder)
        for choice in scenario.fmus:
            with concerning(f"{choice.name}.parameters"):
                expand(files[choice.name].variables, choice.parameters, choice)
        with concerning("plant.name"):
            kind, found = plant_of(scenario.plant.name, scenario.folder)
        plant.check_parameters(kind, scenario.plant.parameters)
    return files, kind, found
