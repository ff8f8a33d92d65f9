#!/usr/bin/env python3
"""Gives the poses of another simulator to many hands at once: eight fingertips press a liver, in a CSV of MuJoCo's convention
(frames at 100 Hz; position in m and quaternion w x y z, in that simulator's world). Writes pose_stream.csv and pose_stream.png.
"""
import csv

import numpy as np

import palpate
from common import BLUE, GREY, figure, out_folder, save

HANDS, FRAMES, FRAME_RATE = 8, 150, 100.0
COLUMNS = ('env', 'time', 'px', 'py', 'pz', 'qw', 'qx', 'qy', 'qz')
ORGAN_POSITION = np.array([0.5, 0.0, 0.8])              # where the other simulator's table has the organ's origin, m
ORGAN_QUATERNION = np.array([np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)])  # w x y z: turned by 90 degrees about z


def product(p, q):
    """Product of quaternions w x y z, on the last axis."""
    a, b = p[..., :1], q[..., :1]
    u, v = p[..., 1:], q[..., 1:]
    return np.concatenate([a * b - (u * v).sum(axis=-1, keepdims=True), a * v + b * u + np.cross(u, v)], axis=-1)


def turned(q, v):
    """Vectors turned by a quaternion."""
    return product(product(q, np.concatenate([np.zeros(v.shape[:-1] + (1,)), v], axis=-1)), q * [1, -1, -1, -1])[..., 1:]


def write_stream(file, surface):
    """The other simulator: each finger goes down onto its own place on the organ, about 4 mm deep, and back."""
    vertices = surface.vertices
    near = np.argsort(np.linalg.norm(vertices[:, :2] - vertices[vertices[:, 2].argmax(), :2], axis=1))
    tops = [v for v in near if vertices[v, 2] > vertices[:, 2].max() - 5e-3][::5][:HANDS]
    time = np.arange(FRAMES) / FRAME_RATE
    height = 5e-3 + 10e-3 + 14e-3 * (np.cos(2.0 * np.pi * time / time[-1]) - 1.0) / 2.0  # radius, gap, way down
    with open(file, 'w', newline='') as stream:
        writer = csv.writer(stream)
        writer.writerow(COLUMNS)
        for env, top in enumerate(tops):
            place = vertices[top] + height[:, np.newaxis] * [0.0, 0.0, 1.0]
            position = ORGAN_POSITION + turned(ORGAN_QUATERNION, place)
            writer.writerows([env, t, *p, *ORGAN_QUATERNION] for t, p in zip(time, position))


def read_stream(file):
    """Times (frames), positions and quaternions (hands, frames, ...)."""
    table = np.genfromtxt(file, delimiter=',', names=True)
    frames = np.stack([table[name] for name in COLUMNS], axis=-1).reshape(int(table['env'].max()) + 1, -1, len(COLUMNS))
    return frames[0, :, 1], frames[:, :, 2:5], frames[:, :, 5:]


def poses_of(position, quaternion):
    """Poses in the frame of the organ: x y z, w x y z. (Isaac Gym has x y z w: np.roll(quaternion, 1, axis=-1).)"""
    back = ORGAN_QUATERNION * [1, -1, -1, -1]
    return np.concatenate([turned(back, position - ORGAN_POSITION), product(back, quaternion)], axis=-1)


def at_rate(time, poses, rate):
    """Frames as ticks: between two frames the pose changes linearly."""
    ticks = np.arange(time[0], time[-1], 1.0 / rate)
    found = np.stack([[np.interp(ticks, time, one[:, i]) for i in range(7)] for one in poses]).transpose(0, 2, 1)
    found[..., 3:] /= np.linalg.norm(found[..., 3:], axis=-1, keepdims=True)
    return ticks, found


def main():
    folder = out_folder(__doc__)
    batch = palpate.Batch(None, HANDS, organ='liver', tool='sphere:5', noise=False)
    write_stream(folder / 'pose_stream.csv', batch.surface)
    time, position, quaternion = read_stream(folder / 'pose_stream.csv')
    ticks, poses = at_rate(time, poses_of(position, quaternion), batch.rate_Hz)
    force, torque, depth = batch.step(poses)  # (hands, ticks, 3), (hands, ticks, 3), (hands, ticks)

    made, (above, below) = figure(2, 5.0)
    for hand in range(HANDS):
        above.plot(ticks, np.linalg.norm(force[hand], axis=-1), color=BLUE, lw=1.2)
        below.plot(ticks, 1e3 * depth[hand], color=GREY, lw=1.2)
    above.set_ylabel('force, N')
    below.set_ylabel('depth, mm')
    below.set_xlabel('time, s')
    save(made, folder / 'pose_stream.png')
    for hand in range(HANDS):
        deepest = depth[hand].argmax()
        print(f'hand {hand}: deepest {1e3 * depth[hand, deepest]:.2f} mm with {np.linalg.norm(force[hand, deepest]):.3f} N '
              f'at {ticks[deepest]:.2f} s, fault {batch.fault[hand].max()}')


if __name__ == '__main__':
    main()
