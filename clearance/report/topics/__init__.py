"""All that is told of a run, a topic a file: keys in the summary, lines in a terminal, a section on the page.

A new topic is a file here, and its place in the two orders below.
"""

from __future__ import annotations

from clearance.report.topics import (
    body_gaps,
    cell,
    certainty,
    contact,
    events,
    findings,
    loaded,
    pairs,
    profiles,
    provenance,
    recordings,
    rules,
    tolerances,
    verdict,
    worst,
)

FIRST = ((worst.TOPIC,), (events.TOPIC, certainty.TOPIC))
"""What stands side by side below the replay, a column each."""

BELOW = (
    recordings.TOPIC,
    tolerances.TOPIC,
    body_gaps.TOPIC,
    findings.TOPIC,
    rules.TOPIC,
    cell.TOPIC,
    contact.TOPIC,
    profiles.TOPIC,
    pairs.TOPIC,
    loaded.TOPIC,
    provenance.TOPIC,
)
"""What stands below that, in this order."""

EVERY = (verdict.TOPIC, *(topic for column in FIRST for topic in column), *BELOW)
"""All topics, as the summary has them."""

IN_TERMINAL = (
    verdict.TOPIC,
    worst.TOPIC,
    rules.TOPIC,
    cell.TOPIC,
    recordings.TOPIC,
    tolerances.TOPIC,
    body_gaps.TOPIC,
    events.TOPIC,
    contact.TOPIC,
    pairs.TOPIC,
    profiles.TOPIC,
    certainty.TOPIC,
)
"""What a terminal shows below the headline, in this order."""
