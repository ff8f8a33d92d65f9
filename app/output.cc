#include "app/output.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <iostream>
#include <memory>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "core/base/text.h"
#include "run/realtime/realtime.h"

namespace palpate::app {
namespace {

constexpr std::chrono::seconds kDrainTime{1};
constexpr std::size_t kChunk = std::size_t{1} << 16U;  // bytes that ResultStream collects

/// Length of the UTF-8 sequence of a printable character at the begin of a text; 0: it begins with none.
std::size_t printable_length(std::string_view text) noexcept {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char lead = byte(0);
  if (lead < 0x80) return lead >= 0x20 && lead != 0x7F ? 1 : 0;
  const std::size_t length = lead >= 0xF0 && lead < 0xF5 ? 4 : lead >= 0xE0 ? 3 : lead >= 0xC2 ? 2 : 0;
  if (length == 0 || lead >= 0xF5 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0U) != 0x80) return 0;
  }
  const bool control = lead == 0xC2 && byte(1) < 0xA0;  // U+0080 to U+009F
  // U+202A to U+202E and U+2066 to U+2069 change the direction of the text that follows.
  const bool turns = lead == 0xE2 && ((byte(1) == 0x80 && byte(2) >= 0xAA && byte(2) <= 0xAE) ||
                                      (byte(1) == 0x81 && byte(2) >= 0xA6 && byte(2) <= 0xA9));
  return control || turns ? 0 : length;
}

std::string describe(int error) { return "cannot be written: " + std::generic_category().message(error); }

std::string describe_loss(std::uint64_t lines) {
  return counted(lines, "line is", "lines are") + " missing, because nobody read the stream in time";
}

std::uint64_t lines_in(std::string_view text) noexcept {
  std::uint64_t lines = 0;
  for (const char letter : text) lines += letter == '\n' ? 1 : 0;
  return lines;
}

/// The texts for one stream and the thread that writes them.
class WritingThread final {
 public:
  explicit WritingThread(int descriptor) : queue_(std::make_shared<Queue>()) {
    const realtime::BlockedSignals signals;
    std::thread([queue = queue_, descriptor] { write_texts(*queue, descriptor); }).detach();
  }

  void push(std::string text) {
    const std::lock_guard lock(queue_->mutex);
    // An empty queue takes a text of any size.
    if (queue_->bytes > 0 && queue_->bytes + text.size() > BackgroundOutput::kRoom) {
      const std::uint64_t lines = std::max<std::uint64_t>(1, lines_in(text));
      queue_->dropped += lines;
      queue_->lost += lines;
      return;
    }
    queue_->bytes += text.size();
    queue_->texts.push_back(std::move(text));
    queue_->changed.notify_all();
  }

  /// Lets the thread end when all texts are written. A thread that still waits for its reader at the deadline
  /// is left behind; the end of the program ends it. @return why texts are missing from the stream; empty:
  /// none are
  std::string finish(std::chrono::steady_clock::time_point deadline) {
    std::unique_lock lock(queue_->mutex);
    queue_->ending = true;
    queue_->changed.notify_all();
    queue_->changed.wait_until(lock, deadline, [this] { return queue_->ended; });
    if (queue_->error != 0) return describe(queue_->error);
    std::uint64_t lost = queue_->lost + queue_->writing;
    for (const std::string& text : queue_->texts) lost += lines_in(text);
    queue_->texts.clear();
    return lost == 0 ? std::string() : describe_loss(lost);
  }

 private:
  struct Queue {
    std::mutex mutex;
    std::condition_variable changed;
    std::deque<std::string> texts;
    std::size_t bytes = 0;      // of the texts, and of the text that is being written
    std::uint64_t writing = 0;  // lines that are being written
    std::uint64_t dropped = 0;  // lines since the last message about them
    std::uint64_t lost = 0;     // lines in all
    int error = 0;
    bool ending = false;
    bool ended = false;
  };

  static void write_texts(Queue& queue, int descriptor) {
    std::unique_lock lock(queue.mutex);
    for (;;) {
      queue.changed.wait(lock, [&queue] { return queue.ending || !queue.texts.empty(); });
      if (queue.texts.empty()) break;
      const std::string text = std::move(queue.texts.front());
      queue.texts.pop_front();
      queue.writing = lines_in(text);
      lock.unlock();
      const int error = write_whole(descriptor, text);
      lock.lock();
      queue.writing = 0;
      queue.bytes -= text.size();
      if (error != 0) queue.error = error;
      const std::uint64_t dropped = std::exchange(queue.dropped, 0);
      if (dropped == 0) continue;
      lock.unlock();
      write_text(STDERR_FILENO,
                 fmt::format("palpate: standard {}: {}\n", descriptor == STDOUT_FILENO ? "output" : "error",
                             describe_loss(dropped)));
      lock.lock();
    }
    queue.ended = true;
    queue.changed.notify_all();
  }

