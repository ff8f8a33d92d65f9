#pragma once
#include "bindings/python/binding.h"

namespace palpate::python {

/// The parts of the module _fit, one per file.
void bind_fit(py::module_& module);
void bind_validate(py::module_& module);

}  // namespace palpate::python
