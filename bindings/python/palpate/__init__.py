"""Palpate: haptic simulation of soft tissue for force-feedback devices.

All values are in SI units (m, N, s); arrays are NumPy arrays. Invalid input raises palpate.InputError, a ValueError, with the
message of the program. docs/python.md has examples.
"""
import sys

import numpy  # noqa: F401  before _palpate, whose error without NumPy is less clear

from . import _palpate
from ._palpate import *  # noqa: F401,F403
from .env import Env  # noqa: F401

__version__ = _palpate.__version__
__all__ = [name for name in dir(_palpate) if not name.startswith('_') and name != 'study']
study = _palpate.study
sys.modules[__name__ + '.study'] = study
