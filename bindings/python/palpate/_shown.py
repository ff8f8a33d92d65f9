"""How objects show themselves: one line with their numbers, and a table with a curve in notebooks."""
import html as _html

import numpy as np

_COLOURS = ('#c0392b', '#2471a3', '#7d8a8c')
_WIDTH, _HEIGHT = 380, 210
_LEFT, _RIGHT, _TOP, _BOTTOM = 58, 10, 22, 38


def number(value):
    """A number with four digits."""
    text = f'{value + 0.0:,.4g}'  # without -0
    return text if 'e' not in text or abs(value) < 1e-4 or abs(value) >= 1e7 else f'{value:,.0f}'


def counted(count, one, more=None):
    return f'{count:,} {one if count == 1 else more or one + "s"}'


def range_of(values, unit, scale=1.0):
    return f'{number(scale * np.min(values))} to {number(scale * np.max(values))} {unit}' if len(values) else 'none'


def ticks(low, high):
    """Three to six round numbers from low to high."""
    step = 10.0 ** np.floor(np.log10((high - low) / 2.0))
    step = next(step * factor for factor in (1, 2, 5, 10) if (high - low) / (step * factor) <= 5.0)
    return np.arange(np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9) + 1) * step + 0.0  # without -0


def thinned(x, y, most=300):
    """At most 2 `most` points, with the least and the largest y of each stretch of x."""
    if len(x) <= 2 * most:
        return x, y
    parts = np.array_split(np.arange(len(x)), most)
    kept = sorted({index for part in parts for index in (part[np.argmin(y[part])], part[np.argmax(y[part])])})
    return x[kept], y[kept]


def plot(curves, x_label, y_label):
    """Curves [(name, x, y, dots)] as an SVG picture. '' if there is nothing to draw."""
    curves = [(name, np.asarray(x, float), np.asarray(y, float), dots) for name, x, y, dots in curves]
    curves = [(name, x[np.isfinite(x * y)], y[np.isfinite(x * y)], dots) for name, x, y, dots in curves]
    curves = [curve for curve in curves if len(curve[1])]
    if not curves:
        return ''
    low_x, high_x = min(x.min() for _, x, _, _ in curves), max(x.max() for _, x, _, _ in curves)
    low_y, high_y = min(0.0, *(y.min() for _, _, y, _ in curves)), max(y.max() for _, _, y, _ in curves)
    high_x, high_y = (high if high > low else low + 1.0 for low, high in ((low_x, high_x), (low_y, high_y)))

    def at_x(value):
        return _LEFT + (value - low_x) / (high_x - low_x) * (_WIDTH - _LEFT - _RIGHT)

    def at_y(value):
        return _HEIGHT - _BOTTOM - (value - low_y) / (high_y - low_y) * (_HEIGHT - _TOP - _BOTTOM)

    parts = []
    for value in ticks(low_x, high_x):
        parts.append(f'<text x="{at_x(value):.1f}" y="{_HEIGHT - _BOTTOM + 15}" text-anchor="middle">{value:.4g}</text>')
    for value in ticks(low_y, high_y):
        parts.append(f'<path d="M{_LEFT} {at_y(value):.1f}H{_WIDTH - _RIGHT}" stroke="currentColor" stroke-opacity=".15"/>'
                     f'<text x="{_LEFT - 5}" y="{at_y(value) + 4:.1f}" text-anchor="end">{value:.4g}</text>')
    for (name, x, y, dots), colour in zip(curves, _COLOURS * len(curves)):
        points = [f'{at_x(a):.1f} {at_y(b):.1f}' for a, b in zip(*thinned(x, y))]
        if dots:
            parts.extend('<circle cx="{}" cy="{}" r="1.6" fill="{}"/>'.format(*point.split(), colour) for point in points)
        else:
            parts.append(f'<path d="M{"L".join(points)}" fill="none" stroke="{colour}" stroke-width="1.6"/>')
    names = [(name, colour) for (name, *_), colour in zip(curves, _COLOURS * len(curves)) if name]
    legend = ''.join(f'<tspan fill="{colour}" dx="{12 if i else 0}">{_html.escape(name)}</tspan>'
                     for i, (name, colour) in enumerate(names))
    return (f'<svg xmlns="http://www.w3.org/2000/svg" width="{_WIDTH}" height="{_HEIGHT}" viewBox="0 0 {_WIDTH} {_HEIGHT}" '
            f'style="font:11px sans-serif" fill="currentColor">{"".join(parts)}'
            f'<text x="{_WIDTH - _RIGHT}" y="13" text-anchor="end">{legend}</text>'
            f'<text x="{_LEFT}" y="13">{_html.escape(y_label)}</text>'
            f'<text x="{_WIDTH - _RIGHT}" y="{_HEIGHT - 6}" text-anchor="end">{_html.escape(x_label)}</text></svg>')


