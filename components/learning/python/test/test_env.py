"""Environments for learning."""
import inspect
import json
import pathlib
import textwrap
import types

import numpy as np
import pytest

import palpate
from example_runs import run  # noqa: F401  a fixture
from example_runs import expect_drawn


def episode(env, seed, policy):
    """Observations and rewards of an episode."""
    observation, info = env.reset(seed=seed)
    seen, rewards = [observation], []
    while True:
        observation, reward, terminated, truncated, info = env.step(policy(observation, info))
        seen.append(observation)
        rewards.append(reward)
        if terminated or truncated:
            return np.array(seen), rewards, terminated


def press(observation, info):
    """Moves down while the force is below the target."""
    return [0.0, 0.0, np.clip(2e-3 * (info['tissue_force'] - observation[8]), -1e-3, 1e-3)]


@pytest.mark.parametrize('task', ['press', 'hold'])
def test_the_same_seed_and_actions_give_the_same_bits(task):
    env = palpate.Env(task, seconds=1.0, surface_points=5)
    first = episode(env, 3, press)
    assert episode(env, 3, press)[0].tobytes() == first[0].tobytes()
    assert episode(env, 4, press)[0].tobytes() != first[0].tobytes()
    assert first[0].shape == (101, 14) and len(env.observation_space['names']) == 14
    assert palpate.Env(task, seconds=1.0, surface_points=5).reset(seed=3)[0].tobytes() == first[0][0].tobytes()


# A proportional controller settles near the target: the last rewards are above those of a hand that stays outside, -1.
def test_a_controller_reaches_the_force_and_is_rewarded():
    seen, rewards, terminated = episode(palpate.Env('press'), 1, press)
    assert not terminated and len(rewards) == 500
    assert rewards[0] == -1.0 and np.mean(rewards[-100:]) > -0.1
    assert np.isclose(np.linalg.norm(seen[-1][5:8]), seen[-1][8], rtol=0.1)


# The vein's lumen is from 4.1 to 8.1 mm below the surface, behind it is the far wall.
def test_a_needle_is_rewarded_in_its_target_and_a_forbidden_layer_ends_the_episode():
    env = palpate.Env('insert', seconds=8.0)
    assert env.observation_space['names'][9] == 'inserted' and env.reset(seed=1)[0][9] == 0.0

    def slowly(observation, info):  # until the resistance is lost in the lumen, 1.1 N at the wall and 0.3 N behind it
        slowly.wall = slowly.wall or observation[9] > 3.4e-3
        lost = slowly.wall and observation[9] > 4.1e-3
        return [0.0, 0.0, 0.0 if lost else -1e-4]

    slowly.wall = False
    seen, rewards, terminated = episode(env, 1, slowly)
    assert not terminated and set(rewards) == {0.0, 1.0} and rewards[-1] == 1.0
    assert 4.1e-3 < seen[-1][9] < 8.1e-3

    seen, rewards, terminated = episode(env, 1, lambda observation, info: [0.0, 0.0, -1e-3])
    assert terminated and rewards[-1] == -1.0 and set(rewards[:-1]) == {0.0, 1.0}
    assert seen[-2][9] <= 8.1e-3 + 1e-6 < seen[-1][9]


def test_an_insertion_needs_a_layer_to_reach():
    press = pathlib.Path(__file__).resolve().parents[4] / 'examples' / 'press.toml'
    with pytest.raises(palpate.InputError, match='the scene has no layer to reach'):
        palpate.Env('insert', scene=str(press))


def test_a_mark_finds_the_hidden_lump_only_near_it():
    env = palpate.Env('search', organ='liver')
    start = env.reset(seed=2)[0]
    assert start[8] == 0.0
    place = np.array([env.parameters['lump_x'], env.parameters['lump_y']])
    assert np.hypot(*place) > 10e-3  # this seed's lump is not under the start
    wrong = env.step([0.0, 0.0, 0.0, 1.0])
    assert wrong[1] == -0.1 and not wrong[2]
    terminated = False
    for _ in range(400):
        away = place - wrong[0][:2]
        wrong = env.step([*np.clip(away, -7e-4, 7e-4), 0.0, float(np.hypot(*away) < 5e-3)])
        terminated = wrong[2]
        if terminated:
            break
    assert terminated and wrong[1] == 1.0
    with pytest.raises(RuntimeError, match='reset'):
        env.step([0.0, 0.0, 0.0, 0.0])


def test_lumps_are_hidden_at_different_places_by_seed():
    env = palpate.Env('search')
    places = []
    for seed in range(6):
        env.reset(seed=seed)
        places.append((env.parameters['lump_x'], env.parameters['lump_y']))
    assert len(set(places)) == 6


