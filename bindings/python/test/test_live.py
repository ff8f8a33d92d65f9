"""Simulations that run in real time while Python looks on."""
import gc
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy as np

import palpate

FAULTY = '''
[organ]
mesh = "gallbladder"
[tool]
mesh = "sphere:5"
[device]
kind = "emulated"
[[device.fault]]
kind = "drop-out"
time_s = 0.2
duration_s = 0.2
'''
TIMES = ('tick_ns', 'late_ns')


def without_times(rows):
    kept = rows.copy()
    for name in TIMES:
        kept[name] = 0
    return kept.tobytes()


def until(true, seconds=20.0):
    """Waits for something that another thread does."""
    end = time.monotonic() + seconds
    while not true():
        if time.monotonic() > end:
            raise AssertionError('waited in vain')
        time.sleep(1e-3)


class WithFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        # The last ticks before a fault go to the user's state folder.
        before = os.environ.get('XDG_STATE_HOME')
        os.environ['XDG_STATE_HOME'] = str(self.folder)
        self.addCleanup(lambda: os.environ.pop('XDG_STATE_HOME') if before is None
                        else os.environ.update(XDG_STATE_HOME=before))


class Run(WithFolder):
    def test_has_the_rows_of_an_offline_run_bit_for_bit(self):
        with palpate.Simulation(task='pull', duration_s=1.0) as simulation:
            self.assertTrue(simulation.wait(60.0))
        rows = simulation.rows()
        self.assertEqual(len(rows), 1000)
        self.assertEqual(simulation.rows_missing, 0)
        self.assertEqual(without_times(rows), without_times(palpate.simulate(task='pull', duration_s=1.0)))
        report = simulation.report()
        self.assertEqual((report['ticks'], report['stopped_early'], report['faults']), (1000, False, []))

    def test_shows_its_newest_tick(self):
        simulation = palpate.Simulation(duration_s=600.0)
        self.assertIsNone(simulation.state())
        with simulation:
            first = simulation.state()
            until(lambda: simulation.state().tick > first.tick + 20)
            state = simulation.state()
            self.assertTrue(state.running)
            self.assertEqual(state.time, state.tick / 1000.0)
            hand = state.hands[0]
            self.assertEqual((len(state.hands), hand.phase, hand.fault), (1, 'approach', ''))
            self.assertEqual((hand.position.shape, hand.orientation.shape, hand.force.shape), ((3,), (4,), (3,)))
            self.assertGreater(hand.distance, 0.0)
        self.assertFalse(simulation.running)
        last = simulation.rows()[-1]
        state = simulation.state()
        self.assertFalse(state.running)
        self.assertEqual((state.tick, state.hands[0].position[2]), (last['tick'], last['tool_z_m']))
        self.assertTrue(simulation.report()['stopped_early'])

    def test_takes_other_tissue_and_noise_and_records_them(self):
        file = self.folder / 'changed.h5'
        with palpate.Simulation(duration_s=600.0, record=file) as simulation:
            soft = palpate.tissue_preset('liver')
            soft.k1 = 7.5
            self.assertEqual(simulation.set_tissue(soft), [])
            self.assertEqual(simulation.set_noise(gain=1e-4, threshold=4e-3), [])
            until(lambda: simulation.state().change == 2)
            self.assertEqual(simulation.tissue.k1, 7.5)
            self.assertEqual(simulation.noise, {'enabled': True, 'gain': 1e-4, 'threshold': 4e-3})
            simulation.set_noise(enabled=False)
            until(lambda: simulation.state().change == 3)
        recording = palpate.read_recording(file)
        self.assertTrue(recording.complete)
        self.assertFalse(recording.offline)
        self.assertEqual(recording.rows.tobytes(), simulation.rows().tobytes())
        self.assertEqual(recording.replay_difference(), '')
        self.assertEqual(np.count_nonzero(recording.rows['events'] & 2), 3)

    def test_leaves_a_bad_change_out(self):
        with palpate.Simulation(duration_s=600.0) as simulation:
            before = simulation.tissue.k1
            bad = palpate.tissue_preset('liver')
            bad.k1 = -1.0
            with self.assertRaisesRegex(palpate.ParameterError, 'k1_N_per_m = -1'):
                simulation.set_tissue(bad)
            with self.assertRaisesRegex(palpate.InputError, 'hearth'):
                simulation.set_tissue('hearth')
            with self.assertRaisesRegex(palpate.ParameterError, 'threshold_mm'):
                simulation.set_noise(threshold=0.0)
            self.assertEqual(simulation.tissue.k1, before)
            self.assertEqual(simulation.state().change, 0)

    def test_tells_a_fault_in_words_and_resets_it(self):
        with palpate.Simulation(scene_text=FAULTY, duration_s=600.0) as simulation:
            until(lambda: simulation.state().hands[0].fault)
            state = simulation.state()
            self.assertIn('could not be read', state.hands[0].fault)
            until(lambda: not np.any(simulation.state().hands[0].force))
            time.sleep(0.3)
            with self.assertRaisesRegex(palpate.InputError, 'hand = 1'):
                simulation.reset_fault(1)

            def reset():
                simulation.reset_fault(0)
                return not simulation.state().hands[0].fault
            until(reset)
        report = simulation.report()
        self.assertEqual(report['faults'][0]['hand'], 0)
        self.assertIn('could not be read', report['faults'][0]['fault'])
        kept = palpate.read_recording(report['fault_recording'])
        self.assertTrue(kept.rows['fault'].any())

    def test_shows_the_surface_that_its_recording_shows(self):
        file = self.folder / 'press.h5'
        # The scripted tool has pressed about 10 mm deep after 3 s.
        with palpate.Simulation(duration_s=3.0, record=file, tool='sphere:5') as simulation:
            self.assertTrue(simulation.wait(60.0))
        surface = simulation.surface()
        self.assertEqual(surface.tick, 2999)
        moved = np.linalg.norm(surface.vertices - simulation.organ.vertices, axis=1)
        self.assertGreater(moved.max(), 1e-3)
        again = palpate.read_recording(file).surface(2999)
        self.assertEqual(again.vertices.tobytes(), surface.vertices.tobytes())
        self.assertTrue((surface.triangles == simulation.organ.triangles).all())
        fine = palpate.read_recording(file).surface(2999, surface_edge=2e-3)
        self.assertGreater(len(fine.vertices), len(surface.vertices))

    def test_keeps_no_more_than_it_was_told(self):
        with palpate.Simulation(duration_s=0.5, keep_s=0.1) as simulation:
            self.assertTrue(simulation.wait(60.0))
        rows = simulation.rows()
        self.assertEqual((len(rows), simulation.rows_missing), (100, 400))
        self.assertEqual(list(rows['tick']), list(range(400, 500)))


