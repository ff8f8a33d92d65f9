"""The examples run and draw."""
import importlib.util
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import palpate
from test_validate import profile_of, side_view, write_columns, write_gray_png

EXAMPLES = pathlib.Path(__file__).resolve().parents[3] / 'examples' / 'python'
DRAWING = ('law_curves', 'simulated_press', 'fit_specimens', 'compare_tissues', 'live_control', 'validate_tissue')


ROOT = EXAMPLES.parents[1]


def measure(folder):
    """The files that docs/python.md names, made with the package itself."""
    liver = palpate.tissue_preset('liver')
    depth = np.linspace(0.0, 14e-3, 40)
    force = palpate.LayeredSpringLaw(liver).force_at(depth)
    for name in ('liver.csv', 'liver-3.csv'):
        write_columns(folder / name, ('displacement_mm', 'force_N'), 1e3 * depth, force)
    r = np.linspace(0.0, 30e-3, 40)
    write_columns(folder / 'side.csv', ('r_mm', 'u_mm'), 1e3 * r, 1e3 * profile_of(liver.reach, 5e-3, 5e-3, r))
    write_gray_png(folder / 'before.png', side_view(0.0, 8e-5, 3e-3))
    write_gray_png(folder / 'after.png', side_view(4e-3, 8e-5, 3e-3))


class Docs(unittest.TestCase):
    @unittest.skipUnless(importlib.util.find_spec('pandas'), 'pandas (package python3-pandas) is not there')
    def test_of_python_run_as_they_stand(self):
        blocks = re.findall(r'^```python\n(.*?)^```', (ROOT / 'docs' / 'python.md').read_text(), re.MULTILINE | re.DOTALL)
        self.assertGreater(len(blocks), 8)
        with tempfile.TemporaryDirectory() as folder:
            measure(pathlib.Path(folder))
            (pathlib.Path(folder) / 'examples').symlink_to(ROOT / 'examples')
            done = subprocess.run([sys.executable, '-B', '-c', '\n'.join(blocks)], cwd=folder, timeout=240,
                                  capture_output=True, text=True, env={**os.environ, 'XDG_STATE_HOME': folder})
            self.assertEqual((done.returncode, done.stderr), (0, ''))
            self.assertIn('every bit the same', done.stdout)

    def test_of_python_name_all_that_is_public_once(self):
        page = (ROOT / 'docs' / 'python.md').read_text()
        table = page[page.index('| what |'):page.index('[`examples/python`]')]
        named = re.findall(r'`(\w+)`', table)
        self.assertEqual(sorted(named), sorted(name for name in palpate.__all__ if not name.endswith('Error')))


class Examples(unittest.TestCase):
    def test_are_short(self):
        for file in EXAMPLES.glob('*.py'):
            self.assertLess(len(file.read_text().splitlines()), 150, file.name)

    @unittest.skipUnless(importlib.util.find_spec('matplotlib'), 'matplotlib (package python3-matplotlib) is not there')
    def test_draw(self):
        for name in DRAWING:
            with self.subTest(name), tempfile.TemporaryDirectory() as folder:
                done = subprocess.run([sys.executable, '-B', EXAMPLES / f'{name}.py', '--out', folder], timeout=240,
                                      capture_output=True, text=True, env={**os.environ, 'MPLCONFIGDIR': folder})
                self.assertEqual((done.returncode, done.stderr), (0, ''), done.stderr)
                picture = (pathlib.Path(folder) / f'{name}.png').read_bytes()
                self.assertEqual(picture[:8], b'\x89PNG\r\n\x1a\n')
                self.assertGreater(len(picture), 20_000)


if __name__ == '__main__':
    unittest.main()
