#pragma once
#include <mutex>
#include <stdexcept>
#include <string>

#include "io/system/shared_library.h"
#include "run/devices/test/stand_in/hd_stand_in.h"

namespace palpate::devices::stand_in {

/// Keeps the stand-in for libHD.so or hd.dll open for a test. The code under test finds the same library in
/// memory by its name, and finds the values that the test sets here. No arm may be open when an object of
/// this class begins or ends.
class LoadedHd final {
 public:
  LoadedHd() : opened_(open_library(PALPATE_HD_STAND_IN)) {
    if (opened_.handle == nullptr) throw std::runtime_error(opened_.error);
    world_ = reinterpret_cast<HdEntry>(find_function(opened_.handle, kHdEntry))();
    const std::lock_guard lock(world_->mutex);
    for (HdArm& arm : world_->arms) arm = {};
    world_->arms[1].name = "Left";
    world_->silent = world_->stepped = false;
    world_->start_error = 0;
    world_->asked = world_->done = 0;
    world_->starts = world_->illegal = 0;
    world_->order.clear();
  }
  ~LoadedHd() { close_library(opened_.handle); }
  LoadedHd(const LoadedHd&) = delete;
  LoadedHd& operator=(const LoadedHd&) = delete;

  /// Changes or reads the world between two calls of the library. @return the result of `use(world)`
  template <typename Use>
  auto set(Use use) const {
    const std::lock_guard lock(world_->mutex);
    return use(*world_);
  }
  /// Changes or reads one arm between two calls of the library. @return the result of `use(arm)`
  template <typename Use>
  auto arm(Use use, int index = 0) const {
    return set([&](HdWorld& world) { return use(world.arms[index]); });
  }
  /// Lets a stepped scheduler call back once, and waits for it.
  void step() const {
    std::unique_lock lock(world_->mutex);
    const unsigned long asked = ++world_->asked;
    world_->changed.notify_all();
    world_->changed.wait(lock, [&] { return world_->done >= asked; });
  }

 private:
  SharedLibrary opened_;
  HdWorld* world_ = nullptr;
};

}  // namespace palpate::devices::stand_in