def page(title, facts, picture=''):
    """A table of facts [(name, text)] beside a picture."""
    rows = ''.join(f'<tr><td style="text-align:left">{_html.escape(name)}</td>'
                   f'<td style="text-align:left">{_html.escape(text)}</td></tr>' for name, text in facts)
    return (f'<div><b>{_html.escape(title)}</b><div style="display:flex;flex-wrap:wrap;gap:24px;align-items:center">'
            f'<table>{rows}</table>{picture}</div></div>')


def line(kind, name, facts):
    quoted = f" '{name}'" if name else ''
    return f'<palpate.{kind}{quoted}: {", ".join(facts)}>'


def depths_of(law):
    """Depths over which a law is drawn: to its last layer, at most 15 mm."""
    return np.linspace(0.0, min(law.max_depth, 15e-3), 120)


def law_end(law):
    return (f'to {number(1e3 * law.max_depth)} mm and {number(law.max_force)} N' if np.isfinite(law.max_depth)
            else 'goes on by its tangent')


def law_line(self):
    at = law_end(self)
    return line(type(self).__name__, '', [counted(self.layers_allowed, 'layer'), f'{number(self.stiffness_at(0.0))} N/m at first '
                                          'contact', f'{number(self.force_at(5e-3))} N at 5 mm', at])


def law_page(self):
    facts = [('layers', str(self.layers_allowed)), ('end', law_end(self))]
    facts += [(f'at {mm} mm', f'{number(self.force_at(mm * 1e-3))} N, {number(self.stiffness_at(mm * 1e-3))} N/m')
              for mm in (1, 2, 5, 10)]
    depth = depths_of(self)
    return page(type(self).__name__, facts, plot([('', 1e3 * depth, self.force_at(depth), False)], 'depth (mm)', 'force (N)'))


def tissue_facts(self):
    facts = [('law', self.law), ('k1', f'{number(self.k1)} N/m'), ('beta', number(self.beta)), ('q', number(self.q)),
             ('limit', f'{number(1e3 * self.first_limit("press"))} mm pressed, {number(1e3 * self.first_limit("pull"))} mm pulled')]
    return facts + [('relaxation', f'{number(100 * share)} % in {number(time)} s') for share, time in self.relaxation]


def tissue_line(self):
    return line('Tissue', self.name, [text if name == 'law' else f'{name} {text}' for name, text in tissue_facts(self)])


def tissue_page(self, spring_law):
    facts = tissue_facts(self) + [('friction', number(self.friction)), ('damping', f'{number(self.damping)} N s/m')]
    curves = []
    for direction in ('press', 'pull'):
        try:
            law = spring_law(self, direction)
        except ValueError as error:  # an invalid tissue shows its numbers and what is wrong
            facts.append((direction, str(error)))
        else:
            curves.append((direction, 1e3 * depths_of(law), law.force_at(depths_of(law)), False))
    if len(curves) == 2 and all(np.array_equal(*both) for both in zip(curves[0][1:3], curves[1][1:3])):
        curves = [('press and pull', *curves[0][1:])]
    return page(f'Tissue {self.name}', facts, plot(curves, 'depth (mm)', 'force (N)'))


def recording_facts(self):
    rows = self.rows
    facts = [('rows', f'{len(rows):,}')]
    if len(rows):
        facts += [('duration', f'{number((rows["tick"][-1] + 1) / self.rate_Hz)} s at {number(self.rate_Hz)} Hz'),
                  ('hands', str(self.hand_count)), ('largest force', f'{number(rows["tissue_force_N"].max())} N'),
                  ('largest depth', f'{number(1e3 * rows["depth_m"].max())} mm')]
        faults = int((rows['fault'] != 0).sum())
        facts += [('ticks with a fault', f'{faults:,}')] if faults else []
    return facts + ([] if self.complete else [('complete', 'no: it was cut off')])


def recording_line(self):
    facts = dict(recording_facts(self))
    texts = [counted(int(facts.pop('rows').replace(',', '')), 'row'), *([facts.pop('duration')] if 'duration' in facts else [])]
    if 'hands' in facts:
        texts.append(counted(int(facts.pop('hands')), 'hand'))
    return line('Recording', self.name, texts + [f'{name} {text}' for name, text in facts.items()])


def recording_page(self):
    rows = self.rows
    curves = [(f'hand {hand}' if self.hand_count > 1 else '', one['time_s'], one['tissue_force_N'], False)
              for hand in range(self.hand_count) for one in (rows[rows['hand'] == hand],)]
    facts = recording_facts(self) + [('tissue', self.tissue.name), ('seed', str(self.seed)), ('version', self.version)]
    facts += [('remark', remark) for remark in self.remarks]
    return page(f'Recording {self.name}', facts, plot(curves, 'time (s)', 'tissue force (N)'))


