"""The Python package against the program: the same numbers, the same messages."""
import json
import os
import pathlib
import subprocess
import tempfile
import threading
import time
import unittest

import numpy as np

import palpate

PROGRAM = os.environ['PALPATE_PROGRAM']


def program(*words):
    """What the program prints, and what it says on standard error."""
    done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True)
    return done.stdout, done.stderr


class WithFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)


class Law(unittest.TestCase):
    def test_is_the_programs_both_ways(self):
        for kind, name in ((palpate.LayeredSpringLaw, 'layered'), (palpate.SmoothSpringLaw, 'smooth')):
            for direction in ('press', 'pull'):
                law = kind(palpate.tissue_preset('liver'), direction, 1e-3)
                depths_mm = [0.0, 0.4, 3.0, 9.5, 14.0, 40.0]
                said = json.loads(program('model', '--tissue', 'liver', '--law', name, '--direction', direction,
                                          '--depth-mm', ','.join(map(str, depths_mm)), '--json')[0])
                found = law.deformation_at(np.array(depths_mm) * 1e-3)
                for one, answer in zip(found, said['results']):
                    self.assertEqual(one['force'], answer['force_N'])
                    self.assertEqual(one['depth'] / 1e-3, answer['depth_mm'])
                    self.assertEqual(one['stiffness'], answer['tangent_stiffness_N_per_m'])
                    self.assertEqual(one['cutoff_layer'], answer['cutoff_layer'])
                    self.assertEqual(one['saturated'], answer['saturated'])
                forces = [0.0, 0.1, 0.7, 50.0]
                said = json.loads(program('model', '--tissue', 'liver', '--law', name, '--direction', direction,
                                          '--force-N', ','.join(map(str, forces)), '--json')[0])
                for one, answer in zip(law.deformation_under(forces), said['results']):
                    self.assertEqual(one['depth'] / 1e-3, answer['depth_mm'])
                    self.assertEqual(list(one['deformation'][:one['cutoff_layer']] / 1e-3),
                                     answer['layer_deformation_mm'])

    def test_keeps_the_shape_of_what_it_is_asked(self):
        law = palpate.LayeredSpringLaw(palpate.tissue_preset('heart'), 'pull')
        self.assertIsInstance(float(law.force_at(0.005)), float)
        self.assertEqual(law.force_at(np.zeros((3, 4, 2))).shape, (3, 4, 2))
        self.assertEqual(law.force_at([]).shape, (0,))
        backwards = np.linspace(0.0, 0.01, 7)[::-2]  # neither in order nor without gaps
        self.assertTrue((law.force_at(backwards) == [law.force_at(depth) for depth in backwards]).all())
        np.testing.assert_allclose(law.depth_under(law.force_at(backwards)), backwards, rtol=1e-12, atol=1e-15)

    def test_refuses_in_the_programs_words(self):
        with self.assertRaisesRegex(palpate.InputError, 'direction = "push": must be press or pull'):
            palpate.LayeredSpringLaw(palpate.tissue_preset('heart'), 'push')
        tissue = palpate.tissue_preset('heart')
        tissue.k1 = -1.0
        with self.assertRaisesRegex(palpate.ParameterError, 'k1_N_per_m = -1: must be'):
            palpate.LayeredSpringLaw(tissue)
        with self.assertRaises(TypeError):
            palpate.LayeredSpringLaw(palpate.tissue_preset('heart')).force_at('deep')


class Tissue(WithFolder):
    def test_goes_to_a_file_and_back(self):
        tissue = palpate.tissue_preset('kidney')
        tissue.law = 'smooth'
        tissue.relaxation = [(0.3, 1.5)]
        file = self.folder / 'kidney.toml'
        file.write_text(tissue.to_toml())
        back = palpate.load_tissue(str(file))
        self.assertEqual((back.k1, back.beta, back.law, back.relaxation),
                         (tissue.k1, tissue.beta, 'smooth', [(0.3, 1.5)]))

    def test_refuses_in_the_programs_words(self):
        _, said = program('model', '--tissue', 'hearth', '--depth-mm', '1')
        with self.assertRaises(palpate.InputError) as refused:
            palpate.load_tissue('hearth')
        self.assertIn(str(refused.exception), said)
        self.assertIsInstance(refused.exception, ValueError)
        tissue = palpate.tissue_preset('heart')
        with self.assertRaises(palpate.InputError):
            tissue.law = 'quadratic'
        with self.assertRaises(palpate.ParameterError):
            tissue.relaxation = [(1.5, 1.0)]
        tissue.q = float('nan')
        with self.assertRaises(palpate.ParameterError):
            tissue.validate()


