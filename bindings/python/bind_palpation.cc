// The score of a search, and the map of the felt stiffness.
#include <cstddef>
#include <string>
#include <vector>

#include "palpate/error.h"
#include "palpate/recording.h"
#include "run/palpation/insertion_score.h"
#include "run/palpation/score.h"

#include "bindings/python/binding.h"
#include "bindings/python/scene_arguments.h"

namespace palpate::python {
namespace {

palpation::ScoredRecording score(const record::Recording& recording, bool cache) {
  const py::gil_scoped_release others_may_run;
  return {recording, preparation_of(cache)};
}

py::dict score_of(const record::Recording& recording, bool cache) {
  std::string text;
  if (palpation::is_insertion(recording.scene)) {
    const py::gil_scoped_release others_may_run;
    text = palpation::to_json(palpation::score_insertions(recording, preparation_of(cache)));
  } else {
    palpation::require_search(recording.scene, "score()", "task='palpate' makes a search");
    text = palpation::to_json(score(recording, cache).scorer().score());
  }
  return py::module_::import("json").attr("loads")(text);
}

py::dict felt_map_of(const record::Recording& recording, bool cache) {
  const palpation::ScoredRecording scored = score(recording, cache);
  const palpation::FeltMap& map = scored.scorer().map();
  const std::size_t count = map.surface().vertices.size();
  std::vector<double> felt(count);
  std::vector<double> truth(count);
  std::vector<double> depth(count);
  std::vector<double> force(count);
  for (std::size_t v = 0; v < count; ++v) {
    const palpation::FeltPlace place = map.at(v);
    felt[v] = place.factor;
    truth[v] = map.true_factor(v);
    depth[v] = place.depth;
    force[v] = place.force;
  }
  py::dict columns;
  columns["points"] = vertices_of(map.surface());
  columns["felt_factor"] = array_of(felt);
  columns["true_factor"] = array_of(truth);
  columns["depth"] = array_of(depth);
  columns["force"] = array_of(force);
  return columns;
}

}  // namespace

void bind_palpation(py::module_& module) {
  const py::object recording = module.attr("Recording");
  recording.attr("score") = py::cpp_function(
      &score_of, py::name("score"), py::is_method(recording), py::arg("cache") = true,
      "Scores the search for inclusions, or the insertions of task insert, as `palpate score --json` does. "
      "Returns a dict. Raises InputError, also when there is neither in it.");
  recording.attr("felt_map") = py::cpp_function(
      &felt_map_of, py::name("felt_map"), py::is_method(recording), py::arg("cache") = true,
      "The stiffness that the hands felt, over the organ's surface. Returns a dict of arrays: points (n x 3, "
      "m, organ frame), felt_factor (NaN: never pressed 1 mm deep), true_factor, depth (m) and force (N), "
      "the largest nearby. Raises InputError.");
}

}  // namespace palpate::python
