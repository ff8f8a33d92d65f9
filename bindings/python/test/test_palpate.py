"""The Python package gives the numbers and messages of the program."""
import pathlib
import threading
import time

import numpy as np
import pytest
from numpy.lib.recfunctions import repack_fields

import palpate

EXAMPLES = pathlib.Path(__file__).resolve().parents[3] / 'examples'
GOLDEN = EXAMPLES.parent / 'tests' / 'golden_hashes.txt'


@pytest.mark.parametrize('direction', ['press', 'pull'])
@pytest.mark.parametrize('kind, name', [(palpate.LayeredSpringLaw, 'layered'), (palpate.SmoothSpringLaw, 'smooth')])
def test_law_is_the_programs_both_ways(program, kind, name, direction):
    law = kind(palpate.tissue_preset('liver'), direction, 1e-3)
    asked = ('model', '--tissue', 'liver', '--law', name, '--direction', direction)
    depths_mm = [0.0, 0.4, 3.0, 9.5, 14.0, 40.0]
    said = program.json(*asked, '--depth-mm', ','.join(map(str, depths_mm)))
    for one, answer in zip(law.deformation_at(np.array(depths_mm) * 1e-3), said['results'], strict=True):
        assert one['force'] == answer['force_N']
        assert one['depth'] / 1e-3 == answer['depth_mm']
        assert one['stiffness'] == answer['tangent_stiffness_N_per_m']
        assert one['cutoff_layer'] == answer['cutoff_layer']
        assert one['saturated'] == answer['saturated']
    forces = [0.0, 0.1, 0.7, 50.0]
    said = program.json(*asked, '--force-N', ','.join(map(str, forces)))
    for one, answer in zip(law.deformation_under(forces), said['results'], strict=True):
        assert one['depth'] / 1e-3 == answer['depth_mm']
        assert list(one['deformation'][:one['cutoff_layer']] / 1e-3) == answer['layer_deformation_mm']


@pytest.mark.parametrize('tissue', ['gallbladder', 'heart', 'liver', 'kidney', 'heart-muscle'])
def test_law_of_every_tissue_is_the_programs(program, tissue):
    depths_mm = np.linspace(0.0, 12.0, 25)
    said = program.json('model', '--tissue', tissue, '--depth-mm', ','.join(map(repr, depths_mm.tolist())),
                        '--direction', 'press')
    law = palpate.spring_law(palpate.tissue_preset(tissue), 'press', loop_period=1e-3)
    assert type(law) is (palpate.LayeredSpringLaw if tissue in ('gallbladder', 'heart') else palpate.SmoothSpringLaw)
    assert law.force_at(depths_mm * 1e-3).tolist() == [answer['force_N'] for answer in said['results']]
    assert law.stiffness_at(depths_mm * 1e-3).tolist() == [answer['tangent_stiffness_N_per_m']
                                                           for answer in said['results']]


def test_law_keeps_the_shape_of_what_it_is_asked():
    law = palpate.LayeredSpringLaw(palpate.tissue_preset('heart'), 'pull')
    assert isinstance(float(law.force_at(0.005)), float)
    assert law.force_at(np.zeros((3, 4, 2))).shape == (3, 4, 2)
    assert law.force_at([]).shape == (0,)
    backwards = np.linspace(0.0, 0.01, 7)[::-2]  # reversed and not contiguous
    assert (law.force_at(backwards) == [law.force_at(depth) for depth in backwards]).all()
    np.testing.assert_allclose(law.depth_under(law.force_at(backwards)), backwards, rtol=1e-12, atol=1e-15)


def test_law_refuses_in_the_programs_words():
    with pytest.raises(palpate.InputError, match='direction = "push": must be press or pull'):
        palpate.LayeredSpringLaw(palpate.tissue_preset('heart'), 'push')
    tissue = palpate.tissue_preset('heart')
    tissue.k1 = -1.0
    with pytest.raises(palpate.ParameterError, match='k1_N_per_m = -1: must be'):
        palpate.LayeredSpringLaw(tissue)
    with pytest.raises(TypeError):
        palpate.LayeredSpringLaw(palpate.tissue_preset('heart')).force_at('deep')