def specimen_facts(self):
    facts = [('points', f'{len(self.force):,}'), ('displacement', range_of(self.displacement, 'mm', 1e3)),
             ('force', range_of(self.force, 'N'))]
    facts += [('time', range_of(self.time, 's'))] if len(self.time) else []
    return facts + ([('ball', f'{number(1e3 * self.tip_radius)} mm')] if self.tip_radius else [])


def specimen_line(self):
    points, *others = specimen_facts(self)
    return line('Specimen', self.name, [counted(len(self.force), 'point')] + [f'{name} {text}' for name, text in others])


def specimen_page(self):
    picture = plot([('', 1e3 * self.displacement, self.force, True)], 'displacement (mm)', 'force (N)')
    return page(f'Specimen {self.name}', specimen_facts(self), picture)


def deformation_line(self):
    depth = f'depth {number(1e3 * self.depth)} mm' if self.depth else 'depth not known'
    return line('Deformation', self.name, [counted(len(self.distance), 'point'), depth,
                                           f'largest displacement {number(1e3 * self.displacement.max())} mm'])


def deformation_page(self):
    facts = [('points', f'{len(self.distance):,}'), ('depth', f'{number(1e3 * self.depth)} mm' if self.depth else 'not known')]
    return page(f'Deformation {self.name}', facts,
                plot([('', 1e3 * self.distance, 1e3 * self.displacement, True)], 'distance (mm)', 'displacement (mm)'))


def mesh_line(self):
    size = 1e3 * np.ptp(self.vertices, axis=0) if len(self.vertices) else np.zeros(3)
    return line('Mesh', '', [counted(len(self.vertices), 'vertex', 'vertices'), counted(len(self.triangles), 'triangle'),
                             ' x '.join(map(number, size)) + ' mm'])


def findings_line(self):
    facts = ['closed' if self.closed else 'open', 'manifold' if self.manifold else 'not manifold', counted(self.shells, 'shell')]
    facts += [f'{number(1e6 * self.volume)} ml'] if self.closed else []
    facts += [f'{counted(len(found), what)}' for found, what in ((self.repairs, 'repair'), (self.defects, 'defect')) if found]
    return line('MeshFindings', '', facts)


def inclusion_line(self):
    where = 'no position yet' if self.position is None else 'at ' + ', '.join(map(number, 1e3 * self.position)) + ' mm'
    return line('Inclusion', self.name, [f'radius {number(1e3 * self.radius)} mm', f'stiffness ratio {number(self.stiffness_ratio)}',
                                         where])


def surface_line(self):
    return line('Surface', '', [f'tick {self.tick:,}', counted(len(self.vertices), 'vertex', 'vertices'),
                                counted(len(self.triangles), 'triangle')])


def indentation_line(self):
    return line('Indentation', '', [f'depth {number(1e3 * self.depth)} mm', f'tip radius {number(1e3 * self.tip_radius)} mm',
                                    'at ' + ', '.join(map(number, 1e3 * self.point)) + ' mm'])


def hand_line(self):
    return line('HandState', '', [self.phase, f'depth {number(1e3 * self.depth)} mm', f'tissue force {number(self.tissue_force)} N',
                                  *([f'fault {self.fault}'] if self.fault else [])])


def state_line(self):
    return line('State', '', [f'tick {self.tick:,}', f'{number(self.time)} s', 'running' if self.running else 'ended',
                              counted(len(self.hands), 'hand')])


def simulation_line(self):
    return line('Simulation', self.name, [counted(self.hand_count, 'hand'), f'{number(self.rate_Hz)} Hz', self.tissue.name,
                                          'running' if self.running else 'not running'])


def noise_line(self):
    return line('TouchNoise', '', [f'{number(1e3 * self.sigma(0.0))} mN in contact'])


class Results(dict):
    """A dictionary that shows its numbers."""

    def table(self):
        """Rows for to_pandas()."""
        raise NotImplementedError

    def _shown_rows(self):
        """Its rows as texts."""
        return [{key: number(value) if isinstance(value, float) else str(value) for key, value in row.items()}
                for row in self.table()]

    def _pictures(self):
        return []

    def _lines(self):
        """Column names, then the texts of each row; a column that a row lacks is empty."""
        rows = self._shown_rows()
        columns = list(dict.fromkeys(key for row in rows for key in row))
        return [columns] + [[row.get(key, '') for key in columns] for row in rows]

    def __repr__(self):
        lines = self._lines()
        widths = [max(map(len, column)) for column in zip(*lines)]
        return '\n'.join('  '.join(text.ljust(width) for text, width in zip(one, widths)).rstrip() for one in lines)

    def _repr_html_(self):
        head, *rows = self._lines()
        parts = [''.join(f'<th>{_html.escape(text)}</th>' for text in head)]
        parts += [''.join(f'<td>{_html.escape(text)}</td>' for text in one) for one in rows]
        return (f'<div><table><tr>{"</tr><tr>".join(parts)}</tr></table>'
                f'<div style="display:flex;flex-wrap:wrap;gap:12px">{"".join(self._pictures())}</div></div>')


