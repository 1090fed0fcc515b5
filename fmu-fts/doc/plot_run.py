"""Draw the picture of the quick start.

python plot_run.py [fmu-fts.fmu [run.svg]]
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from quick_start import run


def plot(found: dict[str, np.ndarray], file: str) -> None:
    """Draw the reference depth, the tracking error and the state."""
    plt.rcParams.update({"svg.hashsalt": "fmu-fts", "font.size": 9.0})
    figure, axes = plt.subplots(3, 1, figsize=(7.0, 4.8), sharex=True, layout="constrained")
    for panel, name, scale, label in (
        (axes[0], "reference", 1e3, "depth, mm"),
        (axes[1], "error", 1e6, "tracking error, um"),
        (axes[2], "state", 1.0, "state"),
    ):
        panel.plot(found["time"], scale * found[name], linewidth=0.8)
        panel.set_ylabel(label)
        panel.grid(alpha=0.3)
    axes[2].set_yticks([1, 3, 5, 9], ["Idle", "Approach", "Track", "Done"])
    axes[2].set_xlabel("time, s")
    figure.savefig(file, metadata={"Date": None})


if __name__ == "__main__":
    folder = Path(__file__).parent
    fmu = sys.argv[1] if len(sys.argv) > 1 else folder.parents[1] / "target/fmu/fmu-fts.fmu"
    plot(run(fmu), sys.argv[2] if len(sys.argv) > 2 else str(folder / "run.svg"))
