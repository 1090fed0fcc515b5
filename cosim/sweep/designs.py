"""Designs of experiments: the cases of a study, as pure functions of its tables and its seed."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cosim import extras
from cosim.errors import CosimError
from cosim.loop.wires.transform import child
from cosim.study.parameters import Vary, value_at

Case = dict[str, Any]
"""One point of a design: keys and values."""


def grid(varied: Sequence[Vary], samples: int, seed: int) -> list[Case]:
    """Every combination of the values, the last key fastest."""
    return [combined(varied, values) for values in itertools.product(*map(levels, varied))]


def latin_hypercube(varied: Sequence[Vary], samples: int, seed: int) -> list[Case]:
    """Latin hypercube: `samples` intervals of equal probability for each key, each sampled once."""
    sampler = quasi_monte_carlo().LatinHypercube(len(varied), rng=generator(seed))
    return points(varied, sampler.random(samples))


def sobol(varied: Sequence[Vary], samples: int, seed: int) -> list[Case]:
    """Scrambled Sobol sequence; more samples extend it, powers of two are balanced."""
    return points(varied, sobol_sequence(len(varied), samples, seed))


def monte_carlo(varied: Sequence[Vary], samples: int, seed: int) -> list[Case]:
    """Independent samples; more samples extend the list."""
    return points(varied, generator(seed).random((samples, len(varied))))


def saltelli(varied: Sequence[Vary], samples: int, seed: int) -> list[Case]:
    """Points that give Sobol indices: A, B, and for each key A with the value of that key from B.

    More samples only add to them; powers of two are balanced.
    """
    count = len(varied)
    a, b = np.hsplit(sobol_sequence(2 * count, samples, seed), 2)
    mixed = [np.where(np.arange(count) == index, b, a) for index in range(count)]
    return points(varied, np.stack([a, b, *mixed], axis=1).reshape(-1, count))


DESIGNS: dict[str, Callable[[Sequence[Vary], int, int], list[Case]]] = {
    "grid": grid,
    "latin-hypercube": latin_hypercube,
    "sobol": sobol,
    "monte-carlo": monte_carlo,
    "saltelli": saltelli,
}


def values_by_key(cases: Iterable[Case]) -> dict[str, list[Any]]:
    """Values of each key in the cases that set it."""
    found: dict[str, list[Any]] = {}
    for key, value in itertools.chain.from_iterable(case.items() for case in cases):
        found.setdefault(key, []).append(value)
    return found


def generator(seed: int) -> np.random.Generator:
    """Random numbers of the design, apart from those of the runs."""
    return np.random.default_rng(child(seed, "design"))


def sobol_sequence(dimensions: int, samples: int, seed: int) -> NDArray[np.float64]:
    """Points of a scrambled Sobol sequence, shape (samples, dimensions); scipy limits its dimensions."""
    try:
        sampler = quasi_monte_carlo().Sobol(dimensions, scramble=True, rng=generator(seed))
    except ValueError as error:
        problem = f"a Sobol sequence of {dimensions} dimensions cannot be made: {error}"
        raise CosimError(problem, "Use fewer keys in `vary`, or `latin-hypercube`.") from None
    # scipy warns of other numbers than powers of two, the balance is the user's choice
    sequence: NDArray[np.float64] = sampler.random_base2((samples - 1).bit_length())
    return sequence[:samples]


def quasi_monte_carlo() -> Any:
    """Return scipy's module of quasi-Monte-Carlo sequences."""
    problem = "scipy is not installed; it makes `latin-hypercube`, `sobol` and `saltelli`"
    hint = f"{extras.hint('sweep')} Or use `grid` or `monte-carlo`."
    return extras.needed("scipy.stats.qmc", problem, hint)


def levels(vary: Vary) -> list[Any]:
    """Values of a key in a grid."""
    if vary.values:
        return list(vary.values)
    count = vary.points or 0
    return [value_at(vary, index / max(1, count - 1)) for index in range(count)]


def points(varied: Sequence[Vary], unit: NDArray[np.float64]) -> list[Case]:
    """Points of the unit cube as values of the keys."""
    return [combined(varied, map(value_at, varied, row)) for row in unit.tolist()]


def combined(varied: Sequence[Vary], values: Any) -> Case:
    """Keys with their values."""
    return {vary.key: value for vary, value in zip(varied, values, strict=True)}