def test_tissue_goes_to_a_file_and_back(tmp_path):
    tissue = palpate.tissue_preset('kidney')
    tissue.law = 'smooth'
    tissue.relaxation = [(0.3, 1.5)]
    tissue.tangential_damping = 0.75
    assert tissue.tangential_stiffness is None
    file = tmp_path / 'kidney.toml'
    file.write_text(tissue.to_toml())
    back = palpate.load_tissue(str(file))
    assert (back.tangential_damping, back.tangential_stiffness) == (0.75, None)
    assert (back.k1, back.beta, back.law, back.relaxation) == (tissue.k1, tissue.beta, 'smooth', [(0.3, 1.5)])


def test_layers_of_a_tissue_are_read_and_set(tmp_path):
    tissue = palpate.tissue_preset('vein')
    layers = tissue.layers
    assert [layer['name'] for layer in layers] == ['skin', 'fat', 'wall', 'lumen', 'far wall', 'muscle']
    assert layers[0]['thickness'] == 1.5e-3 and layers[-1]['thickness'] == np.inf
    layers[3]['cutting_force'] = 0.25
    tissue.layers = layers
    file = tmp_path / 'vein.toml'
    file.write_text(tissue.to_toml())
    assert palpate.load_tissue(str(file)).layers[3]['cutting_force'] == 0.25
    with pytest.raises(palpate.InputError, match='"colour" is no number of a layer'):
        tissue.layers = [{'colour': 1.0}]
    with pytest.raises(palpate.InputError, match='layer 1: cutting_force_N'):
        tissue.layers = [{'cutting_force': -1.0}]
    with pytest.raises(palpate.InputError, match='layer 3: name = "skin": layer 1 has this name too'):
        tissue.layers = [layers[0], layers[1], layers[0], layers[-1]]


def test_tissue_refuses_in_the_programs_words(program):
    said = program.refusal('model', '--tissue', 'hearth', '--depth-mm', '1')
    with pytest.raises(palpate.InputError) as refused:
        palpate.load_tissue('hearth')
    assert str(refused.value) in said
    assert isinstance(refused.value, ValueError)
    tissue = palpate.tissue_preset('heart')
    with pytest.raises(palpate.InputError):
        tissue.law = 'quadratic'
    with pytest.raises(palpate.ParameterError):
        tissue.relaxation = [(1.5, 1.0)]
    tissue.q = float('nan')
    with pytest.raises(palpate.ParameterError):
        tissue.validate()


def test_noise_is_the_programs_line_by_line(program):
    asked = ('noise', '--gain-N-m', '5e-5', '--threshold-mm', '5', '--samples', '200', '--seed', '7')
    noise = palpate.TouchNoise(gain=5e-5, threshold=5e-3, seed=7)
    forces = noise.forces(200, distance=3e-3)
    assert forces.tolist() == [float(line) for line in program(*asked, '--distance-mm', '3').split()]
    assert noise.forces(200, distance=0.0).tolist() == [float(line) for line in program(*asked, '--contact').split()]
    assert (noise.forces(50, distance=3e-3, first=100) == forces[100:150]).all()
    assert float(noise.sigma(3e-3)) == pytest.approx(5e-5 / 8e-3, rel=1e-12)
    for asked_for in (lambda: noise.sigma(np.nan), lambda: noise.forces(3, distance=np.nan)):
        with pytest.raises(palpate.ParameterError, match='distance'):
            asked_for()


