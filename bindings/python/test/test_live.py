"""Simulations in real time, controlled from Python."""
import gc
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

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
    """Waits until `true` returns true, because another thread works meanwhile."""
    end = time.monotonic() + seconds
    while not true():
        if time.monotonic() > end:
            raise AssertionError('waited in vain')
        time.sleep(1e-3)


def test_run_has_the_rows_of_an_offline_run_bit_for_bit():
    with palpate.Simulation(task='pull', duration_s=1.0) as simulation:
        assert simulation.wait(60.0)
    rows = simulation.rows()
    assert len(rows) == 1000
    assert simulation.rows_missing == 0
    assert without_times(rows) == without_times(palpate.simulate(task='pull', duration_s=1.0))
    report = simulation.report()
    assert (report['ticks'], report['stopped_early'], report['faults']) == (1000, False, [])
    assert not report['polled']


def test_polled_run_has_the_rows_of_an_offline_one():
    with palpate.Simulation(task='pull', duration_s=0.5, poll=True) as simulation:
        assert simulation.wait(60.0)
    assert without_times(simulation.rows()) == without_times(palpate.simulate(task='pull', duration_s=0.5))
    assert simulation.report()['polled']


def test_run_shows_its_newest_tick():
    simulation = palpate.Simulation(duration_s=600.0)
    assert simulation.state() is None
    with simulation:
        first = simulation.state()
        until(lambda: simulation.state().tick > first.tick + 20)
        state = simulation.state()
        assert state.running
        assert state.time == state.tick / 1000.0
        hand = state.hands[0]
        assert (len(state.hands), hand.phase, hand.fault) == (1, 'approach', '')
        assert (hand.position.shape, hand.orientation.shape, hand.force.shape) == ((3,), (4,), (3,))
        assert hand.distance > 0.0
    assert not simulation.running
    last = simulation.rows()[-1]
    state = simulation.state()
    assert not state.running
    assert (state.tick, state.hands[0].position[2]) == (last['tick'], last['tool_z_m'])
    assert simulation.report()['stopped_early']


def test_run_takes_other_tissue_and_noise_and_records_them(tmp_path):
    file = tmp_path / 'changed.h5'
    with palpate.Simulation(duration_s=600.0, record=file) as simulation:
        soft = palpate.tissue_preset('liver')
        soft.k1 = 7.5
        assert simulation.set_tissue(soft) == []
        assert simulation.set_noise(gain=1e-4, threshold=4e-3) == []
        until(lambda: simulation.state().change == 2)
        assert simulation.tissue.k1 == 7.5
        assert simulation.noise == {'enabled': True, 'gain': 1e-4, 'threshold': 4e-3}
        simulation.set_noise(enabled=False)
        until(lambda: simulation.state().change == 3)
    recording = palpate.read_recording(file)
    assert recording.complete
    assert not recording.offline
    assert recording.rows.tobytes() == simulation.rows().tobytes()
    assert recording.replay_difference() == ''
    assert np.count_nonzero(recording.rows['events'] & 2) == 3


def test_run_leaves_a_bad_change_out():
    with palpate.Simulation(duration_s=600.0) as simulation:
        before = simulation.tissue.k1
        bad = palpate.tissue_preset('liver')
        bad.k1 = -1.0
        with pytest.raises(palpate.ParameterError, match='k1_N_per_m = -1'):
            simulation.set_tissue(bad)
        with pytest.raises(palpate.InputError, match='hearth'):
            simulation.set_tissue('hearth')
        with pytest.raises(palpate.ParameterError, match='threshold_mm'):
            simulation.set_noise(threshold=0.0)
        assert simulation.tissue.k1 == before
        assert simulation.state().change == 0


