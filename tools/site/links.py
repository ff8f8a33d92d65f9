"""Finds dead links in a folder of HTML pages, and everything that a page would load from another server."""
import html.parser
import pathlib
import urllib.parse

# Loaded by a browser automatically. An <a href> is only followed by a click.
FETCHED = {('img', 'src'), ('script', 'src'), ('link', 'href'), ('iframe', 'src'), ('source', 'src'), ('video', 'src')}
NOT_FETCHED_LINKS = {'canonical', 'next', 'prev'}
FORMS = ('http://', 'https://', 'mailto:')


class Page(html.parser.HTMLParser):
    """Anchors and links of one page."""

    def __init__(self, file):
        super().__init__()
        self.anchors, self.links, self.fetched = set(), [], []
        self.feed(file.read_text())

    def handle_starttag(self, tag, attrs):
        values = dict(attrs)
        for key in ('id', 'name'):
            if values.get(key):
                self.anchors.add(values[key])
        for key in ('href', 'src'):
            target = values.get(key)
            if target is None:
                continue
            if (tag, key) in FETCHED and values.get('rel') not in NOT_FETCHED_LINKS:
                self.fetched.append(target)
            if tag != 'link':
                self.links.append(target)


def problem_of(site, file, target, pages):
    """The problem of one link, or None."""
    if target.startswith(FORMS):
        good = len(urllib.parse.urlsplit(target).netloc) > 3 or target.startswith('mailto:') and '@' in target
        return None if good else 'is no address'
    parts = urllib.parse.urlsplit(target)
    if parts.scheme:
        return None if parts.scheme in ('data', 'javascript') else f'{parts.scheme}: is no address'
    path = urllib.parse.unquote(parts.path)
    aim = file if not path else (site / path[1:] if path.startswith('/') else file.parent / path).resolve()
    if aim.is_dir():
        aim /= 'index.html'
    if not aim.is_file():
        return 'there is no such file'
    anchor = urllib.parse.unquote(parts.fragment)
    if anchor and aim in pages and anchor not in pages[aim].anchors and anchor != '__skip':
        return 'there is no such place on that page'
    return None


def problems_of(site):
    """@return one line per dead link"""
    site = pathlib.Path(site).resolve()
    pages = {file.resolve(): Page(file) for file in sorted(site.rglob('*.html'))}
    problems = []
    for file, page in pages.items():
        name = file.relative_to(site)
        if name == pathlib.Path('404.html'):  # served for any path, so its links start at the root
            continue
        for target in page.links:
            if what := problem_of(site, file, target, pages):
                problems.append(f'{name}: link {target}: {what}')
        problems += [f'{name}: would load {target} from elsewhere' for target in page.fetched
                     if target.startswith(('http:', 'https:', '//'))]
    return problems