class Noise(unittest.TestCase):
    def test_is_the_programs_line_by_line(self):
        said, _ = program('noise', '--gain-N-m', '5e-5', '--threshold-mm', '5', '--distance-mm', '3', '--samples', '200',
                          '--seed', '7')
        noise = palpate.TouchNoise(gain=5e-5, threshold=5e-3, seed=7)
        forces = noise.forces(200, distance=3e-3)
        self.assertEqual(list(forces), [float(line) for line in said.split()])
        self.assertTrue((noise.forces(50, distance=3e-3, first=100) == forces[100:150]).all())
        self.assertAlmostEqual(float(noise.sigma(3e-3)), 5e-5 / 8e-3)

    def test_refuses_a_bad_setting(self):
        with self.assertRaisesRegex(palpate.ParameterError, 'threshold_mm'):
            palpate.TouchNoise(threshold=0.0)


class Meshes(WithFolder):
    def test_are_what_the_program_says_of_them(self):
        file = self.folder / 'gallbladder.obj'
        organ = palpate.make_organ('gallbladder')
        with file.open('w') as out:
            for vertex in organ.vertices * 1e3:
                out.write('v {} {} {}\n'.format(*vertex))
            for triangle in organ.triangles + 1:
                out.write('f {} {} {}\n'.format(*triangle))
        said = json.loads(program('inspect', file, '--unit', 'mm', '--json')[0])
        mesh, findings = palpate.read_mesh(file, 'mm')
        self.assertEqual(mesh.vertices.shape, (said['vertices'], 3))
        self.assertEqual(mesh.triangles.shape, (said['triangles'], 3))
        self.assertEqual((findings.closed, findings.manifold, findings.shells),
                         (said['closed'], said['manifold'], said['shells']))
        self.assertAlmostEqual(findings.volume * 1e9, said['volume_mm3'], places=6)
        # The reader keeps the triangles in their order, not the vertices.
        np.testing.assert_allclose(mesh.vertices[mesh.triangles], organ.vertices[organ.triangles], atol=1e-8)

    def test_are_made_from_arrays(self):
        box = palpate.make_organ('box')
        again = palpate.Mesh(box.vertices, box.triangles)
        self.assertTrue(again.findings().closed)
        self.assertFalse(palpate.Mesh(box.vertices, box.triangles[1:]).findings().closed)
        radius = np.linalg.norm(palpate.make_ball(0.01).vertices, axis=1)
        np.testing.assert_allclose(radius, 0.01, rtol=1e-12)
        self.assertEqual([name for name, _ in palpate.make_tool('curved-forceps')], ['left', 'right', 'shaft'])
        self.assertIn('heart', palpate.organ_names())

    def test_are_refused_in_words(self):
        with self.assertRaisesRegex(palpate.InputError, 'must be an index of the 3 vertices'):
            palpate.Mesh(np.eye(3), [[0, 1, 3]])
        with self.assertRaisesRegex(palpate.InputError, 'n x 3 numbers'):
            palpate.Mesh([1.0, 2.0], [[0, 1, 2]])
        with self.assertRaisesRegex(palpate.InputError, 'n x 3 indices'):
            palpate.Mesh(np.eye(3), [0, 1, 2])
        with self.assertRaisesRegex(palpate.InputError, 'none.stl'):
            palpate.read_mesh('none.stl', 'mm')
        with self.assertRaises(palpate.InputError):
            palpate.make_organ('liverr')


class Runs(WithFolder):
    def same_rows(self, rows, csv):
        """Every number of the program's own export, bit for bit (but for the two that are words there)."""
        lines = pathlib.Path(csv).read_text().splitlines()
        names = lines[0].split(',')
        self.assertEqual(list(rows.dtype.names), names)
        self.assertEqual(len(rows), len(lines) - 1)
        words = {'phase', 'fault'}
        for column, values in zip(names, zip(*(line.split(',') for line in lines[1:]))):
            if column not in words:
                self.assertTrue((rows[column] == np.array(values, dtype=rows.dtype[column])).all(), column)
        phases = [line.split(',')[names.index('phase')] for line in lines[1:]]
        self.assertEqual([('approach', 'press', 'pull')[phase] for phase in rows['phase']], phases)

    def test_simulated_are_the_programs_bit_for_bit(self):
        for task in ('press', 'pull'):
            recording, csv = self.folder / f'{task}.h5', self.folder / f'{task}.csv'
            program('run', '--offline', '--task', task, '--duration-s', '3', '--record', recording)
            program('export', recording, '--csv', csv)
            rows = palpate.simulate(task=task, duration_s=3.0)
            self.assertEqual(len(rows), 3000)
            self.assertGreater(rows['tissue_force_N'].max(), 0.0)
            self.same_rows(rows, csv)

    def test_recorded_here_are_read_and_verified_everywhere(self):
        file, csv = self.folder / 'two.h5', self.folder / 'two.csv'
        rows = palpate.simulate(scene_text='[scene]\nname = "from a text"\nrate_Hz = 2000\nseed = 5\n[organ]\n'
                                'mesh = "box"\n[tool]\nmesh = "sphere:5"\n', duration_s=1.0, record=file)
        recording = palpate.read_recording(file)
        self.assertEqual(recording.rows.tobytes(), rows.tobytes())
        self.assertEqual((recording.name, recording.rate_Hz, recording.seed, recording.offline, recording.complete),
                         ('from a text', 2000.0, 5, True, True))
        self.assertEqual(recording.version, palpate.__version__)
        self.assertEqual(recording.replay_difference(), '')
        self.assertTrue(recording.organ.findings().closed)
        program('export', file, '--csv', csv)
        self.same_rows(recording.rows, csv)
        kept = palpate.read_recording(file).rows  # the rows outlive the recording they came from
        self.assertEqual(kept.tobytes(), rows.tobytes())

    def test_are_refused_in_the_programs_words(self):
        scene = self.folder / 'bad.toml'
        scene.write_text('[organ]\nmesh = "gallbladder"\n[tool]\nmash = "sphere:3"\n')
        _, said = program('run', '--offline', scene)
        with self.assertRaises(palpate.InputError) as refused:
            palpate.simulate(scene)
        self.assertIn(str(refused.exception), said)
        for arguments, words in (({'device': 'haply'}, 'offline'), ({'duration_s': -1.0}, 'duration_s = -1'),
                                 ({'duration_s': 1e300}, 'duration_s'), ({'rate_Hz': 1.0}, 'rate'),
                                 ({'scene': 'a.toml', 'scene_text': ''}, 'at most one')):
            with self.assertRaisesRegex(palpate.InputError, words):
                palpate.simulate(**arguments)
        with self.assertRaisesRegex(palpate.InputError, 'none.h5'):
            palpate.read_recording('none.h5')

    def test_leave_other_threads_running(self):
        done = threading.Event()
        counted = 0
        worker = threading.Thread(target=lambda: (palpate.simulate(duration_s=4.0, cache=False), done.set()))
        worker.start()
        while not done.is_set():
            counted += 1
            time.sleep(1e-3)
        worker.join()
        self.assertGreater(counted, 3, 'a run takes a tenth of a second and more; this thread went on meanwhile')


