"""Experiments with people: QUEST+, staircases, signal detection theory, simulated observers, and the trials of a study's folder."""
from . import _calls, _study  # type: ignore[attr-defined]  # _study has no stub

_calls.answer_all(_study, {})
from ._study import *  # type: ignore[import]  # noqa: E402,F401,F403  after its functions have their errors
