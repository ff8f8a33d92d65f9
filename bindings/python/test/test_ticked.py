"""Simulations that Python itself ticks, against whole runs."""
import pathlib
import tempfile
import unittest

import numpy as np

import palpate


def scripted(simulation, ticks, first=0):
    return np.stack([simulation.scripted_samples(tick) for tick in range(first, first + ticks)])


class Ticks(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def test_are_those_of_a_whole_run_bit_for_bit(self):
        rows = palpate.simulate(duration_s=3.0)
        simulation = palpate.TickedSimulation(no_hand=True)
        self.assertEqual((simulation.hand_count, simulation.rate_Hz, simulation.max_force), (1, 1000.0, 20.0))
        self.assertGreater(simulation.scripted_ticks, 3000)
        samples = scripted(simulation, 3000)
        results = np.concatenate([simulation.tick(samples[:1000]),  # many at once
                                  np.stack([simulation.tick(one) for one in samples[1000:2000]]),  # one by one
                                  simulation.tick(np.repeat(samples[2000:], 2, axis=0)[::2])])[:, 0]  # with gaps
        self.assertGreater(results['tissue_force'].max(), 0.0)
        for ours, theirs in (('tick', 'tick'), ('time', 'time_s'), ('tissue_force', 'tissue_force_N'),
                             ('noise_force', 'noise_force_N'), ('depth', 'depth_m'), ('distance', 'distance_m'),
                             ('friction', 'friction_N'), ('phase', 'phase'), ('status', 'status')):
            self.assertTrue((results[ours] == rows[theirs]).all(), ours)
        for ours, theirs in (('force', 'force_{}_N'), ('contact', 'contact_{}_m'), ('tool_position', 'tool_{}_m')):
            for axis, letter in enumerate('xyz'):
                self.assertTrue((results[ours][:, axis] == rows[theirs.format(letter)]).all(), ours)

    def test_come_back_the_same_after_a_restart(self):
        simulation = palpate.TickedSimulation(task='pull', no_hand=True)
        samples = scripted(simulation, 200)
        first = simulation.tick(samples)
        simulation.restart()
        self.assertEqual(simulation.tick(samples).tobytes(), first.tobytes())

    def test_latch_a_fault_until_it_is_reset(self):
        with palpate.TickedSimulation(no_hand=True) as simulation:
            good = simulation.scripted_samples(0)
            bad = good.copy()
            bad['position'][0] = np.nan
            self.assertEqual(simulation.tick(good)['fault'][0], 0)
            self.assertEqual(simulation.tick(bad)['fault'][0], 1)
            self.assertEqual(simulation.tick(good)['fault'][0], 1)
            simulation.reset_fault(0)
            self.assertEqual(simulation.tick(good)['fault'][0], 0)
            with self.assertRaisesRegex(palpate.InputError, 'hand = 3'):
                simulation.reset_fault(3)

    def test_are_recorded_and_replay(self):
        file = self.folder / 'ticked.h5'
        with palpate.TickedSimulation(record=file, tissue=palpate.tissue_preset('kidney'), no_hand=True) as simulation:
            simulation.tick(scripted(simulation, 3000))
            surface = simulation.surface()
            with self.assertRaisesRegex(RuntimeError, 'while recording'):
                simulation.restart()
        recording = palpate.read_recording(file)
        self.assertTrue(recording.complete)
        self.assertEqual((len(recording.rows), recording.tissue.name), (3000, 'kidney'))
        self.assertEqual(recording.replay_difference(), '')
        again = recording.surface(2999)
        self.assertEqual(again.vertices.tobytes(), surface.vertices.tobytes())
        self.assertGreater(np.abs(surface.vertices - recording.organ.vertices).max(), 1e-3)
        with self.assertRaisesRegex(palpate.InputError, 'tick'):
            recording.surface(3000)

    def test_let_nothing_through_before_a_hand_was_still(self):
        simulation = palpate.TickedSimulation()
        samples = scripted(simulation, 10)
        self.assertTrue((simulation.tick(samples)['engagement'] == 0.0).all())
        free = palpate.TickedSimulation(no_hand=True)
        self.assertTrue((free.tick(scripted(free, 10))['engagement'] == 1.0).all())

    def test_are_refused_in_words(self):
        simulation = palpate.TickedSimulation()
        with self.assertRaisesRegex(palpate.InputError, 'one entry a hand'):
            simulation.tick(np.zeros(2, dtype=simulation.samples().dtype))
        with self.assertRaisesRegex(palpate.InputError, 'type that samples'):
            simulation.tick(np.zeros(1))
        with self.assertRaises(TypeError):
            simulation.tick([1.0])
        simulation.close()
        simulation.close()
        with self.assertRaisesRegex(RuntimeError, 'closed'):
            simulation.samples()
        with self.assertRaisesRegex(palpate.InputError, 'surface_edge'):
            palpate.TickedSimulation(surface_edge=2.0)


class DeformedSurface(unittest.TestCase):
    def test_goes_down_by_the_depth_at_the_contact_and_nowhere_else(self):
        box = palpate.make_organ('box')
        top = box.vertices[:, 2].max()
        middle = box.vertices[np.argmin(np.linalg.norm(box.vertices - [0.0, 0.0, top], axis=1))]
        press = palpate.Indentation(middle, (0.0, 0.0, -3.0), depth=2e-3, tip_radius=4e-3)
        self.assertEqual(list(press.direction), [0.0, 0.0, -1.0])
        moved = palpate.deformed_surface(box, [press], 'liver')
        down = box.vertices[:, 2] - moved.vertices[:, 2]
        self.assertAlmostEqual(down.max(), 2e-3, places=12)
        # R_6 of docs/model.md, section 3: beyond it every vertex keeps its bits.
        contact, first, ratio, _ = palpate.tissue_preset('liver').reach
        reach = contact * np.sqrt(4e-3 * 2e-3) * (1.0 + first * (ratio ** 5 - 1.0) / (ratio - 1.0))
        far = np.linalg.norm(box.vertices - middle, axis=1) > reach
        self.assertTrue(far.any())
        self.assertEqual(moved.vertices[far].tobytes(), box.vertices[far].tobytes())
        self.assertEqual(palpate.deformed_surface(box, [], 'liver').vertices.tobytes(), box.vertices.tobytes())

    def test_is_refused_in_words(self):
        for point, direction, depth, radius, words in (
                ([0.0, 0.0], [0, 0, 1], 1e-3, 1e-3, 'point'), ([np.nan, 0, 0], [0, 0, 1], 1e-3, 1e-3, 'point'),
                ([0, 0, 0], [0, 0, 0], 1e-3, 1e-3, 'direction'), ([0, 0, 0], [0, 0, 1], -1e-3, 1e-3, 'depth'),
                ([0, 0, 0], [0, 0, 1], 1e-3, 0.0, 'tip_radius')):
            with self.assertRaisesRegex(palpate.InputError, words):
                palpate.Indentation(point, direction, depth, radius)


if __name__ == '__main__':
    unittest.main()
