// Two hands with one instrument each on one organ, with a scene from a string instead of a file.
#include <algorithm>
#include <array>
#include <iostream>

#include "palpate/error.h"
#include "palpate/scene.h"
#include "palpate/session.h"

namespace {

constexpr const char* kScene = R"toml(
[scene]
name = "two hands on a liver-like box"
[organ]
mesh = "box"
tissue = "liver"
[[tool]]
mesh = "sphere:5"
[[tool]]
mesh = "curved-forceps"
[[device]]                 # the first hand, 15 mm to one side
kind = "scripted"
base = { position_mm = [-15, 0, 0] }
[[device]]                 # the second, 15 mm to the other
kind = "scripted"
base = { position_mm = [15, 0, 0] }
)toml";

/// Finds each hand's largest force. The loop passes one row per hand and tick.
class LargestForces final : public palpate::haptics::TickObserver {
 public:
  void on_row(const palpate::haptics::TickRow& row) noexcept override {
    double& largest = of_hand[row.hand];
    largest = std::max(largest, row.tissue_force);
  }
  std::array<double, palpate::kMaxHands> of_hand{};  // N
};

void press_with_both() {
  palpate::scene::Overrides request;
  request.scene_text = palpate::scene::SceneText{kScene, "."};
  auto session = palpate::session::Session::open(palpate::scene::load(request));

  LargestForces largest;
  const auto result = session.run({.offline = true}, {&largest});
  std::cout << result.scene << ": " << result.loop.ticks << " ticks\n";
  for (std::size_t hand = 0; hand < session.hands(); ++hand) {
    std::cout << "hand " << hand << ", " << session.scene().tools[hand].name << ": largest force "
              << largest.of_hand[hand] << " N\n";
  }
}

}  // namespace

int main() {
  try {
    press_with_both();
  } catch (const palpate::InputError& error) {
    std::cerr << "several_hands: " << error.what() << '\n';
    return 2;
  }
  return 0;
}
