// The extension _fit: fits and comparisons with measurements.
#include "fit/python/module.h"

PYBIND11_MODULE(_fit, module) {
  palpate::python::bind_fit(module);
  palpate::python::bind_validate(module);
}
