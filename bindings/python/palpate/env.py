"""Reinforcement learning: one hand presses an organ, in Gymnasium's form, without Gymnasium.

    env = palpate.Env('press')
    observation, info = env.reset(seed=1)
    observation, reward, terminated, truncated, info = env.step([0.0, 0.0, -1e-3])

The same seed and actions give the same observations bit for bit.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Dict, List, Optional, Tuple

import numpy as np

from . import InputError, TickedSimulation

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray  # NumPy 1.21

TASKS = ('press', 'hold', 'search')
FASTEST = 0.1  # m/s, of the hand
OUTWARD = 0.5  # least cosine between up and the normal above a hidden lump


def _space(names: List[str], low: ArrayLike, high: ArrayLike) -> Dict[str, Any]:
    low, high = np.asarray(low, dtype=float), np.asarray(high, dtype=float)
    return {'names': names, 'low': low, 'high': high, 'shape': low.shape, 'dtype': 'float64'}


class Env:
    """Tasks: 'press' reaches a force, 'hold' keeps it while the organ breathes, 'search' finds a hidden lump.

    Action: change of the tool's position [m] in the world frame (at most 0.1 m/s), in 'search' then `mark`: above 0.5 it
    marks the place under the tool. Observation: position from the start [m], depth and distance [m], force of the tissue on the
    tool [N], target [N] (0 in 'search'), then the displacement [m] of `surface_points` points of the surface. Reward for each step: -|F -
    target|/target, in 'search' 1 for a mark that finds the lump and -0.1 for another. A found lump ends the episode;
    `seconds` of simulated time truncate it. Other arguments are those of TickedSimulation. Raises InputError, ParameterError.
    """

    def __init__(self, task: str = 'press', *, organ: str = 'liver', tool: str = 'sphere:5', seconds: float = 5.0,
                 ticks: int = 10, tolerance: float = 10e-3, surface_points: int = 0, noise: bool = False,
                 **scene: Any) -> None:
        if task not in TASKS:
            raise InputError(f'task: {task!r} is not press, hold or search')
        if not 1 <= ticks <= 1000:
            raise InputError(f'ticks: {ticks}, must be 1 to 1000 for each step')
        if task == 'hold':
            scene.setdefault('organ_motion', ['breathing'])
        if task == 'search':
            scene.setdefault('inclusions', ['nodule'])
        self.task, self.ticks, self.tolerance = task, ticks, tolerance
        self._simulation = TickedSimulation(organ=organ, tool=tool, noise=noise, no_hand=True, **scene)
        self._start = self._simulation.scripted_samples(0)
        self._limit = FASTEST * ticks / self._simulation.rate_Hz
        self._steps = round(seconds * self._simulation.rate_Hz / ticks)
        surface = self._simulation.surface()
        self._rest = surface.vertices
        self._points = np.linspace(0, len(self._rest) - 1, surface_points).astype(int)
        self._places = self._places_of(surface) if task == 'search' else []
        self.action_space = _space(['dx', 'dy', 'dz'] + ['mark'] * (task == 'search'),
                                   [-self._limit] * 3 + [0.0] * (task == 'search'),
                                   [self._limit] * 3 + [1.0] * (task == 'search'))
        most = self._simulation.max_force
        names = ['x', 'y', 'z', 'depth', 'distance', 'force_x', 'force_y', 'force_z', 'target']
        names += [f'displacement_{i}' for i in range(surface_points)]
        low = [-np.inf] * 3 + [0.0, -np.inf] + [-most] * 3 + [0.0] * (1 + surface_points)
        high = [np.inf] * 5 + [most] * 4 + [np.inf] * surface_points
        self.observation_space = _space(names, low, high)
        self._finished = True

    def _places_of(self, surface: Any) -> List[NDArray[np.float64]]:
        """Centres at the lump's depth below the upper side."""
        lump = self._simulation.inclusions[0]
        first = self._rest - np.asarray(lump.position, dtype=float)
        depth = np.sqrt((first ** 2).sum(axis=1).min())
        corners = self._rest[surface.triangles]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
        upper = normals[:, 2] > OUTWARD
        return list(corners[upper].mean(axis=1) - depth * normals[upper])

    def _hide_lump(self) -> NDArray[np.float64]:
        """Moves the lump to a random place inside the organ."""
        for _ in range(1000):
            place = self._places[self._random.integers(len(self._places))]
            try:
                self._simulation.set_inclusion(0, position=place)
                return place
            except InputError:
                continue  # not inside the organ
        raise InputError('search: the organ has no place for the lump under its upper side')

    def reset(self, *, seed: Optional[int] = None) -> Tuple[NDArray[np.float64], Dict[str, Any]]:
        """Starts an episode. Without a seed the random numbers go on."""
        if seed is not None or not hasattr(self, '_random'):
            self._random = np.random.default_rng(seed)
        self._simulation.restart()
        self._place = self._hide_lump() if self.task == 'search' else None
        self._target = 0.0 if self.task == 'search' else float(self._random.uniform(0.2, 0.8))
        self._position = self._start['position'][0].copy()
        self._step, self._finished = 0, False
        return self._observe(self._move(np.zeros(3)))

    def _move(self, change: NDArray[np.float64]) -> Any:
        samples = np.repeat(self._start[np.newaxis], self.ticks, axis=0)
        share = np.arange(1, self.ticks + 1)[:, np.newaxis] / self.ticks
        samples['position'][:, 0] = self._position + share * change
        samples['velocity'][:, 0] = change * self._simulation.rate_Hz / self.ticks
        self._position = self._position + change
        return self._simulation.tick(samples)[-1, 0]

    def _observe(self, result: Any) -> Tuple[NDArray[np.float64], Dict[str, Any]]:
        moved = self._position - self._start['position'][0]
        values = [*moved, result['depth'], result['distance'], *result['force'], self._target]
        if len(self._points):
            displaced = self._simulation.surface().vertices[self._points] - self._rest[self._points]
            values.extend(np.linalg.norm(displaced, axis=1))
        info = {'tissue_force': float(result['tissue_force']), 'tick': int(result['tick']), 'fault': int(result['fault'])}
        return np.array(values), info

    def step(self, action: ArrayLike) -> Tuple[NDArray[np.float64], float, bool, bool, Dict[str, Any]]:
        """One step of `ticks` ticks. Returns observation, reward, terminated, truncated, info."""
        if self._finished:
            raise RuntimeError('Env.step: the episode has ended, call reset() first')
        action = np.asarray(action, dtype=float)
        if action.shape != self.action_space['shape'] or not np.isfinite(action).all():
            raise InputError(f'action: {action.tolist()}, must be {len(self.action_space["names"])} finite numbers: '
                                      + ', '.join(self.action_space['names']))
        change = action[:3]
        length = np.linalg.norm(change)
        if length > self._limit:
            change = change * (self._limit / length)
        observation, info = self._observe(self._move(change))
        self._step += 1
        terminated = False
        if self.task == 'search':
            reward = 0.0
            if action[3] > 0.5:
                surface = self._simulation.surface()
                turned = _rotate(surface.organ_orientation, np.asarray(self._place)) + surface.organ_position
                terminated = bool(np.hypot(*(self._position - turned)[:2]) <= self.tolerance)
                reward = 1.0 if terminated else -0.1
        else:
            reward = -abs(info['tissue_force'] - self._target) / self._target
        truncated = not terminated and self._step >= self._steps
        self._finished = terminated or truncated
        return observation, reward, terminated, truncated, info


def _rotate(quaternion: NDArray[np.float64], vector: NDArray[np.float64]) -> NDArray[np.float64]:
    scalar, axis = quaternion[0], quaternion[1:]
    twice = 2.0 * np.cross(axis, vector)
    return vector + scalar * twice + np.cross(axis, twice)
