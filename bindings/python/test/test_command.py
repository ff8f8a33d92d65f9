"""The command of the wheel, `python -m palpate`, without the program and with it."""
import pathlib
import subprocess

import pytest

import palpate
from palpate_fixtures import PROGRAM


def test_program_is_the_command_where_it_is_installed(command):
    folder = str(pathlib.Path(PROGRAM).parent)
    done = command('model', '--tissue', 'liver', '--direction', 'press', '--depth-mm', '5', '--json', path=folder)
    assert done.returncode == 0, done.stderr
    assert done.stdout == subprocess.run([PROGRAM, 'model', '--tissue', 'liver', '--direction', 'press', '--depth-mm', '5', '--json'],
                                         capture_output=True, text=True).stdout


def test_a_script_of_that_name_is_not_taken_for_the_program(command, tmp_path):
    script = tmp_path / 'palpate'
    script.write_text('#!/bin/sh\necho another\n')
    script.chmod(0o755)
    done = command('inspect', 'liver', path=str(tmp_path))
    assert 'another' not in done.stdout and '7,000 triangles' in done.stdout


def test_run_and_export_give_the_rows_of_simulate(command, tmp_path):
    done = command('run', '--offline', '--tissue', 'liver', '--duration-s', '0.5', '--no-noise', '--record', 'run.h5')
    assert (done.returncode, done.stderr) == (0, '')
    assert done.stdout.startswith('500 rows, largest force ')
    rows = palpate.simulate(tissue='liver', duration_s=0.5, noise=False)
    assert palpate.read_recording(tmp_path / 'run.h5').rows.tobytes() == rows.tobytes()
    done = command('export', 'run.h5', '--csv', 'run.csv')
    assert done.returncode == 0 and len((tmp_path / 'run.csv').read_text().splitlines()) == 501


def test_doctor_has_the_checks_of_the_program(command, program):
    wanted = [check['name'] for check in program.json('doctor')['checks'][:-1]]  # the last one is measured
    done = command('doctor')
    assert done.returncode == 0
    for name in wanted:
        assert name in done.stdout


@pytest.mark.parametrize('words, answer', [
    (('view', 'run.h5'), 'palpate: view: needs the program palpate'),
    (('rnu',), "palpate: palpate has no command 'rnu', did you mean run?"),
    (('run', '--report', 'out'), 'palpate: --report: no flag of the Python package'),
    (('run', '--tissue', 'livr'), 'palpate: tissue = "livr"'),
    (('export', 'none.h5', '--csv', 'a.csv'), 'palpate: none.h5')])
def test_what_it_cannot_do_is_one_line_and_exit_code_2(command, words, answer):
    done = command(*words)
    assert done.returncode == 2 and done.stdout == ''
    assert done.stderr.startswith(answer) and len(done.stderr.splitlines()) == 1
