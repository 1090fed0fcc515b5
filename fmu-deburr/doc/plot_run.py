"""Draw the picture of the quick start.

python plot_run.py [fmu-deburr.fmu [run.svg]]
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from quick_start import DRY_RUN, PLAYBACK, run


def plot(result: dict[str, np.ndarray], path: str) -> None:
    """Control error of axis 3, feed and state over time, as SVG."""
    plt.rcParams["svg.hashsalt"] = "fmu-deburr"
    thin = slice(None, None, max(1, len(result["time"]) // 600))
    time, active = result["time"][thin], np.isin(result["state"], (5,))[thin]
    figure, axes = plt.subplots(3, 1, figsize=(7, 5), sharex=True, layout="constrained")
    error = np.where(active, np.maximum(np.abs(result["error3"][thin]), 5e-6), np.nan)
    axes[0].semilogy(time, 1e3 * error)
    axes[0].set(ylabel="error of axis 3 in mm")
    for mode, label in ((DRY_RUN, "without patterns"), (PLAYBACK, "with patterns")):
        middle = time[active & (result["mode"][thin] == mode)].mean()
        axes[0].annotate(label, (middle, 0.03), ha="center")
    axes[1].plot(time, 1e3 * result["feed"][thin])
    axes[1].set(ylabel="feed in mm/s")
    names = ["Off", "Idle", "Approach", "Settle", "Run", "Stop", "Done"]
    axes[2].step(time, result["state"][thin], where="post")
    axes[2].set(ylabel="state", xlabel="time in s", yticks=range(1, 8), yticklabels=names)
    axes[2].tick_params(axis="y", labelsize=7)
    figure.savefig(path, metadata={"Date": None})


if __name__ == "__main__":
    folder = Path(__file__).parent
    fmu = sys.argv[1] if len(sys.argv) > 1 else folder.parents[1] / "target/fmu/fmu-deburr.fmu"
    plot(run(fmu), sys.argv[2] if len(sys.argv) > 2 else str(folder / "run.svg"))