def test_run_tells_a_fault_in_words_and_resets_it():
    with palpate.Simulation(scene_text=FAULTY, duration_s=600.0) as simulation:
        until(lambda: simulation.state().hands[0].fault)
        state = simulation.state()
        assert 'could not be read' in state.hands[0].fault
        until(lambda: not np.any(simulation.state().hands[0].force))
        time.sleep(0.3)
        with pytest.raises(palpate.InputError, match='hand = 1'):
            simulation.reset_fault(1)

        def reset():
            simulation.reset_fault(0)
            return not simulation.state().hands[0].fault
        until(reset)
    report = simulation.report()
    assert report['faults'][0]['hand'] == 0
    assert 'could not be read' in report['faults'][0]['fault']
    kept = palpate.read_recording(report['fault_recording'])
    assert kept.rows['fault'].any()


def test_run_shows_the_surface_that_its_recording_shows(tmp_path):
    file = tmp_path / 'press.h5'
    # The scripted tool is about 10 mm deep after 3 s.
    with palpate.Simulation(duration_s=3.0, record=file, tool='sphere:5') as simulation:
        assert simulation.wait(60.0)
    surface = simulation.surface()
    assert surface.tick == 2999
    moved = np.linalg.norm(surface.vertices - simulation.organ.vertices, axis=1)
    assert moved.max() > 1e-3
    again = palpate.read_recording(file).surface(2999)
    assert again.vertices.tobytes() == surface.vertices.tobytes()
    assert (surface.triangles == simulation.organ.triangles).all()
    fine = palpate.read_recording(file).surface(2999, surface_edge=2e-3)
    assert len(fine.vertices) > len(surface.vertices)


def test_run_keeps_no_more_than_it_was_told():
    with palpate.Simulation(duration_s=0.5, keep_s=0.1) as simulation:
        assert simulation.wait(60.0)
    rows = simulation.rows()
    assert (len(rows), simulation.rows_missing) == (100, 400)
    assert list(rows['tick']) == list(range(400, 500))


def test_end_comes_once_and_in_good_order_for_an_object_that_is_dropped(tmp_path):
    file = tmp_path / 'dropped.h5'
    simulation = palpate.Simulation(duration_s=600.0, record=file)
    simulation.start()
    del simulation
    gc.collect()
    assert palpate.read_recording(file).complete


def test_end_comes_in_good_order_when_the_program_ends(tmp_path):
    file = tmp_path / 'left.h5'
    code = ('import palpate, sys\nkept = [palpate.Simulation(duration_s=600.0, record=sys.argv[1])]\n'
            'kept.append(kept)\nkept[0].start()\n')  # a reference cycle, which is never collected
    subprocess.run([sys.executable, '-B', '-c', code, file], check=True, timeout=120)
    assert palpate.read_recording(file).complete


