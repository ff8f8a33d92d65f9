#pragma once
#include <string>

namespace palpate::devices {

/// Looks up functions of a vendor's library opened at run time, and stores the name of the first missing
/// required function.
class VendorFunctions final {
 public:
  explicit VendorFunctions(void* handle) : handle_(handle) {}

  template <typename Function>
  void required(Function& function, const char* name) {
    optional(function, name);
    if (function == nullptr && missing_.empty()) missing_ = name;
  }

  template <typename Function>
  void optional(Function& function, const char* name) const {
    function = reinterpret_cast<Function>(find(name));
  }

  /// [setup] Empty: none is missing.
  [[nodiscard]] const std::string& missing() const { return missing_; }

 private:
  [[nodiscard]] void* find(const char* name) const;

  void* handle_;
  std::string missing_;
};

}  // namespace palpate::devices
