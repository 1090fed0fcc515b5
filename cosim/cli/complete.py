"""Shell completion: scenarios, studies, files and keys for `--set`; never raises errors.

The functions may return more than fits: typer drops names without the incomplete text as prefix.
"""

from __future__ import annotations

import contextlib
import dataclasses
import glob
import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import typer

from cosim import paths

ITEM_KEYS = {
    "wire": ("scale", "offset", "noise", "quantum", "delay", "minimum", "maximum"),
    "criterion": ("minimum", "maximum", "equals"),
}
"""Useful override keys of items, also if the file does not contain them."""


def loops(incomplete: str) -> list[str]:
    """Names of scenarios, and scenario files of the working directory."""
    return [*dict(paths.list_scenarios()), *files(incomplete)]


def studies(incomplete: str) -> list[str]:
    """Names of the project's own studies, and files of the working directory."""
    return list(dict.fromkeys([*paths.list_studies(), *files(incomplete)]))


def any_files(incomplete: str) -> list[str]:
    """Names and files of scenarios and studies."""
    return list(dict.fromkeys([*loops(incomplete), *studies(incomplete)]))


def files(incomplete: str) -> list[str]:
    """TOML files and folders with a given prefix."""
    folder, _, start = incomplete.rpartition("/")
    inside = paths.expanded(folder or ("/" if incomplete.startswith("/") else "."))
    found = sorted(inside.glob(f"{glob.escape(start)}*")) if inside.is_dir() else []
    prefix = incomplete[: len(incomplete) - len(start)]
    wanted = [file for file in found if start.startswith(".") or not file.name.startswith(".")]
    shown = [prefix + file.name + ("/" if file.is_dir() else "") for file in wanted]
    return [name for name in shown if name.endswith((".toml", "/"))]


def keys(ctx: typer.Context, incomplete: str) -> list[str]:
    """Keys of the scenario named earlier on the command line, each with its `=`."""
    from cosim.scenario import overrides

    # an option that still lacks its value leaves the arguments unparsed
    loop = next((word for word in (ctx.params.get("loop"), *ctx.args) if word), "")
    found: set[str] = set()
    # `cosim check` reports errors in the files, and the code of a plant may print
    with contextlib.suppress(Exception), contextlib.redirect_stdout(io.StringIO()):
        file = paths.find_scenario(str(loop))
        table = overrides.read(file).table
        found.update(scenario_keys(table))
        found.update(fmu_keys(table, file.parent))
        # the class is imported only for its own keys
        if incomplete.startswith("plant.") and "plant" in table:
            found.update(plant_keys(table["plant"]["name"], file.parent))
    return [f"{key}=" for key in sorted(found)]


def scenario_keys(table: dict[str, Any]) -> Iterator[str]:
    """Existing and possible keys of a scenario."""
    from cosim.scenario.model import Loop
    from cosim.scenario.tables import IDENTITY

    yield from ("plant.name", *(f"loop.{field.name}" for field in dataclasses.fields(Loop)))
    for name, entry in [*fmus(table), ("plant", table.get("plant", {}))]:
        yield from (f"{name}.{parameter}" for parameter in entry.get("parameters", {}))
    for section, identity in IDENTITY.items():
        for item in () if section == "fmu" else table.get(section, ()):
            own = {key for key in item if key != identity} | set(ITEM_KEYS.get(section, ()))
            yield from (f"{section}.{item[identity]}.{key}" for key in own)


def plant_keys(name: str, folder: Path) -> Iterator[str]:
    """All parameters of a plant."""
    from cosim.loop.plant import plant_class
    from cosim.scenario.tables import toml_key

    yield from (
        f"plant.{toml_key(field)}" for field in dataclasses.fields(plant_class(name, folder).Parameters)
    )


def fmu_keys(table: dict[str, Any], folder: Path) -> Iterator[str]:
    """Files and parameters of the FMUs, read from their model descriptions."""
    import zipfile
    from xml.etree import ElementTree

    for name, entry in fmus(table):
        yield f"{name}.fmu"
        path = paths.find_fmu(entry["fmu"], folder)
        with zipfile.ZipFile(path) as archive, archive.open("modelDescription.xml") as file:
            for _, element in ElementTree.iterparse(file):
                # a `ScalarVariable` in FMI 2.0, an element named by its type in FMI 3.0
                if element.get("causality") == "parameter":
                    yield f"{name}.{element.get('name')}"


def fmus(table: dict[str, Any]) -> list[tuple[str, dict[str, Any]]]:
    """Tables of the FMUs of a scenario, by their names."""
    several = [(entry["name"], entry) for entry in table.get("fmu", ())]
    return several or [("controller", table["controller"])]
