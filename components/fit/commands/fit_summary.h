#pragma once
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "palpate/identify.h"

#include "app/cli.h"
#include "fit/identify/map_choice.h"
#include "fit/identify/needle_fit.h"
#include "fit/identify/sweep.h"
#include "fit/imaging/compare.h"
#include "fit/report/validation_report.h"

namespace palpate::app {

/// [setup] The fits, the pooled fit and the sweeps as one JSON document (docs/fitting.md lists its fields).
[[nodiscard]] std::string fit_json(const std::vector<identify::SpecimenFit>& fits,
                                   const identify::PooledFit& pooled,
                                   const std::vector<identify::Sweep>& sweeps);

/// [setup] The fits as a readable summary: one block per specimen, then the pooled fit of several specimens.
/// Each block ends with its warnings.
[[nodiscard]] std::string fit_text(const std::vector<identify::SpecimenFit>& fits,
                                   const identify::PooledFit& pooled);

/// [setup] The fit of a needle's records as a readable summary.
[[nodiscard]] std::string needle_text(const identify::NeedleFit& fit);

/// [setup] The fit of a needle's records as one JSON document (docs/needle.md lists its fields).
[[nodiscard]] std::string needle_json(const identify::NeedleFit& fit);

/// [setup] The fit of a map as a readable summary.
[[nodiscard]] std::string map_text(const identify::DescribedMap& map);

/// [setup] The fit of a map as one JSON document (docs/lumps.md lists its fields).
[[nodiscard]] std::string map_json(const identify::DescribedMap& map);

/// The files that a scene of a fitted map names, as its [organ] does; empty: none.
struct MapFiles {
  std::string tissue;
  std::string stiffness;
};

/// [setup] A fitted map as a scene without its organ's mesh.
[[nodiscard]] std::string map_toml(const identify::DescribedMap& map, const MapFiles& files);

/// [setup] The stiffness map as CSV, as [organ.stiffness] reads it.
[[nodiscard]] std::string map_csv(const identify::MapFit& fit);

/// How well a fitted map predicts new probes.
struct MapValidation {
  std::size_t probes = 0;
  std::size_t rows = 0;
  double range = 0.0;                 // of the measured force [N]
  double rms = 0.0;                   // error [N]
  double largest = 0.0;               // error [N]
  std::size_t outside_probes = 0;     // farther from every fitted probe than a stiffness map may be
  std::size_t deeper_rows = 0;        // than the fitted ones
  std::vector<std::string> warnings;  // about the measured rows
};

/// [setup] Predicts the probes of a file. @param scene_file as palpate fit --map wrote it @throws InputError
[[nodiscard]] MapValidation validate_map(const std::string& data, const std::string& scene_file);
[[nodiscard]] std::string map_validation_text(const MapValidation& map,
                                              const std::vector<std::string>& missed);
[[nodiscard]] std::string map_validation_json(const MapValidation& map,
                                              const std::vector<std::string>& missed);

/// [setup] Sweeps as CSV, one line per swept value. A field without a value is empty.
[[nodiscard]] std::string sweeps_csv(const std::vector<identify::Sweep>& sweeps);

/// [setup] The result of each sweep in one line; empty without sweeps.
[[nodiscard]] std::string sweeps_text(const std::vector<identify::Sweep>& sweeps);

/// [setup] The results as one JSON document (docs/validation.md lists its fields).
[[nodiscard]] std::string validation_json(const report::Validation& validation);

/// [setup] The results as a readable summary: the errors of each data set, then the missed goals.
[[nodiscard]] std::string validation_text(const report::Validation& validation);

/// The flags of `palpate validate` for photographs.
struct ImageFlags {
  std::vector<std::string> files;  // before, after
  double pixel = 0.0;              // size of a pixel [m]; 0: not given
  bool fixed_camera = false;
};

/// [setup] Adds --image, --scale-mm-per-px and --fixed-camera to a command.
void add_image_flags(CLI::App& command, ImageFlags& flags);

/// [setup] The photographs of the flags; absent without --image. @throws InputError without a scale
[[nodiscard]] std::optional<imaging::Photographs> photographs_of(const ImageFlags& flags);

}  // namespace palpate::app
