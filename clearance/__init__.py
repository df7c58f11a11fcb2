"""How close a robot's path comes to anything, where, when, and how sure that is.

The public names are listed in `__init__.pyi`; each is imported from its room when it is first used.
"""

from importlib import import_module

import lazy_loader

from clearance.geometry.file_reader import attach_file_reader

__version__ = "0.2.0"

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
__all__ += ["__version__"]


def _read_mesh(path, scale):
    return import_module("clearance.load.mesh.mesh_file").read_mesh(path, scale)


attach_file_reader(_read_mesh)
