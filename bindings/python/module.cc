// The extension _palpate, one source file per part. make_docs takes docstrings from the C++ comments at build
// time.
#include <array>

#include "palpate/error.h"
#include "palpate/version.h"

#include "bindings/python/binding.h"

namespace palpate::python {

model::Direction direction_of(const std::string& word) {
  if (word == "press") return model::Direction::kPress;
  if (word == "pull") return model::Direction::kPull;
  throw InputError("direction = \"" + word + "\": must be press or pull");
}

py::array_t<double> array_of(std::span<const double> values) {
  return py::array_t<double>(static_cast<py::ssize_t>(values.size()), values.data());
}

py::array_t<double> array_of(const Vec3& vector) {
  return array_of(std::array{vector.x(), vector.y(), vector.z()});
}

py::array_t<double> array_of(const Quat& rotation) {
  return array_of(std::array{rotation.w(), rotation.x(), rotation.y(), rotation.z()});
}

}  // namespace palpate::python

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
  palpate::python::bind_fit(module);
  palpate::python::bind_live(module);
  palpate::python::bind_study(module);
  palpate::python::bind_learning(module);
  palpate::python::bind_ticked(module);
  palpate::python::bind_validate(module);
}
