"""Palpate: how soft tissue feels through a force-feedback device.

Everything is SI inside (m, N, s); arrays are NumPy's. Bad input raises palpate.InputError, a ValueError, with the
message that the program prints. docs/python.md has examples.
"""
from . import _palpate
from ._palpate import *  # noqa: F401,F403

__version__ = _palpate.__version__
__all__ = [name for name in dir(_palpate) if not name.startswith('_')]
