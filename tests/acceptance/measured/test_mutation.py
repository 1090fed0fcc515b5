"""Counts of the outcomes of `cargo mutants`."""

import json
from pathlib import Path

from .mutation import EQUIVALENT, counted, outcomes
from .store import ROOT

NAME = "fmu-dob/src/law.rs:{}:5: replace + with - in law"


def test_mutants_that_compile_are_counted(tmp_path: Path) -> None:
    def entry(line: int, summary: str) -> dict[str, object]:
        return {"scenario": {"Mutant": {"name": NAME.format(line)}}, "summary": summary}

    found = ["CaughtMutant", "CaughtMutant", "Timeout", "MissedMutant", "Unviable"]
    every = [
        {"scenario": "Baseline", "summary": "Success"},
        *(entry(line, summary) for line, summary in enumerate(found)),
    ]
    (tmp_path / "mutants.out").mkdir()
    (tmp_path / "mutants.out/outcomes.json").write_text(json.dumps({"outcomes": every}), "utf-8")
    read = outcomes(tmp_path)
    assert counted(read, ()) == {"tried": 4, "caught": 3, "endless": 1, "equivalent": 0, "score": 75.0}
    same = counted(read, (NAME.format(3),))
    assert (same["equivalent"], same["score"]) == (1, 100.0)


def test_a_mutant_listed_as_equivalent_is_in_an_existing_file() -> None:
    assert all((ROOT / name.split(":")[0]).is_file() for name in EQUIVALENT)
