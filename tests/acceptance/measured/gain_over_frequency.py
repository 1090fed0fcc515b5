"""Plot for the page: sliding distance of the ball over the frequency of the stick-slip motion.

python -m tests.acceptance.measured.gain_over_frequency fmu-polish/doc/gain.svg
"""

import sys

import cosim

from ..samples.polishing import Run

HALF_PERIODS = (1, 2, 3, 4, 5, 7, 10, 14, 20)
"""Samples of 1 ms of one sign."""
VELOCITIES = (5e-3, 10e-3, 20e-3)
"""m/s"""


def gains(velocity: float, half_periods: tuple[int, ...] = HALF_PERIODS) -> list[float]:
    """Sliding distance over path length for each half period, at one velocity of the stick-slip motion."""
    scenarios = [
        cosim.load(
            "polish/500-hz",
            set=[
                f"controller.stick_slip.velocity={velocity}",
                f"controller.stick_slip.half_period={half_period}",
                "loop.duration=3.0",
            ],
        )
        for half_period in half_periods
    ]
    outcomes = cosim.run_each(scenarios, keep_trace=True)
    return [Run(outcome).gain for outcome in outcomes if isinstance(outcome, cosim.Result)]


def main(file: str) -> None:
    """Measure and draw."""
    from matplotlib import pyplot
    from matplotlib.ticker import ScalarFormatter

    pyplot.rcParams["svg.fonttype"] = "none"
    pyplot.rcParams["svg.hashsalt"] = "gain"
    figure, axes = pyplot.subplots(figsize=(7.0, 3.6), layout="constrained")
    frequencies = [500.0 / half_period for half_period in HALF_PERIODS]
    for velocity in VELOCITIES:
        found = gains(velocity)
        print(f"{1e3 * velocity:g} mm/s:", ", ".join(f"{gain:.2f}" for gain in found))
        axes.plot(frequencies, found, "o-", markersize=3.5, label=f"{1e3 * velocity:g} mm/s")
    axes.axhline(1.0, color="grey", linewidth=0.8)
    axes.annotate(
        "the paper: 500 Hz", (500.0, 1.0), (300.0, 2.6), arrowprops={"arrowstyle": "->"}, ha="center"
    )
    axes.set(xscale="log", xlabel="frequency of the stick-slip motion, Hz", ylabel="sliding distance / path")
    axes.set_xticks([25, 50, 100, 200, 500])
    axes.xaxis.set_major_formatter(ScalarFormatter())
    axes.minorticks_off()
    axes.set_ylim(0.0, None)
    axes.grid(alpha=0.3)
    axes.legend(title="square wave of", frameon=False)
    figure.savefig(file, metadata={"Date": None})


if __name__ == "__main__":
    main(sys.argv[1])
