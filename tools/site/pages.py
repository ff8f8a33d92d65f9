"""Copies the pages of the repository, adapts their links to the site, and writes the navigation."""
import html
import os
import pathlib
import re
import subprocess

PAGES = ('README.md', 'CHANGELOG.md', 'CONTRIBUTING.md', 'CODE_OF_CONDUCT.md', 'SECURITY.md')
PICTURES = {'.png', '.svg', '.jpg', '.webp'}
LANGUAGES = {'.cc': 'cpp', '.h': 'cpp', '.c': 'c', '.py': 'python', '.toml': 'toml', '.txt': 'text', '.csv': 'text',
             '.cff': 'yaml', '.rules': 'text', '.cmake': 'cmake'}
# Sections and their pages. Other pages go to "More".
SECTIONS = (
    ('Start', ('README.md', 'docs/start.md', 'docs/install.md', 'docs/windows.md', 'docs/doors.md', 'docs/first-organ.md', 'docs/first-device.md',
               'docs/first-tissue.md')),
    ('Use', ('docs/file-formats.md', 'docs/odd-data.md', 'api/commands.md', 'docs/window.md', 'docs/devices.md', 'docs/organs.md',
             'docs/lumps.md', 'docs/needle.md', 'docs/tissues.md', 'docs/fitting.md', 'docs/sweeps.md', 'docs/photographs.md', 'docs/safety.md', 'docs/realtime.md',
             'docs/openigtlink.md', 'docs/live-interface.md')),
    ('Embed', ('docs/python.md', 'api/python.md', 'docs/c-interface.md', 'api/palpate.h.md', 'examples/cxx/README.md',
               'examples/c/README.md', 'examples/README.md')),
    ('How it works', ('docs/model.md', 'docs/architecture.md', 'docs/glossary.md', 'docs/picture.md', 'docs/accuracy.md',
                      'docs/validation.md', 'docs/performance.md', 'docs/decisions/README.md')),
    ('C++ API', ('api/README.md',)),
    ('Project', ('CONTRIBUTING.md', 'CODE_OF_CONDUCT.md', 'SECURITY.md', 'CHANGELOG.md', 'docs/dependencies.md')),
)
LINK = re.compile(r'(!?\[(?:[^\[\]]|\[[^\]]*\])*\]\()([^)\s]+)(\))')
LIST_ITEM = re.compile(r'^\s*([-*+]|\d+\.)\s')


def tracked(root):
    listed = subprocess.run(['git', '-C', root, 'ls-files', '-z', '--cached', '--others', '--exclude-standard'],
                            capture_output=True, check=True, text=True).stdout
    return {name for name in listed.split('\0') if name and (root / name).is_file()}


def in_prose(text, change):
    """Applies change(line, number) to every line of the Markdown outside fenced code."""
    lines, fence = [], False
    for number, line in enumerate(text.split('\n'), 1):
        if line.lstrip().startswith('```'):
            fence = not fence
            lines.append(line)
        else:
            lines.append(line if fence else change(line, number))
    return '\n'.join(lines)


def with_lists_apart(text):
    """Inserts an empty line before a list that directly follows text. GitHub needs none, but mkdocs does."""
    lines, fence = [], False
    for line in text.split('\n'):
        fence ^= line.lstrip().startswith('```')
        before = lines[-1] if lines else ''
        if not fence and LIST_ITEM.match(line) and before.strip() and not LIST_ITEM.match(before) \
                and not before.startswith((' ', '#', '|')):
            lines.append('')
        lines.append(line)
    return '\n'.join(lines)


def with_bars_in_cells(line, _number):
    """Replaces `a\\|b` in a table cell. GitHub removes the backslash, mkdocs shows it."""
    if not line.lstrip().startswith('|'):
        return line
    return re.sub(r'`([^`]*\\\|[^`]*)`',
                  lambda m: '<code>' + html.escape(m.group(1).replace('\\|', '|')).replace('|', '&#124;') + '</code>', line)


def first_words(file):
    """The description of a source: its first comment up to the end of a sentence."""
    words = []
    for line in file.read_text(errors='replace').splitlines():
        if line.startswith(('#!', '<')) or not line.strip(' #/*"'):
            if words:
                break
            continue
        if not line.startswith(('//', '#', '/*', ' *', '"""')) and not words:
            break
        words.append(line.strip(' #/*"'))
        if '.' in line or ':' in line:
            break
    text = ' '.join(words)
    return re.split(r'(?<=[.:])\s|\.$', text)[0].rstrip('.:').replace('|', r'\|')


