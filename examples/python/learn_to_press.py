#!/usr/bin/env python3
"""Learns to press an organ with a given force: the cross-entropy method chooses three numbers of a policy, by the reward of
palpate.Env. Writes learn_to_press.png.
"""
import time

import numpy as np

import palpate
from common import BLUE, GREY, ORANGE, figure, out_folder, save

GENERATIONS, POLICIES, BEST, EPISODES = 12, 16, 4, 3


def reward_of(env, policy, seed, forces=None):
    """Mean reward of an episode. Policy: ln of the gains [m/N] of the error and of the force's change, ln of the speed in air [m]."""
    gain, damping, speed = np.exp(policy)
    observation, info = env.reset(seed=seed)
    total, steps, last, done = 0.0, 0, 0.0, False
    while not done:
        force = info['tissue_force']
        down = gain * (observation[8] - force) - damping * (force - last) if force > 0.0 else speed
        last = force
        observation, reward, terminated, truncated, info = env.step([0.0, 0.0, -down])
        total, steps, done = total + reward, steps + 1, terminated or truncated
        if forces is not None:
            forces.append((info['tissue_force'], observation[8]))
    return total / steps


def main():
    folder = out_folder(__doc__)
    env = palpate.Env('press', seconds=2.0)
    random = np.random.default_rng(1)
    mean, spread = np.log([1e-4, 1e-4, 1e-4]), np.full(3, 1.5)
    history, steps, began = [], 0, time.perf_counter()
    for generation in range(GENERATIONS):
        policies = mean + spread * random.normal(size=(POLICIES, 3))
        seeds = EPISODES * generation + np.arange(EPISODES)
        rewards = np.array([np.mean([reward_of(env, policy, int(seed)) for seed in seeds]) for policy in policies])
        steps += POLICIES * EPISODES * 200
        kept = policies[np.argsort(rewards)[-BEST:]]
        mean, spread = kept.mean(axis=0), kept.std(axis=0) + 0.05
        history.append((rewards.mean(), rewards.max()))
    taken = time.perf_counter() - began

    before, after = [], []
    first = reward_of(env, np.log([1e-4, 1e-4, 1e-4]), 999, before)
    learned = reward_of(env, mean, 999, after)
    made, (pane,) = figure(1, 4.0)
    at = 0.01 * np.arange(1, 201)
    pane.axhline(after[0][1], color=GREY, ls='--', label='target')
    pane.plot(at, [force for force, _ in before], color=ORANGE, label='before learning')
    pane.plot(at, [force for force, _ in after], color=BLUE, lw=1.8, label=f'after {GENERATIONS} generations')
    pane.set_xlabel('time, s')
    pane.set_ylabel('tissue force, N')
    pane.legend(frameon=False, loc='center right')
    save(made, folder / 'learn_to_press.png')
    print(f'mean reward of a generation {history[0][0]:.2f} -> {history[-1][0]:.2f}; of a new episode {first:.2f} -> {learned:.2f}; '
          f'{steps / taken:.0f} steps a second')


if __name__ == '__main__':
    main()
