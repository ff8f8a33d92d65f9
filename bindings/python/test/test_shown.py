"""How objects of the package show themselves, and what it answers to wrong arguments."""
import xml.etree.ElementTree

import numpy as np
import pytest

import palpate
from palpate import _shown


def numbers_of(path):
    """Coordinates of an SVG path of lines."""
    return np.array([point.split() for point in path.strip('M').split('L')], float)


def test_package_has_no_module_of_others():
    allowed = {'study', 'env'}
    for name, found in vars(palpate).items():
        if type(found) is type(palpate):
            assert name.startswith('_') or name in allowed, name


def test_every_object_shows_numbers_and_no_address(tmp_path):
    file = tmp_path / 'run.h5'
    rows = palpate.simulate(duration_s=0.5, record=file)
    box = palpate.make_organ('box')
    ramp = np.linspace(0.0, 1e-2, 20)
    top = box.vertices[box.vertices[:, 2].argmax()]
    with palpate.Simulation(duration_s=0.2) as simulation:
        simulation.wait()
        live = [simulation, simulation.state(), simulation.state().hands[0], simulation.surface()]
    if hasattr(palpate, 'Env'):
        live += [palpate.Env('press'), palpate.VectorEnv('press', 3)]
    if hasattr(palpate, 'fit'):
        live += [palpate.Specimen('one', ramp, 10.0 * ramp), palpate.Deformation('side', ramp, ramp[::-1])]
    ticked = palpate.TickedSimulation(no_hand=True)
    for found in [palpate.read_recording(file), palpate.tissue_preset('liver'), palpate.spring_law(palpate.tissue_preset('liver')),
                  palpate.Inclusion('nodule'), box, box.findings(),
                  palpate.Indentation(top, (0, 0, -1), 1e-3, 5e-3), ticked, palpate.Batch(n=3),
                  palpate.TouchNoise(gain=5e-5), *live]:
        text = repr(found)
        assert text.startswith(f'<palpate.{type(found).__name__}') and ' object at ' not in text
        assert any(letter.isdigit() for letter in text), text
    assert len(rows) == 500


def test_recording_shows_its_largest_force_and_depth(tmp_path):
    rows = palpate.simulate(duration_s=3.0, record=tmp_path / 'run.h5')
    recording = palpate.read_recording(tmp_path / 'run.h5')
    assert repr(recording) == ("<palpate.Recording 'gallbladder press': 3,000 rows, 3 s at 1,000 Hz, 1 hand, "
                               f'largest force {rows["tissue_force_N"].max():.4g} N, '
                               f'largest depth {1e3 * rows["depth_m"].max():.4g} mm>')


def test_tissue_shows_its_numbers():
    assert repr(palpate.tissue_preset('gallbladder')) == (
        "<palpate.Tissue 'gallbladder': layered, k1 18 N/m, beta 1.6, q 0.7, limit 8 mm pressed, 8 mm pulled>")


def test_numbers_are_never_in_powers_where_people_write_digits():
    assert [_shown.number(value) for value in (0.0, 0.66081, 7000.0, 123456.0, 1.5e-9)] == ['0', '0.6608', '7,000', '123,456', '1.5e-09']


def test_notebooks_get_a_table_and_the_curve_of_a_law():
    law = palpate.spring_law(palpate.tissue_preset('liver'))
    page = xml.etree.ElementTree.fromstring(law._repr_html_())
    cells = [cell.text for cell in page.iter('td')]
    assert cells[cells.index('at 5 mm') + 1] == f'{law.force_at(5e-3):.4g} N, {law.stiffness_at(5e-3):.4g} N/m'
    namespace = '{http://www.w3.org/2000/svg}'
    curve, = [path for path in page.iter(namespace + 'path') if path.get('fill') == 'none']
    points = numbers_of(curve.get('d'))
    depth = np.linspace(0.0, 15e-3, len(points))
    force = law.force_at(depth)
    # the picture's y axis points down
    scale = (points[0, 1] - points[-1, 1]) / force[-1]
    np.testing.assert_allclose(points[0, 1] - points[:, 1], scale * force, atol=0.11)


def test_a_name_of_a_tissue_cannot_inject_html():
    tissue = palpate.tissue_preset('liver').replace(name='<script>alert(1)</script>')
    assert '<script>' not in tissue._repr_html_()


def test_long_curves_keep_their_peaks():
    x = np.arange(100_000.0)
    y = np.sin(x)
    y[54_321] = 7.0
    thin_x, thin_y = _shown.thinned(x, y)
    assert len(thin_x) <= 600 and thin_y.max() == 7.0 and (np.diff(thin_x) > 0).all()


def test_invalid_tissues_show_what_is_wrong():
    tissue = palpate.tissue_preset('liver')
    tissue.k1 = -1.0
    assert 'k1_N_per_m = -1: must be' in tissue._repr_html_()


def test_replace_gives_a_changed_copy():
    liver = palpate.tissue_preset('liver')
    stiff = liver.replace(k1=30, name='stiff', relaxation=[(0.3, 1.5)])
    assert (stiff.k1, stiff.name, stiff.relaxation, stiff.beta) == (30.0, 'stiff', [(0.3, 1.5)], liver.beta)
    assert (liver.k1, liver.name, liver.relaxation) == (25.0, 'liver', [])


def test_replace_refuses_unknown_names_and_values_out_of_range():
    liver = palpate.tissue_preset('liver')
    with pytest.raises(TypeError, match=r"^replace\(\) has no argument 'k3', did you mean k1\?$"):
        liver.replace(k3=30)
    with pytest.raises(palpate.ParameterError, match='k1_N_per_m = -1: must be'):
        liver.replace(k1=-1)


