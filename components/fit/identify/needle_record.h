#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "fit/identify/needle_model.h"

namespace palpate::identify {

/// A fall of the force while the needle goes in: perhaps a puncture.
struct Fall {
  double time = 0.0;   // at which it begins [s]
  double force = 0.0;  // by which it falls [N]
};

/// A record as a needle's fit uses it.
struct Insertion {
  NeedleRecord all;         // every row
  NeedleRecord thinned;     // means of rows, closer around the falls
  std::vector<Fall> falls;  // the largest first, at least one
  double range = 0.0;       // of the force [N]
  double deepest = 0.0;     // largest depth minus the lowest [m]
  std::size_t turn = 0;     // row at which the needle has gone in
  double hold = 0.0;        // time at the largest depth [s]
  double air = 0.0;         // what the sensor reads before the contact [N] ...
  double air_rows = 1.0;    // ... as the mean of so many rows; 1: a guess
  double drift = 0.0;       // of the sensor from the contact to the withdrawal, subtracted as a line [N]
  bool withdrawn = false;   // by a quarter of the depth or more
  std::vector<std::string> notes;
};

/// [setup] Reads the records of needles in a CSV file, as read_specimens() does; time_s is required.
/// @throws InputError that names file and value; for what is not an insertion too
[[nodiscard]] std::vector<Insertion> read_insertions(const std::filesystem::path& file);

/// [setup] The record of one insertion. @param where for messages @throws InputError as read_insertions()
[[nodiscard]] Insertion insertion_of(Specimen specimen, const std::string& where);

}  // namespace palpate::identify
