#!/usr/bin/env python3
"""Compares the built-in tissues under the same press, and the deformed surface around a ball. Writes compare_tissues.png.
"""
import numpy as np

import palpate
from common import BLUE, GREEN, GREY, ORANGE, out_folder, plt, save

COLOURS = {'gallbladder': GREEN, 'heart': ORANGE, 'liver': BLUE, 'kidney': GREY}


def flat(half, edge):
    """A flat square mesh, and the positions of its middle row."""
    line = np.arange(-half, half + edge / 2, edge)
    count = line.size
    x, y = np.meshgrid(line, line)
    corner = (np.arange(count - 1)[:, None] * count + np.arange(count - 1)).ravel()
    triangles = np.concatenate([np.stack([corner, corner + 1, corner + count + 1], 1),
                                np.stack([corner, corner + count + 1, corner + count], 1)])
    vertices = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], 1)
    return palpate.Mesh(vertices, triangles), count // 2 * count + np.arange(count)


def draw_surfaces(pane):
    """Draws sections of the deformed surface. The built-in tissues have equal falloff ratios, so it adds other ratios."""
    mesh, middle = flat(40e-3, 0.5e-3)
    narrow = palpate.tissue_preset('liver')
    contact, first, ratio, weight = narrow.reach
    narrow.reach = (contact, 0.4 * first, ratio, weight)
    for tissue, style, label in (('liver', '-', '{:g} mm deep'), (narrow, ':', 'narrower reach')):
        for depth, colour in ((2e-3, GREEN), (5e-3, BLUE)):
            press = palpate.Indentation((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), depth=depth, tip_radius=5e-3)
            moved = palpate.deformed_surface(mesh, [press], tissue).vertices[middle]
            said = label.format(1e3 * depth) if style == '-' or depth == 5e-3 else None
            pane.plot(1e3 * moved[:, 0], 1e3 * moved[:, 2], style, color=colour, lw=1.5, label=said)


def main():
    folder = out_folder(__doc__)
    made, (force, over_time, surface) = plt.subplots(1, 3, figsize=(12, 4), constrained_layout=True)
    depth = np.linspace(0.0, 12e-3, 400)
    for name, colour in COLOURS.items():
        tissue = palpate.tissue_preset(name)
        force.plot(1e3 * depth, palpate.spring_law(tissue).force_at(depth), color=colour, lw=2, label=name)

        rows = palpate.simulate(organ='gallbladder', tool='sphere:5', tissue=name, noise=False)
        over_time.plot(rows['time_s'], rows['tissue_force_N'], color=colour, lw=1.5)
    draw_surfaces(surface)
    force.set(xlabel='depth, mm', ylabel='force, N', title='the law')
    force.legend(frameon=False)
    over_time.set(xlabel='time, s', ylabel='force of the tissue, N', title='the same press on each')
    surface.set(xlabel='mm', ylabel='height, mm', title='a surface under a ball of 5 mm')
    surface.legend(frameon=False, fontsize=8, loc='lower right')
    for pane in (force, over_time, surface):
        pane.grid(color='#e4e4e4')
        pane.spines[['top', 'right']].set_visible(False)
    save(made, folder / 'compare_tissues.png')


if __name__ == '__main__':
    main()