def test_noise_gain_from_a_threshold_is_that_of_a_scene(program, tmp_path):
    scene = tmp_path / 'felt.toml'
    pressed = '[organ]\nmesh = "box"\n[tool]\nmesh = "sphere:5"\n'
    scene.write_text(pressed + '[noise]\nuser_threshold_N = 0.02\nshare_of_threshold = 0.6\nthreshold_mm = 5\n')
    gain = palpate.gain_from_threshold(0.02, 0.6, 5e-3)
    by_gain = tmp_path / 'gain.toml'
    by_gain.write_text(f'{pressed}[noise]\ngain_N_m = {gain!r}\nthreshold_mm = 5\n')
    rows = palpate.simulate(scene, duration_s=1.0)
    assert rows['noise_force_N'].any()
    assert rows.tobytes() == palpate.simulate(by_gain, duration_s=1.0).tobytes()
    recording, csv = tmp_path / 'felt.h5', tmp_path / 'felt.csv'
    program('run', scene, '--offline', '--duration-s', '1', '--record', recording)
    program('export', recording, '--csv', csv)
    assert_rows_of(rows, csv)


def test_noise_refuses_a_bad_setting():
    with pytest.raises(palpate.ParameterError, match='threshold_mm'):
        palpate.TouchNoise(threshold=0.0)


def assert_findings(mesh, findings, said):
    assert mesh.vertices.shape == (said['vertices'], 3)
    assert mesh.triangles.shape == (said['triangles'], 3)
    for name in ('closed', 'manifold', 'shells', 'repairs', 'defects', 'remarks'):
        assert getattr(findings, name) == said[name], name
    assert findings.volume * 1e9 == pytest.approx(said['volume_mm3'], rel=1e-12)
    box = np.array([mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)])
    np.testing.assert_allclose(box / 1e-3, said['bbox_mm'], rtol=1e-12)


@pytest.mark.parametrize('name', [name for name in palpate.organ_names() if not name.endswith('k')])
def test_organs_are_what_the_program_says_of_them(program, name):
    organ = palpate.make_organ(name)
    assert_findings(organ, organ.findings(), program.json('inspect', name))


def test_meshes_are_what_the_program_says_of_them(program, tmp_path):
    file = tmp_path / 'gallbladder.obj'
    organ = palpate.make_organ('gallbladder')
    with file.open('w') as out:
        for vertex in organ.vertices * 1e3:
            out.write('v {} {} {}\n'.format(*vertex))
        for triangle in organ.triangles + 1:
            out.write('f {} {} {}\n'.format(*triangle))
    mesh, findings = palpate.read_mesh(file, 'mm')
    assert_findings(mesh, findings, program.json('inspect', file, '--unit', 'mm'))
    # The reader keeps the order of the triangles, but not of the vertices.
    np.testing.assert_allclose(mesh.vertices[mesh.triangles], organ.vertices[organ.triangles], atol=1e-8)


def test_meshes_are_made_from_arrays():
    box = palpate.make_organ('box')
    again = palpate.Mesh(box.vertices, box.triangles)
    assert again.findings().closed
    assert not palpate.Mesh(box.vertices, box.triangles[1:]).findings().closed
    radius = np.linalg.norm(palpate.make_ball(0.01).vertices, axis=1)
    np.testing.assert_allclose(radius, 0.01, rtol=1e-12)
    assert [name for name, _ in palpate.make_tool('curved-forceps')] == ['left', 'right', 'shaft']
    assert {'heart', 'liver', 'kidney-30k'} <= set(palpate.organ_names())


def masked(values):
    """The values with the last one masked."""
    array = np.ma.array(values)
    array[..., -1] = np.ma.masked
    return array


@pytest.mark.parametrize('call', [
    lambda: palpate.SmoothSpringLaw(palpate.tissue_preset('liver'), 'press').force_at(masked([1e-3, 2e-3])),
    lambda: palpate.Mesh(masked(np.eye(3)), [[0, 1, 2]]),
    lambda: palpate.Mesh([masked(row) for row in np.eye(3)], [[0, 1, 2]]),
    lambda: palpate.Mesh(np.eye(3), masked([[0, 1, 2]])),
    lambda: palpate.Batch(None, 2).step(masked(np.zeros((2, 3)))),
    lambda: palpate.Batch(None, 2).displacement(masked([0, 1])),
], ids=['law', 'vertices', 'rows of vertices', 'triangles', 'poses', 'points'])
def test_masked_values_are_refused(call):
    with pytest.raises(palpate.InputError, match='a masked array'):
        call()


