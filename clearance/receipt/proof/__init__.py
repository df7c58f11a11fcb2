"""Proves from plain numbers that bodies in motion keep their distance; knows numpy and nothing of the package.

Not for: finding evidence (`receipt.search`), reading files and cases (`receipt.case_data`).
"""
