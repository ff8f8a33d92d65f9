"""palpate.validate() against `palpate validate`."""
import json
import os
import pathlib
import struct
import subprocess
import tempfile
import unittest
import zlib

import numpy as np

import palpate

PROGRAM = os.environ['PALPATE_PROGRAM']


def said_by(*words):
    done = subprocess.run([PROGRAM, 'validate', *map(str, words), '--json'], capture_output=True, text=True)
    if done.returncode != 0:
        raise AssertionError(done.stderr)
    return json.loads(done.stdout)


def write_columns(file, names, *columns):
    rows = '\n'.join(','.join(repr(float(value)) for value in row) for row in zip(*columns))
    file.write_text(','.join(names) + '\n' + rows + '\n')


def profile_of(reach, depth, radius, distance):
    """u(r) of docs/model.md, section 3, written once more."""
    contact, first, ratio, weight = reach
    r1 = min(contact * np.sqrt(radius * depth), radius)
    weights = weight ** np.arange(6)
    radii = r1 * (1.0 + first * (ratio ** np.arange(6) - 1.0) / (ratio - 1.0))
    bars = np.maximum(0.0, 1.0 - (distance[:, None] / radii) ** 2)
    return depth * (bars @ (weights / weights.sum()))


def write_gray_png(file, picture):
    """8-bit grey, from an array of 0 .. 1."""
    lines = b''.join(b'\0' + line.tobytes() for line in (255.0 * picture).round().astype(np.uint8))

    def chunk(kind, body):
        return struct.pack('>I', len(body)) + kind + body + struct.pack('>I', zlib.crc32(kind + body))
    height, width = picture.shape
    head = struct.pack('>IIBBBBB', width, height, 8, 0, 0, 0, 0)
    file.write_bytes(b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', head) + chunk(b'IDAT', zlib.compress(lines)) +
                     chunk(b'IEND', b''))


def side_view(depth, pixel, radius):
    """Light above, tissue below, a dark ball on a shaft in the dent of that depth [m]."""
    rows, columns = np.mgrid[0:460, 0:900].astype(float)
    tissue = palpate.tissue_preset('liver')
    r = np.abs(np.arange(900) - 450.0) * pixel
    line = 200.0 + (profile_of(tissue.reach, depth, radius, r) / pixel if depth else 0.0)
    picture = 0.75 - 0.35 / (1.0 + np.exp(-(rows - line) / 0.5))
    ball = radius / pixel
    centre = 200.0 + depth / pixel - ball if depth else 40.0
    inside = np.hypot(columns - 450.0, rows - centre) < ball
    shaft = (np.abs(columns - 450.0) < 0.4 * ball) & (rows < centre)
    picture[inside | shaft] = 0.15
    texture = np.random.default_rng(3).normal(0.0, 0.01, picture.shape)
    return np.clip(picture + texture, 0.0, 1.0)


