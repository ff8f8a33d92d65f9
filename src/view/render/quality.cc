#include <algorithm>

#include "palpate/offscreen.h"

namespace palpate::render {
namespace {

constexpr double kShare = 0.15;  // weight of the newest picture in the running mean
constexpr int kFewest = 12;      // number of pictures before the mean is used
constexpr int kSlowInARow = 3;   // consecutive pictures over the budget that lower the quality at once
constexpr double kRoom = 0.6;    // of the budget: a mean below it allows a higher quality
constexpr int kLongestWait = 120 * 32;

Quality better(Quality q) { return static_cast<Quality>(static_cast<int>(q) - 1); }
Quality cheaper(Quality q) { return static_cast<Quality>(static_cast<int>(q) + 1); }

}  // namespace

void QualityChoice::add(double frame_ms) noexcept {
  if (wait_ > 0) --wait_;
  if (seen_++ == 0) return;
  mean_ms_ = seen_ == 2 ? frame_ms : mean_ms_ + kShare * (frame_ms - mean_ms_);
  slow_ = frame_ms > budget_ms_ ? slow_ + 1 : 0;
  const bool judged = seen_ > kFewest;
  if (now_ != Quality::kFast && (slow_ >= kSlowInARow || (judged && mean_ms_ > budget_ms_))) {
    now_ = cheaper(now_);
    seen_ = slow_ = 0;
    wait_ = next_wait_;
    next_wait_ = std::min(2 * next_wait_, kLongestWait);  // each failure of a level doubles the wait
  } else if (judged && mean_ms_ < kRoom * budget_ms_ && now_ != best_ && wait_ == 0) {
    now_ = better(now_);
    seen_ = slow_ = 0;
  }
}

void QualityChoice::limit(Quality best) noexcept {
  best_ = best;
  if (now_ >= best) return;
  now_ = best;
  seen_ = slow_ = 0;
}

}  // namespace palpate::render
