#include "fit/identify/quiet_library.h"

#include <mutex>

#include <glog/logging.h>

namespace palpate::identify {
namespace {

// The log level belongs to the whole process, so the last of the threads that solve restores it.
std::mutex log_level_mutex;
int quiet_threads = 0;
int log_level_before = 0;

}  // namespace

QuietLibrary::QuietLibrary() {
  const std::lock_guard lock(log_level_mutex);
  if (quiet_threads++ > 0) return;
  log_level_before = FLAGS_minloglevel;
  FLAGS_minloglevel = google::GLOG_FATAL;
}

QuietLibrary::~QuietLibrary() {
  const std::lock_guard lock(log_level_mutex);
  if (--quiet_threads == 0) FLAGS_minloglevel = log_level_before;
}

}  // namespace palpate::identify
