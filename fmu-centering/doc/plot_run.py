"""Draw the picture of the quick start.

python plot_run.py [fmu-centering.fmu [run.svg]]
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from quick_start import run


def plot(result: dict[str, np.ndarray], path: str) -> None:
    """Plot eccentricity, slide and state over time, as SVG."""
    plt.rcParams["svg.hashsalt"] = "fmu-centering"
    count = len(result["time"])
    thin = np.unique([*range(0, count, max(1, count // 600)), count - 1])
    time = result["time"][thin]
    figure, axes = plt.subplots(3, 1, figsize=(7, 5), sharex=True, layout="constrained")
    axes[0].semilogy(time, 1e6 * result["eccentricity"][thin], label="plant")
    axes[0].semilogy(
        time, np.where(result["estimate"][thin] > 0, 1e6 * result["estimate"][thin], np.nan), label="measured"
    )
    axes[0].axhline(2.5, color="gray", linestyle=":", label="tolerance")
    axes[0].set(ylabel="eccentricity in um", ylim=(0.1, 1e3))
    axes[0].legend(loc="lower left", ncols=3)
    axes[1].plot(time, 1e3 * result["slide"][thin])
    axes[1].set(ylabel="slide in mm")
    names = [
        "Idle",
        "Approach",
        "Follow",
        "Collect",
        "Model",
        "Wait",
        "Push",
        "Settle",
        "Confirm",
        "Centered",
    ]
    axes[2].step(time, result["state"][thin], where="post")
    axes[2].set(ylabel="state", xlabel="time in s", yticks=range(1, 11), yticklabels=names)
    axes[2].tick_params(axis="y", labelsize=7)
    figure.savefig(path, metadata={"Date": None})


if __name__ == "__main__":
    folder = Path(__file__).parent
    fmu = sys.argv[1] if len(sys.argv) > 1 else folder.parents[1] / "target/fmu/fmu-centering.fmu"
    plot(run(fmu), sys.argv[2] if len(sys.argv) > 2 else str(folder / "run.svg"))
