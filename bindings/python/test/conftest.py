"""What the tests share: the program to compare with, and no files of theirs outside their own folder."""
import json
import os
import subprocess

import pytest

PROGRAM = os.environ.get('PALPATE_PROGRAM', 'palpate')


class Program:
    """`palpate`, as a person runs it."""

    def __call__(self, *words):
        """What it prints, when it ends well."""
        done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return done.stdout

    def json(self, *words):
        return json.loads(self(*words, '--json'))

    def refusal(self, *words):
        """What it says on standard error, when it refuses."""
        done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True)
        assert done.returncode == 2, done.stdout
        return done.stderr


@pytest.fixture
def program():
    return Program()


@pytest.fixture(autouse=True)
def own_state_folder(tmp_path, monkeypatch):
    """The last ticks before a fault go to the user's state folder: here to the test's own."""
    monkeypatch.setenv('XDG_STATE_HOME', str(tmp_path))
