// The extension _palpate, one source file per part. make_docs takes docstrings from the C++ comments at build
// time.
#include "palpate/error.h"
#include "palpate/version.h"

#include "bindings/python/binding.h"

PYBIND11_MODULE(_palpate, module) {
  module.doc() = "The compiled part of palpate; import palpate instead.";
  module.attr("__version__") = palpate::kVersion;
  const auto& input_error =
      pybind11::register_exception<palpate::InputError>(module, "InputError", PyExc_ValueError);
  input_error.attr("__doc__") =
      "Invalid input. The message is one line with the input, its value and the accepted values.";
  const auto& parameter_error =
      pybind11::register_exception<palpate::ParameterError>(module, "ParameterError", input_error);
  parameter_error.attr("__doc__") =
      "A parameter out of its range. The message names the field, its value and its unit.";
  palpate::python::bind_model(module);
  palpate::python::bind_inclusions(module);
  palpate::python::bind_geometry(module);
  palpate::python::bind_surface(module);
  palpate::python::bind_runs(module);
  palpate::python::bind_palpation(module);
  palpate::python::bind_live(module);
  palpate::python::bind_ticked(module);
  palpate::python::bind_batch(module);
}
