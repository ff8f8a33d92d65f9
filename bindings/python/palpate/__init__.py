"""Palpate: haptic simulation of soft tissue for force-feedback devices.

All values are in SI units (m, N, s); arrays are NumPy arrays. Invalid input raises palpate.InputError, a ValueError, with the
message of the program. docs/python.md has examples.
"""
import importlib as _importlib

import numpy as _numpy  # noqa: F401  before _palpate, whose error without NumPy is less clear

from . import _calls, _palpate, _shown, _tissue  # noqa: F401  _tissue adds Tissue.replace()

_RESULTS = {'fit': _shown.FitResult, 'validate': _shown.ValidationResult}
# Components: module, its names in this package (None: all), Debian package.
_COMPONENTS = (('_fit', None, 'palpate-fit'), ('study', ('study',), 'palpate-study'), ('env', ('Env', 'VectorEnv'), 'palpate-learning'))
_missing = []


def _public(module):
    return [name for name in vars(module) if not name.startswith('_')]


def _take(module):
    """Takes all that is public in a compiled module."""
    _shown.show_all(module)
    _calls.answer_all(module, _RESULTS)
    globals().update({name: getattr(module, name) for name in _public(module)})
    __all__.extend(_public(module))


__version__ = _palpate.__version__
__all__ = ['to_pandas']
_take(_palpate)
from ._tables import to_pandas  # noqa: E402  after _palpate's functions have their errors
for _name, _names, _package in _COMPONENTS:
    try:
        _module = _importlib.import_module('.' + _name, __name__)
    except ModuleNotFoundError as _error:
        if not str(_error.name).startswith(__name__ + '.'):
            raise
        _missing.append(_package)
        continue
    if _names is None:
        _take(_module)
        __all__ += [_result.__name__ for _result in _RESULTS.values()]
        FitResult, ValidationResult = _RESULTS.values()
    elif _names != (_name,):
        globals().update({name: getattr(_module, name) for name in _names})
__all__.sort()


def __getattr__(name):
    missing = f' (not installed: {", ".join(_missing)})' if _missing else ''
    raise AttributeError(f'module {__name__!r} has no attribute {name!r}{missing}')
