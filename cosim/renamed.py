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
from collections.abc import Collection
from pathlib import Path

FILE = "resources/renamed.toml"

REPLACEMENTS: dict[str, list[str]] = {}
"""New names by old ones, of all FMUs that this process has opened; empty for a removed one.

FMUs may replace one old name by different new names."""


def learn(folder: Path) -> None:
    """Read the replaced names of an unpacked FMU; a file of another form gives no hints."""
    try:
        import tomllib

        content = tomllib.loads((folder / FILE).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return
    items = content.get("items")
    for table in [content.get("variables"), *(items.values() if isinstance(items, dict) else ())]:
        for old, new in table.items() if isinstance(table, dict) else ():
            known = REPLACEMENTS.setdefault(old, [])
            if isinstance(new, str) and new not in known:
                known.append(new)


def replacement(name: str, choices: Collection[str] = ()) -> str:
    """Hint about a name of a variable or item that was replaced; empty for any other.

    A variable may have an owner (`controller.teach.place`) and an index. Known names in `choices` select
    among the replacements of several FMUs.
    """
    parts = re.fullmatch(r"(.*?)(\[\d+\])?", name, re.DOTALL)
    whole, index = parts.groups("") if parts else (name, "")
    owner, _, rest = whole.partition(".")
    for before, old in (("", whole), (f"{owner}.", rest)):
        # an array may be listed by its elements, or once
        for key, end in ((old + index, ""), (old, index)):
            if found := REPLACEMENTS.get(key):
                # without a known one: removed, if one of the FMUs has no replacement
                new = next((new for new in found if f"{before}{new}{end}" in choices), min(found))
                if new:
                    return f"Use `{before}{new}{end}`, the new name of `{before}{old}{index}`."
                return f"Remove `{before}{old}{index}`: the FMU no longer has it."
    return ""
