#include "bench/peers/plugin.h"

#include <vector>

#include "bench/peers/peer_list.h"

extern "C" [[gnu::visibility("default")]] const PalpatePeer* palpate_peers(size_t* count) {
  static const std::vector<PalpatePeer> all = {
#if PALPATE_WITH_BULLET
    palpate::bench::peers::bullet(),
#endif
#if PALPATE_WITH_FCL
    palpate::bench::peers::fcl(),
#endif
#if PALPATE_WITH_EMBREE
    palpate::bench::peers::embree(),
#endif
  };
  *count = all.size();
  return all.data();
}
