"""to_pandas(): pandas tables of all that has rows."""
import numpy as _numpy

from . import _palpate

_AXES = {3: ('x', 'y', 'z'), 4: ('w', 'x', 'y', 'z')}


def _columns(rows):
    """Columns of a structured array: one for each number of a row. Arrays of several dimensions are flattened, with the index
    in the last one as the column hand."""
    flat = rows.reshape(-1)
    columns = {}
    for name in rows.dtype.names:
        values = flat[name]
        if values.ndim == 1:
            columns[name] = values
        else:
            parts = _AXES.get(values.shape[1], range(1, values.shape[1] + 1))
            columns.update({f'{name}_{part}': values[:, i] for i, part in enumerate(parts)})
    if rows.ndim > 1 and 'hand' not in columns:
        columns['hand'] = _numpy.tile(_numpy.arange(rows.shape[-1]), rows.size // rows.shape[-1])
    return columns


def _of_dictionary(table):
    """Columns of a dictionary of arrays that are equally long."""
    columns = {}
    for name, values in table.items():
        values = _numpy.asarray(values)
        if values.ndim == 1:
            columns[name] = values
        elif values.ndim == 2 and values.shape[1] in _AXES:
            columns.update({f'{name}_{axis}': values[:, i] for i, axis in enumerate(_AXES[values.shape[1]])})
        else:
            return None
    return columns if len({len(values) for values in columns.values()}) == 1 else None


def to_pandas(rows):
    """to_pandas(rows: Any) -> Any

    A pandas DataFrame of the rows of simulate(), of a Recording, a Simulation, a Specimen or a Deformation; of the results of
    fit() and validate() (one row per specimen or data set); of the arrays of laws and ticks; and of the columns of felt_map()
    and study.read_trials(). Rows of runs have the names of phases and faults. Raises ImportError without pandas, TypeError
    for something else.
    """
    import pandas
    if hasattr(rows, 'table'):
        return pandas.DataFrame(rows.table())
    found = getattr(rows, 'rows', rows)
    found = found() if callable(found) else found
    if isinstance(found, (_numpy.ndarray, _numpy.void)) and found.dtype.names:
        found = _numpy.asarray(found)
        if found.ndim == 1 and found.dtype == _palpate._row_type():
            return _palpate._frame_of(found)
        return pandas.DataFrame(_columns(found if found.ndim else found.reshape(1)))
    columns = None
    if hasattr(found, 'displacement'):
        names = [name for name in ('time', 'distance', 'displacement', 'force') if len(getattr(found, name, ()))]
        columns = {name: getattr(found, name) for name in names}
    elif isinstance(found, dict) and found:
        columns = _of_dictionary(found)
    if columns is None:
        raise TypeError(f'to_pandas(): {type(rows).__name__} has no rows; it takes rows of simulate(), a Recording, Simulation, '
                        'Specimen or Deformation, results of fit() and validate(), and dictionaries of arrays')
    return pandas.DataFrame(columns)
