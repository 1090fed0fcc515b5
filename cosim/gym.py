"""A scenario as an environment of Gymnasium: an agent sets inputs in place of wires and signals."""

from __future__ import annotations

import hashlib
from collections.abc import Generator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cosim.errors import CosimError, closest
from cosim.extras import hint
from cosim.loop import reference
from cosim.loop.repeats import NewProcessError
from cosim.loop.session import Session, located
from cosim.loop.wires.connect import PLANT, side_of
from cosim.loop.wires.connections import Connections
from cosim.metrics.expression import Expression
from cosim.pool.runs import loaded
from cosim.scenario.model import Scenario, Signal

try:
    import gymnasium
except ImportError:
    raise CosimError("`cosim.gym` needs the package `gymnasium`", hint("gym")) from None

Values = NDArray[np.float64]


class Environment(gymnasium.Env[Values, Values]):
    """A scenario as an environment; a step of the agent is a row of the trace.

    `reset` executes the first communication step, in which the actions are 0 or the bound next to it. `step`
    writes its action in the next `loop.record_every` communication steps and returns the row of the last one.
    An episode is terminated if `loop.stop_when` is true or an FMU ends the run, and truncated by the last row
    of `loop.duration`. All other wires, signals and injections act as in `cosim run`. FMUs and plant run in
    this process, in the reference engine. The second `reset` repeats the first episode, to check that FMUs
    and plant keep no state.

    Parameters
    ----------
    scenario
        The scenario, or its name or file as for `cosim.load`.
    actions
        Bounds of what the agent sets: Real inputs of FMUs (`controller.<input>`) and commands of the plant
        (`plant.<command>`), in their units. Wires and signals to them are removed from the scenario.
    observations
        Columns of the trace, in their units.
    reward
        Expression over the columns of the row.

    Raises
    ------
    CosimError
        An unknown name, bounds that are not finite and increasing, a wrong expression; or as for `Session`.
    """

    metadata = {"render_modes": []}  # noqa: RUF012 as in the base class

    def __init__(
        self,
        scenario: Scenario | str | Path,
        actions: Mapping[str, tuple[float, float]],
        observations: Sequence[str],
        reward: str,
    ) -> None:
        low, high = np.array([*actions.values()], np.float64).reshape(-1, 2).T
        for name, *bounds in zip(actions, low.tolist(), high.tolist(), strict=True):
            if not (np.isfinite(bounds).all() and bounds[0] < bounds[1]):
                raise CosimError(f"the bounds of `{name}` are `{bounds}`, they must be finite and increasing")
        self.actions = dict(zip(actions, np.clip(0.0, low, high).tolist(), strict=True))
        self.rows: Generator[tuple[int, Values | None]] | None = None
        self.first: list[int | Values] = []
        """Seed and actions of the first episode, until it is repeated."""
        self.repeated = False
        self.session = Session(driven(loaded(scenario), self.actions), engine="reference")
        columns = self.session.columns
        try:
            self._check(observations)
            self.reward = Expression(reward, columns, "`reward`", rowwise=True)
        except CosimError:
            self.session.close()
            raise
        self.observed = [[*columns].index(name) for name in observations]
        self.action_space = gymnasium.spaces.Box(low, high, dtype=np.float64)
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (len(observations),), np.float64)

    def _check(self, observations: Sequence[str]) -> None:
        """Check the names of actions and observations."""
        session = self.session
        inputs = [f"{fmu.name}.{v.name}" for fmu in session.fmus for v in fmu.driven if v.base == "Real"]
        inputs += [f"{PLANT}.{channel.name}" for channel in session.plant.commands]
        for name in (name for name in self.actions if name not in inputs):
            problem = f"`{name}` is not a Real input of an FMU or a command of the plant"
            raise CosimError(problem, closest(name, inputs))
        for name in (name for name in observations if name not in session.columns):
            raise CosimError(f"`{name}` is not a column of the trace", closest(name, session.columns))

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Values, dict[str, Any]]:
        """Begin an episode with the noise of `seed`, or of a new seed; `info["seed"]` is the one in use.

        Raises
        ------
        CosimError
            The run failed; or FMU or plant keep state, so that a repeated episode gives other rows.
        """
        super().reset(seed=seed, options=options)
        self._end()
        seed = int(self.np_random.integers(2**31)) if seed is None else seed
        if self.first and not self.repeated:
            self._repeat_first()
        row = self._begin(seed)
        if not self.repeated:
            self.first = [seed]
        return row[self.observed], {"time": float(row[0]), "seed": seed}

    def _repeat_first(self) -> None:
        """Repeat the first episode; reject other rows."""
        expected = self.checksum.digest()
        self._begin(self.first[0])
        for action in self.first[1:]:
            self._advance(action)
        self._end()
        if self.checksum.digest() != expected:
            problem = f"{self.session.position.ran()} keeps state: a repeated episode gives other rows"
            raise NewProcessError(problem, "Run each episode in a new process.")
        self.first, self.repeated = [], True

    def _begin(self, seed: Any) -> Values:
        """Begin an episode; return its first row."""
        self.checksum = hashlib.sha256()
        with located(self.session.scenario):
            # `step` checks the condition itself
            parts = replace(self.session.start(seed), stop_when=None)
        self.signals = signal_values(parts.scenario, parts.connections, [*self.actions])
        self.rows = reference.steps(parts, reference.recording(parts))
        return self._next_row()

    def step(self, action: Values) -> tuple[Values, float, bool, bool, dict[str, Any]]:
        """Apply an action until the next row; `info["time"]` is the time of the row, s.

        Raises
        ------
        CosimError
            The episode has ended or did not begin, or the run failed.
        """
        if self.rows is None:
            raise CosimError("the episode has ended or did not begin", "Call `reset`.")
        loop = self.session.scenario.loop
        row = self._advance(action)
        if not self.repeated:
            self.first.append(np.array(action, np.float64))
        stop, fmus = self.session.stop, self.session.fmus
        terminated = any(fmu.ended is not None for fmu in fmus) or (stop is not None and bool(stop(row)))
        truncated = self.k + loop.record_every >= loop.steps
        if terminated or truncated:
            self._end()
        return row[self.observed], float(self.reward(row)), terminated, truncated, {"time": float(row[0])}

    def _advance(self, action: Any) -> Values:
        """Write an action; return the next row."""
        length = self.session.scenario.loop.record_every
        for signal, value in zip(self.signals, np.asarray(action, np.float64), strict=True):
            signal[self.k + 1 : self.k + 1 + length] = value
        return self._next_row()

    def _next_row(self) -> Values:
        """Run to the next row; the last one again if an FMU ends the run before. A failed run has ended."""
        assert self.rows is not None
        try:
            with located(self.session.scenario):
                for k, row in self.rows:
                    self.k = k
                    if row is not None:
                        self.row = row
                        self.checksum.update(row.tobytes())
                        break
        except BaseException:
            self._end()
            raise
        return self.row

    def _end(self) -> None:
        """End the episode."""
        if self.rows is not None:
            self.rows.close()
        self.rows = None

    def close(self) -> None:
        """Free the FMUs and close the plant."""
        self._end()
        self.session.close()


def driven(scenario: Scenario, actions: Mapping[str, float]) -> Scenario:
    """Scenario with a signal in place of each wire and signal to an action."""
    signals = [signal for signal in scenario.signal if signal.to not in actions]
    added = [Signal(to=to, times=(0.0,), values=(value,)) for to, value in actions.items()]
    wires = [wire for wire in scenario.wire if wire.to not in actions]
    return replace(scenario, wire=tuple(wires), signal=(*signals, *added))


def signal_values(scenario: Scenario, connections: Connections, names: Sequence[str]) -> list[Values]:
    """Values of some signals in every step of a run, which may be changed before the step."""
    found: dict[str, Values] = {}
    sides = [*(choice.name for choice in scenario.fmus), PLANT]
    for side, inputs in zip(sides, [*connections.fmus, connections.plant], strict=True):
        targets = [signal.to for signal in scenario.signal if side_of(signal.to) == side]
        # the start values that injections hold follow the signals
        found |= {to: stimulus.samples for to, stimulus in zip(targets, inputs.stimuli, strict=False)}
    return [found[name] for name in names]
