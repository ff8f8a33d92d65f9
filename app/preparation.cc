#include "app/preparation.h"

#include <mutex>
#include <string>

#include "io/scene/organ_cache.h"
#include "io/system/cache_folder.h"
#include "io/system/clock.h"

#include "app/messages.h"

namespace palpate::app {
namespace {

constexpr std::int64_t kSilent_ns = 300'000'000;  // delay of the bar: a small organ is ready earlier

}  // namespace

OrganPreparation::OrganPreparation(bool no_cache)
    : bar_("preparing the organ"), show_from_ns_(monotonic_ns() + kSilent_ns) {
  how_.progress = [this](double share, const std::string& what) {
    if (monotonic_ns() >= show_from_ns_) bar_.update(share, what);
  };
  if (no_cache) return;
  scene::use_organ_cache(how_, user_cache_folder(), report_detail, [](const std::string& why) {
    static std::once_flag warned;  // warns once, although a process may prepare many organs
    std::call_once(warned, [&why] { report_message(why); });
  });
}

}  // namespace palpate::app
