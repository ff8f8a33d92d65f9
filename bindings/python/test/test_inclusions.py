"""Inclusions and stiffness maps from Python."""
import numpy as np
import pytest

import palpate

SCENE = {'organ': 'liver', 'tool': 'sphere:5', 'noise': False, 'duration_s': 3.0}


def strongest(**arguments):
    return palpate.simulate(**{**SCENE, **arguments})['tissue_force_N'].max()


def test_a_nodule_under_the_tool_is_harder_than_none_and_than_one_beside():
    plain = strongest()
    over = strongest(inclusions=['nodule'])
    assert over > 1.02 * plain
    with palpate.Simulation(**SCENE, inclusions=['nodule']) as simulation:
        place = simulation.inclusions[0].position
    beside = strongest(inclusions=[palpate.Inclusion('nodule', under=place + [0.03, 0.0, 0.0])])
    assert plain <= beside < plain + 0.3 * (over - plain)


def test_no_inclusion_and_a_ratio_of_one_are_the_uniform_tissue():
    uniform = strongest()
    assert strongest(inclusions=[]) == uniform
    assert strongest(inclusions=[palpate.Inclusion('nodule', stiffness_ratio=1.0)]) == uniform


def test_presets_are_listed_and_their_values_may_be_replaced():
    presets = palpate.inclusion_presets()
    assert sorted(presets) == ['cyst', 'nodule', 'plaque', 'stone', 'vessel']
    assert presets['cyst'].stiffness_ratio < 1.0 < presets['nodule'].stiffness_ratio
    assert presets['nodule'].position is None
    made = palpate.Inclusion('stone', radius=2e-3, name='calculus', visible=False)
    assert (made.name, made.radius, made.visible) == ('calculus', 2e-3, False)
    assert made.stiffness_ratio == presets['stone'].stiffness_ratio


@pytest.mark.parametrize('arguments, words', [
    ({}, 'radius and stiffness_ratio, or a preset'),
    ({'preset': 'lump'}, 'inclusion = "lump": must be'),
    ({'radius': 3e-3, 'stiffness_ratio': 5}, 'needs position or depth'),
    ({'preset': 'nodule', 'position': [0, 0, 0], 'depth': 1e-2}, 'position excludes under and depth'),
    ({'preset': 'nodule', 'position': [0, 0]}, 'position: must have three numbers'),
    ({'preset': 'nodule', 'stiffness_ratio': 101}, 'stiffness_ratio = 101'),
])
def test_invalid_inclusions_are_refused(arguments, words):
    with pytest.raises(palpate.InputError, match=words):
        palpate.Inclusion(**arguments)


def test_an_inclusion_outside_the_organ_is_refused_with_its_index():
    with pytest.raises(palpate.InputError, match=r'inclusions\[1\].*outside the organ'):
        strongest(inclusions=['nodule', palpate.Inclusion('cyst', position=[1, 0, 0])])
    with pytest.raises(palpate.InputError, match='9 are given, must be at most 8'):
        strongest(inclusions=9 * ['nodule'])


def test_a_change_during_a_live_run_takes_effect_and_is_replayed(tmp_path):
    file = tmp_path / 'changed.h5'
    with palpate.Simulation(**SCENE, inclusions=['nodule', 'cyst'], record=file) as simulation:
        before = simulation.inclusions
        assert simulation.set_inclusion('nodule', stiffness_ratio=0.1) == []
        simulation.set_inclusion(1, position=before[1].position - [0.0, 0.0, 1e-3])
        after = simulation.inclusions
        with pytest.raises(palpate.ParameterError, match='stiffness_ratio'):
            simulation.set_inclusion(0, stiffness_ratio=0.0)
        with pytest.raises(palpate.InputError, match='must be nodule or cyst'):
            simulation.set_inclusion('stone', stiffness_ratio=3.0)
        with pytest.raises(palpate.InputError, match='less than the 2 inclusions'):
            simulation.set_inclusion(2, stiffness_ratio=3.0)
        assert simulation.wait(60.0)
        assert simulation.state().change == 2
    assert [one.stiffness_ratio for one in after] == [0.1, before[1].stiffness_ratio]
    np.testing.assert_allclose(after[1].position, before[1].position - [0.0, 0.0, 1e-3])
    assert simulation.rows()['tissue_force_N'].max() < 0.9 * strongest(inclusions=['nodule', 'cyst'])
    assert palpate.read_recording(file).replay_difference() == ''


def test_a_ticked_simulation_takes_a_change_at_the_next_tick(tmp_path):
    file = tmp_path / 'ticked.h5'
    scene = {'organ': 'liver', 'tool': 'sphere:5', 'noise': False, 'inclusions': ['nodule'], 'no_hand': True}

    def force(ratio, **more):
        with palpate.TickedSimulation(**scene, **more) as simulation:
            for tick in range(2400):
                if ratio and tick == 2000:
                    simulation.set_inclusion('nodule', stiffness_ratio=ratio)
                result = simulation.tick(simulation.scripted_samples(tick))
            assert not ratio or simulation.inclusions[0].stiffness_ratio == ratio
            return result['tissue_force'][0]

    assert force(0.1, record=file) < 0.9 * force(None)
    assert palpate.read_recording(file).replay_difference() == ''


def test_a_stiffness_map_comes_from_an_array_or_a_file(tmp_path):
    vertices = palpate.make_organ('gallbladder').vertices
    top = vertices[vertices[:, 2].argmax()]

    def press(**arguments):
        return strongest(organ='gallbladder', **arguments)

    double = press(stiffness_map=[[*top, 2.0]])
    assert double == pytest.approx(2.0 * press(), rel=0.02)
    file = tmp_path / 'map.csv'
    file.write_text('x_mm,y_mm,z_mm,factor\n' + ','.join(repr(1e3 * x) for x in top) + ',2\n')
    assert press(stiffness_map=file) == pytest.approx(double, rel=1e-6)
    with pytest.raises(palpate.ParameterError, match=r'stiffness_map\[0\] = 0'):
        press(stiffness_map=[[0, 0, 0, 0]])
    with pytest.raises(palpate.InputError, match='shape'):
        press(stiffness_map=[[0, 0, 0]])


def test_a_press_has_no_search_to_score(tmp_path):
    palpate.simulate(duration_s=0.2, record=tmp_path / 'press.h5')
    with pytest.raises(palpate.InputError) as refused:
        palpate.read_recording(tmp_path / 'press.h5').score()
    assert str(refused.value) == ("score(): no search in it: its task is press and it has no lump; task='palpate' makes a search")


def test_a_recorded_search_is_scored_and_mapped(tmp_path):
    file = tmp_path / 'search.h5'
    palpate.simulate(task='palpate', seed=3, duration_s=20.0, noise=False, record=file)
    recording = palpate.read_recording(file)
    score = recording.score()
    assert score['lumps'] == score['missed'] == 3 and score['found'] == 0
    assert 0.02 < score['coverage'] < 0.2
    felt = recording.felt_map()
    touched = ~np.isnan(felt['felt_factor'])
    assert felt['points'].shape == (touched.size, 3)
    assert abs(np.median(felt['felt_factor'][touched]) - 1.0) < 0.02
    assert (felt['depth'][touched] >= 1e-3).all()
