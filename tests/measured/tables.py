"""The tables of the documents: the rows of what is kept, in words.

A table stands on a page between two marks, which name it.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from .store import ROOT, load

MARKED = re.compile(r"(<!-- measured: ([\w-]+) -->\n).*?(<!-- end -->\n)", re.DOTALL)
"""A table on a page, and its marks."""
PAGES = [ROOT / "docs/results.md", *sorted(ROOT.glob("fmu-*/README.md"))]


@dataclass(frozen=True)
class Table:
    """A table and what measures its numbers.

    Parameters
    ----------
    tests
        Arguments of pytest.
    head
        Names of the columns.
    rows
        Name of each row in the file of the table, and its cells, with names of its values in braces.
    """

    tests: str
    head: str
    rows: tuple[tuple[str, str], ...]


RINGS = (
    "{rings:.0f} | {centred:.0f} | {median:.1f} / {high:.1f} / {most:.1f} s | "
    "{pushes:.0f} / {pushes_high:.0f} | {eccentricity:.2f} um"
)
LAWS = (
    "{centred:.0f} of {rings:.0f} | {median:.1f} s | {pushes_high:.0f} | {left:.2g} / {left_high:.2g} um"
)
DEPTH = "{runs:.0f} | {missed:.0f} | {early:.0f} | {median:.3f} um | {high:.3f} um | {most:.3f} um"
BOTH = "{error_1:.3f} / {error_3:.3f} mm"
CUT = "{rms:.2g} | {tip:.2g}"
CUTS = "most of {cuts:.0f} seeds"
FORCE = "{force_mean:.2f} N, {force_deviation:.3f} N"

TABLES = {
    "centering": Table(
        "-m full tests/acceptance/test_centering.py -k many_rings",
        "law | rings | N | centred | median / 95 % / most | pushes, median / 95 % | true eccentricity, most",
        (
            (
                "paper's law, e0 0.1 to 0.6 mm",
                f"paper, 2.5 um | 20 rpm, 0.75 to 1.5 kg, 0.1 to 0.6 mm | {RINGS}",
            ),
            ("paper's law at 45 rpm, e0 0.1 to 0.6 mm", f"paper, 2.5 um | 45 rpm, else the same | {RINGS}"),
            ("default law, e0 0.1 to 0.6 mm", f"default, 2.5 um | the first line's | {RINGS}"),
            ("1 um, e0 0.1 to 0.6 mm", f"default, 1 um | the same | {RINGS}"),
            ("45 rpm and 0.5 um, e0 0.1 to 0.6 mm", f"default, 0.5 um | 45 rpm, else the same | {RINGS}"),
            ("0.7 to 20 kg, e0 0.1 to 3 mm", f"default, 2.5 um | 0.7 to 20 kg, 0.1 to 3 mm | {RINGS}"),
            ("badly known machines, e0 0.1 to 0.6 mm", f"default, 2.5 um | badly known machines | {RINGS}"),
            ("70 kg and 80 Hz, e0 1 mm", f"default, 2.5 um | 70 kg, servo of 80 Hz, 1 mm | {RINGS}"),
        ),
    ),
    "centering-baselines": Table(
        "-m full tests/acceptance/test_centering.py -k simplest",
        "law | centred | median | pushes, 95 % | left, median / 95 %",
        tuple(
            (name, f"{name} | {LAWS}")
            for name in (
                "one push by geometry",
                "pushes by geometry",
                "the paper's law",
                "one push of the default law",
                "the default law",
            )
        ),
    ),
    "deburr": Table(
        '-m "full or not full" tests/measured tests/acceptance/test_deburr.py '
        '-k "a_row_is or default_mode or ten_robots or adapts"',
        "mode | delay | paper | measured",
        (
            ("deburr/bare", f"bare servo with load control | 1 | 5.4 / 4.9 mm | {BOTH}"),
            ("deburr/paper", f'law = "Paper", 19 repetitions | 0 | less than 0.5 mm | {BOTH}'),
            (
                "robots",
                f"default, {{castings:.0f}} castings on {{robots:.0f}} robots, each with its own bank | 1 | | most {BOTH}",
            ),
            (
                "robots",
                "the same, burr that is left, or gouge | 1 | -0.5 to +1.0 mm | "
                "{finish_low:+.3f} to {finish_high:+.3f} mm",
            ),
            ("6:1 twice a second", "default, speed between 1/6 and 1, twice a second | 0 | | {error:.3f} mm"),
            ("deburr/six-axis", "six-axis path, at the tip | 1 | | {tip:.3f} mm"),
            (
                "deburr/round-trip",
                "Fig. 7, axis 3 at 500 mm/s, bare error over that of repetition 11 | 0 | 708, worse thereafter | "
                "{ratio_11:.0f}, best at {best:.0f}",
            ),
            (
                "adapted",
                "bank of another robot, {robots:.0f} robots, before and after three repetitions | 1 | | "
                "{before_least:.2f} to {before_most:.2f} mm, then {least:.3f} to {most:.3f} mm",
            ),
        ),
    ),
    "dob-depth": Table(
        '-m full tests/acceptance/test_dob.py -k "approaches or while_learning"',
        "mode | speed | N | missed | stopped early | depth: median | 99 % | most",
        (
            *((f"dob{name}", f"default | {speed} um/s | {DEPTH}") for name, speed in
              (("/10", 10), ("/30", 30), ("", 100), ("/300", 300))),
            *((f"dob/paper{name}", f"paper | {speed} um/s | {DEPTH}") for name, speed in
              (("-10", 10), ("-30", 30), ("", 100), ("-300", 300))),
            ("dob/contact-while-learning", f"contact while the noise is learned | 100 um/s | {DEPTH}"),
        ),
    ),
    "dob-false-alarms": Table(
        "-m full tests/acceptance/test_dob.py -k false_alarms",
        "false alarms in noise | paper says | measured",
        (
            (
                "law=Paper",
                'law = "Paper" (mu + 4 sigma, three in a row) | 3.19e-14 per sample, about 1e-6 per hour | '
                "{alarms:.0f} in {seconds:.0f} s",
            ),
            ("default", "default (four windows, automatic alpha) | | {alarms:.0f} in {seconds:.0f} s"),
        ),
    ),
    "fts": Table(
        '-m "full or not full" tests/measured tests/acceptance/test_fts.py '
        '-k "a_row_is or identified or 20_cuts or without_cutting"',
        "mode | speed | paper | by the encoder | tip of the tool",
        (
            ("fts/feedback", "feedback alone | 600 rpm | | {rms:.0f} | "),
            (
                "fts/feedforward",
                "+ feedforward, error at the second harmonic | 600 rpm | less than about 2 % | {twice:.2f} % | ",
            ),
            (
                "identified response",
                "the same with the response identified in place | 600 rpm | less than about 2 % | {twice:.2f} % | ",
            ),
            (
                "fts/paper",
                '+ cancellation of 2, 4, 6, 8, 10 as printed (law = "Paper") | 600 rpm | 1.2, at the 12th | '
                "{rms:.2f}; of it the 12th {twelfth:.2f} | ",
            ),
            ("fts", f"default, {CUTS} | 600 rpm | | {CUT}"),
            ("fts/1200", f"default, {CUTS} | 1200 rpm | | {CUT}"),
            ("fts/2400", f"default, {CUTS} | 2400 rpm | | {CUT}"),
            ("fts/wide", f"default with a loop of 320 Hz, {CUTS} | 600 rpm | | {CUT}"),
            ("no noise", f"default without the noise of the cut | 600 rpm | | {CUT}"),
            ("fts/3cm", f"3 cm of asymmetry at 500 m/s2, {CUTS} | 870 rpm | up to 3 cm | {CUT}"),
            ("fts/500hz", f"50.7 um at 500 Hz and 500 m/s2, in air | 600 rpm | tracks | {CUT}"),
        ),
    ),
    "fts-calibration": Table(
        "-m full tests/acceptance/test_fts_calibration.py -k 20_machines",
        "machines | what | paper | rms | most | told by the controller",
        tuple(
            (name, f"{{machines:.0f}} | {name} | {paper} | {{rms:.2g}} {unit} | {{most:.2g}} {unit} | {{told:.2g}} {unit}")
            for name, paper, unit in (
                ("arm length", "order of one micron", "um"),
                ("cross-slide offset", "order of one micron", "um"),
                ("arm zero", "0.01 mrad", "mrad"),
            )
        ),
    ),
    "polish": Table(
        '-m "full or not full" tests/measured tests/acceptance/test_polish.py '
        '-k "a_row_is or askew or whole_cavity"',
        "claim | paper | measured",
        (
            (
                "polish/no-stick-slip",
                f'force as printed, without stick-slip; its standard deviation | "stable polishing force" | {FORCE}',
            ),
            ("polish/impedance", f"force as printed, with stick-slip at 50 Hz | | {FORCE}"),
            ("polish", f"default (integral, adapted damping, ripple cancellation) | | {FORCE}"),
            (
                "askew",
                "default, whole cavity, mold (50, 50, 70) um and 2 degrees askew | | "
                f"{FORCE}; found as ({{x:.0f}}, {{y:.0f}}, {{z:.0f}}) um, {{turn:.2f}} degrees",
            ),
            ("polish", 'way that the ball slides over its path, with stick-slip | "another polishing energy" | {gain:.2f}'),
            ("polish/no-stick-slip", "the same without | | {gain:.2f}"),
            ("polish/500-hz", "the same with the sign changed in every sample (500 Hz), as printed | | {gain:.2f}: nothing"),
            (
                "cusps",
                'cusps left after one pass, of {before:.2f} um | "cusps can be removed uniformly" | '
                "{within:.2f} with, {without:.2f} without",
            ),
            ("cusps", "95 % of the cusps at equal removal | | {within_95:.2f} with, {repeated_95:.2f} without"),
        ),
    ),
    "polish-depth": Table(
        "-m full tests/acceptance/test_polish_depth.py",
        "evenness of the depth on a mold | standard deviation over mean | cusps that are left",
        tuple(
            (mold, f"{mold} | {{variation:.2f}} % | {{left:.2f}} um")
            for mold in ("led", "sphere", "saddle", "freeform", "steep")
        ),
    ),
}  # fmt: skip


def text(name: str) -> str:
    """Lines of a table, with what measured it."""
    table, kept = TABLES[name], load(name)
    lines = [f"| {table.head} |", "|---" * (table.head.count("|") + 1) + "|"]
    for row, cells in table.rows:
        values = {key: value for key, value in kept[row].items() if key != "code"}
        # what did not happen within any time
        lines.append(f"| {cells.format(**values).replace('inf s', 'never')} |")
    codes = sorted({str(kept[row]["code"]) for row, _ in table.rows})
    return "\n".join([*lines, "", f"`pytest {table.tests}` measures it, here the code of {', '.join(codes)}.", ""])


def renewed(page: str) -> str:
    """Page with the tables that its marks name."""
    return MARKED.sub(lambda found: f"{found[1]}\n{text(found[2])}\n{found[3]}", page)
