"""mypy over a program that uses the package's type stubs."""
import os
import pathlib
import subprocess
import sys

import pytest

import palpate


def expect_mypy_errors(folder, good, bad):
    """Expects that mypy accepts the lines of `good` and reports an error in each line of `bad`."""
    pytest.importorskip('mypy', reason='mypy (package mypy) is not there')
    file = folder / 'use.py'
    lines = good.splitlines()
    file.write_text('\n'.join(lines + list(bad)) + '\n')
    cache = pathlib.Path(os.environ['XDG_CACHE_HOME']) / 'mypy'  # own_cache
    done = subprocess.run([sys.executable, '-m', 'mypy', '--cache-dir', cache, file], capture_output=True, text=True,
                          env={'MYPYPATH': str(pathlib.Path(palpate.__file__).parents[1]), 'PATH': '/usr/bin'})
    wrong = {int(line.split(':')[1]) for line in done.stdout.splitlines() if ' error: ' in line}
    assert wrong == set(range(len(lines) + 1, len(lines) + 1 + len(bad))), done.stdout
