"""JUnit XML, which CI systems show: a test suite for each scenario, a test case for each criterion."""

from __future__ import annotations

import re
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from cosim.acceptance.runner import Outcomes
from cosim.errors import readable
from cosim.formatting.verdicts import NOTHING_DEMANDED, limits, measured
from cosim.loop.result import Result
from cosim.metrics.criteria import Verdict
from cosim.pool.job import Outcome

BEGINNING = re.compile(rb"\s*(<\?xml[^>]*>\s*)?<testsuite")
"""Start of a JUnit XML file of any program."""
COUNTS = {"failures": "failure", "errors": "error", "skipped": "skipped"}
"""Counts of a test suite, by kind."""


def document(outcomes: Outcomes) -> str:
    """Text of the XML file."""
    root = Element("testsuites", name="cosim")
    for name, outcome in outcomes.items():
        root.append(suite(name, outcome))
    for element in root.iter():
        # XML has no control characters; those of terminals are frequent in messages of exceptions
        element.text = element.text and readable(element.text)
        element.attrib.update({name: readable(value) for name, value in element.items()})
    ElementTree.indent(root)
    return ElementTree.tostring(root, "unicode", xml_declaration=True) + "\n"


def suite(name: str, outcome: Outcome) -> Element:
    """Test suite of a scenario; a scenario without criteria has one test case."""
    found = Element("testsuite", name=name)

    def case(identifier: str, kind: str = "", message: str = "") -> Element:
        """Add a test case, with an element of a kind if it did not pass."""
        added = SubElement(found, "testcase", classname=name, name=identifier)
        return SubElement(added, kind, message=message) if kind else added

    if not isinstance(outcome, Result):
        case("run", "error", outcome.message).text = str(outcome)
    elif not outcome.criteria:
        case("run", "skipped", NOTHING_DEMANDED)
    else:
        found.set("time", f"{outcome.wall_s:.3f}")
        for verdict in outcome.criteria:
            case(verdict.criterion.id, "" if verdict.passed else "failure", problem(verdict))
    found.set("tests", str(len(found)))
    for count, kind in COUNTS.items():
        found.set(count, str(len(found.findall(f"testcase/{kind}"))))
    return found


def problem(verdict: Verdict) -> str:
    """Claim, measured value and limit of a failed criterion."""
    limit = f", limit {limits(verdict)}" if limits(verdict) else ""
    return f"{verdict.criterion.claim}: {measured(verdict)}{limit}"
