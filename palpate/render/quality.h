#pragma once
#include <cstdint>

namespace palpate::render {

/// How much work a picture may be. All draw the same things in the same light.
enum class Quality : std::uint8_t {
  kFull,      // pictures for reports and files: finest surface, shadows and occlusion of everything, four
              // samples a pixel
  kBalanced,  // moving pictures: occlusion of the organ at rest, the tools' soft shadow, smoothed edges
  kFast,      // the same without the finest pattern, and edges as they come
};

/// Chooses between kBalanced and kFast by how long pictures take, so that they stay within a budget; or kFull
/// where there is time for that. Goes down when pictures are slow in the mean or three in a row are, and up
/// only when there is clearly room, more rarely each time that it had to go down again, so that it does not
/// swing. The first picture of a level does not count: it may have had to be prepared for.
class QualityChoice final {
 public:
  static constexpr double kBudget_ms = 32.0;  // the paper's own frame time

  /// [any] @param best the best level that it may choose
  explicit QualityChoice(Quality best = Quality::kBalanced, double budget_ms = kBudget_ms) noexcept
      : best_(best), now_(best), budget_ms_(budget_ms) {}

  /// [any] Takes the time of one picture at now().
  void add(double frame_ms) noexcept;
  /// [any] From here on no better level than this.
  void limit(Quality best) noexcept;
  [[nodiscard]] Quality now() const noexcept { return now_; }

 private:
  Quality best_;
  Quality now_;
  double budget_ms_;
  double mean_ms_ = 0.0;  // of late, at now_
  int seen_ = 0;          // pictures at now_
  int slow_ = 0;          // of them over the budget without one between them that was not
  int wait_ = 0;          // pictures before a better level is tried again
  int next_wait_ = 120;
};

}  // namespace palpate::render