class Stage:
    """Copies pages to a folder with the repository's layout. Linked sources become pages."""

    def __init__(self, root, folder):
        self.root, self.folder, self.files = root, folder, tracked(root)
        self.problems, self.done, self.waiting = [], set(), []

    def run(self):
        names = [n for n in self.files
                 if n in PAGES or n.startswith('docs/') and n.endswith('.md')]
        self.waiting = sorted(names) + ['docs/decisions', 'examples', 'examples/cxx', 'examples/c']
        while self.waiting:
            name = self.waiting.pop()
            if name not in self.done:
                self.done.add(name)
                self.write(name)
        return self.problems

    def write(self, name):
        source = self.root / name
        if source.is_dir():
            self.put(name + '/README.md', self.folder_page(name))
        elif source.suffix == '.md':
            text = in_prose(source.read_text(), lambda line, number: self.relinked(name, line, number))
            title, _, rest = text.partition('\n')
            text = title.replace('`', '') + '\n' + rest  # the navigation does not render Markdown in titles
            self.put(name, with_lists_apart(in_prose(text, with_bars_in_cells)))
        elif source.suffix in PICTURES:
            target = self.folder / name
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(source.read_bytes())
        else:
            self.put(name + '.md', self.source_page(name))

    def put(self, name, text):
        target = self.folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(text)

    def relinked(self, page, line, number):
        def change(found):
            before, target, after = found.groups()
            if re.match(r'[a-z]+:', target) or target.startswith('#'):
                return found.group()
            path, _, anchor = target.partition('#')
            name = os.path.normpath(os.path.join(os.path.dirname(page), path))
            is_folder = any(file.startswith(name + '/') for file in self.files)
            if name not in self.files and not is_folder:
                self.problems.append(f'{page}:{number}: dead link {target}')
                return found.group()
            self.waiting.append(name)
            path = path.rstrip('/')
            if is_folder:
                path += '/README.md'
            elif pathlib.Path(name).suffix not in PICTURES | {'.md'}:
                path += '.md'
            return before + path + ('#' + anchor if anchor else '') + after
        return LINK.sub(change, line)

    def source_page(self, name):
        try:
            text = (self.root / name).read_text()
        except UnicodeDecodeError:
            return f'# {name}\n\nA file that is no text, of {(self.root / name).stat().st_size:,} bytes.\n'
        language = LANGUAGES.get(pathlib.Path(name).suffix, 'text')
        if text.startswith('#!'):
            language = 'python' if 'python' in text.split('\n')[0] else 'bash'
        return f'# {name}\n\n`````{language}\n{text.rstrip()}\n`````\n'

    def folder_page(self, name):
        inside = sorted(file for file in self.files if file.startswith(name + '/') and file.count('/') == name.count('/') + 1)
        rows = []
        for file in inside:
            self.waiting.append(file)
            short = file.rsplit('/', 1)[1]
            if file.endswith('.md'):
                title = (self.root / file).read_text().split('\n')[0].lstrip('# ')
                rows.append(f'- [{title}]({short})')
            elif pathlib.Path(file).suffix in PICTURES:
                rows.append(f'- [{short}]({short})')
            else:
                try:
                    says = first_words(self.root / file)
                except OSError:
                    says = ''
                rows.append(f'| [`{short}`]({short}.md) | {says} |')
        head = '| file | what it is |\n|---|---|\n' if rows and rows[0].startswith('|') else ''
        title = {'docs/decisions': 'Decisions', 'examples/cxx': 'Examples in C++', 'examples/c': 'Example in C',
                 'examples': 'Scenes, meshes and scripts'}.get(name, name)
        return f'# {title}\n\n{head}' + '\n'.join(rows) + '\n'


def stage_repository(root, folder):
    """Writes the pages. @return problems, one per line"""
    return Stage(root, folder).run()


def navigation(folder):
    """The navigation for mkdocs. Sources of examples and decisions are linked from the pages of their folders."""
    there = {str(file.relative_to(folder)) for file in folder.rglob('*.md')}
    named = {name for _, names in SECTIONS for name in names}
    tree = []
    for title, names in SECTIONS:
        inside = [name for name in names if name in there]
        if title == 'C++ API':
            inside += sorted(name for name in there if name.startswith('api/cxx/'))
        tree.append({title: inside})
    rest = sorted(name for name in there - named if name.startswith('docs/') and name.count('/') == 1
                  and (folder / name).suffixes == ['.md'])
    if rest:
        tree.append({'More': rest})
    return tree