def test_actions_are_limited_in_speed_and_refused_in_words():
    env = palpate.Env('press')
    env.reset(seed=0)
    moved = env.step([1.0, 0.0, 0.0])[0][:3]
    assert np.allclose(moved, [1e-3, 0.0, 0.0], atol=1e-12)
    for action in ([0.0, 0.0], [0.0, np.nan, 0.0]):
        with pytest.raises(palpate.InputError, match='3 finite numbers: dx, dy, dz'):
            env.step(action)
    with pytest.raises(palpate.InputError, match='press, hold, search or insert'):
        palpate.Env('dance')
    with pytest.raises(palpate.InputError, match='ticks = 0: must be 1 to 1000'):
        palpate.Env(ticks=0)


def test_the_start_without_a_seed_is_random_and_then_goes_on():
    env = palpate.Env('press')
    targets = [env.reset()[0][8] for _ in range(3)] + [palpate.Env('press').reset()[0][8]]
    assert len(set(targets)) == 4
    first = env.reset(seed=5)[0][8]
    assert env.reset()[0][8] != first and env.reset(seed=5, options={})[0][8] == first


def test_a_scene_keeps_its_own_organ_and_tool(tmp_path):
    (tmp_path / 'press.toml').write_text('[organ]\nmesh = "box"\n[tool]\nmesh = "sphere:3"\n')
    start = palpate.Env(scene=tmp_path / 'press.toml').reset(seed=1)[0]
    assert start.tobytes() == palpate.Env(organ='box', tool='sphere:3').reset(seed=1)[0].tobytes()


# The class of env.py's docstring, with stand-ins of the two classes of Gymnasium that it needs.
def test_the_adapter_of_the_docstring_fits_gymnasium():
    class Box:
        def __init__(self, low, high, shape, dtype):
            assert low.shape == high.shape == shape
            self.low, self.high, self.dtype = low.astype(dtype), high.astype(dtype), dtype

        def contains(self, values):
            return values.dtype == self.dtype and ((values >= self.low) & (values <= self.high)).all()

    class GymnasiumEnv:
        def reset(self, *, seed=None, options=None):
            pass

    names = {'palpate': palpate, 'np': np,
             'gymnasium': types.SimpleNamespace(Env=GymnasiumEnv, spaces=types.SimpleNamespace(Box=Box))}
    text = inspect.getdoc(inspect.getmodule(palpate.Env))
    exec(textwrap.dedent(text[text.index('    class GymEnv'):]), names)
    env = names['GymEnv']('search', seconds=0.05)
    assert env.observation_space.contains(env.reset(seed=1, options=None)[0])
    for _ in range(5):
        observation, reward, terminated, truncated, info = env.step(env.action_space.low)
        assert env.observation_space.contains(observation)
        assert (type(reward), type(terminated), type(truncated), type(info)) == (float, bool, bool, dict)
    assert truncated and not terminated


@pytest.mark.parametrize('flags', [['--task', 'press', '--stiffness-factor', '0.5:2', '--noise-gain-N-m', '0:5e-5'],
                                   ['--task', 'hold', '--surface-points', '3', '--start-offset-mm', '4', '--policy', 'random'],
                                   ['--task', 'search', '--organ', 'kidney', '--policy', 'random', '--tolerance-mm', '30',
                                    '--rate-Hz', '2000', '--ticks', '7']])
def test_the_actions_of_a_generated_file_give_its_observations_again(flags, program, tmp_path):
    file = tmp_path / 'episodes.npz'
    program('generate', '--episodes', '3', '--steps', '150', '--seed', '9', '--out', file, *flags)
    data = np.load(file)  # refuses pickles
    meta = json.loads(str(data['metadata']))
    env = palpate.Env(**meta['arguments'])
    assert env.observation_space['names'] == meta['observations']['names']
    starts = data['episode_starts']
    assert len(starts) == 3 and len(set(data['seeds'])) == 3
    for episode, (first, end) in enumerate(zip(starts, [*starts[1:], len(data['rewards'])])):
        observation, info = env.reset(seed=int(data['seeds'][episode]))
        assert list(env.parameters) == meta['parameters']['names']
        assert list(env.parameters.values()) == data['parameters'][episode].tolist()
        for i in range(first, end):
            assert observation.tobytes() == data['observations'][i].tobytes()
            observation, reward, terminated, truncated, info = env.step(data['actions'][i])
            assert (reward, terminated, truncated) == (data['rewards'][i], data['terminals'][i], data['timeouts'][i])
        assert terminated or truncated
        assert observation.tobytes() == data['final_observations'][episode].tobytes()


@pytest.mark.parametrize('name', ['learn_to_press', 'clone_a_press'])
def test_example_draws(run, name, tmp_path):  # noqa: F811
    expect_drawn(run, name, tmp_path)