def test_end_comes_with_ctrl_c():
    code = ('import palpate\nsimulation = palpate.Simulation(duration_s=600.0)\n'
            'try:\n  with simulation:\n    print("begun", flush=True)\n    simulation.wait()\n'
            'except KeyboardInterrupt:\n  print(simulation.running, simulation.report()["stopped_early"])\n')
    with subprocess.Popen([sys.executable, '-B', '-c', code], stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout.readline() == 'begun\n'
        time.sleep(0.2)
        child.send_signal(signal.SIGINT)
        assert child.communicate(timeout=60)[0] == 'False True\n'


def test_end_of_a_child_process_leaves_the_run_of_its_parent(tmp_path, exit_status_of_child):
    file = tmp_path / 'parents.h5'
    simulation = palpate.Simulation(duration_s=600.0, record=file)
    simulation.start()

    def child():
        nonlocal simulation
        with pytest.raises(RuntimeError, match=r'fork\(\)'):
            simulation.set_noise(enabled=False)
        simulation.stop()
        del simulation
        gc.collect()
    assert exit_status_of_child(child) == 0
    assert simulation.running
    ticks = simulation.state().tick
    until(lambda: simulation.state().tick > ticks + 10)
    simulation.stop()
    assert palpate.read_recording(file).complete


def test_end_of_a_block_leaves_its_exception():
    simulation = palpate.Simulation(duration_s=600.0)
    with pytest.raises(ZeroDivisionError):
        with simulation:
            1 / 0
    assert not simulation.running


def test_end_is_waited_for_without_holding_other_threads_up():
    counted = 0
    with palpate.Simulation(duration_s=0.5) as simulation:
        worker = threading.Thread(target=simulation.wait)
        worker.start()
        while worker.is_alive():
            counted += 1
            time.sleep(1e-3)
    assert counted > 3


def test_use_is_refused_in_words():
    for arguments, words in (({'device': 'mouse'}, 'device mouse: needs the window'), ({'core': 4000}, 'core = 4000'),
                             ({'duration_s': 0.0}, 'duration_s = 0'), ({'keep_s': -1.0}, 'keep_s = -1'),
                             ({'surface_edge': 1e-6}, 'surface_edge'), ({'tissue': 'hearth'}, 'hearth'),
                             ({'device': 'host'}, 'device host'), ({'organ_motion': ['sneezing']}, 'sneezing')):
        with pytest.raises(palpate.InputError, match=words):
            palpate.Simulation(**arguments)
    with pytest.raises(palpate.InputError, match='no-folder'):
        palpate.Simulation(record='no-folder/run.h5').start()


def test_use_out_of_order_is_refused():
    simulation = palpate.Simulation(duration_s=0.05)
    assert not simulation.wait()
    assert (len(simulation.rows()), simulation.running) == (0, False)
    with pytest.raises(RuntimeError, match='not ended'):
        simulation.report()
    simulation.start()
    with pytest.raises(RuntimeError, match='started before'):
        simulation.start()
    with pytest.raises(palpate.ParameterError, match='timeout_s'):
        simulation.wait(-1.0)
    assert simulation.wait(60.0)
    simulation.stop()
    simulation.stop()


def test_use_takes_a_tissue_as_an_object():
    tissue = palpate.tissue_preset('kidney')
    by_name = palpate.simulate(tissue='kidney', duration_s=3.0)
    assert palpate.simulate(tissue=tissue, duration_s=3.0).tobytes() == by_name.tobytes()
    tissue.k1 = -1.0
    with pytest.raises(palpate.ParameterError):
        palpate.simulate(tissue=tissue)


def test_run_takes_timed_commanded_forces_and_records_them(tmp_path):
    file = tmp_path / 'trial.h5'
    with palpate.Simulation(duration_s=600.0, record=file) as simulation:
        first = simulation.state().tick + 1000
        simulation.set_noise(enabled=False, not_before_tick=first)
        simulation.set_stimulus(0.02, ramp_ms=20, interval=1, not_before_tick=first + 50)
        simulation.set_stimulus(0.0, not_before_tick=first + 150)
        with pytest.raises(palpate.ParameterError, match='force_N = 1000'):
            simulation.set_stimulus(1000)
        with pytest.raises(palpate.ParameterError, match='ramp_ms = 5'):
            simulation.set_stimulus(0.1, ramp_ms=5)
        with pytest.raises(palpate.ParameterError, match='interval = 3'):
            simulation.set_stimulus(0.1, interval=3)
        until(lambda: simulation.state().change == 3)
        until(lambda: simulation.state().tick > first + 250)
        assert simulation.state().hands[0].stimulus_force == 0.0
    recording = palpate.read_recording(file)
    force = recording.rows['stimulus_force_N']
    events = recording.rows['events']
    assert np.flatnonzero(events & 2).tolist() == [first, first + 50, first + 150]
    assert np.flatnonzero(events & 8).tolist() == [first + 50]
    assert np.flatnonzero(events & 16).tolist() == [first + 150]
    assert np.all(force[first + 69:first + 150] == 0.02)
    assert np.count_nonzero(force) == 149
    assert recording.replay_difference() == ''
