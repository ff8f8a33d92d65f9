// Prints the force of a tissue at a depth. Usage: law TISSUE press|pull DEPTH_MM
#include <cstdlib>
#include <iostream>
#include <string>

#include "palpate/error.h"
#include "palpate/scene.h"
#include "palpate/spring_law.h"

int main(int argc, char** argv) {
  if (argc != 4) {
    std::cerr << "usage: law TISSUE press|pull DEPTH_MM\n";
    return 2;
  }
  try {
    const auto direction =
        std::string(argv[2]) == "pull" ? palpate::model::Direction::kPull : palpate::model::Direction::kPress;
    const palpate::model::SpringLaw law(palpate::scene::load_tissue(argv[1]), direction, 1e-3);
    std::cout << law.force_at(std::atof(argv[3]) * 1e-3).force << '\n';
  } catch (const palpate::InputError& error) {
    std::cerr << "law: " << error.what() << '\n';
    return 2;
  }
  return 0;
}
