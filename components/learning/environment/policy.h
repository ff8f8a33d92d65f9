#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "learning/environment/environment.h"

namespace palpate::learning {

enum class PolicyKind : std::uint8_t {
  kRandom,    // a smooth random walk of the tool, within 15 mm to the sides (in a search: the organ's size)
  kScripted,  // approach, then a proportional force controller; in a search a raster of presses, then marks
};

/// [any] "random" or "scripted".
[[nodiscard]] const char* to_string(PolicyKind kind) noexcept;
/// [setup] @throws InputError that names the text and the policies
[[nodiscard]] PolicyKind parse_policy(const std::string& text);

/// Chooses the actions of one episode. [setup], one thread.
class Policy {
 public:
  Policy() = default;
  virtual ~Policy() = default;
  Policy(const Policy&) = delete;
  Policy& operator=(const Policy&) = delete;

  /// The next action. @param last result of the last step or reset @param action one value per action channel
  virtual void act(const StepResult& last, std::span<double> action) = 0;
};

/// [setup] A policy for an episode. @param environment outlives it @param seed of its random numbers
/// @throws InputError when the organ's upper side has no place to press
[[nodiscard]] std::unique_ptr<Policy> make_policy(PolicyKind kind, const Environment& environment,
                                                  std::uint64_t seed);

}  // namespace palpate::learning
