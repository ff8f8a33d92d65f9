"""Many hands at once give what each gives alone."""
import functools

import numpy as np
import pytest

import palpate

TICKS = 1500


def poses_of(samples):
    return np.concatenate([samples['position'], samples['orientation']], axis=-1)


@functools.cache
def press():
    """Samples (1, ticks) of the default press."""
    simulation = palpate.TickedSimulation(no_hand=True)
    return np.stack([simulation.scripted_samples(tick) for tick in range(TICKS)], axis=1)


def presses(hands=5):
    """A press for each hand, beside the others: samples (hands, ticks) that begin outside the organ."""
    samples = np.repeat(press(), hands, axis=0)
    samples['velocity'] = 0.0
    samples['position'][:, :, 0] += 1e-3 * np.arange(hands)[:, np.newaxis]
    samples['position'][:, :, 2] -= 6e-3 * np.linspace(0.0, 1.0, TICKS)
    return samples


def alone(samples, **scene):
    """Results (hands, ticks) of one TickedSimulation per hand."""
    return np.stack([palpate.TickedSimulation(no_hand=True, **scene).tick(one[:, np.newaxis])[:, 0] for one in samples])


def expect_same_bits(batch, found, results):
    for name, array in zip(('force', 'torque', 'depth'), found):
        assert array.tobytes() == np.ascontiguousarray(results[name]).tobytes(), name
    for name in ('status', 'fault'):
        assert (getattr(batch, name) == results[name]).all(), name


@pytest.mark.parametrize('jobs', [1, 3, None])
def test_every_hand_of_a_batch_has_the_bits_of_a_run_of_its_own(jobs):
    samples = presses()
    results = alone(samples)
    assert (results['depth'].max(axis=1) > 2e-3).all() and len(set(results['tissue_force'][:, -1])) == 5
    batch = palpate.Batch(None, 5, jobs=jobs)
    expect_same_bits(batch, batch.step(poses_of(samples)), results)


def test_ticks_of_a_batch_one_by_one_are_those_of_one_call():
    samples = presses()
    results = alone(samples)
    batch = palpate.Batch(None, 5)
    for tick in range(TICKS):
        found = batch.step(poses_of(samples[:, tick]))
        if tick % 250 == 249:
            expect_same_bits(batch, found, results[:, tick])


def test_jaws_of_a_batch_close_as_those_of_a_run():
    simulation = palpate.TickedSimulation(task='pull', no_hand=True)
    samples = np.stack([simulation.scripted_samples(tick) for tick in range(simulation.scripted_ticks)], axis=1)
    samples['velocity'] = 0.0
    results = alone(samples, task='pull')
    assert (results['phase'] == 2).any()
    batch = palpate.Batch(None, 1, task='pull')
    expect_same_bits(batch, batch.step(poses_of(samples), samples['gripper']), results)


def test_arrays_of_a_batch_are_the_same_memory_until_the_number_of_ticks_changes():
    poses = poses_of(presses())
    batch = palpate.Batch(None, 5)
    many = batch.step(poses)
    kept = [array.copy() for array in many]
    one = batch.step(poses[:, -1])
    assert [array.shape for array in one] == [(5, 3), (5, 3), (5,)]
    assert all((array == copy).all() for array, copy in zip(many, kept))
    assert all(np.shares_memory(new, old) for new, old in zip(batch.step(poses[:, -2]), one))


def test_out_receives_what_the_arrays_of_a_batch_would_get():
    poses = poses_of(presses())
    batch = palpate.Batch(None, 5)
    out = np.ones((5, TICKS, 3)), np.ones((5, TICKS, 3)), np.ones((5, TICKS))
    given = batch.step(poses, out=out)
    assert all(np.shares_memory(new, old) for new, old in zip(given, out))
    again = palpate.Batch(None, 5).step(poses)
    assert all(new.tobytes() == old.tobytes() for new, old in zip(out, again))


@pytest.mark.parametrize('spoil', [lambda force: force.astype(np.float32), lambda force: force[:4], lambda force: force.tolist(),
                                   lambda force: np.asfortranarray(force), lambda force: np.broadcast_to(0.0, (5, 3))])
def test_an_out_that_a_batch_cannot_write_to_is_refused(spoil):
    batch = palpate.Batch(None, 5)
    out = spoil(np.zeros((5, 3))), np.zeros((5, 3)), np.zeros(5)
    with pytest.raises(palpate.InputError, match=r'out: force must be .* with shape \(5, 3\)'):
        batch.step(poses_of(presses()[:, 0]), out=out)


