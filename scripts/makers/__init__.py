"""What the scripts that make our robot and our scenes share.

Not part of the package: nothing imports it at run time.
"""