  std::shared_ptr<Queue> queue_;  // shared with the thread, which may outlive this object
};

/// The program's standard streams. It is a mutable global, as they are.
struct Streams {
  std::mutex mutex;
  std::array<std::unique_ptr<WritingThread>, 2> threads;  // of output and error; null: write_text() writes
  std::string failure;                                    // of standard output
};

Streams& streams() {
  static Streams* const all = new Streams;  // never destroyed: a thread that is left behind may use it
  return *all;
}

}  // namespace

std::string escaped(std::string_view text, bool lines) {
  std::string safe;
  safe.reserve(text.size());
  while (!text.empty()) {
    std::size_t length = 0;  // of the part that stays as it is
    while (length < text.size()) {
      const bool kept = lines && (text[length] == '\n' || text[length] == '\t');
      const std::size_t more = kept ? 1 : printable_length(text.substr(length));
      if (more == 0) break;
      length += more;
    }
    safe += text.substr(0, length);
    text.remove_prefix(length);
    if (text.empty()) break;
    safe += fmt::format("\\x{:02X}", static_cast<unsigned>(static_cast<unsigned char>(text.front())));
    text.remove_prefix(1);
  }
  return safe;
}

std::string json_text(const nlohmann::ordered_json& json, int indent) {
  return json.dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

void write_text(int descriptor, std::string text) {
  Streams& all = streams();
  {
    const std::lock_guard lock(all.mutex);
    WritingThread* thread = all.threads[descriptor == STDOUT_FILENO ? 0 : 1].get();
    if (thread != nullptr) return thread->push(std::move(text));
  }
  const int error = write_whole(descriptor, text);
  if (error == 0 || descriptor != STDOUT_FILENO) return;
  const std::lock_guard lock(all.mutex);
  if (all.failure.empty()) all.failure = describe(error);
}

BackgroundOutput::BackgroundOutput() {
  Streams& all = streams();
  const std::lock_guard lock(all.mutex);
  all.threads[0] = std::make_unique<WritingThread>(STDOUT_FILENO);
  all.threads[1] = std::make_unique<WritingThread>(STDERR_FILENO);
}

BackgroundOutput::~BackgroundOutput() {
  std::cout.flush();
  const auto deadline = std::chrono::steady_clock::now() + kDrainTime;
  Streams& all = streams();
  for (std::size_t stream = 0; stream < all.threads.size(); ++stream) {
    std::string failure = all.threads[stream]->finish(deadline);
    const std::lock_guard lock(all.mutex);
    all.threads[stream].reset();
    if (stream == 0 && all.failure.empty()) all.failure = std::move(failure);
  }
}

ResultStream::ResultStream() : before_(std::cout.rdbuf(this)) {}

ResultStream::~ResultStream() {
  (void)sync();
  std::cout.rdbuf(before_);
}

std::string ResultStream::failure() {
  (void)sync();
  Streams& all = streams();
  const std::lock_guard lock(all.mutex);
  return all.failure;
}

ResultStream::int_type ResultStream::overflow(int_type letter) {
  if (traits_type::eq_int_type(letter, traits_type::eof())) return traits_type::not_eof(letter);
  const char one = traits_type::to_char_type(letter);
  return xsputn(&one, 1) == 1 ? letter : traits_type::eof();
}

/// Keeps the last bytes back when they could be the begin of a longer UTF-8 sequence.
std::streamsize ResultStream::xsputn(const char* letters, std::streamsize count) {
  constexpr std::size_t kLongestSequence = 4;
  text_.append(letters, static_cast<std::size_t>(count));
  if (text_.size() < kChunk) return count;
  std::size_t end = text_.size();
  while (text_.size() - end < kLongestSequence && (static_cast<unsigned char>(text_[end - 1]) & 0x80U) != 0) {
    --end;
  }
  return write(end) ? count : 0;
}

int ResultStream::sync() { return write(text_.size()) ? 0 : -1; }

/// Writes the first `count` bytes. @return whether standard output takes results
bool ResultStream::write(std::size_t count) {
  if (count > 0) write_text(STDOUT_FILENO, escaped(std::string_view(text_).substr(0, count), true));
  text_.erase(0, count);
  Streams& all = streams();
  const std::lock_guard lock(all.mutex);
  return all.failure.empty();
}

}  // namespace palpate::app
