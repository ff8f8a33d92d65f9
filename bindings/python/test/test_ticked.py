"""Simulations that Python ticks give the rows of offline runs."""
import gc

import numpy as np
import pytest

import palpate


def scripted(simulation, ticks, first=0):
    return np.stack([simulation.scripted_samples(tick) for tick in range(first, first + ticks)])


def test_ticks_are_those_of_a_whole_run_bit_for_bit():
    rows = palpate.simulate(duration_s=3.0)
    simulation = palpate.TickedSimulation(no_hand=True)
    assert (simulation.hand_count, simulation.rate_Hz, simulation.max_force) == (1, 1000.0, 20.0)
    assert simulation.scripted_ticks > 3000
    samples = scripted(simulation, 3000)
    results = np.concatenate([simulation.tick(samples[:1000]),  # many ticks in one call
                              np.stack([simulation.tick(one) for one in samples[1000:2000]]),  # one tick per call
                              simulation.tick(np.repeat(samples[2000:], 2, axis=0)[::2])])[:, 0]  # not contiguous
    assert results['tissue_force'].max() > 0.0
    for ours, theirs in (('tick', 'tick'), ('time', 'time_s'), ('tissue_force', 'tissue_force_N'),
                         ('noise_force', 'noise_force_N'), ('depth', 'depth_m'), ('distance', 'distance_m'),
                         ('friction', 'friction_N'), ('phase', 'phase'), ('status', 'status')):
        assert (results[ours] == rows[theirs]).all(), ours
    for ours, theirs in (('force', 'force_{}_N'), ('contact', 'contact_{}_m'), ('tool_position', 'tool_{}_m')):
        for axis, letter in enumerate('xyz'):
            assert (results[ours][:, axis] == rows[theirs.format(letter)]).all(), ours


def test_ticks_come_back_the_same_after_a_restart():
    simulation = palpate.TickedSimulation(task='pull', no_hand=True)
    samples = scripted(simulation, 200)
    first = simulation.tick(samples)
    simulation.restart()
    assert simulation.tick(samples).tobytes() == first.tobytes()


def test_ticks_latch_a_fault_until_it_is_reset():
    with palpate.TickedSimulation(no_hand=True) as simulation:
        good = simulation.scripted_samples(0)
        bad = good.copy()
        bad['position'][0] = np.nan
        assert simulation.tick(good)['fault'][0] == 0
        assert simulation.tick(bad)['fault'][0] == 1
        assert simulation.tick(good)['fault'][0] == 1
        simulation.reset_fault(0)
        assert simulation.tick(good)['fault'][0] == 0
        with pytest.raises(palpate.InputError, match='hand = 3'):
            simulation.reset_fault(3)


def test_ticks_of_a_child_process_are_refused_and_its_close_leaves_the_recording(tmp_path, exit_status_of_child):
    file = tmp_path / 'parents.h5'
    simulation = palpate.TickedSimulation(record=file, no_hand=True)
    samples = scripted(simulation, 200)
    simulation.tick(samples[:100])

    def child():
        nonlocal simulation
        with pytest.raises(RuntimeError, match=r'fork\(\)'):
            simulation.tick(samples[100])
        simulation.close()
        del simulation
        gc.collect()
    assert exit_status_of_child(child) == 0
    simulation.tick(samples[100:])
    simulation.close()
    recording = palpate.read_recording(file)
    assert recording.complete
    assert len(recording.rows) == 200


def test_ticks_are_recorded_and_replay(tmp_path):
    file = tmp_path / 'ticked.h5'
    with palpate.TickedSimulation(record=file, tissue=palpate.tissue_preset('kidney'), no_hand=True) as simulation:
        simulation.tick(scripted(simulation, 3000))
        surface = simulation.surface()
        with pytest.raises(RuntimeError, match='while recording'):
            simulation.restart()
    recording = palpate.read_recording(file)
    assert recording.complete
    assert (len(recording.rows), recording.tissue.name) == (3000, 'kidney')
    assert recording.replay_difference() == ''
    again = recording.surface(2999)
    assert again.vertices.tobytes() == surface.vertices.tobytes()
    assert np.abs(surface.vertices - recording.organ.vertices).max() > 1e-3
    with pytest.raises(palpate.InputError, match='tick'):
        recording.surface(3000)


