#!/usr/bin/env python3
"""Observes and changes a simulation in real time: an emulated hand presses, and halfway the tissue becomes
softer and the noise is switched off. Writes live_control.h5 and live_control.png.
"""
import numpy as np

import palpate
from common import BLUE, GREY, ORANGE, figure, out_folder, save

CHANGE_AT = 3.6


def main():
    folder = out_folder(__doc__)
    seen = []
    simulation = palpate.Simulation(device='emulated', tool='sphere:5',
                                    record=folder / 'live_control.h5')
    with simulation:
        changed = False
        while not simulation.wait(0.02):  # 50 states per second, as for a display
            state = simulation.state()
            hand = state.hands[0]
            seen.append((state.time, hand.depth, hand.tissue_force))
            if not changed and state.time >= CHANGE_AT:
                softer = simulation.tissue
                softer.k1 *= 0.6
                for warning in simulation.set_tissue(softer):
                    print('warning:', warning)
                simulation.set_noise(enabled=False)
                changed = True
            if hand.fault:
                print('fault:', hand.fault)
                simulation.reset_fault()
    report = simulation.report()
    print(f"{report['ticks']} ticks, median {1e-3 * report['tick_p50_ns']:.1f} us; "
          f"{report['missed_deadlines']} deadlines missed")

    recording = palpate.read_recording(folder / 'live_control.h5')
    print('replayed:', recording.replay_difference() or 'every bit the same')
    rows = recording.rows
    made, (force, depth) = figure(2, 6.0)
    force.plot(rows['time_s'], np.linalg.norm([rows[f'force_{axis}_N'] for axis in 'xyz'], axis=0), color=GREY, lw=0.6,
               label='to the hand')
    force.plot(rows['time_s'], rows['tissue_force_N'], color=BLUE, lw=1.8, label='of the tissue')
    depth.plot(rows['time_s'], 1e3 * rows['depth_m'], color=BLUE, lw=1.8, label='recorded, 1000 a second')
    time, deep, _ = np.transpose(seen)
    depth.plot(time, 1e3 * deep, '.', ms=4, color=ORANGE, label='seen live')
    for tick in rows['tick'][(rows['events'] & 2) != 0][:1]:
        for pane in (force, depth):
            pane.axvline(tick / recording.rate_Hz, color='black', lw=1, ls=':')
        force.annotate('softer tissue, no noise', (tick / recording.rate_Hz, force.get_ylim()[1]), xytext=(4, -12),
                       textcoords='offset points')
    force.set_ylabel('force, N')
    depth.set_ylabel('depth, mm')
    depth.set_xlabel('time, s')
    force.legend(frameon=False, loc='upper left')
    depth.legend(frameon=False, loc='upper left')
    save(made, folder / 'live_control.png')


if __name__ == '__main__':
    main()
