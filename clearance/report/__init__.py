"""A record put into files that people and programs read. Not for: measuring or judging anything."""

from clearance.report.junit import write_junit
from clearance.report.output import json_text, write
from clearance.report.summary import summary_of

__all__ = ["json_text", "summary_of", "write", "write_junit"]
