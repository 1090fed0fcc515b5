"""Draw the picture of the quick start.

python plot_run.py [fmu-polish.fmu [run.svg]]
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from quick_start import FOLLOW, run


def plot(found: dict[str, np.ndarray], file: str) -> None:
    """Draw force, stick-slip motion and state over time, with 0.1 s of the motion."""
    plt.rcParams.update({"svg.hashsalt": "fmu-polish", "font.size": 9.0})
    start = int(np.argmax(found["state"] == FOLLOW)) + 1000
    samples = len(found["time"])
    zoom, all_times = slice(start, start + 100), np.r_[0:samples:20, samples - 1]
    figure, axes = plt.subplots(3, 1, figsize=(7.0, 5.2), layout="constrained")
    for panel, name, scale, label, keep in (
        (axes[0], "force", 1.0, "normal force in N", all_times),
        (axes[1], "state", 1.0, "state", all_times),
        (axes[2], "across", 1e6, "across the path in um", zoom),
    ):
        panel.plot(found["time"][keep], scale * found[name][keep], linewidth=0.9)
        panel.set_ylabel(label)
        panel.grid(alpha=0.3)
    axes[1].set_yticks(range(1, 8), ["Idle", "Approach", "Settle", "Follow", "Unload", "Retract", "Done"])
    axes[2].set_title("Stick-slip motion, 0.1 s of the path", fontsize=9.0)
    axes[2].set_xlabel("time in s")
    figure.savefig(file, metadata={"Date": None})


if __name__ == "__main__":
    folder = Path(__file__).parent
    fmu = sys.argv[1] if len(sys.argv) > 1 else folder.parents[1] / "target/fmu/fmu-polish.fmu"
    plot(run(fmu), sys.argv[2] if len(sys.argv) > 2 else str(folder / "run.svg"))
