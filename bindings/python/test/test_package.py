"""Type stubs and pandas tables of the package."""
import ast
import inspect
import pathlib
import sys

import pytest

import palpate
from mypy_run import expect_mypy_errors

FOLDER = pathlib.Path(palpate.__file__).parent

GOOD = '''
from typing import List
import numpy
import palpate

with palpate.Simulation("a.toml", tissue=palpate.tissue_preset("liver"), duration_s=1.0) as simulation:
    state = simulation.state()
    if state is not None:
        depth: float = state.hands[0].depth
    simulation.set_noise(gain=1e-4)
    simulation.set_stimulus(0.1, ramp_ms=20.0, interval=1, not_before_tick=100)
one: float = palpate.spring_law(palpate.tissue_preset("liver")).force_at(1e-3)
stiff: palpate.Tissue = palpate.tissue_preset("liver").replace(k1=30, relaxation=[(0.3, 1.5)])
names: List[str] = palpate.tissue_names() + palpate.device_names()
force: numpy.ndarray = palpate.LayeredSpringLaw(palpate.load_tissue("heart")).force_at([1e-3, 2e-3])
tissue: palpate.Tissue = palpate.load_tissue("heart")
tissue.k1 = 12.0
batch = palpate.Batch("a.toml", 3, tissue=tissue, jobs=2)
forces, torques, depths = batch.step([[0.0, 0.0, 0.1, 1.0, 0.0, 0.0, 0.0]] * 3)
deepest: float = depths.max()
faults: numpy.ndarray = batch.fault
'''
BAD = ('palpate.tissue_preset(3)', 'palpate.tissue_preset("liver").k2', 'palpate.simulate(tisue="liver")',
       'palpate.Simulation().state().tick', 'palpate.Batch(hands=3)', 'palpate.tissue_preset("liver").replace(k3=30)',
       'palpate.spring_law(palpate.tissue_preset("liver")).force_at(1e-3).shape', 'palpate.State().hands[0].force + "N"')


def test_stubs_name_everything_that_is_public():
    assert (FOLDER / 'py.typed').is_file()
    tree = ast.parse((FOLDER / '__init__.pyi').read_text())
    named = {node.name: node for node in tree.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
    assert sorted(named) == sorted(palpate.__all__)
    for name, node in named.items():
        found = getattr(palpate, name)
        if not inspect.isclass(found):
            continue
        members = {part.name for part in node.body if isinstance(part, ast.FunctionDef)}
        for member in vars(found):
            if not member.startswith('_'):
                assert member in members, name


def test_stubs_let_mypy_see_what_is_right_and_wrong(tmp_path):
    expect_mypy_errors(tmp_path, GOOD, BAD)


def test_tables_have_the_rows_with_phase_and_fault_in_words(tmp_path):
    pytest.importorskip('pandas', reason='pandas (package python3-pandas) is not there')
    rows = palpate.simulate(duration_s=3.0, record=tmp_path / 'run.h5')
    frame = palpate.to_pandas(rows)
    assert list(frame.columns) == list(rows.dtype.names)
    assert (frame['depth_m'].to_numpy() == rows['depth_m']).all()
    assert list(frame['phase']) == [('approach', 'press', 'pull')[phase] for phase in rows['phase']]
    assert set(frame['fault']) == {'none'}
    assert frame.equals(palpate.read_recording(tmp_path / 'run.h5').to_pandas())


def test_tables_need_pandas(monkeypatch):
    monkeypatch.setitem(sys.modules, 'pandas', None)  # as if it was not installed
    with pytest.raises(ImportError):
        palpate.to_pandas(palpate.simulate(duration_s=0.01))
