#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "palpate/scene.h"

#include "bench/measure/account.h"
#include "bench/measure/ticks.h"
#include "bench/peers/plugin.h"

namespace palpate::bench {

/// A library that can be compared, and its Debian package.
struct SupportedPeer {
  std::string name;
  std::string package;
};

/// [any] All of them, in the order of the tables.
[[nodiscard]] const std::vector<SupportedPeer>& supported_peers();

/// [setup] Path of libpalpate_peers.so beside the running program palpate-bench.
[[nodiscard]] std::filesystem::path peers_library();

/// The peers in a shared library of peers/plugin.h; none when it cannot be opened.
class Peers final {
 public:
  /// [setup]
  explicit Peers(const std::filesystem::path& library);

  /// [any] The peers that were built.
  [[nodiscard]] const std::vector<PalpatePeer>& all() const noexcept { return all_; }
  /// [any] One line for each peer that was not built.
  [[nodiscard]] std::vector<std::string> missing() const;

 private:
  std::vector<PalpatePeer> all_;
};

/// A comparison of one peer along a path.
struct PeerComparison {
  const scene::Scene& scene;
  const std::vector<PathPoint>& way;
  double seconds = 0.0;  // time limit: beyond it only every n-th point of the path is used
};

/// [setup] CPU time of a peer's queries along the path; ratios stay 0. Without contact between tool and organ
/// there are no figures for contact. @throws std::runtime_error when it rejects the organ, or when its
/// distances differ from Palpate's by more than 20 um (single precision) while the tool is outside, so that
/// it does not answer the same question.
[[nodiscard]] PeerAccount measure_peer(const PalpatePeer& peer, const PeerComparison& question);

}  // namespace palpate::bench
