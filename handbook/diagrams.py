"""State diagrams of Mermaid as tables, because drawing them needs a library from the network."""

from __future__ import annotations

import re


def shown(fence: str) -> str:
    """Return a fenced block unchanged, or a state diagram as a table of its transitions and its notes."""
    if not fence.startswith("```mermaid\nstateDiagram"):
        return fence
    rows, notes = [], []
    for line in fence.splitlines():
        if arrow := re.match(r"\s*(\S+) --> ([^\s:]+)(?:: (.*))?$", line):
            rows.append([name(arrow[1]), name(arrow[2]), arrow[3] or ""])
        elif note := re.match(r"\s*note \w+ of (\w+): (.*)$", line):
            notes.append(f"{note[1]}: {note[2]}.")
    table = ["| From | To | When |", "|---|---|---|", *(f"| {' | '.join(row)} |" for row in rows)]
    return "\n".join([*table, "", *notes])


def name(state: str) -> str:
    """Return the name of a state, or a text for the start."""
    return "begin" if state == "[*]" else f"`{state}`"
