#pragma once
#include <filesystem>
#include <functional>
#include <string>

namespace palpate::contact {

/// How an organ is prepared; by default in silence and without a cache.
struct Preparation {
  /// Folder of prepared organs that may be read instead of worked out again, and written; empty: none. A
  /// folder or file that cannot be read or written is no error.
  std::filesystem::path cache = {};
  /// Told now and then what is being done and how far all of it is, 0..1; on the thread that prepares.
  std::function<void(double share, const std::string& what)> progress = {};
  /// Told once whether the cache served and, if not, why; for a log.
  std::function<void(const std::string& words)> remark = {};
};

}  // namespace palpate::contact
