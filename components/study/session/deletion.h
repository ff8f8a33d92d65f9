#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "study/session/folder.h"

namespace palpate::study {

/// [setup] The files in the study's folder that hold one person's data. Of a person whose data were deleted,
/// those that are left of them. @throws InputError when a folder cannot be read
[[nodiscard]] std::vector<std::filesystem::path> files_of_person(const StudyFolder& study,
                                                                 const std::string& id);

/// [setup] Deletes one person's data for ever: replaces the log by one line that says so, then removes the
/// recordings and all other files of the person. Called again, it finishes what a killed process began. The
/// id stays, so that nobody else's order changes. @return what the log says now @throws InputError for an
/// empty reason, without data of this person, while a session runs, or when a file cannot be written or
/// removed
Deletion delete_person(const StudyFolder& study, const std::string& id, const std::string& why);

/// [setup] @throws InputError when files of a person whose data were deleted are there
void require_deleted(const StudyFolder& study, const std::string& id);

/// [any] "1 person's data deleted on request (PX7K2, 2026-11-29: asked by letter)"; of nobody: empty.
[[nodiscard]] std::string deletions_text(const Deletions& deletions);

}  // namespace palpate::study
