#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "palpate/identify.h"

#include "fit/identify/needle_record.h"

namespace palpate::identify {

/// One parameter of a needle's fit.
struct NeedleValue {
  std::string name;   // with its unit, as in a tissue file: "cutting_force_N", "relaxation 1 share"
  double unit = 1.0;  // value of that unit in SI
  int layer = 0;      // from 1; 0: of the tissue
  Estimate estimate;  // in SI
};

/// [setup] A value and its interval for readers, in its unit. A value that the records do not determine has
/// its interval alone.
[[nodiscard]] std::pair<std::string, std::string> shown(const NeedleValue& value);

/// What a fit shows of one record.
struct NeedleRepeat {
  std::string name;
  double rms = 0.0;                       // N, of the fit to this record alone
  double nrmse = 0.0;                     // over the range of its force
  std::optional<double> predicted_nrmse;  // mean over the fits to each other record; with its own zero, and
                                          // the first contact that suits its press
  double contact = 0.0;                   // m, depth of first contact
  double zero = 0.0;                      // N, of the sensor
  std::vector<Puncture> punctures;        // depths as in the record
  NeedleRecord record;                    // its rows, or means of them
  std::vector<double> fitted;             // N, one a row
};

/// The evidence for a number of layers.
struct LayerEvidence {
  std::size_t layers = 0;
  std::size_t votes = 0;    // records that show this number
  double nrmse = 0.0;       // mean over the records fitted with it
  std::size_t records = 0;  // fitted with it
};

struct NeedleFit {
  std::size_t layers = 0;
  std::size_t terms = 0;  // of the relaxation
  std::vector<NeedleValue> values;
  std::vector<LayerEvidence> evidence;
  std::vector<NeedleRepeat> repeats;
  double nrmse = 0.0;  // of one tissue for all records: root of the mean square over the records
  model::TissueParameters tissue;
  std::vector<std::string> warnings;
  std::string poor;  // why no tissue may come from this fit; empty: one may
};

/// [setup] Fits one tissue with layers to the records of insertions (docs/needle.md, "From records").
/// @param settings law, period and t1 @throws InputError when no record shows a puncture
[[nodiscard]] NeedleFit fit_needle(const std::vector<Insertion>& records, const Settings& settings,
                                   const Progress& progress);

}  // namespace palpate::identify
