"""Draw the picture of the quick start.

python plot_run.py [fmu-dob.fmu [run.svg]]
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from quick_start import SURFACE, run


def plot(found: dict[str, np.ndarray], file: str) -> None:
    """Draw position, contact force and state over time."""
    plt.rcParams.update({"svg.hashsalt": "fmu-dob", "font.size": 9.0})
    touched, entered = np.flatnonzero(found["force"] > 0.0), 1 + np.flatnonzero(np.diff(found["state"]))
    keep = np.unique(np.r_[0 : len(found["time"]) : 25, touched, entered, len(found["time"]) - 1])
    figure, axes = plt.subplots(3, 1, figsize=(7.0, 4.8), sharex=True, layout="constrained")
    for panel, name, scale, label in (
        (axes[0], "position", 1e6, "position in um"),
        (axes[1], "force", 1e3, "contact force in mN"),
        (axes[2], "state", 1.0, "state"),
    ):
        style = "steps-post" if name == "state" else "default"
        panel.plot(found["time"][keep], scale * found[name][keep], linewidth=0.9, drawstyle=style)
        panel.set_ylabel(label)
        panel.grid(alpha=0.3)
    axes[0].axhline(1e6 * SURFACE, color="gray", linestyle=":", label="surface")
    axes[0].legend(loc="center left")
    axes[2].set_yticks(range(1, 8), ["Idle", "Approach", "Learn", "Detect", "Contact", "Retract", "Done"])
    axes[2].set_xlabel("time in s")
    figure.savefig(file, metadata={"Date": None})


if __name__ == "__main__":
    folder = Path(__file__).parent
    fmu = sys.argv[1] if len(sys.argv) > 1 else folder.parents[1] / "target/fmu/fmu-dob.fmu"
    plot(run(fmu), sys.argv[2] if len(sys.argv) > 2 else str(folder / "run.svg"))