class Validate(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def test_finds_of_forces_what_the_program_finds(self):
        law = palpate.SmoothSpringLaw(palpate.tissue_preset('liver'), 'press')
        depth = np.linspace(0.0, 9e-3, 40)
        force = 1.05 * law.force_at(depth) + 1e-3 * np.cos(31.0 * np.arange(40.0))
        file = self.folder / 'liver.csv'
        write_columns(file, ('displacement_mm', 'force_N'), 1e3 * depth, force)
        said = said_by(file, '--tissue', 'liver', '--law', 'smooth', '--against', 'hertz,exponential',
                       '--first-contact-mm', '0.1', '--offset-N', '0.002')['sets'][0]
        found = palpate.validate('liver', forces=palpate.read_specimens(file), law='smooth',
                                 against=['hertz', 'exponential'], first_contact=1e-4, offset=0.002)['forces'][0]
        for name in ('name', 'rms', 'max', 'nrmse', 'within_jnd', 'extrapolated_points', 'rows'):
            self.assertEqual(found[name], said[name], name)
        for ours, theirs in zip(found['against'], said['against']):
            for name in ('name', 'parameters', 'rms', 'max', 'nrmse'):
                self.assertEqual(ours[name], theirs[name], name)
            self.assertGreater(ours['evaluation_ns'], 0.0)
        error = found['computed'] - found['measured']
        self.assertAlmostEqual(found['rms'], np.sqrt(np.mean(error ** 2)), places=12)

    def test_finds_of_profiles_what_the_program_finds(self):
        true = (1.0, 0.5, 1.7, 0.6)
        distance = np.linspace(0.0, 30e-3, 60)
        u = profile_of(true, 4e-3, 5e-3, distance)
        file = self.folder / 'side.csv'
        write_columns(file, ('r_mm', 'u_mm'), 1e3 * distance, 1e3 * u)
        said = said_by('--profile', file, '--tissue', 'liver', '--depth-mm', '4', '--tip-radius-mm', '5', '--fit-reach')
        found = palpate.validate('liver', profiles=palpate.read_deformations(file), depth=4e-3, tip_radius=5e-3,
                                 fit_reach=True)
        for name in ('contact_ratio', 'first_bar_ratio', 'bar_ratio', 'weight_ratio'):
            self.assertEqual(found['reach'][name], said['reach'][name])
        self.assertEqual(found['profiles'][0]['nrmse'], said['sets'][0]['nrmse'])
        self.assertLess(found['profiles'][0]['nrmse'], 1e-3)
        self.assertEqual(found['tissue'].reach, tuple(found['reach'][name] for name in (
            'contact_ratio', 'first_bar_ratio', 'bar_ratio', 'weight_ratio')))
        by_load = palpate.LayeredSpringLaw(palpate.tissue_preset('liver')).force_at(4e-3)
        deformation = palpate.Deformation('side', distance, u)
        again = palpate.validate('liver', profiles=[deformation], force=float(by_load), tip_radius=5e-3)
        self.assertAlmostEqual(again['profiles'][0]['depth'], 4e-3, places=9)

    def test_finds_in_photographs_what_the_program_finds(self):
        before, after = self.folder / 'before.png', self.folder / 'after.png'
        write_gray_png(before, side_view(0.0, 1e-4, 3e-3))
        write_gray_png(after, side_view(5e-3, 1e-4, 3e-3))
        said = said_by('--image', before, after, '--scale-mm-per-px', '0.1', '--tissue', 'liver', '--tip-radius-mm', '3',
                       '--depth-mm', '5')
        found = palpate.validate('liver', image=(before, after), pixel=1e-4, tip_radius=3e-3, depth=5e-3)
        self.assertEqual(found['profiles'][0]['rms'] / 1e-3, said['sets'][0]['rms'])
        image = found['image']
        self.assertEqual((image['confidence'], image['tip_hidden'], image['within_uncertainty']),
                         (said['image']['confidence'], said['image']['tip_hidden'], said['image']['within_uncertainty']))
        self.assertEqual(list(image['u'] / 1e-3), [point['u_mm'] for point in said['image']['points']])
        self.assertLess(found['profiles'][0]['nrmse'], 0.05)

    def test_is_refused_in_words(self):
        ramp = np.linspace(0.0, 1e-2, 20)
        specimen = palpate.Specimen('ramp', ramp, 10.0 * ramp)
        side = palpate.Deformation('side', ramp, np.exp(-300.0 * ramp) * 1e-3)
        for arguments, words in (
                ({}, 'nothing to compare'), ({'forces': [specimen], 'depth': 1e-3}, 'are of profiles'),
                ({'forces': [specimen], 'fit_reach': True}, 'fit_reach'), ({'profiles': [side]}, 'tip_radius|depth'),
                ({'profiles': [side], 'tip_radius': 5e-3, 'depth': [1e-3, 2e-3]}, 'has 2 values'),
                ({'profiles': [side], 'tip_radius': 5e-3, 'depth': -1e-3}, 'depth = -0.001'),
                ({'profiles': [side], 'tip_radius': -1.0, 'depth': 1e-3}, 'tip_radius = -1'),
                ({'profiles': [side], 'depth': 1e-3, 'force': 1.0}, 'at most one'),
                ({'image': ('a.png', 'b.png')}, 'pixel'), ({'forces': [specimen], 'direction': 'up'}, 'direction'),
                ({'forces': [specimen], 'loop_period': 0.0}, 'loop_period'), ({'forces': [specimen], 'law': 'cubic'}, 'cubic'),
                ({'forces': [specimen], 'against': ['newton']}, 'newton')):
            with self.assertRaisesRegex(palpate.InputError, words):
                palpate.validate('liver', **arguments)
        with self.assertRaisesRegex(palpate.InputError, 'same length'):
            palpate.Deformation('side', ramp[1:], ramp)
        with self.assertRaisesRegex(palpate.InputError, 'one row'):
            palpate.Deformation('side', ramp.reshape(4, 5), ramp)
        with self.assertRaisesRegex(palpate.InputError, "deformation 'short'"):
            palpate.Deformation('short', ramp[:3], ramp[:3][::-1])
        with self.assertRaisesRegex(palpate.ParameterError, 'depth'):
            palpate.Deformation('side', ramp, ramp, depth=-1.0)


if __name__ == '__main__':
    unittest.main()
