#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "palpate/scene.h"

#include "bench/measure/account.h"
#include "bench/measure/ticks.h"
#include "bench/peers/plugin.h"

namespace palpate::bench {

/// A library that palpate knows how to ask, and Debian's package of it.
struct KnownPeer {
  std::string name;
  std::string package;
};

/// [any] All of them, in the order of the tables.
[[nodiscard]] const std::vector<KnownPeer>& known_peers();

/// [setup] libpalpate_peers.so beside the running program, palpate-bench.
[[nodiscard]] std::filesystem::path peers_library();

/// The peers in a shared library of peers/plugin.h; none when it cannot be opened.
class Peers final {
 public:
  /// [setup]
  explicit Peers(const std::filesystem::path& library);

  /// [any] Those that were built in.
  [[nodiscard]] const std::vector<PalpatePeer>& all() const noexcept { return all_; }
  /// [any] One line each on those that were not.
  [[nodiscard]] std::vector<std::string> missing() const;

 private:
  std::vector<PalpatePeer> all_;
};

/// One peer asked along a way.
struct PeerQuestion {
  const scene::Setup& setup;
  const std::vector<WayPoint>& way;
  double seconds = 0.0;  // about so long at most: else only every n-th point of the way is asked
};

/// [setup] Processor time of a peer's answers along the way; ratios are left at 0.
/// @throws std::runtime_error when it refuses the organ, or its distances are not palpate's within 20 um
/// (single precision) while the tool is outside: then it was asked another question. No figures in contact
/// when it never was in touch with the organ.
[[nodiscard]] PeerAccount ask_peer(const PalpatePeer& peer, const PeerQuestion& question);

}  // namespace palpate::bench
