"""The examples run and draw their figures."""
import pytest

from example_runs import EXAMPLES, run  # noqa: F401  a fixture
from example_runs import expect_drawn


def test_examples_are_short():
    for file in EXAMPLES.glob('*.py'):
        assert len(file.read_text().splitlines()) < 150, file.name


@pytest.mark.parametrize('name', ['law_curves', 'simulated_press', 'compare_tissues', 'live_control', 'pose_stream'])
def test_example_draws(run, name, tmp_path):  # noqa: F811
    expect_drawn(run, name, tmp_path)
