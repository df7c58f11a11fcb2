"""A record put into files that people and programs read. Not for: measuring or judging anything."""

from clearance.report.contact import contact_of
from clearance.report.junit import write_junit
from clearance.report.output import json_text, write
from clearance.report.summary import certified_of, notes_of, summary_of, tessellation_bound
from clearance.report.verdict import Verdict, verdict_of

__all__ = [
    "Verdict",
    "certified_of",
    "contact_of",
    "json_text",
    "notes_of",
    "summary_of",
    "tessellation_bound",
    "verdict_of",
    "write",
    "write_junit",
]
