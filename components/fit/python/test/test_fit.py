"""palpate.fit() gives the results of `palpate fit`."""
import xml.etree.ElementTree

import numpy as np
import pytest

import palpate
from example_runs import run  # noqa: F401  a fixture
from example_runs import expect_drawn
from measurements import measured_files, write_columns


LAW_PARAMETERS = ('k1_N_per_m', 'beta', 'q', 'limit_mm')


def assert_fit_is(ours, said, intervals):
    for name in LAW_PARAMETERS:
        value, low, high = ours['parameters'][name]
        assert value == said['parameters'][name], name
        assert [low, high] == intervals[name], name
    for name in ('rms_N', 'nrmse', 'points', 'warnings'):
        assert ours[name] == said[name], name


@pytest.mark.parametrize('law', ['layered', 'smooth'])
def test_fit_is_the_programs(program, tmp_path, law):
    true = palpate.tissue_preset('liver')
    kind = palpate.LayeredSpringLaw if law == 'layered' else palpate.SmoothSpringLaw
    files = []
    for n, stiffer in enumerate((1.0, 1.1)):
        depth = np.linspace(0.0, 12e-3, 60)
        force = stiffer * kind(true, 'press').force_at(depth) + 2e-3 * np.sin((37.0 + n) * np.arange(60.0))
        files.append(tmp_path / f'liver-{n}.csv')
        write_columns(files[-1], ('displacement_mm', 'force_N'), 1e3 * depth, force)
    toml = tmp_path / 'fitted.toml'
    said = program.json('fit', *files, '--direction', 'press', '--law', law, '--out', toml)
    found = palpate.fit([one for file in files for one in palpate.read_specimens(file)], direction='press', law=law)
    for ours, theirs in zip(found['specimens'], said['specimens'], strict=True):
        assert (ours['name'], ours['layers'], ours['layers_reached']) == (
            theirs['name'], theirs['layers'], theirs['layers_reached'])
        assert ours['leave_out_nrmse'] == theirs['leave_out_nrmse']
        assert_fit_is(ours, theirs, theirs['interval_95'])
        assert len(ours['fitted']) == len(ours['measured'])
    assert_fit_is(found['pooled'], said['pooled'], said['pooled']['interval_95'])
    assert found['pooled']['tissue'].name == 'fitted'
    assert found['pooled']['tissue'].to_toml() == toml.read_text()


def test_a_fit_with_an_error_over_a_fifth_of_the_force_range_gives_no_tissue():
    rows = np.arange(30)
    bump = palpate.Specimen('bump', 1e-3 * rows, np.where((rows >= 15) & (rows < 20), 1.0, 0.0))
    pooled = palpate.fit([bump])['pooled']
    assert pooled['nrmse'] > 0.2
    assert pooled['tissue'] is None


def test_curves_and_profiles_with_masked_values_are_refused():
    ramp = np.ma.array(np.linspace(0.0, 1e-2, 20), mask=np.arange(20) == 7)
    for make in (lambda: palpate.Specimen('masked', ramp.data, 10 * ramp),
                 lambda: palpate.Specimen('masked', list(ramp), 10 * ramp.data),
                 lambda: palpate.Deformation('masked', ramp, ramp.data[::-1])):
        with pytest.raises(palpate.InputError):
            make()
    plain = palpate.Specimen('none masked', np.ma.array(ramp.data), 10 * ramp.data)
    assert np.array_equal(plain.displacement, ramp.data)


def test_fit_refuses_what_cannot_be_fitted():
    with pytest.raises(palpate.InputError, match='at least 10'):
        palpate.Specimen('few', [0.0, 1e-3], [0.0, 0.1])
    ramp = np.linspace(0.0, 1e-2, 20)
    with pytest.raises(palpate.InputError, match='same length'):
        palpate.Specimen('uneven', ramp[1:], ramp)
    with pytest.raises(palpate.InputError, match='one row'):
        palpate.Specimen('square', ramp.reshape(4, 5), ramp)
    specimen = palpate.Specimen('ramp', ramp, 10.0 * ramp)
    with pytest.raises(palpate.InputError, match='at least one'):
        palpate.fit([])
    for arguments, words in (({'loop_period': 0.0}, 'loop_period'), ({'t1': -1.0}, 't1'),
                             ({'bootstrap': -1}, 'bootstrap'), ({'law': 'cubic'}, 'cubic')):
        with pytest.raises(palpate.InputError, match=words):
            palpate.fit([specimen], **arguments)


