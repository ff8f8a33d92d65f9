#include "run/session/usable_core.h"

#include <algorithm>
#include <vector>

#include "palpate/error.h"
#include "run/realtime/realtime.h"

namespace palpate::session {

void require_usable_core(std::optional<int> core, const std::string& name) {
  if (!core) return;
  const std::vector<int> cores = realtime::usable_cores();
  if (std::find(cores.begin(), cores.end(), *core) != cores.end()) return;
  std::string list;
  for (const int usable : cores) list += (list.empty() ? "" : ", ") + std::to_string(usable);
  throw ParameterError(name, *core, "a core that this program may use: " + list);
}

}  // namespace palpate::session