def curve_beside(name, x, measured, computed, x_label, y_label, law):
    return plot([('measured', x, measured, True), (law, x, computed, False)], x_label, f'{name}: {y_label}')


class FitResult(Results):
    """The result of fit(): a dictionary whose `specimens` has one dictionary per specimen, and whose `pooled` is the fit of all.
    It shows a row for each, with 95 % intervals; to_pandas() has them as numbers."""

    def _fits(self):
        return [(one['name'], one) for one in self['specimens']] + [('pooled', self['pooled'])]

    def table(self):
        """Rows for to_pandas(): parameters with the ends of their intervals."""
        rows = []
        for name, one in self._fits():
            row = {'name': name}
            for key, (value, low, high) in one['parameters'].items():
                row.update({key: value, f'{key}_low': low, f'{key}_high': high})
            rows.append({**row, 'rms_N': one['rms_N'], 'nrmse': one['nrmse'], 'points': one['points']})
        return rows

    def _shown_rows(self):
        return [{'name': name, **{key: f'{value:.3g} ({low:.3g} to {high:.3g})' for key, (value, low, high) in
                                  one['parameters'].items() if not key.startswith('offset')},
                 'error': f'{100 * one["nrmse"]:.2g} %', 'points': str(one['points'])} for name, one in self._fits()]

    def __repr__(self):
        return '\n'.join([super().__repr__(), *(f'warning: {text}' for text in self['pooled']['warnings'])])

    def _pictures(self):
        return [curve_beside(one['name'], 1e3 * one['displacement'], one['measured'], one['fitted'], 'displacement (mm)',
                             'force (N)', 'fitted') for one in self['specimens'][:4]]


class ValidationResult(Results):
    """The result of validate(): a dictionary with `tissue`, `forces` and `profiles`. It shows a row for each data set, in N and m."""

    def table(self):
        """Rows for to_pandas()."""
        return [{'name': one['name'], 'kind': kind[:-1], **{key: one[key] for key in ('rms', 'max', 'nrmse')}}
                for kind in ('forces', 'profiles') for one in self[kind]]

    def _pictures(self):
        forces = [curve_beside(one['name'], 1e3 * one['displacement'], one['measured'], one['computed'], 'displacement (mm)',
                               'force (N)', 'computed') for one in self['forces'][:4]]
        return forces + [curve_beside(one['name'], 1e3 * one['distance'], 1e3 * one['measured'], 1e3 * one['computed'],
                                      'distance (mm)', 'displacement (mm)', 'computed') for one in self['profiles'][:4]]


def ticked_line(self):
    return line('TickedSimulation', '', [counted(self.hand_count, 'hand'), f'{number(self.rate_Hz)} Hz',
                                         f'at most {number(self.max_force)} N'])


def batch_line(self):
    return line('Batch', '', [counted(self.n, 'hand'), f'{number(self.rate_Hz)} Hz'])


_SHOWN = {'Tissue': (tissue_line, None), 'LayeredSpringLaw': (law_line, law_page), 'SmoothSpringLaw': (law_line, law_page),
          'Recording': (recording_line, recording_page), 'Specimen': (specimen_line, specimen_page),
          'Deformation': (deformation_line, deformation_page), 'Mesh': (mesh_line, None), 'MeshFindings': (findings_line, None),
          'Inclusion': (inclusion_line, None), 'Surface': (surface_line, None), 'Indentation': (indentation_line, None),
          'HandState': (hand_line, None), 'State': (state_line, None), 'Simulation': (simulation_line, None),
          'TouchNoise': (noise_line, None), 'TickedSimulation': (ticked_line, None), 'Batch': (batch_line, None)}


def show_all(module):
    """Gives the classes of a compiled module their texts."""
    for name, (text, table) in _SHOWN.items():
        found = vars(module).get(name)
        if found is None:
            continue
        found.__repr__ = text
        if table is not None:
            found._repr_html_ = table
    if 'Tissue' in vars(module):
        law = module.spring_law
        module.Tissue._repr_html_ = lambda self: tissue_page(self, law)
