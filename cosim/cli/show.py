"""`cosim list`, `cosim show`, `cosim check`, `cosim schema` and `cosim cache`: nothing runs."""

from __future__ import annotations

import logging
from typing import Annotated, Literal

import typer
from typer import Argument, Option

from cosim import paths
from cosim.check.checked import Checked
from cosim.cli import complete, tasks
from cosim.cli.options import COULD_NOT_RUN, InProcess, Json, Loop, Set, Timeout, checked_limits, emit
from cosim.errors import CosimError
from cosim.formatting import strict
from cosim.show.console import output, report, stdout
from cosim.writing import write

PARTS = ("controller", "plant", "inputs", "outputs", "parameters", "wires")
"""Usual parts of `cosim show`."""

log = logging.getLogger("cosim")


def list_scenarios(
    studies: Annotated[
        bool, Option("--studies", help="List the studies of `cosim sweep` and `optimize` instead.")
    ] = False,
) -> None:
    """List the scenarios by name and title."""
    from cosim.scenario.overrides import title_of
    from cosim.show import listing

    entries = []
    for name, file in paths.list_studies().items() if studies else paths.list_scenarios():
        try:
            entries.append((name, title_of(file)))
        except CosimError as error:
            log.warning("%s", error.message)
    if not entries and not studies:
        raise CosimError(
            f"no scenario files in {paths.folders_text()}", f"Set {paths.SCENARIOS_ENV} to your folder."
        )
    output().print(listing.scenarios(entries))


def show(
    loop: Loop,
    parts: Annotated[
        list[str] | None,
        Argument(
            metavar="[PART]...",
            help="Only some parts, for example `plant`, `controller`, `parameters` or `wires`.",
            autocompletion=lambda incomplete: PARTS,
        ),
    ] = None,
    set_: Set = None,
    timeout: Timeout = None,
    in_process: InProcess = False,
) -> None:
    """Show variables, parameters and wires.

    Variables and parameters have units, defaults and ranges.

    \b
        cosim show dob plant
        cosim show dob inputs outputs
    """  # noqa: D301 - click keeps the lines of a paragraph that starts with a backspace
    limits = checked_limits(timeout, None, in_process)
    text = tasks.perform(limits, None, tasks.show, loop, tuple(set_ or ()), tuple(parts or ()), stdout())
    print(text, end="", flush=True)


def check(
    files: Annotated[
        list[str],
        Argument(
            metavar="SCENARIO|FILE.toml...",
            help="Scenarios, studies and optimizations.",
            autocompletion=complete.any_files,
        ),
    ],
    timeout: Timeout = None,
    in_process: InProcess = False,
    json: Json = None,
) -> None:
    """Check scenario, study and optimization files.

    Checks names, types, units, ranges, wires and metrics. Nothing runs.
    """
    found = []
    with tasks.executor(checked_limits(timeout, None, in_process)) as do:
        for file in files:
            outcome = do(tasks.TaskCall(tasks.check, (file,)))
            # an error here is that of a check that ended its process
            is_error = isinstance(outcome, CosimError)
            found.append(Checked(file, error=outcome, runs=0) if is_error else outcome)
    emit(json, strict.text([entry.to_dict() for entry in found]))
    for entry in found if json != "-" else ():
        print_checked(entry)
    raise typer.Exit(COULD_NOT_RUN if any(entry.error for entry in found) else 0)


def print_checked(entry: Checked) -> None:
    """Print one line for a valid file; print errors and warnings on stderr."""
    if entry.error is not None:
        names = f"`{entry.name}`", f"`{paths.shown(paths.expanded(entry.name))}`"
        message = entry.error.message
        report(message if message.startswith(names) else f"{names[0]}: {message}", entry.error.hint)
        return
    for warning in entry.warnings:
        log.warning("`%s`: %s", entry.name, warning)
    runs = f", {entry.runs} runs" if entry.kind != "scenario" else ""
    print(f"{entry.name}: {entry.kind}{runs}, valid")


def schema(
    file: Annotated[
        Literal["scenario", "study", "optimization"],
        Argument(metavar="[scenario|study|optimization]", help="Kind of the file."),
    ] = "scenario",
    for_: Annotated[
        str,
        Option(
            "--for",
            metavar="SCENARIO|FILE.toml",
            help="Add the FMU variables and plant parameters of this scenario.",
            autocompletion=complete.loops,
        ),
    ] = "",
) -> None:
    """Print the JSON schema of one kind of file.

    Editors with Taplo use it to complete and check files: VS Code with Even Better TOML,
    others with `taplo lsp`. `cosim new` writes it next to the scenario. For other files,
    store it and name it in the first line of the TOML, `#:schema ./my.schema.json`:

    \b
        cosim schema --for my.toml > my.schema.json
    """  # noqa: D301 - click keeps the lines of a paragraph that starts with a backspace
    if for_ and file != "scenario":
        raise CosimError("`--for` works only for the schema of scenarios", f"Omit `--for` or `{file}`.")
    if for_:
        # the plant may be foreign code
        limits = checked_limits(None, None, in_process=False)
        write(strict.text(tasks.perform(limits, None, tasks.schema, for_)), "-")
        return
    from cosim.schema.files import SCHEMAS

    write(strict.text(SCHEMAS[file]()), "-")


def cache(
    action: Annotated[
        Literal["dir", "clean"], Argument(metavar="dir|clean", help="Print the folder, or empty it.")
    ],
) -> None:
    """Show or clean the cache of extracted FMUs.

    The cache is in the user's cache folder, or in the folder that COSIM_CACHE names. FMUs that
    were not used for 7 days are removed in any case.
    """
    folder = paths.cache_folder()
    if action == "dir":
        print(folder)
        return
    from cosim.fmu.cache import remove_unused

    removed = remove_unused(folder, days=0.0) if folder.is_dir() else 0
    print(f"removed {removed} extracted FMUs from {folder}")
