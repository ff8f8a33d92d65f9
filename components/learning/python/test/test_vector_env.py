"""Many environments at once give what each gives alone."""
import numpy as np
import pytest

import palpate

RANGES = {'stiffness_factor': (0.5, 2.0), 'noise_gain': (0.0, 5e-5), 'start_offset': 2e-3, 'noise': True}


def press(observation, force):
    """Moves down while the force is below the target."""
    return np.stack([0.0 * force, 0.0 * force, np.clip(2e-3 * (force - observation[..., 8]), -1e-3, 1e-3)], axis=-1)


@pytest.mark.parametrize('task, jobs', [('press', 1), ('press', 3), ('hold', None), ('search', None), ('insert', 2)])
def test_every_environment_has_the_bits_of_one_alone(task, jobs):
    settings = {'seconds': 0.8, 'surface_points': 4, **RANGES}
    envs = palpate.VectorEnv(task, 3, jobs=jobs, **settings)
    single = [palpate.Env(task, **settings) for _ in range(3)]
    seen, info = envs.reset(seed=7)
    alone = [env.reset(seed=7 + i) for i, env in enumerate(single)]
    for _ in range(80):
        assert seen.tobytes() == np.stack([one[0] for one in alone]).tobytes()
        for name in info.keys() - {'final_observation'}:
            assert list(info[name]) == [one[-1][name] for one in alone]
        actions = press(seen, info['tissue_force'])
        if task == 'search':
            actions = np.concatenate([actions - [0.0, 0.0, 5e-4], np.zeros((3, 1))], axis=1)
        if task == 'insert':
            actions = actions - [0.0, 0.0, 1e-3]
        seen, rewards, terminated, truncated, info = envs.step(actions)
        alone = [env.step(action) for env, action in zip(single, actions)]
        assert list(rewards) == [one[1] for one in alone]
        assert [list(terminated), list(truncated)] == [[one[2] for one in alone], [one[3] for one in alone]]
        if truncated.any():
            break
    assert truncated.all() and info['tissue_force'].max() > 0.05
    # The next episode has begun, with the random numbers that follow.
    assert info['final_observation'].tobytes() == np.stack([one[0] for one in alone]).tobytes()
    assert seen.tobytes() == np.stack([env.reset()[0] for env in single]).tobytes()
    for name, values in envs.parameters.items():
        assert list(values) == [env.parameters[name] for env in single]


def test_only_an_environment_whose_episode_ends_starts_the_next_one():
    envs = palpate.VectorEnv('search', 2, tolerance=0.5)
    first = envs.reset(seed=3)[0].copy()
    moved = envs.step([[1e-3, 0.0, 0.0, 0.0], [1e-3, 0.0, 0.0, 1.0]])
    assert list(moved[2]) == [False, True] and list(moved[1]) == [0.0, 1.0]
    assert moved[0][0, 0] == pytest.approx(1e-3) and moved[0][1, 0] == first[1, 0]
    assert moved[4]['final_observation'][:, 0] == pytest.approx([1e-3, 1e-3])


def test_without_a_seed_the_environments_start_differently():
    envs = palpate.VectorEnv('press', 4)
    assert np.isnan(envs.parameters['target']).all()
    targets = np.concatenate([envs.reset()[0][:, 8] for _ in range(2)])
    assert len(set(targets)) == 8


@pytest.mark.parametrize('actions, words', [(np.zeros((3, 3)), r'must have shape \(2, 3\)'), (np.zeros(3), r'must have shape \(2, 3\)'),
                                            ([[0.0, 0.0, 0.0], [0.0, np.inf, 0.0]], r'actions\[1, 1\] = inf: must be finite')])
def test_actions_are_refused_in_words_before_any_environment_steps(actions, words):
    envs = palpate.VectorEnv('press', 2)
    tick = envs.reset(seed=1)[1]['tick']
    with pytest.raises(palpate.InputError, match=words):
        envs.step(actions)
    assert (envs.step(np.zeros((2, 3)))[4]['tick'] == tick + envs.ticks).all()


def test_settings_are_refused_in_words():
    for settings, words in (({'num_envs': 0}, 'num_envs = 0: must be 1 to'), ({'jobs': 0}, 'jobs = 0: must be 1 to'),
                            ({'task': 'dance'}, 'press, hold, search or insert')):
        with pytest.raises(palpate.InputError, match=words):
            palpate.VectorEnv(**settings)
    with pytest.raises(RuntimeError, match='reset'):
        palpate.VectorEnv('press', 2).step(np.zeros((2, 3)))
