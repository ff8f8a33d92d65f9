#include "fit/imaging/compare.h"

#include <cstddef>
#include <string>
#include <utility>

#include <fmt/core.h>

#include "palpate/error.h"

#include "fit/identify/loading.h"
#include "fit/identify/plausible_specimen.h"

namespace palpate::imaging {
namespace {

/// Rejects arguments that would have no effect or contradict each other.
void check(const Request& request, const RequestNames& names) {
  const bool stated = request.first_contact || request.offset;
  const bool surfaces = !request.profiles.empty() || request.photographs;
  if (request.forces.empty() && !surfaces) throw InputError(names.nothing);
  if (request.forces.empty() && (stated || request.zeros_fitted)) throw InputError(names.zeros_unused);
  if (request.zeros_fitted && stated) throw InputError(names.zeros_twice);
  if (request.rule.as_drawn &&
      (request.profiles.empty() || request.law.direction == model::Direction::kPull)) {
    throw InputError(names.drawn_unused);
  }
  if (!surfaces && (request.depths || request.loads || request.tip_radius))
    throw InputError(names.depths_unused);
}

/// Depth [m] of each of `count` profiles; 0: the profile has its own.
std::vector<double> depths_of(const Request& request, const RequestNames& names, std::size_t count) {
  if (!request.depths && !request.loads) return std::vector<double>(count, 0.0);
  std::vector<double> depths = request.loads ? *request.loads : *request.depths;
  if (request.loads) {
    for (double& value : depths) value = request.law.depth_under(value);
  }
  if (depths.size() == 1) depths.resize(count, depths.front());
  if (depths.size() != count) {
    throw InputError(fmt::format("{}: has {} values, must have one, or one for each of the {} profiles",
                                 request.loads ? names.loads : names.depths, depths.size(), count));
  }
  return depths;
}

double tip_radius_of(const Request& request, const RequestNames& names) {
  if (request.tip_radius) {
    identify::require_tip_radius(names.tip_radius, *request.tip_radius);
    return *request.tip_radius;
  }
  if (request.law.tissue.source) return request.law.tissue.source->radius;
  throw InputError(std::string(names.tip_radius) + ": missing, a profile needs the radius of the tool's tip");
}

/// The rows that a tissue without relaxation describes, as `palpate fit` takes them, with the doubts about
/// them as notes. @throws InputError as a reader of specimens
identify::Specimen comparable(identify::Specimen specimen, bool relaxes) {
  identify::check_specimen(specimen, "specimen " + specimen.name);
  identify::Specimen used = relaxes ? specimen : identify::last_loading(specimen);
  for (std::string& doubt : identify::unit_questions(specimen))
    used.preparation.notes.push_back(std::move(doubt));
  return used;
}

}  // namespace

Validation compare(const Request& request, const RequestNames& names) {
  check(request, names);
  Validation validation;
  validation.law = request.law;
  const validate::Zeros zeros{request.first_contact.value_or(0.0), request.offset.value_or(0.0)};
  for (const identify::Specimen& specimen : request.forces) {
    validate::Law law = request.law;
    if (specimen.tip_radius > 0.0) law.tissue = model::for_tool(law.tissue, specimen.tip_radius);
    const identify::Specimen used = comparable(specimen, !law.tissue.relaxation.empty());
    validation.forces.push_back(validate::compare_forces(used, law, zeros, request.zeros_fitted));
  }
  if (!request.profiles.empty()) {
    std::vector<validate::Deformation> profiles;
    for (const validate::Deformation& profile : request.profiles)
      profiles.push_back(validate::thinned(profile, validate::kMaxPoints));
    const double radius = tip_radius_of(request, names);
    validate::compare_profiles(profiles, depths_of(request, names, profiles.size()), radius,
                               request.fit_reach, validation, request.rule);
  }
  if (request.photographs) {
    const Photographs& pictures = *request.photographs;
    const double depth = depths_of(request, names, 1).front();
    validation.image = compare_photographs(pictures.before, pictures.after,
                                           {pictures.pixel, request.law.direction, pictures.fixed_camera},
                                           validation.law, depth, tip_radius_of(request, names));
    validate::ProfileSet set;
    set.ours = validation.image->comparison;
    validation.profiles.push_back(std::move(set));
  }
  if (!request.baselines.empty()) validate::compare_with_baselines(request.baselines, validation);
  return validation;
}

}  // namespace palpate::imaging
