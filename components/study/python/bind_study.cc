// palpate.study: estimators and simulated observers for experiments with people.
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/text.h"
#include "palpate/error.h"

#include "bindings/python/binding.h"
#include "study/psychophysics/psychophysics.h"
#include "study/session/deletion.h"
#include "study/session/trial_table.h"

namespace palpate::python {
namespace {

using psychophysics::Estimate;
using psychophysics::Observer;
using psychophysics::QuestPlus;
using psychophysics::Sensitivity;
using psychophysics::Staircase;
using Shape = psychophysics::PsychometricFunction::Shape;

py::dict dict_of(const Estimate& estimate) {
  py::dict values;
  values["mean"] = estimate.mean;
  values["sd"] = estimate.sd;
  values["low"] = estimate.low;
  values["high"] = estimate.high;
  return values;
}

py::dict dict_of(const Sensitivity& found) {
  py::dict values;
  values["d_prime"] = found.d_prime;
  values["criterion"] = found.criterion;
  values["ln_beta"] = found.ln_beta;
  values["reliable"] = found.reliable;
  return values;
}

py::dict threshold_of(const QuestPlus& quest) {
  const bool detects = quest.grid().function.shape == Shape::kWeibull;
  return dict_of(quest.estimate(detects ? psychophysics::threshold_of : psychophysics::log10_difference_of));
}

void bind_quest(py::module_& module) {
  py::class_<QuestPlus>(module, "QuestPlus",
                        "QUEST+: Bayesian estimation of a threshold, with the stimulus that leaves the least "
                        "expected entropy (Watson 2017). Lapses are a nuisance parameter.")
      .def_static(
          "detection",
          [](double from, double to, int per_decade) {
            return QuestPlus(psychophysics::detection_grid(from, to, per_decade));
          },
          py::arg("smallest"), py::arg("largest"), py::arg("per_decade") = 20,
          "Detection of a vibration or force in two intervals, between two amplitudes in any unit. Levels "
          "are log10 of the amplitude. Raises ParameterError.")
      .def_static(
          "difference",
          [](double least, double largest, int steps) {
            return QuestPlus(psychophysics::difference_grid(least, largest, steps));
          },
          py::arg("least") = 1.02, py::arg("largest") = 3.3, py::arg("steps") = 14,
          "Comparison of two stimuli by their ratio. Levels are ln(second / first). Raises ParameterError.")
      .def_property_readonly(
          "levels", [](const QuestPlus& quest) { return array_of(quest.grid().levels); },
          "The levels of the stimuli, ascending.")
      .def("next", &QuestPlus::next, "Index of the next stimulus in levels.")
      .def("update", &QuestPlus::update, py::arg("index"), py::arg("counted"),
           "Adds a trial. counted: correct (detection), or whether the second was judged larger "
           "(difference). Raises ParameterError.")
      .def("threshold", &threshold_of,
           "log10 of the amplitude with 75 % correct, or of the just noticeable difference (-1: 10 %): a "
           "dict of mean, sd, low and high, the central 95 % interval.")
      .def("edge_probability", &QuestPlus::edge_probability,
           "Larger of the probabilities of the first and the last location. Above 0.01 the range of stimuli "
           "is too small.")
      .def("lapses_often", &QuestPlus::lapses_often,
           "Whether a lapse rate of 5 % or more has a probability above 0.4.")
      .def("reset", &QuestPlus::reset, "Starts again from the prior.");
}

void bind_staircase(py::module_& module) {
  const psychophysics::StaircaseSetup usual;
  py::class_<Staircase>(module, "Staircase",
                        "A transformed and weighted up-down staircase (Levitt 1971; Kaernbach 1991).")
      .def(py::init([](double start, int down, std::vector<double> steps, int reversals_per_step,
                       double down_ratio, double least, double largest, int discarded) {
             return Staircase(
                 {start, down, std::move(steps), reversals_per_step, down_ratio, least, largest, discarded});
           }),
           py::arg("start"), py::arg("down") = usual.down, py::arg("steps") = usual.steps,
           py::arg("reversals_per_step") = usual.reversals_per_step, py::arg("down_ratio") = usual.down_ratio,
           py::arg("least") = usual.least, py::arg("largest") = usual.largest,
           py::arg("discarded") = usual.discarded,
           "start: first level; down: correct answers in succession that move the level down; steps: upward "
           "steps, each for reversals_per_step reversals; down_ratio: downward over upward step; least, "
           "largest: limits of the level; discarded: first reversals that mean() leaves out. Raises "
           "ParameterError.")
      .def_property_readonly("level", &Staircase::level, "Level of the next stimulus.")
      .def("update", &Staircase::update, py::arg("correct"), "Adds the answer to the stimulus at level.")
      .def(
          "reversals", [](const Staircase& stair) { return array_of(stair.reversals()); },
          "Levels at which the direction changed.")
      .def("mean", &Staircase::mean, "Mean of the reversals; None with fewer than two.");
}

void bind_detection_theory(py::module_& module) {
  module.def(
      "yes_no",
      [](int hits, int signals, int false_alarms, int blanks, bool log_linear) {
        return dict_of(psychophysics::yes_no({signals, hits}, {blanks, false_alarms}, log_linear));
      },
      py::arg("hits"), py::arg("signals"), py::arg("false_alarms"), py::arg("blanks"),
      py::arg("log_linear") = false,
      "Yes/no task: a dict of d_prime, criterion, ln_beta and reliable (False: a rate is below 0.05 or above "
      "0.95, and no statement may be made). signals, blanks: numbers of trials. Raises ParameterError.");
  module.def(
      "two_interval",
      [](int correct_first, int first, int correct_second, int second, bool log_linear) {
        return dict_of(
            psychophysics::two_interval({first, correct_first}, {second, correct_second}, log_linear));
      },
      py::arg("correct_first"), py::arg("first"), py::arg("correct_second"), py::arg("second"),
      py::arg("log_linear") = false,
      "Two-interval task: as yes_no(), from the correct answers and numbers of trials with the signal in the "
      "first and in the second interval. Raises ParameterError.");
  module.def("d_prime_of_correct", &psychophysics::d_prime_of_correct, py::arg("correct"),
             py::arg("intervals") = 2,
             "d' for a share of correct answers among some intervals without bias. Raises ParameterError.");
  module.def("correct_of_d_prime", &psychophysics::correct_of_d_prime, py::arg("d_prime"),
             py::arg("intervals") = 2,
             "Share of correct answers among some intervals without bias. Raises ParameterError.");
}

void bind_observers(py::module_& module) {
  py::class_<Observer>(module, "Observer",
                       "A simulated observer. Signal and noise are in units of its detection threshold.")
      .def(py::init([](const std::string& name) { return psychophysics::make_observer(name); }),
           py::arg("name"), "ideal, linear, sr, lapse, random, tires or learns. Raises InputError.")
      .def(
          "probability_second",
          [](const Observer& observer, double level, double noise, bool second, double progress) {
            return psychophysics::probability_second(observer, {level, noise, second, progress});
          },
          py::arg("level"), py::arg("noise") = 0.0, py::arg("second") = false, py::arg("progress") = 0.0,
          "Probability of the answer 'second'. level: of the signal; second: it is in the second interval; "
          "noise: its standard deviation in both intervals; progress: elapsed share of the session.");
  module.def("draw_answer", &psychophysics::draw_answer, py::arg("probability"), py::arg("seed"),
             py::arg("participant"), py::arg("trial"),
             "An answer with this probability, the same for the same numbers on any machine.");
}

// A column of the table: numbers, with NaN for an empty field, where all fields are numbers.
py::object array_of_column(const std::vector<std::string>& fields) {
  std::vector<double> numbers;
  for (const std::string& field : fields) {
    const std::optional<double> number = field.empty() ? std::nan("") : parse_number(field);
    if (!number) return py::module_::import("numpy").attr("array")(fields);
    numbers.push_back(*number);
  }
  return array_of(numbers);
}

py::dict read_trials(const std::filesystem::path& folder) {
  const study::StudyFolder study = study::open_study(folder);
  const study::ArmNames names(study.study, study.key, study.unblinded());
  const std::vector<study::TrialColumn>& columns = study::trial_columns();
  std::vector<std::vector<std::string>> fields(columns.size());
  const std::vector<study::Participant> people = study::read_people(study);
  const std::string deleted = study::deletions_text(study::deletions_of(people));
  if (!deleted.empty() && PyErr_WarnEx(PyExc_UserWarning, deleted.c_str(), 1) != 0) {
    throw py::error_already_set();
  }
  for (const study::Participant& person : people) {
    if (person.log.withdrawn()) continue;
    for (const study::TrialRecord& trial : person.log.trials) {
      const std::vector<std::string> row = study::trial_row(study.study, person, trial, names);
      for (std::size_t i = 0; i < row.size(); ++i) fields[i].push_back(row[i]);
    }
  }
  py::dict table;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const std::string unit = columns[i].unit.empty() ? "" : "_" + columns[i].unit;
    table[py::str(columns[i].name + unit)] = array_of_column(fields[i]);
  }
  return table;
}

}  // namespace

}  // namespace palpate::python

PYBIND11_MODULE(_study, module) {
  using namespace palpate::python;
  namespace py = pybind11;
  bind_quest(module);
  bind_staircase(module);
  bind_detection_theory(module);
  bind_observers(module);
  module.def(
      "read_trials", &read_trials, py::arg("folder"),
      "All trials of a study's folder, as `palpate study export --csv`: a dict of arrays. Conditions are the "
      "participants' own codes until the study is unblinded. Raises InputError for a changed file.");
}
