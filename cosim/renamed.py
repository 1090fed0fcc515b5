"""Names that a newer version of an FMU has replaced, for hints.

An FMU lists them in `resources/renamed.toml`:

    [variables]
    "teach.place" = "calibration.position"
    "cusum.drift" = ""                          # removed

    [items.State]
    Teach = "Calibrate"
"""

from __future__ import annotations

import re
from pathlib import Path

FILE = "resources/renamed.toml"

REPLACEMENTS: dict[str, str] = {}
"""New names by old ones, of all FMUs that this process has opened; empty for a removed one."""


def learn(folder: Path) -> None:
    """Read the replaced names of an unpacked FMU; a file of another form gives no hints."""
    try:
        import tomllib

        content = tomllib.loads((folder / FILE).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return
    items = content.get("items")
    for table in [content.get("variables"), *(items.values() if isinstance(items, dict) else ())]:
        if isinstance(table, dict):
            REPLACEMENTS.update({old: new for old, new in table.items() if isinstance(new, str)})


def replacement(name: str) -> str:
    """Hint about a name that was replaced; empty for any other.

    Parameters
    ----------
    name
        Variable or item; a variable may have an owner (`controller.teach.place`) and an index.
    """
    found = re.fullmatch(r"(.*?)(\[\d+\])?", name, re.DOTALL)
    whole, index = found.groups("") if found else (name, "")
    owner, _, rest = whole.partition(".")
    for before, old in (("", whole), (f"{owner}.", rest)):
        # an array may be listed by its elements, or once
        for key, end in ((old + index, ""), (old, index)):
            new = REPLACEMENTS.get(key)
            if new == "":
                return f"Remove `{before}{old}{index}`: the FMU no longer has it."
            if new:
                return f"Use `{before}{new}{end}`, the new name of `{before}{old}{index}`."
    return ""