def test_every_built_in_name_is_listed():
    assert [palpate.tissue_preset(name).name for name in palpate.tissue_names()] == palpate.tissue_names()
    assert palpate.inclusion_names() == list(palpate.inclusion_presets())
    assert {'scripted', 'emulated', 'haply'} <= set(palpate.device_names())
    with pytest.raises(palpate.InputError) as refused:
        palpate.simulate(device='omega')
    for name in palpate.device_names():
        assert name in str(refused.value)


@pytest.mark.parametrize('call, words', [
    (lambda: palpate.simulate(tisue='liver'), "simulate() has no argument 'tisue', did you mean tissue?"),
    (lambda: palpate.Simulation(durations=1.0), "Simulation() has no argument 'durations', did you mean duration_s?"),
    (lambda: palpate.make_ball(radios=1.0), "make_ball() has no argument 'radios', did you mean radius?"),
    (lambda: palpate.simulate(tissue=3), 'simulate(): tissue = 3: must be Tissue or str'),
    (lambda: palpate.simulate(tool=3), 'simulate(): tool = 3: must be str or list of str'),
    (lambda: palpate.Mesh([[0.0, 0.0, 0.0]]), 'Mesh() needs triangles: array'),
    (lambda: palpate.Mesh(), 'Mesh() needs vertices: array'),
    (lambda: palpate.Mesh([], [], 3), 'Mesh() takes vertices, triangles: 3 given'),
    (lambda: palpate.Mesh([], vertices=[]), 'Mesh() needs triangles: array'),
    (lambda: palpate.Mesh([], [], vertices=[]), 'Mesh(): vertices is given twice'),
    (lambda: palpate.Mesh('a', triangles=[]), "Mesh(): vertices = 'a': must be array"),
    (lambda: palpate.Mesh(triangle=[]), "Mesh() has no argument 'triangle', did you mean triangles?"),
    (lambda: palpate.Tissue(3), 'Tissue() takes no argument: 1 given'),
    (lambda: palpate.Indentation([0, 0, 0], [0, 0, 'a'], 1e-3, 3e-3),
     'Indentation(): a value does not fit; they must be point: array, direction: array, depth: float, tip_radius: float'),
    (lambda: palpate.LayeredSpringLaw('liver'), "LayeredSpringLaw(): tissue = 'liver': must be Tissue"),
    (lambda: palpate.Indentation(1.0, 2.0, [3.0], 4.0), 'Indentation(): depth = [3.0]: must be float')])
def test_wrong_arguments_are_answered_in_one_line(call, words):
    with pytest.raises(TypeError) as refused:
        call()
    assert str(refused.value) == words


@pytest.mark.parametrize('arguments, words', [
    ({'tissue': 'livr'}, 'tissue = "livr": no built-in tissue of that name'), ({'organ': 'a.stl'}, 'give organ_unit: mm'),
    ({'organ': 'livr'}, 'organ = "livr": must be'), ({'tool': 'a.stl'}, 'give tool_unit: mm'), ({'task': 'pres'}, 'task = "pres"'),
    ({'organ_motion': ['brething']}, 'organ_motion = "brething"'), ({'device': 'omega'}, 'device = "omega"'),
    ({'rate_Hz': 1.0}, 'rate_Hz = 1: must be a number')])
def test_errors_name_arguments_and_not_flags(arguments, words):
    with pytest.raises(palpate.InputError) as refused:
        palpate.simulate(**arguments)
    assert words in str(refused.value) and '--' not in str(refused.value)
    if 'rate_Hz' in arguments:
        assert isinstance(refused.value, palpate.ParameterError)


def test_tables_are_made_of_all_that_has_rows(tmp_path):
    pandas = pytest.importorskip('pandas', reason='pandas (package python3-pandas) is not there')
    rows = palpate.simulate(duration_s=0.5, record=tmp_path / 'run.h5')
    recording = palpate.read_recording(tmp_path / 'run.h5')
    assert palpate.to_pandas(recording).equals(palpate.to_pandas(rows))
    depth = np.linspace(0.0, 1e-2, 20)
    specimen = palpate.Specimen('one', depth, 10.0 * depth)
    pandas.testing.assert_frame_equal(palpate.to_pandas(specimen), pandas.DataFrame({'displacement': depth, 'force': 10.0 * depth}))
    law = palpate.spring_law(palpate.tissue_preset('liver'))
    states = law.deformation_at(depth)
    assert (palpate.to_pandas(states)['deformation_1'] == states['deformation'][:, 0]).all()
    with palpate.TickedSimulation(palpate_scene(), no_hand=True) as ticked:
        results = ticked.tick(np.stack([ticked.samples()] * 3))
    frame = palpate.to_pandas(results)
    assert list(frame['hand']) == [0, 1, 0, 1, 0, 1] and list(frame['tick']) == [0, 0, 1, 1, 2, 2]
    assert (frame['force_z'] == results['force'].reshape(-1, 3)[:, 2]).all()
    assert len(palpate.to_pandas(results[0, 0])) == 1
    with pytest.raises(TypeError, match='int has no rows'):
        palpate.to_pandas(3)


def palpate_scene():
    from test_palpate import EXAMPLES
    return EXAMPLES / 'bimanual.toml'


def test_recordings_export_as_the_program_does(program, tmp_path):
    file = tmp_path / 'run.h5'
    palpate.simulate(duration_s=0.5, record=file)
    program('export', file, '--csv', tmp_path / 'theirs.csv')
    assert palpate.read_recording(file).export_csv(tmp_path / 'ours.csv') == 500
    assert (tmp_path / 'ours.csv').read_bytes() == (tmp_path / 'theirs.csv').read_bytes()


def test_a_zero_is_shown_without_a_minus():
    assert _shown.number(-0.0) == '0' and _shown.number(-0.5) == '-0.5'