@pytest.mark.parametrize('name', ['fit_specimens', 'validate_tissue'])
def test_example_draws(run, name, tmp_path):  # noqa: F811
    expect_drawn(run, name, tmp_path)


def test_several_files_of_specimens_are_read_at_once(tmp_path):
    files = measured_files(tmp_path)
    assert [one.name for one in palpate.read_specimens(files)] == ['soft', 'stiff']
    assert [one.name for one in palpate.read_specimens([str(files[1])])] == ['stiff']
    found = palpate.fit(palpate.read_specimens(files), law='smooth')
    lines = repr(found).splitlines()
    assert [line.split()[0] for line in lines[:4]] == ['name', 'soft', 'stiff', 'pooled']
    value, low, high = found['pooled']['parameters']['k1_N_per_m']
    assert f'{value:.3g} ({low:.3g} to {high:.3g})' in lines[3]
    frame = [{**row} for row in found.table()]
    assert (frame[2]['k1_N_per_m'], frame[2]['k1_N_per_m_low']) == (value, low)
    page = xml.etree.ElementTree.fromstring(found._repr_html_())
    assert len(list(page.iter('{http://www.w3.org/2000/svg}svg'))) == 2


def test_fit_writes_the_programs_tissue(command, program, tmp_path):
    files = measured_files(tmp_path)
    program('fit', *files, '--law', 'smooth', '--direction', 'press', '--out', tmp_path / 'mine.toml')
    wanted = (tmp_path / 'mine.toml').read_text()
    (tmp_path / 'mine.toml').unlink()
    done = command('fit', *files, '--law', 'smooth', '--out', 'mine.toml')
    assert (done.returncode, done.stderr) == (0, '')
    assert 'pooled' in done.stdout
    assert (tmp_path / 'mine.toml').read_text() == wanted


def test_fit_needle_is_the_programs(program, tmp_path):
    rng = np.random.default_rng(1)
    depth = np.concatenate([np.arange(-1.0, 25.0, 0.02), np.full(500, 25.0), np.arange(25.0, -1.0, -0.02)])
    into = np.arange(depth.size) < 1300
    out = np.arange(depth.size) >= 1800
    force = np.where(depth < 10.0, 0.01 * np.maximum(depth, 0.0) ** 2,
                     0.4 + 0.02 * (depth - 4.0) + 0.6 * np.exp(-np.maximum(depth - 10.0, 0.0) / 0.04))
    force[~into & ~out] = 0.5 + 0.3 * np.exp(-np.arange(500) / 100.0)
    turned = 0.5 - 0.9 * np.minimum(1.0, (25.0 - depth) / 8.0)
    force[out] = (turned * np.clip((depth + 1.0) / 15.0, 0.0, 1.0))[out]
    force += rng.normal(0.0, 2e-3, force.size)
    file = tmp_path / 'in.csv'
    write_columns(file, ('time_s', 'displacement_mm', 'force_N'), 0.01 * np.arange(depth.size), depth, force)
    toml = tmp_path / 'fitted.toml'
    said = program.json('fit', '--needle', file, '--out', toml)
    records = palpate.read_insertions(file)
    found = palpate.fit_needle(records)
    assert found['layers'] == said['layers'] == 1
    assert found['nrmse'] == said['nrmse'] < 0.06
    value, low, high = found['tissue_layers'][0]['puncture_force_N']
    theirs = said['tissue_layers'][0]['puncture_force_N']
    assert (value, [low, high]) == (theirs['value'], theirs['interval_95'])
    assert found['tissue'].to_toml() == toml.read_text()
    assert found['repeats'][0]['punctures'][0][1] == pytest.approx(10e-3, abs=0.3e-3)
    with pytest.raises(palpate.InputError, match='time_s: missing'):
        palpate.fit_needle([palpate.Specimen('press', np.linspace(0, 1e-2, 200), np.linspace(0, 1, 200))])
    with pytest.raises(palpate.InputError, match='at least one'):
        palpate.fit_needle([])
