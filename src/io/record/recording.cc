#include "palpate/recording.h"

#include <new>

#include "io/record/blind.h"
#include "io/record/recording_reader.h"
#include "io/system/path_text.h"
#include "palpate/error.h"

namespace palpate::record {

Recording read_recording(const std::filesystem::path& file, const Progress& progress, Blind blind) {
  RecordingReader reader(file);
  if (blind == Blind::kRefuse && reader.facts().blind) refuse_blind(file, reader.facts().study.name);
  Recording recording;
  try {
    (void)reader.for_each_block(true, [&](std::span<const haptics::TickRow> rows) {
      recording.rows.insert(recording.rows.end(), rows.begin(), rows.end());
      if (progress && reader.rows_claimed() > 0) {
        progress(static_cast<double>(recording.rows.size()) / static_cast<double>(reader.rows_claimed()));
      }
    });
  } catch (const std::bad_alloc&) {
    throw InputError(to_text(file) + ": too large for this machine's memory");
  }
  recording.facts = reader.facts();
  recording.changes = reader.changes();
  recording.scene = reader.take_setup();
  return recording;
}

Recording break_blind(const std::filesystem::path& file, const std::string& command,
                      const Progress& progress) {
  Recording recording = read_recording(file, progress, Blind::kAllow);
  if (recording.facts.blind) log_broken_blind(file, command);
  recording.facts.blind = false;
  return recording;
}

}  // namespace palpate::record
