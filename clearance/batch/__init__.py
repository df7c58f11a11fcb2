"""Many cases: found in manifests, measured once each, kept in a store, answered together.

What one case comes to is found by `run` as for `clearance check`; here are the list of cases, the store of their
rows, the engines that spread them over processes, and the page for all. Not for: the command line (`cli.batch`).
"""
