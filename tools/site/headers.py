"""Generates pages of the C++ and C headers: every documented declaration with its comment.

This short parser relies on clang-format: at namespace level, a comment of /// lines precedes one declaration, which ends
where its braces and brackets are closed.
"""
import re

MARKS = {'setup': 'may allocate and throw', 'rt': 'for the tick: noexcept, never allocates, locks or calls the system',
         'any': 'from any thread', 'picture': 'for the picture\'s thread'}


def without_strings(line):
    return re.sub(r'"(?:\\.|[^"\\])*"|\'(?:\\.|[^\'\\])\'|//.*', '', line)


def depth_of(line):
    code = without_strings(line)
    return sum(code.count(c) for c in '{(') - sum(code.count(c) for c in '})')


def public_only(lines):
    """A class without its private part."""
    kept, hidden = [], False
    for line in lines:
        label = line.strip()
        if re.match(r'^ (private|protected):$', line):
            hidden = True
        elif re.match(r'^ public:$', line):
            hidden = False
        if line.startswith('}'):
            hidden = False
        if not hidden and label != 'private:':
            kept.append(line)
    while len(kept) > 1 and kept[-2].strip() in ('', 'public:'):
        del kept[-2]
    return kept


def without_bodies(lines):
    """Replaces functions of more than one line by their declarations."""
    kept, inside = [], 0
    for line in lines:
        if inside:
            inside += depth_of(line)
            continue
        code = without_strings(line).rstrip()
        opens = code.endswith('{') and not re.match(r'^\s*(class|struct|enum|union|extern|namespace)\b', code)
        if opens and depth_of(line) > 0 and ('(' in code or ')' in code):
            kept.append(re.sub(r'\s*\{$', ';', line))
            inside = depth_of(line)
        else:
            kept.append(line)
    return [re.sub(r'\)( const)?( noexcept)?( override)? : .*;$', r')\1\2\3;', line) for line in kept]


def name_of(declaration):
    text = ' '.join(line for line in declaration if not line.lstrip().startswith('//'))
    if found := re.match(r'\s*#define (\w+)', text):
        return found.group(1)
    text = re.sub(r'template <[^{(]*?> ', '', text)
    if found := re.search(r'\b(?:class|struct|enum class|enum|union)\s+(?:alignas\(\w+\)\s+)?(\w+)[^(]*\{', text):
        return found.group(1)
    if found := re.match(r'\s*(?:typedef struct (\w+)|typedef \S+ (\w+);|using (\w+))', text):
        return next(filter(None, found.groups()))
    if found := re.search(r'(\boperator\s*\S+?|~?\w+)\s*\(', re.sub(r'\[\[\w+\]\]|\bnoexcept\(', '', text)):
        return found.group(1)
    if found := re.search(r'(\w+)\s*(?:\[[^\]]*\]\s*)?(?:=|\{|;)', text):
        return found.group(1)
    return None


def entities_of(text):
    """Yields (name, comment lines, declaration lines) of declarations at namespace level."""
    comment, declaration, depth = [], [], 0
    for line in text.split('\n'):
        stripped = line.strip()
        if not declaration:
            if stripped.startswith('///'):
                comment.append(stripped[3:].removeprefix(' '))
                continue
            if not stripped or stripped.startswith(('//', 'namespace', 'extern "C"', '#if', '#endif', '#else',
                                                    '#pragma', '#include', '}')):
                comment = comment if stripped.startswith('namespace') else []
                continue
        declaration.append(line)
        depth += depth_of(line)
        ended = without_strings(line).rstrip().endswith((';', '}')) or stripped.startswith('#define')
        if depth <= 0 and ended:
            yield name_of(declaration), comment, declaration
            comment, declaration, depth = [], [], 0


def prose(lines):
    """A doc comment as Markdown: thread marks in bold, @param and @throws on separate lines."""
    text = '\n'.join(lines)
    text = re.sub(r'\[(setup|rt|any|picture)\]', lambda m: f'**{m.group(1)}**', text)
    text = re.sub(r'\s*@(param|throws|return)\s+', lambda m: f'\n\n*{m.group(1)}* ', text)
    text = re.sub(r'\*param\* (\w+(?:, \w+)*)', r'*param* `\1`', text)
    return text.replace('<', '&lt;').replace('_', r'\_').replace('\\_\\_', '__')


