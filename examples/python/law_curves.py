#!/usr/bin/env python3
"""The force law of a tissue: force over depth, and the deformation of each layer. Writes law_curves.png."""
import numpy as np

import palpate
from common import BLUE, GREY, ORANGE, figure, out_folder, plt, save


def main():
    folder = out_folder(__doc__)
    tissue = palpate.tissue_preset('liver')
    layered = palpate.LayeredSpringLaw(tissue, 'press', loop_period=1e-3)
    smooth = palpate.SmoothSpringLaw(tissue, 'press', loop_period=1e-3)
    depth = np.linspace(0.0, min(layered.max_depth, 15e-3), 600)
    found = layered.deformation_at(depth)

    made, (above, below) = figure(2, 6.5)
    above.plot(1e3 * depth, found['force'], color=BLUE, lw=2, label='layered law')
    above.plot(1e3 * depth, smooth.force_at(depth), color=ORANGE, lw=1.5, ls='--', label='smooth law')
    joints = np.flatnonzero(np.diff(found['cutoff_layer']))
    above.plot(1e3 * depth[joints], found['force'][joints], 'o', ms=5, color=BLUE, label='the next layer begins')
    above.set_ylabel('force, N')
    above.set_title(f'{tissue.name}: k1 {tissue.k1:g} N/m, beta {tissue.beta:g}, q {tissue.q:g}')
    above.legend(frameon=False)

    layers = found['cutoff_layer'].max()
    shades = plt.cm.viridis(np.linspace(0.1, 0.9, layers))
    below.stackplot(1e3 * depth, 1e3 * found['deformation'][:, :layers].T, colors=shades,
                    labels=[f'layer {i + 1}' for i in range(layers)])
    below.plot(1e3 * depth, 1e3 * depth, color=GREY, lw=1, ls=':')
    below.set_xlabel('depth, mm')
    below.set_ylabel('deformation of the layers, mm')
    below.legend(frameon=False, loc='upper left')
    save(made, folder / 'law_curves.png')


if __name__ == '__main__':
    main()
