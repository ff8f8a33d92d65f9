#pragma once
#include <span>
#include <vector>

#include "palpate/identify.h"

namespace palpate::identify {

/// The force that a tissue would have shown the sensor, at every point of a specimen: the law at displacement
/// minus first-contact depth, relaxed over the specimen's times when there are terms, never below 0 (a
/// contact cannot pull), plus the sensor's offset. [setup]
/// @param force gets one value [N] a point; all NaN where the parameters make no law
/// @param shared, own as in a Point
void predict(const Specimen& specimen, const Ranges& ranges, const Settings& settings,
             std::span<const double> shared, std::span<const double> own, std::span<double> force);

/// [setup] Turns elastic forces [N] at rising times [s] into relaxed ones. Before the first point nothing was
/// held: what force it has came at once. @param time as many as `force`, at least two
void relax(std::span<const model::RelaxationTerm> terms, const std::vector<double>& time,
           std::span<double> force);

/// [setup] Layers that the law of `shared` has, and how many of them the specimen's largest depth reaches.
struct LayerCount {
  int allowed = 0;
  int reached = 0;
};
[[nodiscard]] LayerCount layers_of(const Specimen& specimen, const Ranges& ranges, const Settings& settings,
                                   std::span<const double> shared, std::span<const double> own);

}  // namespace palpate::identify
