#!/usr/bin/env python3
"""Measures a force threshold from a script, as in PsychoPy: QUEST+ chooses the force, the device gives it in one of two
intervals. Here a simulated observer feels the force; a person would answer by a key, with device='haply' or another
in place of the emulated one. Writes force_threshold.png.
"""
import math
import time

import numpy as np

import palpate
from common import BLUE, GREY, ORANGE, figure, out_folder, save
from palpate import study

TRIALS = 12
INTERVAL = 250   # ticks of 1 ms
BETWEEN = 150
THRESHOLD = 0.04  # N, of the simulated observer: 82 % correct


def give(simulation, force, signal):
    """Two intervals at exact ticks, the force in one of them. Returns their first ticks."""
    starts = []
    tick = simulation.state().tick + 60
    for interval in (1, 2):
        starts.append(tick)
        simulation.set_stimulus(force if interval == signal else 0.0, interval=interval, not_before_tick=tick)
        simulation.set_stimulus(0.0, not_before_tick=tick + INTERVAL)
        tick += INTERVAL + BETWEEN
    while simulation.state().tick < tick:
        time.sleep(0.01)
    return starts


def give_again_after_a_fault(simulation, force, signal):
    """As give(). A fault takes the force away: it is reset, and the trial repeated once the soft start has ended."""
    starts = give(simulation, force, signal)
    while fault := simulation.state().hands[0].fault:
        print(f'trial repeated after a fault: {fault}')
        simulation.reset_fault()
        while simulation.rows()['engagement'][-1] < 1.0 and not simulation.wait(0.05):
            if simulation.state().hands[0].fault:
                simulation.reset_fault()
        starts = give(simulation, force, signal)
    return starts


def answer(simulation, starts, trial, observer):
    """The observer's answer to the forces that the device gave."""
    rows = simulation.rows()
    felt = [rows['stimulus_force_N'][(rows['tick'] >= start) & (rows['tick'] < start + INTERVAL)].max()
            for start in starts]
    second = felt[1] > felt[0]
    level = math.log10(max(felt) / THRESHOLD)
    return study.draw_answer(observer.probability_second(level, second=bool(second)), 7, 1, trial)


def main():
    folder = out_folder(__doc__)
    quest = study.QuestPlus.detection(5e-3, 0.5)
    observer = study.Observer('ideal')
    random = np.random.default_rng(1)
    seen = []
    with palpate.Simulation(device='emulated', duration_s=600.0) as simulation:
        simulation.set_noise(enabled=False)
        for trial in range(TRIALS):
            index = quest.next()
            signal = int(random.integers(1, 3))
            starts = give_again_after_a_fault(simulation, 10 ** quest.levels[index], signal)
            correct = answer(simulation, starts, trial, observer) == (signal == 2)
            quest.update(index, correct)
            found = quest.threshold()
            seen.append((1e3 * 10 ** quest.levels[index], correct, *(1e3 * 10 ** found[key] for key in ('mean', 'low', 'high'))))
    force, correct, mean, low, high = (np.array(column) for column in zip(*seen))
    trials = np.arange(1, TRIALS + 1)
    made, (pane,) = figure(1, 4.0)
    pane.fill_between(trials, low, high, color=BLUE, alpha=0.15, lw=0, label='95 % interval')
    pane.plot(trials, mean, color=BLUE, label='threshold, 75 % correct')
    pane.plot(trials[correct], force[correct], 'o', color=GREY, label='correct')
    pane.plot(trials[~correct], force[~correct], 'x', color=ORANGE, ms=9, mew=2, label='not correct')
    pane.set_yscale('log')
    pane.set_xlabel('trial')
    pane.set_ylabel('force, mN')
    pane.legend(frameon=False, ncols=2)
    save(made, folder / 'force_threshold.png')
    print(f'{TRIALS} trials: threshold {mean[-1]:.0f} mN, 95 % interval {low[-1]:.0f} to {high[-1]:.0f} mN')


if __name__ == '__main__':
    main()
