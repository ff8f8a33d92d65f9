#pragma once
#include <span>
#include <vector>

#include "palpate/identify.h"

namespace palpate::identify {

/// [setup] Forces [N] that the model predicts at the points of a specimen: the law at displacement minus
/// first-contact depth, relaxed over the specimen's times if the model has relaxation terms, limited to >= 0
/// (a contact cannot pull), plus the sensor offset.
/// @param force one value [N] per point; all NaN where the parameters are not a valid law
/// @param shared, own parameters in the form of a Point
void predict(const Specimen& specimen, const Ranges& ranges, const Settings& settings,
             std::span<const double> shared, std::span<const double> own, std::span<double> force);

/// [setup] Applies relaxation to elastic forces [N] at increasing times [s]. The force at the first point is
/// treated as applied at that instant. @param time same size as `force`, at least 2
void relax(std::span<const model::RelaxationTerm> terms, const std::vector<double>& time,
           std::span<double> force);

/// Number of layers of the law, and how many of them the specimen's largest depth reaches.
struct LayerCount {
  int allowed = 0;
  int reached = 0;
};
[[nodiscard]] LayerCount layers_of(const Specimen& specimen, const Ranges& ranges, const Settings& settings,
                                   std::span<const double> shared, std::span<const double> own);

}  // namespace palpate::identify
