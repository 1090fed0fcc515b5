"""Draft of a scenario: opens FMU and plant, matches ports by names and units, chooses the steps."""

from __future__ import annotations

import difflib
import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from cosim import paths
from cosim.errors import FmuError
from cosim.fmu.archive import open_fmu
from cosim.fmu.description import FmuFile, Variable
from cosim.loop import plant
from cosim.loop.plant import Channel
from cosim.loop.position import Position, Stage
from cosim.show.display import limits_text
from cosim.units import UNCHANGED, Conversion, conversion

DEFAULT_STEP, LONGEST = 0.01, 1.0
"""Default communication step, and duration of the first run, s."""
ENOUGH = 0.65
"""Similarity of two names above which they match."""
OTHER_THING = 0.3
"""Penalty for names with the same words about different parts."""
SAME_UNIT = 0.1
"""Bonus for equal units."""


@dataclass(frozen=True)
class End:
    """One end of a wire: an input, output, measurement or command.

    The unit is empty if unknown. `note` has type, unit, range and description for a comment. `start` is the
    start value as TOML.
    """

    name: str
    unit: str = ""
    note: str = ""
    start: str = "0.0"


@dataclass(frozen=True)
class Match:
    """Two matching ports; `conversion` is that of the unit, `sure` is true if the names match."""

    source: End
    target: End
    conversion: Conversion = UNCHANGED
    sure: bool = True


@dataclass(frozen=True)
class Side:
    """The FMU or the plant: its outputs or measurements, its inputs or commands, and the wires to these."""

    name: str
    sources: list[End]
    targets: list[End]
    wires: list[Match]

    @property
    def undriven(self) -> list[End]:
        """Inputs or commands without a wire."""
        driven = {match.target for match in self.wires}
        return [end for end in self.targets if end not in driven]


@dataclass(frozen=True)
class Draft:
    """Content of a new scenario.

    `fmu` and `plant` are names or paths for the file, empty without a plant. `parameters` has the plant's
    parameters that are not the defaults, with value and reason. `step` and `duration` are in s, `substeps`
    are the plant steps in a step. `sides` are the FMU and the plant, which has no ports without a plant.
    """

    title: str
    fmu: str
    plant: str
    parameters: dict[str, tuple[str, str]]
    step: float
    substeps: int
    duration: float
    sides: tuple[Side, Side]


def draft(fmu: str, plant_name: str, folder: Path, position: Position) -> Draft:
    """Draft of a scenario in a folder; `position` records whose code runs."""
    if fmu.endswith(plant.MJCF):
        hint = f"Give the FMU first: `cosim new {plant_name or 'FMU'} {fmu}`."
        raise FmuError(f"`{paths.brief(fmu)}` is not an FMU", hint)
    file = open_fmu(paths.find_fmu(fmu, Path.cwd()))
    inputs, outputs = variables(file, "input"), variables(file, "output")
    required: dict[str, tuple[str, str]] = {}
    timestep, sensed, commanded = 0.0, list[End](), list[End]()
    position.begin(file.name, plant_name, 0, 0.0)
    if plant_name:
        position.at(Stage.BUILD_PLANT)
        try:
            # the plants of MJCF files with RK4 have a value for `integrator`
            required = getattr(plant.plant_class(plant_name, Path.cwd()), "required", {})
            values = {name: value for name, (value, _) in required.items()}
            driven = plant.build(plant_name, values, Path.cwd())
        except SystemExit as error:
            raise plant.exited(plant_name, error) from error
        sensed, commanded = channels(driven.readings), channels(driven.commands)
        timestep = driven.timestep
        position.at(Stage.CLOSE_PLANT)
        plant.close(driven, plant_name)
        position.at(Stage.NONE)
    step, substeps = wanted_step(file), 1
    if timestep > 0.0:
        substeps = max(1, round(step / timestep))
        step = float(f"{substeps * timestep:.12g}")
    return Draft(
        f"{file.name} and {Path(plant_name).stem}" if plant_name else f"{file.name} alone",
        relative_name(fmu, file.path, folder),
        relative_name(plant_name, paths.expanded(plant_name), folder),
        required,
        step,
        substeps,
        duration=max(1, round(LONGEST / step)) * step,
        sides=(
            Side("controller", outputs, inputs, match(sensed, inputs)),
            Side("plant", sensed, commanded, match(outputs, commanded)),
        ),
    )