class Fit(WithFolder):
    def test_is_the_programs(self):
        law = palpate.LayeredSpringLaw(palpate.tissue_preset('liver'), 'press')
        depth = np.linspace(0.0, 12e-3, 60)
        wobble = 2e-3 * np.sin(37.0 * np.arange(60.0))
        force = law.force_at(depth) + wobble
        file = self.folder / 'liver.csv'
        file.write_text('displacement_mm,force_N\n' +
                        ''.join(f'{d * 1e3!r},{f!r}\n' for d, f in zip(depth.tolist(), force.tolist())))
        said = json.loads(program('fit', file, '--direction', 'press', '--json')[0])
        found = palpate.fit(palpate.read_specimens(file), direction='press')
        ours, theirs = found['specimens'][0], said['specimens'][0]
        self.assertEqual(ours['name'], theirs['name'])
        self.assertEqual(ours['nrmse'], theirs['nrmse'])
        for name in ('k1_N_per_m', 'beta', 'q', 'limit_mm'):
            self.assertEqual(ours['parameters'][name][0], theirs['parameters'][name])
        self.assertAlmostEqual(found['pooled']['tissue'].k1, ours['parameters']['k1_N_per_m'][0])
        self.assertEqual(len(ours['fitted']), len(ours['measured']))
        written = self.folder / 'liver.toml'
        written.write_text(found['pooled']['tissue'].to_toml())
        self.assertEqual(palpate.load_tissue(str(written)).name, 'fitted')

    def test_refuses_what_cannot_be_fitted(self):
        with self.assertRaisesRegex(palpate.InputError, 'at least 10'):
            palpate.Specimen('few', [0.0, 1e-3], [0.0, 0.1])
        ramp = np.linspace(0.0, 1e-2, 20)
        with self.assertRaisesRegex(palpate.InputError, 'same length'):
            palpate.Specimen('uneven', ramp[1:], ramp)
        with self.assertRaisesRegex(palpate.InputError, 'one row'):
            palpate.Specimen('square', ramp.reshape(4, 5), ramp)
        specimen = palpate.Specimen('ramp', ramp, 10.0 * ramp)
        with self.assertRaisesRegex(palpate.InputError, 'at least one'):
            palpate.fit([])
        for arguments, words in (({'loop_period': 0.0}, 'loop_period'), ({'t1': -1.0}, 't1'),
                                 ({'bootstrap': -1}, 'bootstrap'), ({'law': 'cubic'}, 'cubic')):
            with self.assertRaisesRegex(palpate.InputError, words):
                palpate.fit([specimen], **arguments)


class Docstrings(unittest.TestCase):
    def test_are_the_cpp_comments(self):
        self.assertIn('Node transforms are applied', palpate.read_mesh.__doc__)
        self.assertIn('stiffness of the first layer', palpate.Tissue.k1.__doc__)

    def test_are_there_for_every_class_and_function(self):
        for name in palpate.__all__:
            self.assertGreater(len((getattr(palpate, name).__doc__ or '').strip()), 20, name)

    def test_hold_no_mark_for_cpp_callers(self):
        for name in palpate.__all__:
            for mark in ('[setup]', '[rt]', '[any]', '@'):
                self.assertNotIn(mark, getattr(palpate, name).__doc__, name)


if __name__ == '__main__':
    unittest.main()
