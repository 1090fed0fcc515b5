"""Warnings about a scenario: undriven inputs, different units and ineffective settings."""

from __future__ import annotations

from cosim.loop import reference, undriven
from cosim.loop.session import Session, located
from cosim.scenario.model import Wire
from cosim.units import conversion


def check(session: Session) -> list[str]:
    """Connect everything as in a run, without a step; return the warnings."""
    scenario = session.scenario
    with located(scenario):
        reference.initialise(scenario, session.fmus, session.plant, scenario.loop.seed, session.position)
    session.check_drawn()
    return warnings(session)


def warnings(session: Session) -> list[str]:
    """Sentences about undriven inputs, different units, ineffective settings and missing criteria."""
    found = []
    known = undriven.ends(session.fmus, session.plant)
    if unknown := undriven.unknown(session.scenario, known):
        found.append(unknown)
    if forgotten := undriven.undriven(session.scenario, known):
        found.append(undriven.sentence(forgotten, session.plant))
    found += [sentence for wire in session.scenario.wire if (sentence := unlike(wire, session))]
    found += [sentence for _, sentence in undriven.ineffective_settings(session.scenario)]
    if not session.scenario.criterion:
        found.append("the scenario has no criteria")
    return found


def unlike(wire: Wire, session: Session) -> str:
    """Warning of a wire between different units without conversion; empty if there is none."""
    before, after = (unit_of(end, session) for end in (wire.source, wire.to))
    if {"", "1"} & {before, after} or (wire.scale, wire.offset) != (1.0, 0.0):
        return ""
    found = conversion(before, after)
    if found is not None and not found.changes:
        return ""
    sentence = f"`wire.{wire.to}` connects {before} of `{wire.source}` to {after} without conversion"
    if found is None:
        return sentence
    offset = f" and `offset = {found.offset:.12g}`" if found.offset else ""
    return f"{sentence}; set `scale = {found.factor:.12g}`{offset}"


def unit_of(end: str, session: Session) -> str:
    """Return the unit at one end of a wire; empty if unknown."""
    side, _, name = end.partition(".")
    if fmu := next((fmu for fmu in session.fmus if fmu.name == side), None):
        return fmu.file.variables[name].unit
    channels = (*session.plant.readings, *session.plant.commands)
    return next((channel.unit for channel in channels if channel.name == name), "")
