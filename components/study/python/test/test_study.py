"""Estimators and observers from Python."""
import ast
import math
import pathlib

import numpy as np
import pytest

import palpate
import palpate.study
from example_runs import run  # noqa: F401  a fixture
from example_runs import expect_drawn
from mypy_run import expect_mypy_errors
from palpate import study

SHORT_STUDY = pathlib.Path(__file__).resolve().parents[4] / 'examples' / 'study' / 'short.toml'


def test_quest_finds_the_threshold_of_a_simulated_person():
    true = math.log10(12.0)  # with 81.6 % correct at level 0 of the function
    quest = study.QuestPlus.detection(1.0, 100.0)
    observer = study.Observer('ideal')
    for trial in range(80):
        index = quest.next()
        second = trial % 2 == 1
        says_second = study.draw_answer(observer.probability_second(quest.levels[index] - true, second=second), 5, 1, trial)
        quest.update(index, says_second == second)
    found = quest.threshold()
    assert found['low'] < found['mean'] < found['high']
    assert abs(found['mean'] - true) < 0.2
    assert quest.edge_probability() < 0.01
    quest.reset()
    assert quest.threshold()['sd'] > 2.0 * found['sd']


# 75 % correct of two intervals is d' = 0.9538725524; a rate of 0.84134 above one of 0.5 is d' = 1.
def test_detection_theory_has_the_values_of_the_tables():
    assert study.d_prime_of_correct(0.75) == pytest.approx(0.9538725524, abs=1e-9)
    assert study.correct_of_d_prime(0.9538725524, intervals=2) == pytest.approx(0.75, abs=1e-9)
    found = study.yes_no(84134, 100000, 50000, 100000)
    assert found['d_prime'] == pytest.approx(1.0, abs=1e-4) and found['reliable']
    assert not study.two_interval(99, 100, 50, 100)['reliable']


def test_a_staircase_of_two_down_goes_down_after_two_correct_answers():
    stair = study.Staircase(0.0, steps=[1.0])
    levels = []
    for correct in (True, True, True, False):
        levels.append(stair.level)
        stair.update(correct)
    assert levels == [0.0, 0.0, -1.0, -1.0] and stair.level == 0.0
    assert list(stair.reversals()) == [-1.0] and stair.mean() is None


def test_invalid_input_is_refused_in_words():
    with pytest.raises(palpate.InputError, match='is not ideal, linear'):
        study.Observer('wizard')
    with pytest.raises(palpate.ParameterError):
        study.QuestPlus.detection(10.0, 1.0)
    with pytest.raises(palpate.ParameterError, match='at most 1e8 times'):
        study.QuestPlus.detection(1e-300, 1e300)
    assert palpate.study is study


def test_a_study_folder_is_read_as_a_table(tmp_path, program):
    folder = tmp_path / 'try'
    program('study', 'prepare', SHORT_STUDY, folder, '--participants', 2)
    program('study', 'simulate', folder, '--observer', 'sr')
    trials = study.read_trials(folder)
    assert len(set(trials['participant'])) == 2
    stiffness = trials['task'] == 'stiffness'
    assert np.count_nonzero(stiffness) == 2 * 3 * 10
    assert set(trials['condition'][stiffness]) == {'c1', 'c2', 'c3'}  # blind
    counted = stiffness & (trials['practice'] == 0)
    ratio = trials['stimulus'][counted]
    assert np.allclose(np.log(ratio), trials['level'][counted], atol=1e-3)
    with pytest.raises(palpate.InputError):
        study.read_trials(tmp_path)


def test_the_stub_of_study_names_everything_in_it():
    tree = ast.parse((pathlib.Path(palpate.__file__).parent / 'study.pyi').read_text())
    named = {node.name for node in tree.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
    assert named == {name for name in dir(palpate.study) if not name.startswith('_')}


def test_its_stub_lets_mypy_see_what_is_right_and_wrong(tmp_path):
    expect_mypy_errors(tmp_path, 'import palpate\nquest = palpate.study.QuestPlus.detection(1.0, 100.0)\nquest.update(quest.next(), True)\n',
                       ['palpate.study.QuestPlus.detection("low", 100.0)'])


@pytest.mark.parametrize('name', ['force_threshold'])
def test_example_draws(run, name, tmp_path):  # noqa: F811
    expect_drawn(run, name, tmp_path)
