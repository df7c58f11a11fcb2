"""`python -m clearance` is the command `clearance`.

Python looks for modules in the current folder first where a module is run by name; a folder that was received, a
report say, may hold any. So that folder is left out before anything is imported from outside this package.
"""

import os
import sys
from contextlib import suppress

with suppress(OSError):  # of a folder that is gone
    if not sys.flags.safe_path and sys.path[:1] == [os.getcwd()]:
        del sys.path[0]

from clearance.cli import main

if __name__ == "__main__":
    main()
