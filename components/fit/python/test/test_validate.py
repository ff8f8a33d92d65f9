"""palpate.validate() gives the results of `palpate validate`."""
import numpy as np
import pytest

import palpate
from measurements import profile_of, side_view, write_columns, write_gray_png

REACH = ('contact_ratio', 'first_bar_ratio', 'bar_ratio', 'weight_ratio')


def test_validate_finds_of_forces_what_the_program_finds(program, tmp_path):
    law = palpate.SmoothSpringLaw(palpate.tissue_preset('liver'), 'press')
    depth = np.linspace(0.0, 9e-3, 40)
    force = 1.05 * law.force_at(depth) + 1e-3 * np.cos(31.0 * np.arange(40.0))
    file = tmp_path / 'liver.csv'
    write_columns(file, ('displacement_mm', 'force_N'), 1e3 * depth, force)
    said = program.json('validate', file, '--tissue', 'liver', '--law', 'smooth', '--against', 'hertz,exponential',
                        '--first-contact-mm', '0.1', '--offset-N', '0.002')['sets'][0]
    found = palpate.validate('liver', forces=palpate.read_specimens(file), law='smooth',
                             against=['hertz', 'exponential'], first_contact=1e-4, offset=0.002)['forces'][0]
    for name in ('name', 'rms', 'max', 'nrmse', 'within_jnd', 'extrapolated_points', 'rows'):
        assert found[name] == said[name], name
    for ours, theirs in zip(found['against'], said['against']):
        for name in ('name', 'parameters', 'rms', 'max', 'nrmse'):
            assert ours[name] == theirs[name], name
        assert ours['evaluation_ns'] > 0.0
    error = found['computed'] - found['measured']
    assert found['rms'] == pytest.approx(np.sqrt(np.mean(error ** 2)), abs=5e-13)


def assert_zeros_are(ours, theirs):
    assert ours['first_contact'] / 1e-3 == theirs['first_contact_mm']
    assert ours['offset'] == theirs['offset_N']
    for name in ('rms', 'max', 'nrmse'):
        assert ours[name] == theirs[name], name


@pytest.mark.parametrize('zeros', ['given', 'fitted'])
def test_validate_takes_the_zeros_that_the_program_takes(program, tmp_path, zeros):
    depth = np.linspace(0.0, 12e-3, 40)
    # Contact begins 0.3 mm late, and the sensor has an offset of 0.02 N.
    force = 0.02 + palpate.spring_law(palpate.tissue_preset('liver')).force_at(np.maximum(0.0, depth - 3e-4))
    file = tmp_path / 'late.csv'
    write_columns(file, ('displacement_mm', 'force_N'), 1e3 * depth, force)
    said = program.json('validate', file, '--tissue', 'liver', '--zeros', zeros)['sets'][0]
    found = palpate.validate('liver', forces=palpate.read_specimens(file), zeros=zeros)['forces'][0]
    for name in ('zeros', 'rms', 'max', 'nrmse', 'within_jnd'):
        assert found[name] == said[name], name
    assert_zeros_are(found['zeros_given'], said['zeros_given'])
    assert_zeros_are(found['zeros_fitted'], said['zeros_fitted'])
    assert found['zeros_fitted']['at_limit'] == said['zeros_fitted']['at_limit']
    assert found['zeros_fitted']['rms'] < 0.1 * found['zeros_given']['rms']
    assert found['rms'] == found[f'zeros_{zeros}']['rms']


def test_validate_draws_the_surface_as_the_program_does(program, tmp_path):
    # A falloff so steep that the law alone would put the surface above the side of the ball.
    tissue = palpate.tissue_preset('liver')
    tissue.reach = (0.4, 0.3, 1.3, 0.5)
    toml, file = tmp_path / 'narrow.toml', tmp_path / 'side.csv'
    toml.write_text(tissue.to_toml())
    r = np.linspace(0.0, 30e-3, 60)
    write_columns(file, ('r_mm', 'u_mm'), 1e3 * r, 1e3 * profile_of((1.0, 0.5, 1.7, 0.6), 4e-3, 5e-3, r))
    asked = ('validate', '--profile', file, '--tissue', toml, '--depth-mm', '4', '--tip-radius-mm', '5')
    profiles = palpate.read_deformations(file)
    found = []
    for flags, arguments in (((), {}), (('--as-drawn',), {'as_drawn': True}),
                             (('--as-drawn', '--surface-radius-mm', '20'), {'as_drawn': True, 'surface_radius': 0.02})):
        said = program.json(*asked, *flags)['sets'][0]
        ours = palpate.validate(tissue, profiles=profiles, depth=4e-3, tip_radius=5e-3, **arguments)['profiles'][0]
        assert (ours['as_drawn'], ours['nrmse']) == (said['as_drawn'], said['nrmse'])
        found.append(ours['nrmse'])
    assert len(set(found)) == 3


