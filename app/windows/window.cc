// The window of `palpate run`, in a program without one.
#include "app/window/run_in_window.h"

namespace palpate::app {

bool display_there() { return false; }

const char* describe_no_display() noexcept { return "palpate for Windows has no window yet"; }

std::optional<float> UiScale::asked(const std::string& /*flag*/) { return std::nullopt; }

WindowOutcome run_in_window(std::shared_ptr<Session> /*first*/, const scene::Overrides& /*request*/,
                            const WindowOptions& /*options*/) {
  throw NoWindow(describe_no_display());
}

}  // namespace palpate::app
