"""State diagrams of Mermaid as tables: drawing them takes a library from a network."""

from __future__ import annotations

import re


def shown(fence: str) -> str:
    """Return a fenced block as it is, and a state diagram as the table of its transitions, then its notes."""
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
    """Return the name of a state, which is text where it is the beginning."""
    return "begin" if state == "[*]" else f"`{state}`"