def entity_page(name, comment, declaration, level):
    shown = without_bodies(public_only(declaration))
    page = f'{level} {name}\n\n'
    if comment:
        page += prose(comment) + '\n\n'
    return page + '```cpp\n' + '\n'.join(shown) + '\n```\n\n'


def header_page(root, header):
    """The section of one header, empty without any comment. @return text, names"""
    text, names = '', []
    for name, comment, declaration in entities_of((root / header).read_text()):
        if name is None or not comment and not names or 'static_assert' in declaration[0]:
            continue
        if not comment and len(declaration) == 1:  # belongs to the previous declaration
            text = text.removesuffix('```\n\n') + declaration[0] + '\n```\n\n'
            continue
        text += entity_page(name, comment, declaration, '###')
        names.append((name, ' '.join(comment)))
    return (f'## {header}\n\n{text}' if text else ''), names


def first_sentence(text):
    text = re.sub(r'\[(setup|rt|any|picture)\]\s*', '', text)
    text = re.split(r'(?<=[.;])\s|\s@', text)[0].rstrip(';')
    return text.replace('|', r'\|').replace('<', '&lt;').replace('_', r'\_')


def write_pages(root, folder):
    """Writes api/README.md, one page per public header, and the page of palpate.h."""
    (folder / 'cxx').mkdir(parents=True, exist_ok=True)
    index = ['# C++ API', '', 'The public headers of the C++ library, from their own comments. What must last from version '
             'to version uses the [C interface](palpate.h.md) instead. How to link them: [installation]'
             '(../docs/install.md#in-a-cmake-project); how to use them: [examples](../examples/cxx/README.md).', '',
             'Who may call a function is said first:', '']
    index += [f'- **{mark}** {says}' for mark, says in MARKS.items() if mark != 'picture'] + ['']
    public = [*(root / 'include' / 'palpate').glob('*.h'), *(root / 'components').glob('*/include/palpate/*.h')]
    for file in sorted(public, key=lambda one: one.name):
        text, names = header_page(root, str(file.relative_to(root)))
        if not text:
            continue
        (folder / 'cxx' / f'{file.stem}.md').write_text(f'# {file.stem}\n\n{text}')
        index += [f'## [{file.stem}](cxx/{file.stem}.md)', '', f'`#include <palpate/{file.name}>`', '', '| name | |', '|---|---|']
        seen = set()
        for name, comment in [(n, c) for n, c in names if c]:
            if name not in seen and 'operator' not in name:
                seen.add(name)
                index.append(f'| [`{name}`](cxx/{file.stem}.md#{name.lower()}) | {first_sentence(comment)} |')
        index.append('')
    (folder / 'README.md').write_text('\n'.join(index))
    write_c_page(root, folder)


def write_c_page(root, folder):
    header = (root / 'bindings' / 'c' / 'palpate.h').read_text()
    head = re.search(r'((?:^//.*\n)+)', header, re.MULTILINE).group(1)
    intro = re.sub(r'^// ?', '', head, flags=re.MULTILINE)
    page = '# palpate.h\n\n' + prose([intro]) + '\n'
    for title, part in [('Constants', header.split('\n// ---- ')[0].split('extern "C" {', 1)[1])] + \
            [tuple(part.split('\n', 1)) for part in header.split('\n// ---- ')[1:]]:
        page += f'## {title.strip()}\n\n'
        for name, comment, declaration in entities_of(part):
            if comment and name:
                page += entity_page(name, comment, declaration, '###')
            elif name:
                page += '```cpp\n' + '\n'.join(declaration) + '\n```\n\n'
    # Merges consecutive constants into one block.
    (folder / 'palpate.h.md').write_text(page.replace('\n```\n\n```cpp\n', '\n').replace('PALPATE_API ', ''))
