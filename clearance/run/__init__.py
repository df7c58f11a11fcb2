"""Answers a case: from options and question over all that is found to the record and what it comes to.

The names are listed in `__init__.pyi`; each is imported when it is first used, so that options are known at once.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
