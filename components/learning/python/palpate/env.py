"""Reinforcement learning: one hand presses an organ, in Gymnasium's form, without Gymnasium.

    env = palpate.Env('press')
    observation, info = env.reset(seed=1)
    observation, reward, terminated, truncated, info = env.step([0.0, 0.0, -1e-3])

The same seed and actions give the same observations bit for bit. For libraries that need Gymnasium's own classes:

    class GymEnv(gymnasium.Env):
        def __init__(self, *arguments, **named):
            self.env = palpate.Env(*arguments, **named)
            self.action_space, self.observation_space = (
                gymnasium.spaces.Box(space['low'], space['high'], space['shape'], np.float64)
                for space in (self.env.action_space, self.env.observation_space))

        def reset(self, *, seed=None, options=None):
            super().reset(seed=seed)
            return self.env.reset(seed=seed)

        def step(self, action):
            return self.env.step(action)
"""
from __future__ import annotations

import secrets
from typing import TYPE_CHECKING, Any, Dict, Optional, Sequence, Tuple

import numpy as np

import palpate._learning as _learning  # type: ignore[import]  # has no stub

from . import _calls

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray  # NumPy 1.21

_calls.answer_class(_learning._Environment, 'Env')
_calls.answer_class(_learning._VectorEnvironment, 'VectorEnv')
TASKS = ('press', 'hold', 'search', 'insert')


class Env:
    """Tasks: 'press' reaches a force, 'hold' keeps it while the organ breathes, 'search' finds a hidden lump,
    'insert' brings a needle's tip into the scene's target layer ([target]) and keeps it there.

    Action: change of the tool's position [m] in the world frame (at most 0.1 m/s), in 'search' then `mark`: above 0.5 it
    marks the place under the tool. Observation: position from the start [m], depth and distance [m], force of the tissue on the
    tool [N], target [N] (0 in 'search' and 'insert'), in 'insert' the length of the needle inside [m], then the displacement [m] of `surface_points` points of the surface. Reward for each step: -|F -
    target|/target, in 'search' 1 for a mark that finds the lump and -0.1 for another, in 'insert' 1 while the tip is in the target and -1 when it
    enters a forbidden layer. A found lump or a forbidden layer ends the episode;
    `seconds` of simulated time truncate it.

    Each episode draws from the ranges `stiffness_factor` (of the tissue's k1) and `noise_gain` [N m] (None: as the scene), and
    moves the start by at most `start_offset` [m] along x and y. Other arguments are those of TickedSimulation; without a scene,
    a ball of 5 mm presses the liver, and 'insert' brings a needle into a vein ('lumen'; 'far wall' is forbidden). Raises InputError, ParameterError.
    """

    def __init__(self, task: str = 'press', *, seconds: float = 5.0, ticks: int = 10, tolerance: float = 10e-3,
                 surface_points: int = 0, noise: bool = False, stiffness_factor: Sequence[float] = (1.0, 1.0),
                 noise_gain: Optional[Sequence[float]] = None, start_offset: float = 0.0, **scene: Any) -> None:
        self.task, self.ticks, self.tolerance = task, ticks, tolerance
        self._environment = _learning._Environment(
            learning_task=task, seconds=seconds, ticks=ticks, tolerance=tolerance, surface_points=surface_points, noise=noise,
            stiffness_factor=stiffness_factor, noise_gain=noise_gain, start_offset=start_offset, **scene)
        self.action_space: Dict[str, Any] = self._environment.action_space
        self.observation_space: Dict[str, Any] = self._environment.observation_space
        self._seeded = False

    def __repr__(self) -> str:
        actions, observations = self.action_space['shape'][0], self.observation_space['shape'][0]
        return f"<palpate.Env '{self.task}': {self.ticks} ticks a step, {actions} actions, {observations} observations>"

    @property
    def parameters(self) -> Dict[str, float]:
        """What the episode drew, with the target or the centre of the hidden lump from the start [m]. Empty before reset()."""
        return dict(self._environment.parameters)

    def reset(self, *, seed: Optional[int] = None,
              options: Optional[Dict[str, Any]] = None) -> Tuple[NDArray[np.float64], Dict[str, Any]]:
        """Starts an episode. Without a seed the random numbers go on. `options` has no effect."""
        if seed is None and not self._seeded:
            seed = secrets.randbits(63)
        self._seeded = True
        return self._environment.reset(seed)

    def step(self, action: ArrayLike) -> Tuple[NDArray[np.float64], float, bool, bool, Dict[str, Any]]:
        """One step of `ticks` ticks. Returns observation, reward, terminated, truncated, info."""
        return self._environment.step(action)


class VectorEnv:
    """`num_envs` environments of one task that step at once, on `jobs` threads (None: all cores), and share the prepared organ.

    Environment i has the same bits as Env with the same arguments, reset(seed=seed + i) and its actions. Observations have the
    shape (num_envs, channels), rewards, terminated, truncated and the entries of info (num_envs,). After the end of an episode the
    environment starts the next one at once: observation is its first, info['final_observation'] has the ended one's last. Spaces
    are those of one environment. Other arguments are those of Env.
    """

    def __init__(self, task: str = 'press', num_envs: int = 1, *, jobs: Optional[int] = None, seconds: float = 5.0,
                 ticks: int = 10, tolerance: float = 10e-3, surface_points: int = 0, noise: bool = False,
                 stiffness_factor: Sequence[float] = (1.0, 1.0), noise_gain: Optional[Sequence[float]] = None,
                 start_offset: float = 0.0, **scene: Any) -> None:
        self.task, self.num_envs, self.ticks, self.tolerance = task, num_envs, ticks, tolerance
        self._environments = _learning._VectorEnvironment(
            learning_task=task, seconds=seconds, ticks=ticks, tolerance=tolerance, surface_points=surface_points, noise=noise,
            stiffness_factor=stiffness_factor, noise_gain=noise_gain, start_offset=start_offset, num_envs=num_envs, jobs=jobs,
            **scene)
        self.single_action_space: Dict[str, Any] = self._environments.action_space
        self.single_observation_space: Dict[str, Any] = self._environments.observation_space
        self._seeded = False

    def __repr__(self) -> str:
        return f"<palpate.VectorEnv '{self.task}': {self.num_envs} environments, {self.ticks} ticks a step>"

    @property
    def parameters(self) -> Dict[str, NDArray[np.float64]]:
        """What each episode drew, as Env.parameters: arrays (num_envs,). NaN before reset()."""
        return dict(self._environments.parameters)

    def reset(self, *, seed: Optional[int] = None,
              options: Optional[Dict[str, Any]] = None) -> Tuple[NDArray[np.float64], Dict[str, Any]]:
        """Starts an episode in every environment. Without a seed the random numbers go on. `options` has no effect."""
        if seed is None and not self._seeded:
            seed = secrets.randbits(62)
        self._seeded = True
        return self._environments.reset(seed)

    def step(self, actions: ArrayLike) -> Tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_],
                                                NDArray[np.bool_], Dict[str, Any]]:
        """One step of `ticks` ticks of every environment. Returns observations, rewards, terminated, truncated, info."""
        return self._environments.step(actions)