class End(WithFolder):
    def test_comes_once_and_in_good_order_for_an_object_that_is_dropped(self):
        file = self.folder / 'dropped.h5'
        simulation = palpate.Simulation(duration_s=600.0, record=file)
        simulation.start()
        del simulation
        gc.collect()
        self.assertTrue(palpate.read_recording(file).complete)

    def test_comes_in_good_order_when_the_program_ends(self):
        file = self.folder / 'left.h5'
        code = ('import palpate, sys\nkept = [palpate.Simulation(duration_s=600.0, record=sys.argv[1])]\n'
                'kept.append(kept)\nkept[0].start()\n')  # a ring, which nobody takes apart
        subprocess.run([sys.executable, '-B', '-c', code, file], check=True, timeout=120)
        self.assertTrue(palpate.read_recording(file).complete)

    def test_comes_with_ctrl_c(self):
        code = ('import palpate\nsimulation = palpate.Simulation(duration_s=600.0)\n'
                'try:\n  with simulation:\n    print("begun", flush=True)\n    simulation.wait()\n'
                'except KeyboardInterrupt:\n  print(simulation.running, simulation.report()["stopped_early"])\n')
        with subprocess.Popen([sys.executable, '-B', '-c', code], stdout=subprocess.PIPE, text=True) as child:
            self.assertEqual(child.stdout.readline(), 'begun\n')
            time.sleep(0.2)
            child.send_signal(signal.SIGINT)
            self.assertEqual(child.communicate(timeout=60)[0], 'False True\n')

    def test_of_a_block_leaves_its_exception(self):
        simulation = palpate.Simulation(duration_s=600.0)
        with self.assertRaises(ZeroDivisionError):
            with simulation:
                1 / 0
        self.assertFalse(simulation.running)

    def test_is_waited_for_without_holding_other_threads_up(self):
        counted = 0
        with palpate.Simulation(duration_s=0.5) as simulation:
            worker = threading.Thread(target=simulation.wait)
            worker.start()
            while worker.is_alive():
                counted += 1
                time.sleep(1e-3)
        self.assertGreater(counted, 3)


class Use(WithFolder):
    def test_is_refused_in_words(self):
        for arguments, words in (({'device': 'mouse'}, 'device mouse: the window'), ({'core': 4000}, 'core = 4000'),
                                 ({'duration_s': 0.0}, 'duration_s = 0'), ({'keep_s': -1.0}, 'keep_s = -1'),
                                 ({'surface_edge': 1e-6}, 'surface_edge'), ({'tissue': 'hearth'}, 'hearth'),
                                 ({'device': 'host'}, 'device host'), ({'organ_motion': ['sneezing']}, 'sneezing')):
            with self.assertRaisesRegex(palpate.InputError, words):
                palpate.Simulation(**arguments)
        with self.assertRaisesRegex(palpate.InputError, 'no-folder'):
            palpate.Simulation(record='no-folder/run.h5').start()

    def test_out_of_order_is_refused(self):
        simulation = palpate.Simulation(duration_s=0.05)
        self.assertFalse(simulation.wait())
        self.assertEqual((len(simulation.rows()), simulation.running), (0, False))
        with self.assertRaisesRegex(RuntimeError, 'not ended'):
            simulation.report()
        simulation.start()
        with self.assertRaisesRegex(RuntimeError, 'started before'):
            simulation.start()
        with self.assertRaisesRegex(palpate.ParameterError, 'timeout_s'):
            simulation.wait(-1.0)
        self.assertTrue(simulation.wait(60.0))
        simulation.stop()
        simulation.stop()

    def test_takes_a_tissue_as_an_object(self):
        tissue = palpate.tissue_preset('kidney')
        self.assertEqual(palpate.simulate(tissue=tissue, duration_s=3.0).tobytes(),
                         palpate.simulate(tissue='kidney', duration_s=3.0).tobytes())
        tissue.k1 = -1.0
        with self.assertRaises(palpate.ParameterError):
            palpate.simulate(tissue=tissue)


if __name__ == '__main__':
    unittest.main()
