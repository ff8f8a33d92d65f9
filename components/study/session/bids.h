#pragma once
#include <filesystem>
#include <span>
#include <string>

#include "study/session/analysis.h"

namespace palpate::study {

/// Study, people and files of a BIDS folder.
struct BidsSource {
  const Study& study;
  std::span<const Participant> people;
  const ArmNames& names;
  std::filesystem::path recordings;  // folder of the HDF5 files; empty: none
  std::string lock_hash;
  bool simulated = false;
};

/// [setup] Writes the study as a folder of the Brain Imaging Data Structure 1.8 (modality beh): one table for
/// each person, session, task and repetition, with its description. People who withdrew are left out. Until
/// unblinding the conditions are n/a, and the recordings stay where they are; after it they are linked, or
/// copied, to sourcedata/. @throws InputError unless the folder is missing or empty, or when it cannot be
/// written
void write_bids(const BidsSource& source, const std::filesystem::path& folder);

}  // namespace palpate::study
