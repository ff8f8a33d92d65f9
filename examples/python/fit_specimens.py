#!/usr/bin/env python3
"""Fits synthetic measurements of a known tissue as `palpate fit` does: curves and 95 % intervals.

Writes specimens.csv, fitted.toml and fit_specimens.png.
"""
import numpy as np

import palpate
from common import BLUE, GREY, ORANGE, out_folder, plt, save

SPECIMENS = 3
SENSOR = 4e-3  # N, standard deviation of the force sensor


def measure(file, truth):
    """Writes a CSV of specimens with different stiffness, each pressed 15 mm deep, into its third layer."""
    random = np.random.default_rng(5)
    depth = np.linspace(0.0, 15e-3, 60)
    with file.open('w') as out:
        out.write('specimen,displacement_mm,force_N\n')
        for number in range(SPECIMENS):
            tissue = truth.replace(k1=truth.k1 * (1.0 + 0.08 * random.standard_normal()))
            force = palpate.LayeredSpringLaw(tissue).force_at(depth) + SENSOR * random.standard_normal(depth.size)
            for one, load in zip(depth, force):
                out.write(f'liver-{number + 1},{1e3 * one:.4f},{load:.5f}\n')


def main():
    folder = out_folder(__doc__)
    truth = palpate.tissue_preset('liver')
    measure(folder / 'specimens.csv', truth)
    found = palpate.fit(palpate.read_specimens(folder / 'specimens.csv'), direction='press')
    (folder / 'fitted.toml').write_text(found['pooled']['tissue'].to_toml())

    made, panes = plt.subplots(1, 3, figsize=(11, 4), constrained_layout=True, width_ratios=(2.2, 1, 1))
    curve = panes[0]
    for number, one in enumerate(found['specimens']):
        first = number == 0
        curve.plot(1e3 * one['displacement'], one['measured'], '.', ms=3, color=ORANGE,
                   label='measured' if first else None)
        curve.fill_between(1e3 * one['displacement'], one['low'], one['high'], color=BLUE, alpha=0.2, lw=0)
        curve.plot(1e3 * one['displacement'], one['fitted'], color=BLUE, lw=1.3, label='fitted' if first else None)
    curve.set(xlabel='displacement, mm', ylabel='force, N', title='three specimens')
    curve.legend(frameon=False)
    for pane, name, right in ((panes[1], 'k1_N_per_m', truth.k1), (panes[2], 'q', truth.q)):
        all_fits = [*found['specimens'], found['pooled']]
        value, low, high = np.transpose([one['parameters'][name] for one in all_fits])
        colours = [BLUE] * SPECIMENS + ['black']
        for place in range(len(all_fits)):
            pane.errorbar(place, value[place], [[value[place] - low[place]], [high[place] - value[place]]], fmt='o', ms=5,
                          capsize=4, color=colours[place])
        pane.axhline(right, color=GREY, ls='--', lw=1)
        pane.set_xticks(range(len(all_fits)), [*map(str, range(1, SPECIMENS + 1)), 'all'])
        pane.set(title=name, xlabel='specimen')
    for pane in panes:
        pane.grid(color='#e4e4e4')
        pane.spines[['top', 'right']].set_visible(False)
    save(made, folder / 'fit_specimens.png')
    for name, (value, low, high) in found['pooled']['parameters'].items():
        print(f'{name}: {value:.4g} ({low:.4g} to {high:.4g})')


if __name__ == '__main__':
    main()
