#include "app/window/resolution_choice.h"

#include <algorithm>
#include <array>
#include <utility>

namespace palpate::app {
namespace {

constexpr std::array<double, 5> kLevels = {1.0, 0.8, 0.65, 0.5, 0.4};
constexpr double kRoom = 0.75;     // fraction of the budget below which the resolution rises
constexpr double kVerySlow = 3.0;  // multiple of the budget
constexpr std::size_t kLongestWait = 32 * ResolutionChoice::kFirstWait;

}  // namespace

bool ResolutionChoice::add(double frame_time, bool may_cheapen, std::size_t judged) {
  times_.push_back(frame_time);
  if (times_.size() < judged) return false;
  std::sort(times_.begin(), times_.end());
  const double usual = times_[times_.size() / 2];
  times_.clear();
  return fits(usual, may_cheapen);
}

bool ResolutionChoice::fits(double usual, bool may_cheapen) noexcept {
  if (wait_ > 0) --wait_;
  const bool tried = std::exchange(tried_, false);
  if (usual <= kBudget) {
    if (usual < kRoom * kBudget && level_ > 0 && wait_ == 0) {
      --level_;
      tried_ = true;
    }
    return true;
  }
  if (may_cheapen && usual <= kVerySlow * kBudget) return false;
  if (tried) {
    wait_ = next_wait_;
    next_wait_ = std::min(2 * next_wait_, kLongestWait);
  }
  if (usual > kVerySlow * kBudget) (void)lower();
  return !lower();
}

bool ResolutionChoice::lower() noexcept {
  if (level_ + 1 >= kLevels.size()) return false;
  ++level_;
  return true;
}

double ResolutionChoice::now() const noexcept { return kLevels[level_]; }

}  // namespace palpate::app
