"""Injections of a scenario: faults on the connections between FMUs and plant."""

from __future__ import annotations

from dataclasses import dataclass

from cosim.scenario.ranges import COUNT, FINITE, NOT_NAN, NOT_NEGATIVE, POSITIVE, limited

INJECTED = ("value", "frozen", "offset", "scale", "ramp", "noise", "drop", "late")
"""Kinds of injections."""


@dataclass(frozen=True)
class Injection:
    """Fault: from `from_time` or `when`, the value that arrives at `to` is changed according to its kind.

    Give exactly one kind. Several injections at one target act in their order.

    Parameters
    ----------
    to
        `controller.<input>` or `plant.<command>`.
    from_time
        Time of the first step (s); or `when`.
    to_time
        Time of the first step without the fault (s); default: the end of the run.
    when
        Condition over the current row of the trace, in place of `from_time`; see `loop.stop_when`. The fault
        starts in the step after the first row that meets it.
    after
        Time between that row and the first step, s.
    duration
        Duration of the fault, s, in place of `to_time`; one step is `loop.step`.
    value
        Kind: the value is this number.
    frozen
        Kind: the value of the first step is held.
    offset
        Kind: this is added, in the unit of the target.
    scale
        Kind: the value is multiplied; -1 swaps a sign.
    ramp
        Kind: this is added for each second since the first step.
    noise
        Kind: white Gaussian noise of this standard deviation is added.
    drop
        Kind: fraction of lost samples, 0 .. 1. A lost number keeps its last value, a lost Boolean is
        false.
    late
        Kind: delay of the value in steps.
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
        """Given kinds; a checked injection has one."""
        given = ((kind, getattr(self, kind)) for kind in INJECTED)
        return [kind for kind, said in given if said is not None and said is not False]

    @property
    def kind(self) -> str:
        """Kind of the injection."""
        return self.kinds[0]
