"""Environments for learning."""
import numpy as np
import pytest

import palpate


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


def test_a_mark_finds_the_hidden_lump_only_near_it():
    env = palpate.Env('search', organ='liver')
    start = env.reset(seed=2)[0]
    assert start[8] == 0.0
    place = env._place[:2] - env._start['position'][0][:2]
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
        places.append(tuple(env._place))
    assert len(set(places)) == 6


def test_actions_are_limited_in_speed_and_refused_in_words():
    env = palpate.Env('press')
    env.reset(seed=0)
    moved = env.step([1.0, 0.0, 0.0])[0][:3]
    assert np.allclose(moved, [1e-3, 0.0, 0.0], atol=1e-12)
    for action in ([0.0, 0.0], [0.0, np.nan, 0.0]):
        with pytest.raises(palpate.InputError, match='3 finite numbers: dx, dy, dz'):
            env.step(action)
    with pytest.raises(palpate.InputError, match='press, hold or search'):
        palpate.Env('dance')
