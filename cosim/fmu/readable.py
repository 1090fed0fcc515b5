"""Variables in a model description that the FMU itself does not know."""

from __future__ import annotations

import logging

from cosim.errors import FmuError
from cosim.fmu.instance import Instance

log = logging.getLogger("cosim")
_read: set[tuple[str, str]] = set()
"""GUID and folder of the FMUs that were read in this process."""


def report(fmu: Instance) -> None:
    """Read every number of an FMU after its run, once in a process; log the first rejected variable.

    A rejected call ends an instance, so the variables after the first are not read.
    """
    known = (fmu.file.guid, str(fmu.file.folder))
    if known in _read:
        return
    _read.add(known)
    for variable in fmu.file.variables.values():
        if not variable.base or variable.element:
            continue
        try:
            fmu.read(variable)
        except FmuError as error:
            reference = f"value reference {variable.reference}"
            log.warning(
                "%s does not know its variable `%s` (%s): %s",
                fmu.owner.who,
                variable.name,
                reference,
                error.message,
            )
            return
