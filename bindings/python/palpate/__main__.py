"""The command `palpate` of the wheel, also `python -m palpate`.

Where the program palpate is on the PATH, the command is that program, with all its commands and flags. Otherwise it does what this
package can do alone, with the program's names: run (offline), fit, export, inspect and doctor. Flags of run and fit are the
arguments of simulate() and fit().
"""
import argparse
import os
import pathlib
import re
import sys

import palpate
from palpate import _calls, _palpate, _shown

ELSEWHERE = ('view', 'demo', 'model', 'noise', 'replay', 'repair', 'serve', 'ros', 'devices', 'score', 'study', 'sweep', 'generate',
             'validate', 'bench', 'list')
NEEDS = 'needs the program palpate, which is not on the PATH (Debian package palpate, or ./run in the sources)'


def program():
    """The program palpate on the PATH, or None. The wheel's own command of that name is a script."""
    for folder in os.get_exec_path():
        file = pathlib.Path(folder) / 'palpate'
        try:
            with file.open('rb') as content:
                if content.read(4) == b'\x7fELF' and os.access(file, os.X_OK):
                    return str(file)
        except OSError:
            continue
    return None


class Parser(argparse.ArgumentParser):
    def error(self, message):
        known = [*ELSEWHERE, 'run', 'fit', 'export', 'inspect', 'doctor']
        found = re.search(r"invalid choice: '(.*?)'", message)
        if found and found[1] in known:
            message = f'{found[1]}: {NEEDS}'
        elif found:
            message = str(_calls.unknown('palpate', found[1], known)).replace('() has no argument', ' has no command')
        elif 'unrecognized' in message:
            message = message.replace('unrecognized arguments: ', '') + f': no flag of the Python package; a flag of the program {NEEDS}'
        sys.exit(stop(message))


def stop(message):
    print(f'palpate: {message}', file=sys.stderr)
    return 2


def add_flags(parser, function, without):
    """A flag for each argument of `function`. One that is a list may be given several times."""
    for name, kind in _calls.arguments(function.__doc__).items():
        flag = '--' + name.replace('_', '-')
        if name in without:
            continue
        if name in ('noise', 'cache'):  # on, unless --no-noise
            parser.add_argument('--no-' + name, dest=name, action='store_false', default=None)
        elif kind == 'bool':
            parser.add_argument(flag, dest=name, action='store_true', default=None)
        elif 'List' in kind:
            parser.add_argument(flag.removesuffix('s') if name == 'inclusions' else flag, dest=name, action='append')
        else:
            number = float if 'float' in kind and 'str' not in kind else int if 'int' in kind else str
            parser.add_argument(flag, dest=name, type=number)


def given(options, function):
    """The flags that are given, as arguments of `function`."""
    known = _calls.arguments(function.__doc__)
    return {name: value for name, value in vars(options).items() if name in known and value is not None}


def run(options):
    arguments = given(options, palpate.simulate)
    rows = palpate.simulate(options.file, **arguments)
    print(f'{_shown.counted(len(rows), "row")}, largest force {_shown.number(rows["tissue_force_N"].max())} N, '
          f'largest depth {_shown.number(1e3 * rows["depth_m"].max())} mm' if len(rows) else 'no rows')
    if options.record:
        print(options.record)
    return 3 if (rows['fault'] != 0).any() else 0


def fit(options):
    found = palpate.fit(palpate.read_specimens(options.files), **given(options, palpate.fit))
    print(found)
    if options.out is not None:
        tissue = found['pooled']['tissue']
        if tissue is None:
            return stop(f'--out {options.out}: not written, the error is over 20 % of the force range')
        tissue.name = pathlib.Path(options.out).stem
        pathlib.Path(options.out).write_text(tissue.to_toml())
        print(options.out)
    return 0


def export(options):
    count = palpate.read_recording(options.recording).export_csv(options.csv)
    print(f'{options.csv}: {_shown.counted(count, "row")}', file=sys.stderr)
    return 0


def inspect(options):
    if re.search('[/.]', options.mesh):
        mesh, findings = palpate.read_mesh(options.mesh, options.unit or 'mm')
        if options.unit is None:
            print(f'palpate: {options.mesh}: no --unit given: mm is assumed', file=sys.stderr)
    else:
        mesh = palpate.make_organ(options.mesh)
        findings = mesh.findings()
    print(f'{mesh}\n{findings}')
    for name in ('repairs', 'defects', 'remarks'):
        for text in getattr(findings, name):
            print(f'{name[:-1]}: {text}')
    return 0


def doctor(options):
    for name, verdict, found, advice in _palpate._machine_checks():
        print(f'{verdict:8}{name:24}{found}' + (f'\n        -> {advice}' if advice else ''))
    return 0


def parser_of_commands():
    parser = Parser(prog='palpate', description='Palpate lets a hand feel soft tissue through a force-feedback device. This is the '
                    f'part of its program that the Python package has; {", ".join(ELSEWHERE[:3])} and others need the program.')
    parser.add_argument('--version', action='version', version=f'palpate {palpate.__version__}')
    commands = parser.add_subparsers(required=True, metavar='COMMAND')

    def add(function, summary, example):
        command = commands.add_parser(function.__name__, help=summary, description=summary, epilog=f'Example: palpate {example}',
                                      allow_abbrev=False)
        command.set_defaults(function=function)
        return command

    command = add(run, 'Run one interaction offline', 'run --offline --tissue liver --record press.h5')
    command.add_argument('file', nargs='?', metavar='SCENE.toml')
    command.add_argument('--offline', action='store_true', help='always so here')
    add_flags(command, palpate.simulate, ('scene', 'scene_text'))
    if hasattr(palpate, 'fit'):
        command = add(fit, 'Identify a tissue from measured curves', 'fit liver-[1-4].csv --law smooth --out liver.toml')
        command.add_argument('files', nargs='+', metavar='DATA.csv')
        add_flags(command, palpate.fit, ('specimens', 'loop_period', 't1'))
        command.add_argument('--out', metavar='TISSUE.toml')
    command = add(export, "Write a recording's ticks as CSV", 'export press.h5 --csv press.csv')
    command.add_argument('recording')
    command.add_argument('--csv', required=True)
    command = add(inspect, 'Describe a mesh and its repairs', 'inspect liver.stl --unit mm')
    command.add_argument('mesh')
    command.add_argument('--unit')
    add(doctor, 'Check what this machine lacks for real time', 'doctor')
    return parser


def main():
    found = program()
    if found is not None:
        os.execv(found, [found, *sys.argv[1:]])
    options = parser_of_commands().parse_args()
    try:
        return options.function(options)
    except (palpate.InputError, OSError) as error:
        return stop(error)


if __name__ == '__main__':
    sys.exit(main())
