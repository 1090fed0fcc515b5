"""Runs an FMU for one second in libcosim and prints what it saw as JSON: `cosim_execution.py FMU`."""

from __future__ import annotations

import json
import sys

from libcosimpy.CosimEnums import CosimVariableType
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave

STEP = 1_000_000  # ns
STEPS = 1000


def main(fmu: str) -> None:
    """Run and print."""
    log_output_level(CosimLogLevel.ERROR)
    execution = CosimExecution.from_step_size(step_size=STEP)
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer=observer)
    index = execution.add_local_slave(local_slave=CosimLocalSlave(fmu_path=fmu, instance_name="slave"))
    stepped = execution.step(step_count=STEPS)
    variables = execution.slave_variables(slave_index=index)
    reals = [v for v in variables if v.type == CosimVariableType.REAL.value]
    values = observer.last_real_values(slave_index=index, variable_references=[v.reference for v in reals])
    seen = {
        "stepped": stepped,
        "time": execution.status().current_time,
        "variables": [v.name.decode() for v in variables],
        "reals": {v.name.decode(): value for v, value in zip(reals, values, strict=True)},
    }
    print(json.dumps(seen))


if __name__ == "__main__":
    main(*sys.argv[1:])
