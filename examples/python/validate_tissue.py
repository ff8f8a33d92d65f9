#!/usr/bin/env python3
"""Compares a tissue with measured forces and with baseline models, and the error with the smallest difference that a hand
notices, as figure 7 of the paper does. The measurements are synthetic. Writes validate_tissue.png.
"""
import numpy as np

import palpate
from common import BLUE, GREEN, GREY, ORANGE, figure, out_folder, save

NOTICED = 0.07  # fraction of a force, the smallest difference that a hand notices (docs/model.md)


def main():
    folder = out_folder(__doc__)
    # A specimen that is slightly stiffer than the tissue in the library.
    specimen_tissue = palpate.tissue_preset('liver')
    specimen_tissue.k1 *= 1.04
    depth = np.linspace(0.0, 10e-3, 60)
    sensor = 3e-3 * np.random.default_rng(7).standard_normal(depth.size)
    force = palpate.spring_law(specimen_tissue).force_at(depth) + sensor
    specimen = palpate.Specimen('liver, made here', depth, force)

    found = palpate.validate('liver', forces=[specimen], against=['hertz', 'linear'])['forces'][0]
    made, (above, below) = figure(2, 6.5)
    x = 1e3 * found['displacement']
    above.plot(x, found['measured'], 'o', ms=3, color=ORANGE, label='measured')
    above.plot(x, found['computed'], color=BLUE, lw=2, label=f"the tissue, RMS {100 * found['nrmse']:.1f} %")
    for rival, colour in zip(found['against'], (GREEN, GREY)):
        above.plot(x, rival['computed'], color=colour, lw=1.2, ls='--',
                   label=f"{rival['name']}, fitted to these data, RMS {100 * rival['nrmse']:.1f} %")
    above.set_ylabel('force, N')
    above.set_title(found['name'])
    above.legend(frameon=False)
    below.plot(x, 1e3 * np.abs(found['computed'] - found['measured']), '.-', lw=1, ms=4, color=BLUE, label='absolute error')
    below.plot(x, 1e3 * NOTICED * np.abs(found['measured']), color='black', lw=1, ls=':', label='7 % of the force')
    below.set_ylabel('mN')
    below.set_xlabel('displacement, mm')
    below.legend(frameon=False, loc='upper left')
    save(made, folder / 'validate_tissue.png')
    print(f"RMS {1e3 * found['rms']:.1f} mN, {100 * found['nrmse']:.2f} % of the range; "
          f"{100 * found['within_jnd']:.0f} % of the points within {100 * NOTICED:g} %")


if __name__ == '__main__':
    main()