def test_validate_finds_of_profiles_what_the_program_finds(program, tmp_path):
    true = (1.0, 0.5, 1.7, 0.6)
    distance = np.linspace(0.0, 30e-3, 60)
    u = profile_of(true, 4e-3, 5e-3, distance)
    file = tmp_path / 'side.csv'
    write_columns(file, ('r_mm', 'u_mm'), 1e3 * distance, 1e3 * u)
    said = program.json('validate', '--profile', file, '--tissue', 'liver', '--depth-mm', '4', '--tip-radius-mm', '5',
                        '--fit-reach')
    found = palpate.validate('liver', profiles=palpate.read_deformations(file), depth=4e-3, tip_radius=5e-3,
                             fit_reach=True)
    for name in REACH:
        assert found['reach'][name] == said['reach'][name]
    assert found['profiles'][0]['nrmse'] == said['sets'][0]['nrmse']
    assert found['profiles'][0]['nrmse'] < 1e-3
    assert found['tissue'].reach == tuple(found['reach'][name] for name in REACH)
    assert found['reach']['depth_exponent_kept'] and said['reach']['depth_exponent_kept']
    assert found['tissue'].depth_exponent == 0.5
    assert 'depth_exponent' not in found['reach']['at_limit']
    by_load = palpate.spring_law(palpate.tissue_preset('liver')).force_at(4e-3)
    deformation = palpate.Deformation('side', distance, u)
    again = palpate.validate('liver', profiles=[deformation], force=float(by_load), tip_radius=5e-3)
    assert again['profiles'][0]['depth'] == pytest.approx(4e-3, abs=5e-10)


def test_validate_finds_the_exponent_of_several_depths_that_the_program_finds(program, tmp_path):
    ratios, exponent = (0.8, 0.5, 1.7, 0.6), 0.4
    distance = np.linspace(0.0, 30e-3, 60)
    profiles, columns = [], []
    for depth in (1e-3, 2e-3, 4e-3):
        # profile_of() computes c sqrt(D/R); the ratio is scaled to give c (D/R)^p.
        scaled = (ratios[0] * (depth / 5e-3) ** (exponent - 0.5), *ratios[1:])
        u = profile_of(scaled, depth, 5e-3, distance)
        profiles.append(palpate.Deformation('side', distance, u))
        columns.append(np.column_stack([np.full(60, 1e3 * depth), 1e3 * distance, 1e3 * u]))
    file = tmp_path / 'side.csv'
    write_columns(file, ('depth_mm', 'r_mm', 'u_mm'), *np.concatenate(columns).T)
    found = palpate.validate('liver', profiles=profiles, depth=[1e-3, 2e-3, 4e-3], tip_radius=5e-3, fit_reach=True)
    assert found['tissue'].depth_exponent == pytest.approx(exponent, abs=1e-3)
    assert not found['reach']['depth_exponent_kept']
    said = program.json('validate', '--profile', file, '--tissue', 'liver', '--tip-radius-mm', '5', '--fit-reach')
    assert said['reach']['depth_exponent'] == pytest.approx(exponent, abs=1e-3)
    assert f'depth_exponent = {found["tissue"].depth_exponent!r}' in found['tissue'].to_toml()


def test_validate_finds_in_photographs_what_the_program_finds(program, tmp_path):
    before, after = tmp_path / 'before.png', tmp_path / 'after.png'
    write_gray_png(before, side_view(0.0, 1e-4, 3e-3))
    write_gray_png(after, side_view(5e-3, 1e-4, 3e-3))
    said = program.json('validate', '--image', before, after, '--scale-mm-per-px', '0.1', '--tissue', 'liver',
                        '--tip-radius-mm', '3', '--depth-mm', '5')
    found = palpate.validate('liver', image=(before, after), pixel=1e-4, tip_radius=3e-3, depth=5e-3)
    assert found['profiles'][0]['rms'] / 1e-3 == said['sets'][0]['rms']
    image = found['image']
    for name in ('confidence', 'tip_hidden', 'within_uncertainty'):
        assert image[name] == said['image'][name], name
    assert list(image['u'] / 1e-3) == [point['u_mm'] for point in said['image']['points']]
    assert found['profiles'][0]['nrmse'] < 0.05


def test_validate_is_refused_in_words():
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
            ({'forces': [specimen], 'loop_period': 0.0}, 'loop_period'),
            ({'forces': [specimen], 'law': 'cubic'}, 'cubic'),
            ({'forces': [specimen], 'against': ['newton']}, 'newton'),
            ({'forces': [specimen], 'zeros': 'free'}, 'zeros = "free": must be given or fitted'),
            ({'forces': [specimen], 'zeros': 'fitted', 'offset': 0.1}, 'one of the two'),
            ({'profiles': [side], 'tip_radius': 5e-3, 'depth': 1e-3, 'zeros': 'fitted'}, 'need forces'),
            ({'profiles': [side], 'tip_radius': 5e-3, 'depth': 1e-3, 'offset': 0.1}, 'need forces'),
            ({'forces': [specimen], 'as_drawn': True}, 'as_drawn'),
            ({'profiles': [side], 'tip_radius': 5e-3, 'depth': 1e-3, 'direction': 'pull', 'as_drawn': True},
             'as_drawn'),
            ({'profiles': [side], 'tip_radius': 5e-3, 'depth': 1e-3, 'surface_radius': 0.1}, 'needs as_drawn'),
            ({'profiles': [side], 'tip_radius': 5e-3, 'depth': 1e-3, 'as_drawn': True, 'surface_radius': -1.0},
             'surface_radius = -1')):
        with pytest.raises(palpate.InputError, match=words):
            palpate.validate('liver', **arguments)
    with pytest.raises(palpate.InputError, match='same length'):
        palpate.Deformation('side', ramp[1:], ramp)
    with pytest.raises(palpate.InputError, match='one row'):
        palpate.Deformation('side', ramp.reshape(4, 5), ramp)
    with pytest.raises(palpate.InputError, match="deformation 'short'"):
        palpate.Deformation('short', ramp[:3], ramp[:3][::-1])
    with pytest.raises(palpate.ParameterError, match='depth'):
        palpate.Deformation('side', ramp, ramp, depth=-1.0)
