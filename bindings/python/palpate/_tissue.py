"""Tissue.replace()."""
import copy

from . import _calls
from ._palpate import Tissue


def _numbers():
    """Names and types of what a Tissue has."""
    for name, found in vars(Tissue).items():
        if isinstance(found, property) and found.fset is not None:
            yield name, found.fget.__doc__.partition(' -> ')[2].partition('\n')[0]


_KNOWN = dict(_numbers())


def replace(self, **changes):
    changed = copy.copy(self)
    for name, value in changes.items():
        if name not in _KNOWN:
            raise _calls.unknown('replace', name, list(_KNOWN))
        setattr(changed, name, value)
    changed.validate()
    return changed


replace.__doc__ = f'''replace(self: Tissue, *, {", ".join(f"{name}: {kind} = ..." for name, kind in _KNOWN.items())}) -> Tissue

A copy with other numbers: `tissue_preset('liver').replace(k1=30)`. Raises TypeError for an unknown name, ParameterError for a value
out of its range.'''
Tissue.replace = replace
