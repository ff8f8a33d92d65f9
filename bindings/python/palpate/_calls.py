"""Short answers to wrong arguments: "simulate() has no argument 'tisue', did you mean tissue?"."""
import difflib
import functools
import inspect
import os
import re

import numpy as np


def parameters(document):
    """Arguments in the signature that pybind11 writes into the first line of a docstring: a list of name, type, whether it must be
    given, whether it may be given without its name."""
    line = (document or '').strip().partition('\n')[0]
    inside, depth, parts = line.partition('(')[2].rpartition(')')[0], 0, ['']
    for letter in inside:
        depth += (letter in '[(') - (letter in '])')
        if letter == ',' and depth == 0:
            parts.append('')
        else:
            parts[-1] += letter
    found, by_place = [], True
    for part in parts:
        by_place = by_place and part.strip() != '*'
        name, _, kind = part.partition(' = ')[0].strip().partition(': ')
        if kind and name != 'self':
            found.append((name, kind, ' = ' not in part, by_place))
    return found


def arguments(document):
    """Names and types of these arguments."""
    return {name: kind for name, kind, _, _ in parameters(document)}


def fits(value, kind):
    """Whether a value may have the type `kind` of a signature. True where the type does not say."""
    words = set(re.findall(r'\w+', kind))
    if value is None:
        return 'Optional' in words
    if isinstance(value, (bool, np.bool_)):
        return bool(words & {'bool', 'int', 'float'})
    if isinstance(value, (int, float, np.number)):
        return bool(words & {'float', 'ndarray'}) or 'int' in words and isinstance(value, (int, np.integer))
    if isinstance(value, (str, os.PathLike)):
        return bool(words & ({'str', 'PathLike'} if isinstance(value, str) else {'PathLike'}))
    return type(value).__name__ in words or bool(words & {'List', 'Tuple', 'ndarray', 'object', 'dict'})


def words_of(kind):
    """A type of a signature in words: "Tissue or str"."""
    text = re.sub(r'palpate\._\w+\.|typing\.', '', kind)
    text = re.sub(r'numpy\.ndarray(\[[\w.]+\])?', 'array', text).replace('os.PathLike', 'path')
    before = None
    while text != before:  # from the innermost brackets outwards
        before = text
        text = re.sub(r'List\[([^][]*)\]', r'list of \1', text)
        text = re.sub(r'Optional\[([^][]*)\]', r'\1', text)
        text = re.sub(r'Union\[([^][]*)\]', lambda found: found[1].replace(', ', ' or '), text)
    return text


def mismatch(function, given, named, found):
    """The error for arguments that do not fit. `found`: what parameters() returns"""
    known = {name: kind for name, kind, _, _ in found}
    places = [name for name, _, _, by_place in found if by_place]
    wrong = [name for name in named if name not in known]
    if wrong:
        return unknown(function, wrong[0], list(known))
    if len(given) > len(places):
        return TypeError(f'{function}() takes {", ".join(places) or "no argument"}: {len(given)} given')
    for name, value in [*zip(places, given), *named.items()]:
        if not fits(value, known[name]):
            return TypeError(f'{function}(): {name} = {value!r:.60}: must be {words_of(known[name])}')
    for name, kind, needed, _ in found:
        if needed and name not in named and name not in places[:len(given)]:
            return TypeError(f'{function}() needs {name}: {words_of(kind)}')
    twice = [name for name in places[:len(given)] if name in named]
    if twice:
        return TypeError(f'{function}(): {twice[0]} is given twice')
    shown = [f'{name}: {words_of(known[name])}' for name in [*places[:len(given)], *named]]
    return TypeError(f'{function}(): a value does not fit; they must be {", ".join(shown)}')


def unknown(function, name, known):
    """The error for an argument that `function` does not have."""
    near = difflib.get_close_matches(name, known, n=1, cutoff=0.5)
    return TypeError(f"{function}() has no argument {name!r}" +
                     (f', did you mean {near[0]}?' if near else f'; it has {", ".join(known)}'))


def answered(function, shown, result=None):
    """`function`, whose errors for wrong arguments are short. `shown`: its name in them; `result` makes its result."""
    document = function.__doc__
    if result is not None:
        document = document.replace('-> dict', f'-> {result.__name__}', 1)

    @functools.wraps(function, assigned=('__name__',), updated=())
    def call(*given, **named):
        try:
            found = function(*given, **named)
        except TypeError as error:
            own = given[document.startswith(f'{function.__name__}(self: '):]
            short = mismatch(shown, own, named, parameters(document)) if 'incompatible' in str(error) else None
            if short is None:
                raise
            raise short from None
        return found if result is None else result(found)

    del call.__wrapped__  # inspect finds no signature in it
    call.__doc__ = document
    call.__module__ = 'palpate'
    return call


def answer_class(found, shown):
    """Gives a class these errors: its constructor, and its methods with keyword-only arguments. A loop may call the others, which
    stay as they are."""
    for member, method in list(vars(found).items()):
        if member == '__init__':
            found.__init__ = answered(method, shown)
        elif not member.startswith('_') and ', *, ' in (getattr(method, '__doc__', '') or ''):
            setattr(found, member, answered(method, member))


def answer_all(module, results):
    """Gives the functions and classes of a compiled module these errors. `results`: name of a function to a class of results."""
    for name, found in list(vars(module).items()):
        if name.startswith('_'):
            continue
        if inspect.isclass(found):
            answer_class(found, name)
        elif inspect.isroutine(found):
            setattr(module, name, answered(found, name, results.get(name)))
