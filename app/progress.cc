#include "app/progress.h"

#include <algorithm>
#include <mutex>

#include <fmt/core.h>
#include <unistd.h>

#include "io/system/clock.h"
#include "palpate/organ_cache.h"

#include "app/messages.h"
#include "app/output.h"

namespace palpate::app {
namespace {

constexpr int kBarWidth = 30;
constexpr std::int64_t kRedraw_ns = 50'000'000;
constexpr const char* kClearLine = "\r\033[K";

constexpr std::int64_t kNextLine_ns = 10'000'000'000;  // between lines where no terminal is

constexpr std::int64_t kSilent_ns = 300'000'000;  // delay of the bar: a small organ is ready earlier

}  // namespace

Progress::Progress(const std::string& title, WithoutTerminal otherwise)
    : title_(escaped(title, false)),
      terminal_(is_terminal(STDERR_FILENO)),
      otherwise_(otherwise),
      next_draw_ns_(terminal_ ? 0 : monotonic_ns() + kNextLine_ns) {}

Progress::~Progress() { clear(); }

void Progress::clear() {
  if (!drawn_) return;
  write_text(STDERR_FILENO, kClearLine);
  drawn_ = false;
  next_draw_ns_ = 0;
}

void Progress::update(double share, const std::string& what) {
  if (!terminal_ && otherwise_ == WithoutTerminal::kNothing) return;
  const std::int64_t now = monotonic_ns();
  const bool steps = !terminal_ && otherwise_ == WithoutTerminal::kSteps;
  if (steps ? what == step_ : now < next_draw_ns_) return;
  step_ = what;
  share = share > 0.0 ? std::min(share, 1.0) : 0.0;
  if (!terminal_) {
    next_draw_ns_ = now + kNextLine_ns;
    write_text(STDERR_FILENO,
               fmt::format("{}: {} % {}\n", title_, static_cast<int>(100.0 * share), escaped(what, false)));
    return;
  }
  next_draw_ns_ = now + kRedraw_ns;
  drawn_ = true;
  const int filled = static_cast<int>(share * kBarWidth);
  const std::string bar = std::string(static_cast<std::size_t>(filled), '#') +
                          std::string(static_cast<std::size_t>(kBarWidth - filled), '.');
  write_text(STDERR_FILENO, fmt::format("{}{} [{}] {:3} % {}", kClearLine, title_, bar,
                                        static_cast<int>(100.0 * share), escaped(what, false)));
}

OrganPreparation::OrganPreparation(bool no_cache)
    : bar_("preparing the organ"), show_from_ns_(monotonic_ns() + kSilent_ns) {
  how_.progress = [this](double share, const std::string& what) {
    if (monotonic_ns() >= show_from_ns_) bar_.update(share, what);
  };
  if (no_cache) return;
  scene::use_organ_cache(how_, scene::organ_cache_folder(), report_detail, [](const std::string& why) {
    static std::once_flag warned;  // warns once, although a process may prepare many organs
    std::call_once(warned, [&why] { report_message(why); });
  });
}

}  // namespace palpate::app