def test_a_masked_array_without_masked_values_is_an_array():
    law = palpate.SmoothSpringLaw(palpate.tissue_preset('liver'), 'press')
    depth = np.array([1e-3, 2e-3])
    assert np.array_equal(law.force_at(np.ma.array(depth)), law.force_at(depth))


def test_meshes_are_refused_in_words():
    with pytest.raises(palpate.InputError, match='must be an index of the 3 vertices'):
        palpate.Mesh(np.eye(3), [[0, 1, 3]])
    with pytest.raises(TypeError):
        palpate.Mesh(np.eye(3), np.array([[0.0, 1.4, 2.0]]))
    for wrong in (np.nan, np.inf):
        with pytest.raises(palpate.InputError, match=r'vertices\[1\]: must be three finite numbers'):
            palpate.Mesh([[0, 0, 0], [0, wrong, 0], [0, 0, 1]], [[0, 1, 2]])
    with pytest.raises(palpate.InputError, match='n x 3 numbers'):
        palpate.Mesh([1.0, 2.0], [[0, 1, 2]])
    with pytest.raises(palpate.InputError, match='n x 3 indices'):
        palpate.Mesh(np.eye(3), [0, 1, 2])
    with pytest.raises(palpate.InputError, match='none.stl'):
        palpate.read_mesh('none.stl', 'mm')
    with pytest.raises(palpate.InputError):
        palpate.make_organ('liverr')


def assert_rows_of(rows, csv):
    """Asserts that rows equal the program's export bit for bit, except the columns that are text in the export."""
    lines = pathlib.Path(csv).read_text().splitlines()
    names = lines[0].split(',')
    assert list(rows.dtype.names) == names
    assert len(rows) == len(lines) - 1
    words = {'phase', 'fault'}
    for column, values in zip(names, zip(*(line.split(',') for line in lines[1:]))):
        if column not in words:
            assert (rows[column] == np.array(values, dtype=rows.dtype[column])).all(), column
    phases = [line.split(',')[names.index('phase')] for line in lines[1:]]
    assert [('approach', 'press', 'pull')[phase] for phase in rows['phase']] == phases


@pytest.mark.parametrize('task', ['press', 'pull'])
def test_runs_simulated_are_the_programs_bit_for_bit(program, tmp_path, task):
    recording, csv = tmp_path / 'run.h5', tmp_path / 'run.csv'
    program('run', '--offline', '--task', task, '--duration-s', '3', '--record', recording)
    program('export', recording, '--csv', csv)
    rows = palpate.simulate(task=task, duration_s=3.0)
    assert len(rows) == 3000
    assert rows['tissue_force_N'].max() > 0.0
    assert_rows_of(rows, csv)


def hash_of(rows):
    """FNV-1a hash of the rows without measured times, as in tests/golden_hash.cc. Zeros of later columns do not count."""
    later = ('stimulus_force_N', 'layer', 'inserted_mm', 'slip', 'tip_force_N')
    assert not any(rows[name].any() for name in later)
    kept = [name for name in rows.dtype.names if name not in ('tick_ns', 'late_ns', *later)]
    found = 14695981039346656037
    for byte in repack_fields(rows[kept]).tobytes():
        found = (found ^ byte) * 1099511628211 & 0xffffffffffffffff
    return f'{found:016x}'


