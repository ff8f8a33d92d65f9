"""Generates pages from the commands' --help and the docstrings of the Python package."""
import importlib
import inspect
import re
import subprocess
import sys


def help_of(palpate, *words):
    return subprocess.run([palpate, *words, '--help'], capture_output=True, text=True, check=True).stdout.rstrip()


def write_commands(palpate, file):
    summary = help_of(palpate)
    commands = re.findall(r'^  ([a-z][a-z-]*)\s', summary.split('Subcommands:')[1], re.MULTILINE)
    page = '# Commands\n\nAs the program itself says it, by `palpate COMMAND --help`. Files and formats: ' \
           '[file formats](../docs/file-formats.md).\n\n'
    page += f'```text\n{summary}\n```\n\n'
    for command in commands:
        page += f'## palpate {command}\n\n```text\n{help_of(palpate, command)}\n```\n\n'
    file.write_text(page)


def paragraphs(text):
    return inspect.cleandoc(text or '').replace('<', '&lt;').replace('_', r'\_').replace('*', r'\*')


def signatures_and_words(name, thing):
    """Splits a docstring of pybind11: the signature is in its first line, and several signatures are numbered."""
    text = inspect.getdoc(thing) or ''
    found = re.findall(rf'^(?:\d+\. )?({re.escape(name)}\(.*)$', text, re.MULTILINE)
    words = re.sub(rf'^(?:\d+\. )?{re.escape(name)}\(.*$|^Overloaded function\.$', '', text, flags=re.MULTILINE)
    if not found:
        try:
            found = [name + str(inspect.signature(thing))]
        except (TypeError, ValueError):
            found = [name + '(...)']
    shown = [re.sub(r'palpate\._palpate\.|_palpate\.', '', one) for one in found]
    return shown, paragraphs(words)


def in_lines(signature):
    """Writes a long signature with one argument per line."""
    if len(signature) <= 100:
        return signature
    inside, depth, text = False, 0, ''
    for i, letter in enumerate(signature):
        depth += (letter in '([{') - (letter in ')]}')
        if letter == '(' and depth == 1:
            text, inside = text + '(\n    ', True
        elif letter == ')' and depth == 0:
            text, inside = text + '\n)', False
        elif inside and depth == 1 and letter == ' ' and signature[i - 1] == ',':
            text += '\n    '
        else:
            text += letter
    return text


def function_text(name, thing, level):
    shown, words = signatures_and_words(name, thing)
    return f'{level} {name}\n\n' + (words + '\n\n' if words else '') + '```python\n' + '\n'.join(map(in_lines, shown)) + '\n```\n\n'


def class_text(name, thing):
    page = f'## {name}\n\n{paragraphs(thing.__doc__)}\n\n'
    if issubclass(thing, Exception):
        return page
    rows, methods = [], ''
    for member, value in sorted(vars(thing).items()):
        if member.startswith('_') and member != '__init__':
            continue
        if isinstance(value, property) or inspect.isgetsetdescriptor(value) or inspect.ismemberdescriptor(value):
            rows.append(f'| `{member}` | {paragraphs(value.__doc__ or "").replace(chr(10), " ")} |')
        elif callable(value) or isinstance(value, (staticmethod, classmethod)):
            called = getattr(thing, member)
            if member == '__init__' and not re.search(r'__init__\(', called.__doc__ or ''):
                continue
            methods += function_text(member, called, '###').replace('### __init__', f'### {name}()')
    if rows:
        page += '| attribute | |\n|---|---|\n' + '\n'.join(rows) + '\n\n'
    return page + methods


def write_python(folder, file):
    sys.path.insert(0, str(folder))
    palpate = importlib.import_module('palpate')
    names = sorted(name for name in getattr(palpate, '__all__', dir(palpate)) if not name.startswith('_'))
    page = f'# import palpate\n\n{paragraphs(palpate.__doc__)}\n\nHow to use it: [Python](../docs/python.md).\n\n'
    things = [(name, getattr(palpate, name)) for name in names]
    for name, thing in things:
        if not inspect.isclass(thing) and not inspect.ismodule(thing) and callable(thing):
            page += function_text(name, thing, '##')
    for name, thing in things:
        if inspect.isclass(thing):
            page += class_text(name, thing)
    file.write_text(page)
