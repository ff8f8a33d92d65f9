"""What belongs to the package beside its functions: type stubs, pandas tables."""
import ast
import importlib.util
import inspect
import pathlib
import subprocess
import sys
import tempfile
import unittest

import palpate

FOLDER = pathlib.Path(palpate.__file__).parent

GOOD = '''
import numpy
import palpate

with palpate.Simulation("a.toml", tissue=palpate.tissue_preset("liver"), duration_s=1.0) as simulation:
    state = simulation.state()
    if state is not None:
        depth: float = state.hands[0].depth
    simulation.set_noise(gain=1e-4)
force: numpy.ndarray = palpate.LayeredSpringLaw(palpate.load_tissue("heart")).force_at([1e-3, 2e-3])
tissue: palpate.Tissue = palpate.validate("liver", forces=palpate.read_specimens("a.csv"))["tissue"]
tissue.k1 = 12.0
'''
BAD = ('palpate.tissue_preset(3)', 'palpate.tissue_preset("liver").k2', 'palpate.simulate(tisue="liver")',
       'palpate.Simulation().state().tick')


class Stubs(unittest.TestCase):
    def test_name_everything_that_is_public(self):
        self.assertTrue((FOLDER / 'py.typed').is_file())
        tree = ast.parse((FOLDER / '__init__.pyi').read_text())
        named = {node.name: node for node in tree.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
        self.assertEqual(sorted(named), sorted(palpate.__all__))
        for name, node in named.items():
            found = getattr(palpate, name)
            if not inspect.isclass(found):
                continue
            members = {part.name for part in node.body if isinstance(part, ast.FunctionDef)}
            for member in vars(found):
                if not member.startswith('_'):
                    self.assertIn(member, members, name)

    @unittest.skipUnless(importlib.util.find_spec('mypy'), 'mypy (package mypy) is not there')
    def test_let_mypy_see_what_is_right_and_wrong(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / 'use.py'
            lines = GOOD.splitlines()
            file.write_text('\n'.join(lines + list(BAD)) + '\n')
            done = subprocess.run([sys.executable, '-m', 'mypy', '--cache-dir', folder, file], capture_output=True, text=True,
                                  env={'MYPYPATH': str(FOLDER.parent), 'PATH': '/usr/bin'})
            wrong = {int(line.split(':')[1]) for line in done.stdout.splitlines() if ' error: ' in line}
            self.assertEqual(wrong, set(range(len(lines) + 1, len(lines) + 1 + len(BAD))), done.stdout)


class Tables(unittest.TestCase):
    @unittest.skipUnless(importlib.util.find_spec('pandas'), 'pandas (package python3-pandas) is not there')
    def test_have_the_rows_with_phase_and_fault_in_words(self):
        with tempfile.TemporaryDirectory() as folder:
            rows = palpate.simulate(duration_s=3.0, record=pathlib.Path(folder) / 'run.h5')
            frame = palpate.to_pandas(rows)
            self.assertEqual(list(frame.columns), list(rows.dtype.names))
            self.assertTrue((frame['depth_m'].to_numpy() == rows['depth_m']).all())
            self.assertEqual(list(frame['phase']), [('approach', 'press', 'pull')[phase] for phase in rows['phase']])
            self.assertEqual(set(frame['fault']), {'none'})
            self.assertTrue(frame.equals(palpate.read_recording(pathlib.Path(folder) / 'run.h5').to_pandas()))

    @unittest.skipIf(importlib.util.find_spec('pandas'), 'pandas is there')
    def test_need_pandas(self):
        with self.assertRaises(ImportError):
            palpate.to_pandas(palpate.simulate(duration_s=0.01))


if __name__ == '__main__':
    unittest.main()
