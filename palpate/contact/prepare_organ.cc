// How an organ's surface is prepared: worked out on all processors, or read from the cache.
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "palpate/base/array_file.h"
#include "palpate/base/cache_folder.h"
#include "palpate/base/parallel.h"
#include "palpate/contact/organ_surface.h"

namespace palpate::contact {
namespace {

namespace fs = std::filesystem;

constexpr const char* kEnding = ".organ";
constexpr std::uint64_t kMostCached = std::uint64_t{1}
                                      << 30;  // bytes: about ten organs of a million triangles

/// Part of the whole time at which each stage begins, for a fine mesh.
constexpr double kDistanceFrom = 0.02;
constexpr double kArraysFrom = 0.25;
constexpr double kStoreFrom = 0.98;

/// The cache's file of one organ; without a folder nothing is ever found or kept.
class CachedOrgan final {
 public:
  CachedOrgan(const geometry::TriangleMesh& organ, double reference_radius, const Preparation& how)
      : how_(how) {
    if (how.cache.empty()) return;
    key_ = organ_key(organ, reference_radius);
    file_ = how.cache / (key_.hexadecimal() + kEnding);
  }

  [[nodiscard]] std::optional<OrganArrays> load() const {
    if (file_.empty()) return std::nullopt;
    std::error_code error;
    if (!fs::exists(file_, error)) {
      say("the cache does not have this organ: " + file_.string());
      return std::nullopt;
    }
    const std::optional<ArrayFileReader> reader = ArrayFileReader::open(file_, key_);
    std::optional<OrganArrays> arrays = reader ? OrganArrays::get(*reader) : std::nullopt;
    if (!arrays) {
      say("the cached organ is damaged or of another version and is made anew: " + file_.string());
      return std::nullopt;
    }
    say("prepared organ taken from the cache: " + file_.string());
    fs::last_write_time(file_, fs::file_time_type::clock::now(), error);  // used last are kept longest
    return arrays;
  }

  void store(const OrganArrays& arrays) const {
    if (file_.empty()) return;
    std::error_code error;
    fs::create_directories(how_.cache, error);
    ArrayFileWriter writer(file_, key_);
    arrays.put(writer);
    if (!writer.commit()) say("the prepared organ could not be kept as " + file_.string());
    trim_cache(how_.cache, kEnding, kMostCached);
  }

 private:
  void say(const std::string& words) const {
    if (how_.remark) how_.remark(words);
  }

  const Preparation& how_;
  ContentHash key_;
  fs::path file_;
};

}  // namespace

OrganSurface::Prepared OrganSurface::prepare(const geometry::TriangleMesh& organ, double reference_radius,
                                             const Preparation& how) {
  const auto tell = [&](double share, const std::string& what) {
    if (how.progress) how.progress(share, what);
  };
  const WorkerThreads workers;
  const CachedOrgan cached(organ, reference_radius, how);
  tell(0.0, "cache");
  if (std::optional<OrganArrays> arrays = cached.load()) {
    tell(kDistanceFrom, "distances");
    geometry::SurfaceDistance distance(arrays->mesh);
    tell(1.0, "done");
    return {std::move(*arrays), std::move(distance)};
  }
  tell(0.0, "refinement");
  geometry::TriangleMesh mesh = refined(organ, reference_radius);
  tell(kDistanceFrom, "distances");
  geometry::SurfaceDistance distance(mesh);  // refuses what is no closed surface
  OrganArrays arrays =
      organ_arrays(std::move(mesh), reference_radius, [&](double share, const std::string& what) {
        tell(kArraysFrom + (kStoreFrom - kArraysFrom) * share, what);
      });
  tell(kStoreFrom, "cache");
  cached.store(arrays);
  tell(1.0, "done");
  return {std::move(arrays), std::move(distance)};
}

}  // namespace palpate::contact
