#pragma once
#include <vector>

#include "core/model/relaxation.h"
#include "palpate/recording.h"
#include "palpate/spring_law.h"

namespace palpate::report {

/// The force that one contact should have had at each tick of a recording: the law in force then, with its
/// relaxation from where the contact began.
class LawOverTime final {
 public:
  /// [setup] @param recording outlives this @throws ParameterError for a recorded tissue that is none
  LawOverTime(const record::Recording& recording, model::Direction direction);

  /// [setup] Of one hand's rows, in order, one call a row. @return N; 0 out of contact
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

/// [setup] Each change to tissue or noise that a recording holds, in words.
[[nodiscard]] std::vector<std::string> changes_in_words(const record::Recording& recording);

}  // namespace palpate::report
