"""Synthetic measurements from the equations of a tissue, written as input files."""
import struct
import zlib

import numpy as np

import palpate


def write_columns(file, names, *columns):
    rows = '\n'.join(','.join(repr(float(value)) for value in row) for row in zip(*columns))
    file.write_text(','.join(names) + '\n' + rows + '\n')


def profile_of(reach, depth, radius, distance):
    """Independent implementation of u(r) from docs/model.md, section 3."""
    contact, first, ratio, weight = reach
    r1 = min(contact * np.sqrt(radius * depth), radius)
    weights = weight ** np.arange(6)
    radii = r1 * (1.0 + first * (ratio ** np.arange(6) - 1.0) / (ratio - 1.0))
    bars = np.maximum(0.0, 1.0 - (distance[:, None] / radii) ** 2)
    return depth * (bars @ (weights / weights.sum()))


def write_gray_png(file, picture):
    """8-bit grey PNG of an array with values from 0 to 1."""
    lines = b''.join(b'\0' + line.tobytes() for line in (255.0 * picture).round().astype(np.uint8))

    def chunk(kind, body):
        return struct.pack('>I', len(body)) + kind + body + struct.pack('>I', zlib.crc32(kind + body))
    height, width = picture.shape
    head = struct.pack('>IIBBBBB', width, height, 8, 0, 0, 0, 0)
    file.write_bytes(b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', head) + chunk(b'IDAT', zlib.compress(lines)) +
                     chunk(b'IEND', b''))


def side_view(depth, pixel, radius):
    """Side view of an indentation of this depth [m]: bright background, tissue below, a dark ball on a shaft."""
    rows, columns = np.mgrid[0:460, 0:900].astype(float)
    tissue = palpate.tissue_preset('liver')
    r = np.abs(np.arange(900) - 450.0) * pixel
    line = 200.0 + (profile_of(tissue.reach, depth, radius, r) / pixel if depth else 0.0)
    picture = 0.75 - 0.35 / (1.0 + np.exp(-(rows - line) / 0.5))
    ball = radius / pixel
    centre = 200.0 + depth / pixel - ball if depth else 40.0
    inside = np.hypot(columns - 450.0, rows - centre) < ball
    shaft = (np.abs(columns - 450.0) < 0.4 * ball) & (rows < centre)
    picture[inside | shaft] = 0.15
    texture = np.random.default_rng(3).normal(0.0, 0.01, picture.shape)
    return np.clip(picture + texture, 0.0, 1.0)


def measured_files(folder):
    """Two force curves of a liver, one a tenth stiffer."""
    depth = np.linspace(0.0, 12e-3, 60)
    files = [folder / 'soft.csv', folder / 'stiff.csv']
    for file, factor in zip(files, (1.0, 1.1)):
        write_columns(file, ('displacement_mm', 'force_N'), 1e3 * depth,
                      factor * palpate.spring_law(palpate.tissue_preset('liver')).force_at(depth))
    return files
