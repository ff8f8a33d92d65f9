"""The notebook in examples/python runs, and its text is what it shows."""
import pytest

from example_runs import EXAMPLES, run  # noqa: F401  a fixture


def test_notebook_shows_what_its_cells_give(run, tmp_path):  # noqa: F811
    pytest.importorskip('matplotlib', reason='matplotlib (package python3-matplotlib) is not there')
    done = run(tmp_path, EXAMPLES.parents[1] / 'tools' / 'update_notebook', '--check', EXAMPLES / 'first_tissue.ipynb')
    assert (done.returncode, done.stderr) == (0, '')