@pytest.mark.parametrize('change, words', [
    (lambda poses: poses[:4], r'poses: has shape \(4, 9, 7\), must be \(5, 7\) or \(5, ticks, 7\)'),
    (lambda poses: poses[:, :, :6], r'poses: has shape \(5, 9, 6\)'),
    (lambda poses: poses[0, 0], r'poses: has shape \(7,\)'),
    (lambda poses: poses[np.newaxis], r'poses: has shape \(1, 5, 9, 7\)')])
def test_poses_of_a_wrong_shape_are_refused_with_both_shapes(change, words):
    with pytest.raises(palpate.InputError, match=words):
        palpate.Batch(None, 5).step(change(poses_of(presses()[:, :9])))


@pytest.mark.parametrize('number, value, words', [
    (2, np.nan, r'poses\[3, 8, 2\] = nan: must be finite'), (6, np.inf, r'poses\[3, 8, 6\] = inf: must be finite'),
    (3, 0.0, r'poses\[3, 8, 3:7\] = \[0, 0, 0, 0\]: must be a quaternion w x y z of length 1, has 0')])
def test_a_bad_pose_is_refused_with_its_index_and_value_before_any_hand_moves(number, value, words):
    poses = poses_of(presses())
    poses[:, :, 3:] = [1.0, 0.0, 0.0, 0.0]
    batch = palpate.Batch(None, 5)
    bad = poses.copy()
    bad[3, 8, number] = value
    with pytest.raises(palpate.InputError, match=words):
        batch.step(bad)
    one = batch.step(poses)
    assert all(new.tobytes() == old.tobytes() for new, old in zip(one, palpate.Batch(None, 5).step(poses)))
    with pytest.raises(palpate.InputError, match=words.replace(', 8', '')):
        batch.step(bad[:, 8])
    with pytest.raises(palpate.InputError, match=words.replace(', 8', ', 0')):
        batch.step(bad[:, 8:9])


@pytest.mark.parametrize('value', [np.nan, -0.1, 1.5])
def test_a_jaw_opening_out_of_range_is_refused_with_its_index_and_value(value):
    batch = palpate.Batch(None, 5)
    opening = np.zeros(5)
    opening[4] = value
    with pytest.raises(palpate.InputError, match=rf'gripper\[4\] = {value}: must be 0 \(closed\) to 1 \(open\)'):
        batch.step(poses_of(presses()[:, 0]), opening)
    with pytest.raises(palpate.InputError, match=r'gripper: has shape \(4,\), must be \(5,\)'):
        batch.step(poses_of(presses()[:, 0]), opening[:4])


def test_a_fault_takes_the_force_of_its_own_hand_until_it_is_reset():
    poses = poses_of(presses())
    batch = palpate.Batch(None, 5, noise=False)
    good = palpate.Batch(None, 5, noise=False)
    batch.step(poses)
    good.step(poses)
    away = poses[:, -1:].repeat(20, axis=1)
    away[2, 0, 0] = 200.0  # m: no device is there
    force = batch.step(away)[0]
    expected = good.step(poses[:, -1:].repeat(20, axis=1))[0]
    assert list(batch.fault[:, -1]) == [0, 0, 2, 0, 0]
    assert (force[2, 10:] == 0.0).all() and np.linalg.norm(expected[2, -1]) > 0.05
    others = [0, 1, 3, 4]
    assert force[others].tobytes() == expected[others].tobytes()
    batch.reset_fault([2])
    assert np.linalg.norm(batch.step(poses[:, -1])[0][2]) > 0.05
    assert not batch.fault.any()


def test_restart_takes_only_the_hands_that_are_named_back_before_their_first_tick():
    poses = poses_of(presses())
    first = [array.copy() for array in palpate.Batch(None, 5).step(poses)]
    batch = palpate.Batch(None, 5)
    batch.step(poses)
    batch.restart([0, 3])
    again = batch.step(poses)
    for new, old in zip(again, first):
        assert new[[0, 3]].tobytes() == old[[0, 3]].tobytes()
    assert (again[0][[1, 2, 4]] != first[0][[1, 2, 4]]).any(axis=(1, 2)).all()  # the touch noise of later ticks
    batch.restart(np.array([True, False, False, True, False]))
    assert batch.step(poses)[0][[0, 3]].tobytes() == first[0][[0, 3]].tobytes()
    batch.restart()
    assert all(new.tobytes() == old.tobytes() for new, old in zip(batch.step(poses), first))
    for hands, words in (([5], r'hands\[0\] = 5: must be 0 to 4'), ([0, -1], r'hands\[1\] = -1'), ([True], 'a mask of 5'),
                         ([1.0], 'whole numbers'), (1, 'whole numbers'), ('one', 'whole numbers')):
        with pytest.raises(palpate.InputError, match=words):
            batch.restart(hands)