@pytest.mark.parametrize('name, task', [('gallbladder-press', 'press'), ('heart-pull', 'pull')])
def test_runs_have_the_committed_golden_hashes(name, task):
    golden = {line.split()[0]: line.split()[1:] for line in GOLDEN.read_text().splitlines() if not line.startswith('#')}
    rows = palpate.simulate(task=task, duration_s=4.0)
    assert [str(len(rows)), hash_of(rows)] == golden[name]


@pytest.mark.parametrize('scene', ['bimanual.toml', 'beating-heart.toml'])
def test_runs_of_a_scene_are_the_programs_bit_for_bit(program, tmp_path, scene):
    recording, csv = tmp_path / 'run.h5', tmp_path / 'run.csv'
    program('run', EXAMPLES / scene, '--offline', '--duration-s', '2', '--record', recording)
    program('export', recording, '--csv', csv)
    assert_rows_of(palpate.simulate(EXAMPLES / scene, duration_s=2.0), csv)
    program('replay', recording, '--verify')
    assert palpate.read_recording(recording).replay_difference() == ''


def test_runs_recorded_here_are_read_and_verified_everywhere(program, tmp_path):
    file, csv = tmp_path / 'two.h5', tmp_path / 'two.csv'
    rows = palpate.simulate(scene_text='[scene]\nname = "from a text"\nrate_Hz = 2000\nseed = 5\n[organ]\n'
                            'mesh = "box"\n[tool]\nmesh = "sphere:5"\n', duration_s=1.0, record=file)
    recording = palpate.read_recording(file)
    assert recording.rows.tobytes() == rows.tobytes()
    assert (recording.name, recording.rate_Hz, recording.seed) == ('from a text', 2000.0, 5)
    assert (recording.offline, recording.complete) == (True, True)
    assert recording.version == palpate.__version__
    assert recording.replay_difference() == ''
    assert recording.organ.findings().closed
    program('replay', file, '--verify')
    program('export', file, '--csv', csv)
    assert_rows_of(recording.rows, csv)
    kept = palpate.read_recording(file).rows  # the rows outlive their recording
    assert kept.tobytes() == rows.tobytes()


def test_runs_are_refused_in_the_programs_words(program, tmp_path):
    scene = tmp_path / 'bad.toml'
    scene.write_text('[organ]\nmesh = "gallbladder"\n[tool]\nmash = "sphere:3"\n')
    said = program.refusal('run', '--offline', scene)
    with pytest.raises(palpate.InputError) as refused:
        palpate.simulate(scene)
    assert str(refused.value) in said
    for arguments, words in (({'device': 'haply'}, 'offline'), ({'duration_s': -1.0}, 'duration_s = -1'),
                             ({'duration_s': 1e300}, 'duration_s'), ({'rate_Hz': 1.0}, 'rate'),
                             ({'scene': 'a.toml', 'scene_text': ''}, 'at most one')):
        with pytest.raises(palpate.InputError, match=words):
            palpate.simulate(**arguments)
    with pytest.raises(palpate.InputError, match='none.h5'):
        palpate.read_recording('none.h5')


def test_runs_leave_other_threads_running():
    done = threading.Event()
    counted = 0
    worker = threading.Thread(target=lambda: (palpate.simulate(duration_s=4.0, cache=False), done.set()))
    worker.start()
    while not done.is_set():
        counted += 1
        time.sleep(1e-3)
    worker.join()
    assert counted > 3, 'a run takes a tenth of a second and more; this thread went on meanwhile'


def test_docstrings_are_the_cpp_comments():
    assert 'Applies node transforms' in palpate.read_mesh.__doc__
    assert 'stiffness of the first layer' in palpate.Tissue.k1.__doc__


def test_docstrings_are_there_for_every_class_and_function():
    for name in palpate.__all__:
        assert len((getattr(palpate, name).__doc__ or '').strip()) > 20, name


def test_docstrings_hold_no_mark_for_cpp_callers():
    for name in palpate.__all__:
        for mark in ('[setup]', '[rt]', '[any]', '@'):
            assert mark not in getattr(palpate, name).__doc__, name
