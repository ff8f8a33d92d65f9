"""Fixtures: the program for comparisons, and a separate state folder per test."""
import json
import os
import subprocess
import sys

import pytest

PROGRAM = os.environ.get('PALPATE_PROGRAM', 'palpate')


def pytest_sessionfinish(session, exitstatus):
    """Ends with 77, which CTest reports as skipped, if no test failed and a package was missing for some."""
    reporter = session.config.pluginmanager.get_plugin('terminalreporter')
    if exitstatus == 0 and reporter.stats.get('skipped'):
        session.exitstatus = 77


class Program:
    """The `palpate` program."""

    def __call__(self, *words):
        """Standard output of a successful call."""
        done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return done.stdout

    def json(self, *words):
        return json.loads(self(*words, '--json'))

    def refusal(self, *words):
        """Standard error of a call that fails with exit code 2."""
        done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True)
        assert done.returncode == 2, done.stdout
        return done.stderr


@pytest.fixture(scope='session', autouse=True)
def own_cache(tmp_path_factory):
    """Prepares an organ once for all tests, and not in the user's cache."""
    if os.environ.get('PALPATE_CACHE') == 'shared':  # by CTest
        yield
        return
    with pytest.MonkeyPatch.context() as patch:
        patch.delenv('PALPATE_CACHE', raising=False)
        patch.setenv('XDG_CACHE_HOME', str(tmp_path_factory.mktemp('cache')))
        yield


@pytest.fixture
def program():
    return Program()


@pytest.fixture(autouse=True)
def own_state_folder(tmp_path, monkeypatch):
    """Sends recordings of faults, which go to the user's state folder, to the test's folder."""
    monkeypatch.setenv('XDG_STATE_HOME', str(tmp_path))


@pytest.fixture
def exit_status_of_child():
    """Exit status of a child process, made by fork(), that calls a function; 0 when that returns."""
    def exit_status(function):
        child = os.fork()
        if child == 0:
            code = 1
            try:
                function()
                code = 0
            finally:
                os._exit(code)
        return os.waitpid(child, 0)[1]
    return exit_status


@pytest.fixture
def command(tmp_path):
    """Runs `python -m palpate` in a folder. `path`: where it finds the program; '': nowhere."""
    def run(*words, path=''):
        environment = {**os.environ, 'PATH': path}
        return subprocess.run([sys.executable, '-B', '-m', 'palpate', *map(str, words)], cwd=tmp_path, capture_output=True, text=True,
                              env=environment, timeout=240)
    return run
