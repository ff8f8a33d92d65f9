"""Runs the examples of Python."""
import os
import pathlib
import subprocess
import sys

import pytest

EXAMPLES = pathlib.Path(__file__).resolve().parents[3] / 'examples' / 'python'


@pytest.fixture(scope='session')
def run():
    """run(folder, *arguments) runs Python with these arguments in the folder."""
    fonts = pathlib.Path(os.environ['XDG_CACHE_HOME']) / 'matplotlib'  # own_cache
    environment = {**os.environ, 'MPLCONFIGDIR': str(fonts)}

    def python(folder, *words):
        return subprocess.run([sys.executable, '-B', *map(str, words)], cwd=folder, timeout=240, capture_output=True,
                              text=True, env=environment)

    # Builds matplotlib's font cache once. If that takes over 5 s, matplotlib writes a message to standard error.
    if not any(fonts.glob('fontlist*')):
        python(None, '-c', 'import matplotlib.font_manager')
    return python


def expect_drawn(run, name, folder):
    """Expects that an example draws its figure and prints no error."""
    pytest.importorskip('matplotlib', reason='matplotlib (package python3-matplotlib) is not there')
    done = run(folder, EXAMPLES / f'{name}.py', '--out', folder)
    assert (done.returncode, done.stderr) == (0, '')
    picture = (folder / f'{name}.png').read_bytes()
    assert picture[:8] == b'\x89PNG\r\n\x1a\n'
    assert len(picture) > 20_000
