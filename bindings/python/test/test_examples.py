"""The examples run and draw."""
import importlib.util
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

EXAMPLES = pathlib.Path(__file__).resolve().parents[3] / 'examples' / 'python'
DRAWING = ('law_curves', 'simulated_press', 'fit_specimens', 'compare_tissues', 'live_control', 'validate_tissue')


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
