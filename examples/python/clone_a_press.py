#!/usr/bin/env python3
"""Clones a policy: `palpate generate` writes episodes of a force controller, least squares learn its actions from what it
observed, and the clone presses tissues that it has not seen. Writes clone_a_press.png. The program is PALPATE_PROGRAM, or
palpate of the PATH.
"""
import json
import os
import subprocess
import time

import numpy as np

import palpate
from common import BLUE, GREY, ORANGE, figure, out_folder, save

PROGRAM = os.environ.get('PALPATE_PROGRAM', 'palpate')
FEATURES = 100


def generated(folder, policy, episodes):
    """The arrays of episodes with tissues of half to twice the stiffness."""
    file = folder / f'press-{policy}.npz'
    subprocess.run([PROGRAM, 'generate', '--task', 'press', '--policy', policy, '--episodes', str(episodes), '--steps', '200',
                    '--stiffness-factor', '0.5:2', '--out', file], check=True, stdout=subprocess.PIPE)
    return np.load(file)


def features(observations, planes):
    """Rectified random planes over depth, distance, force and target, and these themselves."""
    force = np.linalg.norm(observations[:, 5:8], axis=1)
    inputs = np.column_stack([100.0 * observations[:, 3:5], force, observations[:, 8], np.ones(len(force))])
    return np.column_stack([np.maximum(inputs @ planes, 0.0), inputs])


def press(env, planes, weights, seed):
    """Mean reward, forces, target and the tissue's stiffness factor of the clone in an episode."""
    observation, info = env.reset(seed=seed)
    rewards, forces, done = [], [], False
    while not done:
        action = features(observation[np.newaxis], planes)[0] @ weights
        observation, reward, terminated, truncated, info = env.step(action)
        rewards.append(reward)
        forces.append(info['tissue_force'])
        done = terminated or truncated
    return np.mean(rewards), forces, observation[8], env.parameters['stiffness_factor']


def main():
    folder = out_folder(__doc__)
    began = time.perf_counter()
    data, random_hand = generated(folder, 'scripted', 60), generated(folder, 'random', 20)
    planes = np.random.default_rng(1).normal(size=(5, FEATURES))
    weights = np.linalg.lstsq(features(data['observations'], planes), data['actions'], rcond=None)[0]
    env = palpate.Env(**json.loads(str(data['metadata']))['arguments'])
    pressed = [press(env, planes, weights, 10_000 + seed) for seed in range(10)]
    taken = time.perf_counter() - began

    made, (pane,) = figure(1, 4.0)
    at = 0.01 * np.arange(1, 201)
    for (_, forces, target, factor), colour in zip(pressed, (BLUE, ORANGE)):
        pane.plot(at, forces, color=colour, lw=1.8, label=f'clone, tissue {factor:.2f} times as stiff')
        pane.axhline(target, color=GREY, ls='--')
    pane.set_xlabel('time, s')
    pane.set_ylabel('tissue force, N (dashed: target)')
    pane.legend(frameon=False, loc='lower right')
    save(made, folder / 'clone_a_press.png')
    clone = np.mean([episode[0] for episode in pressed])
    print(f'mean reward of a step: controller {data["rewards"].mean():.2f}, clone {clone:.2f}, random '
          f'{random_hand["rewards"].mean():.2f}; {taken:.1f} s')


if __name__ == '__main__':
    main()
