"""docs/python.md, which describes the package with all components."""
import re

import numpy as np
import pytest

import palpate
from example_runs import EXAMPLES, run  # noqa: F401  a fixture
from measurements import profile_of, side_view, write_columns, write_gray_png

ROOT = EXAMPLES.parents[1]


def measure(folder):
    """Writes the input files that docs/python.md names."""
    liver = palpate.tissue_preset('liver')
    depth = np.linspace(0.0, 14e-3, 40)
    force = palpate.spring_law(liver).force_at(depth)
    for name in ('liver.csv', 'liver-3.csv'):
        write_columns(folder / name, ('displacement_mm', 'force_N'), 1e3 * depth, force)
    r = np.linspace(0.0, 30e-3, 40)
    write_columns(folder / 'side.csv', ('r_mm', 'u_mm'), 1e3 * r, 1e3 * profile_of(liver.reach, 5e-3, 5e-3, r))
    write_gray_png(folder / 'before.png', side_view(0.0, 8e-5, 3e-3))
    write_gray_png(folder / 'after.png', side_view(4e-3, 8e-5, 3e-3))


def test_docs_of_python_run_as_they_stand(run, tmp_path):  # noqa: F811
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
