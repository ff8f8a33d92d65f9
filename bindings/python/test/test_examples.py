"""The examples run and draw their figures."""
import os
import pathlib
import re
import subprocess
import sys

import numpy as np
import pytest

import palpate
from measurements import profile_of, side_view, write_columns, write_gray_png

EXAMPLES = pathlib.Path(__file__).resolve().parents[3] / 'examples' / 'python'
DRAWING = ('law_curves', 'simulated_press', 'fit_specimens', 'compare_tissues', 'live_control', 'force_threshold', 'learn_to_press', 'clone_a_press', 'validate_tissue')
ROOT = EXAMPLES.parents[1]


def measure(folder):
    """Writes the input files that docs/python.md names."""
    liver = palpate.tissue_preset('liver')
    depth = np.linspace(0.0, 14e-3, 40)
    force = palpate.LayeredSpringLaw(liver).force_at(depth)
    for name in ('liver.csv', 'liver-3.csv'):
        write_columns(folder / name, ('displacement_mm', 'force_N'), 1e3 * depth, force)
    r = np.linspace(0.0, 30e-3, 40)
    write_columns(folder / 'side.csv', ('r_mm', 'u_mm'), 1e3 * r, 1e3 * profile_of(liver.reach, 5e-3, 5e-3, r))
    write_gray_png(folder / 'before.png', side_view(0.0, 8e-5, 3e-3))
    write_gray_png(folder / 'after.png', side_view(4e-3, 8e-5, 3e-3))


@pytest.fixture(scope='session')
def run(tmp_path_factory):
    """run(folder, *arguments) runs Python with these arguments in the folder."""
    environment = {**os.environ, 'MPLCONFIGDIR': str(tmp_path_factory.mktemp('matplotlib'))}

    def python(folder, *words):
        return subprocess.run([sys.executable, '-B', *map(str, words)], cwd=folder, timeout=240, capture_output=True,
                              text=True, env=environment)

    # Builds matplotlib's font cache once. If that takes over 5 s, matplotlib writes a message to standard error.
    python(None, '-c', 'import matplotlib.font_manager')
    return python


def test_docs_of_python_run_as_they_stand(run, tmp_path):
    pytest.importorskip('pandas', reason='pandas (package python3-pandas) is not there')
    blocks = re.findall(r'^```python\n(.*?)^```', (ROOT / 'docs' / 'python.md').read_text(), re.MULTILINE | re.DOTALL)
    assert len(blocks) > 8
    measure(tmp_path)
    (tmp_path / 'examples').symlink_to(ROOT / 'examples')
    done = run(tmp_path, '-c', '\n'.join(blocks))
    assert (done.returncode, done.stderr) == (0, '')
    assert 'every bit the same' in done.stdout


def test_docs_of_python_name_all_that_is_public_once():
    page = (ROOT / 'docs' / 'python.md').read_text()
    table = page[page.index('| what |'):page.index('[`examples/python`]')]
    named = re.findall(r'`(\w+)`', table)
    assert sorted(named) == sorted(name for name in palpate.__all__ if not name.endswith('Error'))


def test_examples_are_short():
    for file in EXAMPLES.glob('*.py'):
        assert len(file.read_text().splitlines()) < 150, file.name


@pytest.mark.parametrize('name', DRAWING)
def test_example_draws(run, name, tmp_path):
    pytest.importorskip('matplotlib', reason='matplotlib (package python3-matplotlib) is not there')
    done = run(tmp_path, EXAMPLES / f'{name}.py', '--out', tmp_path)
    assert (done.returncode, done.stderr) == (0, '')
    picture = (tmp_path / f'{name}.png').read_bytes()
    assert picture[:8] == b'\x89PNG\r\n\x1a\n'
    assert len(picture) > 20_000
