"""Experiments with people: QUEST+, staircases, signal detection theory, simulated observers, and the trials of a study's folder."""
from ._study import *  # type: ignore[import]  # noqa: F401,F403  has no stub
