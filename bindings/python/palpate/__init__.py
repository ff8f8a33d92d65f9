"""Palpate: haptic simulation of soft tissue for force-feedback devices.

All values are in SI units (m, N, s); arrays are NumPy arrays. Invalid input raises palpate.InputError, a ValueError, with the
message of the program. docs/python.md has examples.
"""
import importlib

import numpy  # noqa: F401  before _palpate, whose error without NumPy is less clear

from . import _palpate
from ._palpate import *  # noqa: F401,F403

# Components: module, its names in this package (None: all), Debian package.
_COMPONENTS = (('_fit', None, 'palpate-fit'), ('study', ('study',), 'palpate-study'), ('env', ('Env', 'VectorEnv'), 'palpate-learning'))
_missing = []


def _public(module):
    return [name for name in dir(module) if not name.startswith('_')]


__version__ = _palpate.__version__
__all__ = _public(_palpate)
for _name, _names, _package in _COMPONENTS:
    try:
        _module = importlib.import_module('.' + _name, __name__)
    except ModuleNotFoundError as _error:
        if not str(_error.name).startswith(__name__ + '.'):
            raise
        _missing.append(_package)
        continue
    if _names is None:
        globals().update({name: getattr(_module, name) for name in _public(_module)})
        __all__ += _public(_module)
    elif _names != (_name,):
        globals().update({name: getattr(_module, name) for name in _names})
__all__.sort()
del _name, _names, _package


def __getattr__(name):
    missing = f' (not installed: {", ".join(_missing)})' if _missing else ''
    raise AttributeError(f'module {__name__!r} has no attribute {name!r}{missing}')
