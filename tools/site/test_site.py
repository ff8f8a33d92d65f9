"""Tests of the site generator: python3 -m unittest discover -s tools/site"""
import pathlib
import re
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
ROOT = pathlib.Path(__file__).resolve().parent.parent.parent

import headers  # noqa: E402
import links  # noqa: E402
import pages  # noqa: E402


def problems_of(**files):
    """Problems of a site with these pages, given by name without extension."""
    with tempfile.TemporaryDirectory() as folder:
        for name, text in files.items():
            (pathlib.Path(folder) / f'{name}.html').write_text(text)
        return links.problems_of(folder)


class Links(unittest.TestCase):
    def test_a_link_to_a_page_and_to_a_place_on_it_is_good(self):
        self.assertEqual(problems_of(a='<a href="b.html#there">', b='<h2 id="there">'), [])

    def test_a_link_to_a_missing_page_is_found(self):
        self.assertEqual(problems_of(a='<a href="c.html">'), ['a.html: link c.html: there is no such file'])

    def test_a_link_to_a_missing_place_is_found(self):
        self.assertIn('no such place', problems_of(a='<a href="b.html#nowhere">', b='<h2 id="there">')[0])

    def test_a_missing_picture_is_found(self):
        self.assertIn('no such file', problems_of(a='<img src="none.png">')[0])

    def test_an_address_of_a_wrong_form_is_found(self):
        self.assertIn('is no address', problems_of(a='<a href="https://">')[0])
        self.assertEqual(problems_of(a='<a href="https://example.org/x">'), [])

    def test_a_script_from_elsewhere_is_found(self):
        self.assertIn('from elsewhere', problems_of(a='<script src="https://example.org/x.js"></script>')[0])


class Headers(unittest.TestCase):
    def test_private_parts_and_bodies_are_left_out(self):
        header = '''namespace palpate {
/// A thing.
class Thing final {
 public:
  /// [any] Its size.
  int size() const {
    return size_;
  }

 private:
  int size_ = 0;
};
}  // namespace palpate
'''
        (name, comment, declaration), = headers.entities_of(header)
        self.assertEqual((name, comment), ('Thing', ['A thing.']))
        page = headers.entity_page(name, comment, declaration, '###')
        self.assertIn('int size() const;', page)
        self.assertNotIn('size_', page)

    def test_every_documented_type_of_the_library_is_found(self):
        for file in sorted((ROOT / 'include' / 'palpate').glob('*.h')):
            text = file.read_text()
            wanted = re.findall(r'^///[^\n]*\n(?:template <[^\n]*>\n)?(?:class|struct|enum class) (?:alignas\(\d+\) )?(\w+)',
                                text, re.MULTILINE)
            found = {name for name, _, _ in headers.entities_of(text)}
            for name in wanted:
                self.assertIn(name, found, str(file.relative_to(ROOT)))

    def test_every_function_of_the_c_interface_is_found(self):
        text = (ROOT / 'bindings/c/palpate.h').read_text()
        wanted = re.findall(r'^PALPATE_API .*?(palpate_\w+)\(', text, re.MULTILINE)
        found = {name for part in text.split('\n// ---- ') for name, _, _ in headers.entities_of(part)}
        self.assertGreater(len(wanted), 20)
        self.assertEqual([name for name in wanted if name not in found], [])


class Pages(unittest.TestCase):
    def test_a_list_right_behind_text_gets_an_empty_line(self):
        self.assertEqual(pages.with_lists_apart('text:\n- one\n- two'), 'text:\n\n- one\n- two')

    def test_what_stands_in_a_fence_is_left_alone(self):
        text = '```\ntext\n- one\n```'
        self.assertEqual(pages.with_lists_apart(text), text)

    def test_a_bar_in_a_cell_loses_its_backslash(self):
        self.assertEqual(pages.with_bars_in_cells(r'| `a\|b` |', 1), '| <code>a&#124;b</code> |')


if __name__ == '__main__':
    unittest.main()