@pytest.mark.parametrize('support', [[], ['bed:0,0,-1']])
def test_displacement_of_a_batch_is_that_of_the_surface_of_each_hand(support):
    samples = presses(3)
    batch = palpate.Batch(None, 3, surface_edge=4e-3, organ_support=support)
    batch.step(poses_of(samples))
    rest = batch.surface.vertices
    moved = batch.displacement()
    for hand in range(3):
        simulation = palpate.TickedSimulation(no_hand=True, surface_edge=4e-3, organ_support=support)
        simulation.tick(samples[hand][:, np.newaxis])
        assert moved[hand].tobytes() == (simulation.surface().vertices - rest).tobytes()
    assert (np.linalg.norm(moved, axis=2).max(axis=1) > 2e-3).all()
    assert batch.displacement([7, 2]).tobytes() == moved[:, [7, 2]].tobytes()
    with pytest.raises(palpate.InputError, match=r'points\[1\] = '):
        batch.displacement([0, len(rest)])


def areas(mesh):
    """Of the vertices: a third of each triangle's."""
    corners = mesh.vertices[mesh.triangles]
    each = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 6.0
    return np.bincount(mesh.triangles.ravel(), np.repeat(each, 3), len(mesh.vertices))


def test_pressure_of_a_ball_adds_up_to_its_force_and_is_hertzs_in_the_middle():
    batch = palpate.Batch(None, 1, organ='box', tool=['sphere:5'], tissue='liver', noise=False, surface_edge=1e-3)
    points = batch.surface.vertices
    poses = np.zeros((1, 1000, 7))
    poses[:, :, 2], poses[:, :, 3] = points[:, 2].max() + 0.005 + np.linspace(0.005, -0.004, 1000), 1.0
    force, _, depth = batch.step(poses)
    pressure = batch.pressure()[0]
    assert pressure @ areas(batch.surface) == pytest.approx(force[0, -1, 2], rel=0.01)
    radii = np.linspace(0.0, 0.005, 100_001)[:-1]
    radius = radii[np.searchsorted(radii * np.arctanh(radii / 0.005), depth[0, -1])]    # Sneddon
    assert pressure.max() == pytest.approx(1.5 * force[0, -1, 2] / (np.pi * radius ** 2), rel=0.01)    # a ball of triangles
    distance = np.linalg.norm(points - [0.0, 0.0, points[:, 2].max()], axis=1)
    assert (pressure[distance < 0.99 * radius] > 0.0).sum() > 20 and not pressure[distance > 1.01 * radius].any()
    middle = int(pressure.argmax())
    assert batch.pressure([middle, 0]).tolist() == [[pressure[middle], 0.0]]
    with pytest.raises(palpate.InputError, match=r'points\[1\] = '):
        batch.pressure([0, len(points)])


def test_pressure_is_negative_where_jaws_pull_and_none_away_from_contact():
    simulation = palpate.TickedSimulation(no_hand=True, task='pull', noise=False)
    samples = np.stack([simulation.scripted_samples(tick) for tick in range(2500)], axis=1)
    batch = palpate.Batch(None, 1, task='pull', noise=False, surface_edge=1e-3)
    assert not batch.pressure().any()
    force, _, _ = batch.step(poses_of(samples), samples['gripper'])
    pressure = batch.pressure()[0]
    assert pressure.min() < 0.0 and pressure.max() == 0.0
    assert -pressure @ areas(batch.surface) == pytest.approx(np.linalg.norm(force[0, -1]), rel=0.1)


def test_a_batch_of_a_child_process_is_refused(exit_status_of_child):
    batch = palpate.Batch(None, 2)

    def child():
        with pytest.raises(RuntimeError, match=r'fork\(\)'):
            batch.step(poses_of(presses(2)[:, 0]))
    assert exit_status_of_child(child) == 0


@pytest.mark.parametrize('arguments, words', [
    ({'n': 0}, 'n = 0: must be 1 to'), ({'jobs': 0}, 'jobs = 0: must be 1 to'), ({'surface_edge': 2.0}, 'surface_edge'),
    ({'scene_text': '[organ]\nmesh = "box"\n[[tool]]\nmesh = "sphere:2"\n[[tool]]\nmesh = "sphere:3"\n' + 2 * '[[device]]\nkind = "scripted"\n'},
     'the scene has 2 hands: must have one')])
def test_arguments_of_a_batch_are_refused_in_words(arguments, words):
    with pytest.raises(palpate.InputError, match=words):
        palpate.Batch(**arguments)
