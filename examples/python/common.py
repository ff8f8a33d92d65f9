"""Shared by the examples: the output folder and the style of the figures."""
import argparse
import pathlib

import matplotlib

matplotlib.use('Agg')  # draws without a display
import matplotlib.pyplot as plt  # noqa: E402

BLUE, ORANGE, GREEN, GREY = '#0072B2', '#D55E00', '#009E73', '#777777'  # distinct for colour-blind readers [Okabe and Ito 2008]


def out_folder(document):
    """The folder of --out, or the current folder."""
    parser = argparse.ArgumentParser(description=document)
    parser.add_argument('--out', type=pathlib.Path, default=pathlib.Path('.'), help='folder for the pictures')
    folder = parser.parse_args().out
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def figure(rows, height):
    """A figure of stacked panes with a common x axis."""
    made, panes = plt.subplots(rows, 1, figsize=(7.5, height), sharex=True, constrained_layout=True, squeeze=False)
    for pane in panes[:, 0]:
        pane.grid(color='#e4e4e4')
        pane.spines[['top', 'right']].set_visible(False)
    return made, panes[:, 0]


def save(made, file):
    made.savefig(file, dpi=150)
    plt.close(made)
    print(file)
