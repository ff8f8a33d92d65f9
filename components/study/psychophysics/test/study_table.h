#pragma once
#include <cstdlib>
#include <iostream>
#include <string>

namespace palpate::psychophysics {

/// PALPATE_STUDY_TABLE=1 simulates as many people as the table of accuracy needs and prints its figures.
inline bool full_table() { return std::getenv("PALPATE_STUDY_TABLE") != nullptr; }

/// Number of simulated people or groups: few in a test, many for the table.
inline int simulated(int few, int many) { return full_table() ? many : few; }

inline void print_figure(const std::string& what, double value) {
  if (full_table()) std::cout << "  " << what << " " << value << '\n';
}

}  // namespace palpate::psychophysics
