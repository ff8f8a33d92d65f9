#pragma once
#include <vector>

#include "core/model/relaxation.h"
#include "palpate/recording.h"
#include "palpate/spring_law.h"

namespace palpate::report {

/// Expected force of a single contact at each tick of a recording: the law valid at that tick, with
/// relaxation since the contact began.
class LawOverTime final {
 public:
  /// [setup] @param recording must outlive this object @throws ParameterError for an invalid recorded tissue
  LawOverTime(const record::Recording& recording, model::Direction direction);

  /// [setup] Expected force [N] of a row; 0 out of contact. Call it once per row of one hand, in order.
  double force_at(const haptics::TickRow& row);

 private:
  void change_to(const model::TissueParameters& tissue);

  const record::Recording& recording_;
  model::Direction direction_;
  double period_;  // s
  model::SpringLaw law_;
  model::Relaxation relaxation_;
  model::RelaxationState memory_;
  std::size_t next_change_ = 0;
};

/// [setup] Describes each parameter update of tissue or noise in a recording.
[[nodiscard]] std::vector<std::string> changes_text(const record::Recording& recording);

}  // namespace palpate::report
