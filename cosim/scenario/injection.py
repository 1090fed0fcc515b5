"""Injections of a scenario: faults on the way between FMUs and plant."""

from __future__ import annotations

from dataclasses import dataclass

from cosim.scenario.ranges import COUNT, FINITE, NOT_NAN, NOT_NEGATIVE, POSITIVE, limited

INJECTED = ("value", "frozen", "offset", "scale", "ramp", "noise", "drop", "late")
"""Kinds of injections."""


@dataclass(frozen=True)
class Injection:
    """Fault: from `from_time` or `when` on the value that arrives at `to` is changed, as its kind says.

    Exactly one kind is given. Several injections at one target act in their order.

    Parameters
    ----------
    to
        `controller.<input>` or `plant.<command>`.
    from_time
        Time of the first step (s); or `when`.
    to_time
        Time of the first step without it (s); left out it lasts to the end of the run.
    when
        Instead of `from_time`: condition over the current row of the trace, as `loop.stop_when`; the fault
        begins in the step after the first row that this holds for.
    after
        Time between that row and the first step, s.
    duration
        How long it lasts, s, instead of `to_time`; one step is `loop.step`.
    value
        Kind: the value is this number.
    frozen
        Kind: the value stays what arrives in the first step.
    offset
        Kind: this is added, in the unit of the target.
    scale
        Kind: the value is multiplied; -1 swaps a sign.
    ramp
        Kind: this is added for each second since the first step.
    noise
        Kind: white Gaussian noise of this standard deviation is added.
    drop
        Kind: share of the samples that are lost, 0 .. 1; a number then stays what it was, a truth value is
        false.
    late
        Kind: steps by which the value is late.
    """

    to: str
    from_time: float | None = limited(NOT_NAN, None)
    to_time: float | None = limited(NOT_NAN, None)
    value: float | None = None
    when: str = ""
    after: float = limited(NOT_NEGATIVE, 0.0)
    duration: float | None = limited(POSITIVE, None)
    frozen: bool = False
    offset: float | None = limited(FINITE, None)
    scale: float | None = limited(FINITE, None)
    ramp: float | None = limited(FINITE, None)
    noise: float | None = limited(NOT_NEGATIVE, None)
    drop: float | None = limited({"minimum": 0.0, "maximum": 1.0}, None)
    late: int | None = limited(COUNT, None)

    @property
    def kinds(self) -> list[str]:
        """Keys that say what happens to the value; a checked one has one."""
        given = ((kind, getattr(self, kind)) for kind in INJECTED)
        return [kind for kind, said in given if said is not None and said is not False]

    @property
    def kind(self) -> str:
        """Key that says what happens to the value."""
        return self.kinds[0]
