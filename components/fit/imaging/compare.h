#pragma once
#include <filesystem>
#include <optional>
#include <vector>

#include "palpate/validate.h"

#include "fit/imaging/image_compare.h"

namespace palpate::imaging {

/// Two photographs of a surface from the side.
struct Photographs {
  std::filesystem::path before;
  std::filesystem::path after;
  double pixel = 0.0;  // size of a pixel [m] > 0
  bool fixed_camera = false;
};

/// What a validation compares with the law. SI units.
struct Request {
  validate::Law law;
  std::vector<identify::Specimen> forces;
  std::vector<validate::Deformation> profiles;
  std::optional<Photographs> photographs;
  bool zeros_fitted = false;                  // judge the force curves with fitted zeros
  std::optional<double> first_contact;        // displacement at first contact [m]; absent: 0
  std::optional<double> offset;               // force reading without load [N]; absent: 0
  std::optional<std::vector<double>> depths;  // > 0 [m], one for all profiles or one each
  std::optional<std::vector<double>> loads;   // > 0 [N], instead of depths: the law gives the depths
  std::optional<double> tip_radius;           // m; absent: the radius in the tissue's source
  bool fit_reach = false;                     // first fit the falloff ratios to the profiles
  validate::SurfaceRule rule;
  std::vector<validate::BaselineKind> baselines;
};

/// Names of the request's arguments as the user types them, and messages for requests that contradict
/// themselves.
struct RequestNames {
  const char* depths;
  const char* loads;
  const char* tip_radius;
  const char* nothing;        // there is nothing to compare with
  const char* zeros_unused;   // zeros without a force curve
  const char* zeros_twice;    // zeros both given and to be fitted
  const char* drawn_unused;   // rule.as_drawn without a profile, or in a pull
  const char* depths_unused;  // depths, loads or a tip radius without a profile
};

/// [setup] Compares all data of the request with the law, then with the baseline models.
/// @throws InputError with the text of `names`, or as compare_forces(), compare_profiles() and
/// compare_photographs().
[[nodiscard]] Validation compare(const Request& request, const RequestNames& names);

}  // namespace palpate::imaging
