#!/usr/bin/env python3
"""Simulates a press as `palpate run --offline` does: force, depth and touch noise over time. Writes simulated_press.png."""
import numpy as np

import palpate
from common import BLUE, GREY, ORANGE, figure, out_folder, save


def main():
    folder = out_folder(__doc__)
    rows = palpate.simulate(organ='gallbladder', tool='curved-forceps')
    time = rows['time_s']
    pressed = rows['phase'] == 1

    made, (force, depth, noise) = figure(3, 7.5)
    force.plot(time, np.linalg.norm([rows[f'force_{axis}_N'] for axis in 'xyz'], axis=0), color=GREY, lw=0.6,
               label='to the device, with noise')
    force.plot(time, rows['tissue_force_N'], color=BLUE, lw=1.8, label='of the tissue')
    force.set_ylabel('force, N')
    force.legend(frameon=False)
    depth.plot(time, 1e3 * rows['depth_m'], color=BLUE, lw=1.8, label='depth')
    depth.plot(time, np.where(pressed, np.nan, 1e3 * rows['distance_m']), color=ORANGE, lw=1.5, ls='--',
               label='distance before and after')
    depth.set_ylabel('mm')
    depth.legend(frameon=False)
    noise.plot(time, 1e3 * rows['noise_force_N'], color=GREY, lw=0.4)
    # Standard deviation from docs/model.md: K / (distance + d0), and K / d0 in contact.
    sigma = palpate.TouchNoise().sigma(np.maximum(rows['distance_m'], 0.0))
    for side in (-3e3, 3e3):
        noise.plot(time, side * sigma, color=ORANGE, lw=1.2, label='three standard deviations' if side > 0 else None)
    noise.set_ylim(-45.0, 45.0)
    noise.set_ylabel('touch noise, mN')
    noise.set_xlabel('time, s')
    noise.legend(frameon=False, loc='upper right')
    save(made, folder / 'simulated_press.png')

    deepest = rows[rows['depth_m'].argmax()]
    print(f"deepest {1e3 * deepest['depth_m']:.2f} mm with {deepest['tissue_force_N']:.3f} N at {deepest['time_s']:.2f} s; "
          f"{pressed.sum()} of {len(rows)} ticks in contact")


if __name__ == '__main__':
    main()
