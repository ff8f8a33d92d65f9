#pragma once
#include <functional>
#include <memory>
#include <string>

namespace palpate::contact {

class OrganStore;  // opaque; scene::use_organ_cache() makes one of a folder

/// Options for the preparation of an organ. By default there is no cache: the organ is prepared each time,
/// and no progress is reported.
struct Preparation {
  /// The cache of prepared organs. Null: none.
  std::shared_ptr<const OrganStore> store = {};
  /// Called repeatedly with the completed fraction of the preparation, 0..1, and a description of the current
  /// step; on the thread that prepares the organ.
  std::function<void(double share, const std::string& what)> progress = {};
};

}  // namespace palpate::contact