def test_ticks_let_nothing_through_before_a_hand_was_still():
    simulation = palpate.TickedSimulation()
    samples = scripted(simulation, 10)
    assert (simulation.tick(samples)['engagement'] == 0.0).all()
    free = palpate.TickedSimulation(no_hand=True)
    assert (free.tick(scripted(free, 10))['engagement'] == 1.0).all()


def test_ticks_are_refused_in_words():
    simulation = palpate.TickedSimulation()
    with pytest.raises(palpate.InputError, match='one entry a hand'):
        simulation.tick(np.zeros(2, dtype=simulation.samples().dtype))
    with pytest.raises(palpate.InputError, match='type that samples'):
        simulation.tick(np.zeros(1))
    with pytest.raises(TypeError):
        simulation.tick([1.0])
    simulation.close()
    simulation.close()
    with pytest.raises(RuntimeError, match='closed'):
        simulation.samples()
    with pytest.raises(palpate.InputError, match='surface_edge'):
        palpate.TickedSimulation(surface_edge=2.0)


def test_deformed_surface_goes_down_by_the_depth_at_the_contact_and_nowhere_else():
    box = palpate.make_organ('box')
    top = box.vertices[:, 2].max()
    middle = box.vertices[np.argmin(np.linalg.norm(box.vertices - [0.0, 0.0, top], axis=1))]
    press = palpate.Indentation(middle, (0.0, 0.0, -3.0), depth=2e-3, tip_radius=4e-3)
    assert list(press.direction) == [0.0, 0.0, -1.0]
    moved = palpate.deformed_surface(box, [press], 'liver')
    down = box.vertices[:, 2] - moved.vertices[:, 2]
    assert down.max() == pytest.approx(2e-3, abs=1e-8)  # vertices move in single precision
    # Beyond R_6 of docs/model.md, section 3, no vertex changes.
    contact, first, ratio, _ = palpate.tissue_preset('liver').reach
    reach = contact * np.sqrt(4e-3 * 2e-3) * (1.0 + first * (ratio ** 5 - 1.0) / (ratio - 1.0))
    far = np.linalg.norm(box.vertices - middle, axis=1) > reach
    assert far.any()
    assert moved.vertices[far].tobytes() == box.vertices[far].tobytes()
    assert palpate.deformed_surface(box, [], 'liver').vertices.tobytes() == box.vertices.tobytes()


def test_deformed_surface_is_refused_in_words():
    for point, direction, depth, radius, words in (
            ([0.0, 0.0], [0, 0, 1], 1e-3, 1e-3, 'point'), ([np.nan, 0, 0], [0, 0, 1], 1e-3, 1e-3, 'point'),
            ([0, 0, 0], [0, 0, 0], 1e-3, 1e-3, 'direction'), ([0, 0, 0], [0, 0, 1], -1e-3, 1e-3, 'depth'),
            ([0, 0, 0], [0, 0, 1], 1e-3, 0.0, 'tip_radius')):
        with pytest.raises(palpate.InputError, match=words):
            palpate.Indentation(point, direction, depth, radius)
    box = palpate.make_organ('box')
    off = palpate.Indentation([0, 0, 10.0], [0, 0, -1], 1e-3, 1e-3)
    with pytest.raises(palpate.InputError, match=r'indentations\[0\]: its point is .* off the mesh'):
        palpate.deformed_surface(box, [off], 'liver')
    deep = palpate.Indentation([0, 0, box.vertices[:, 2].max()], [0, 0, -1], 4.0, 1e-3)
    with pytest.raises(palpate.InputError, match=r'indentations\[0\]: depth = 4 m'):
        palpate.deformed_surface(box, [deep], 'liver')
