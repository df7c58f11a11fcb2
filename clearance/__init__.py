"""How close a robot's path comes to anything, where, when, and how sure that is.

The public names are listed in `__init__.pyi`; each is imported from its room when it is first used.
"""

import lazy_loader

__version__ = "0.2.0"

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
__all__ += ["__version__"]