def variables(file: FmuFile, causality: str) -> list[End]:
    """List numeric inputs or outputs of an FMU."""
    return [
        end(one, one.kind, " | ".join(name for name, _ in one.items), start(one))
        for one in file.named(causality)
        if one.kind != "String"
    ]


def channels(found: tuple[Channel, ...]) -> list[End]:
    """List measurements or commands of a plant."""
    return [end(one, "", "", repr(plant.start(one))) for one in found]


def end(one: Variable | Channel, kind: str, items: str, start: str) -> End:
    """End of a wire with a note in one line; `items` are those of an enumeration."""
    limits = items or limits_text(one.minimum, one.maximum).strip()
    note = ", ".join(filter(None, (kind, one.unit, limits, one.description)))
    return End(one.name, one.unit, " ".join(note.split()), start)


def start(found: Variable) -> str:
    """Start value as TOML."""
    if found.kind == "Real":
        return repr(float(found.start or 0.0))
    if found.kind == "Boolean":
        return "true" if found.start in ("true", "1") else "false"
    return str(int(found.start or 0))


def wanted_step(file: FmuFile) -> float:
    """Step that the description of an FMU proposes."""
    return file.step_size if file.step_size > 0.0 else DEFAULT_STEP


def relative_name(name: str, file: Path, folder: Path) -> str:
    """Name in the scenario: a path is relative to its folder."""
    if name.endswith((".fmu", *plant.MJCF)) or os.sep in name:
        return Path(os.path.relpath(file.resolve(), folder.resolve())).as_posix()
    return name


def match(sources: Sequence[End], targets: Sequence[End]) -> list[Match]:
    """Pair sources with targets, the most similar first; each is used once.

    One remaining source and one remaining target with compatible units also are a pair.
    """
    found: dict[str, Match] = {}
    used: set[str] = set()
    pairs = [(likeness(source, target), source, target) for source in sources for target in targets]
    for value, source, target in sorted(pairs, key=lambda pair: -pair[0]):
        if value >= ENOUGH and source.name not in used and target.name not in found:
            found[target.name] = Match(source, target, converted(source.unit, target.unit) or UNCHANGED)
            used.add(source.name)
    left = [source for source in sources if source.name not in used]
    open_ = [target for target in targets if target.name not in found]
    if len(left) == len(open_) == 1 and (change := converted(left[0].unit, open_[0].unit)) is not None:
        found[open_[0].name] = Match(left[0], open_[0], change, sure=False)
    return [found[target.name] for target in targets if target.name in found]


def likeness(source: End, target: End) -> float:
    """From 0 to a little above 1; 0 for units that contradict each other."""
    if converted(source.unit, target.unit) is None:
        return 0.0
    known = source.unit == target.unit and source.unit not in ("", "1")
    return same_words(source.name, target.name) + (SAME_UNIT if known else 0.0)


def same_words(one: str, other: str) -> float:
    """Similarity of two names, 1 for the same words; slightly less if one contains the other."""
    mine, others = words(one), words(other)
    if not mine or not others:
        return float(one == other)
    fewer, more = sorted((set(mine), set(others)), key=len)
    # a letter or an index alone names a component: the output `y` is not `force.y`
    named = any(len(word) > 1 and not word.isdigit() for word in fewer)
    if fewer <= more and (named or fewer == more):
        return 1.0 - 0.02 * abs(len(mine) - len(others))
    whole = difflib.SequenceMatcher(None, "_".join(mine), "_".join(others)).ratio()
    # `x.position` and `y.position` differ in the significant word
    return whole - OTHER_THING if mine[-1] == others[-1] and len(mine) == len(others) else whole


def words(name: str) -> list[str]:
    """Words of a name in small letters: `Slide.posX[1]` is slide, pos, x, 1."""
    parts = re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+", name)
    return [part.lower() for part in parts]


def converted(before: str, after: str) -> Conversion | None:
    """Conversion from one unit to another; no change if one is unknown, None if they are incompatible."""
    return UNCHANGED if {before, after} & {"", "1"} else conversion(before, after)
