#include "palpate/render/quality.h"

#include <algorithm>

namespace palpate::render {
namespace {

constexpr double kShare = 0.15;  // of the newest picture in the running mean
constexpr int kFewest = 12;      // pictures before a level is judged
constexpr double kRoom = 0.6;    // of the budget: a level this cheap leaves room for the better one
constexpr int kLongestWait = 120 * 32;

Quality better(Quality q) { return static_cast<Quality>(static_cast<int>(q) - 1); }
Quality cheaper(Quality q) { return static_cast<Quality>(static_cast<int>(q) + 1); }

}  // namespace

void QualityChoice::add(double frame_ms) noexcept {
  mean_ms_ = seen_ == 0 ? frame_ms : mean_ms_ + kShare * (frame_ms - mean_ms_);
  ++seen_;
  if (wait_ > 0) --wait_;
  if (seen_ < kFewest) return;
  if (mean_ms_ > budget_ms_ && now_ != Quality::kFast) {
    now_ = cheaper(now_);
    seen_ = 0;
    wait_ = next_wait_;
    next_wait_ = std::min(2 * next_wait_, kLongestWait);  // each failure of a level makes it rarer
  } else if (mean_ms_ < kRoom * budget_ms_ && now_ != best_ && wait_ == 0) {
    now_ = better(now_);
    seen_ = 0;
  }
}

}  // namespace palpate::render
