#include "run/ros/ros_node.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <exception>
#include <string_view>

#include <fmt/core.h>

#include "io/system/plugin.h"
#include "io/system/shared_library.h"
#include "palpate/error.h"

namespace palpate::ros {
namespace {

constexpr const char* kPlugin = "palpate_ros.so";
constexpr std::uint32_t kLastDomain = 232;     // its ports end below 65536
constexpr std::size_t kLongestName = 255;      // bytes: DDS
constexpr std::size_t kLongestInterface = 64;  // bytes: longer than names of interfaces and IPv6 addresses

std::string environment(const char* name) {
  const char* value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): nothing writes it
  return value == nullptr ? std::string() : std::string(value);
}

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// A name is a sequence of /WORD, and no word begins with a digit.
bool is_topic_name(std::string_view name) {
  if (name.size() < 2 || name.size() > kLongestName || name.front() != '/') return false;
  char before = 'a';
  for (const char c : name) {
    const bool fits = before == '/' ? is_letter(c) : is_letter(c) || is_digit(c) || c == '/';
    if (!fits) return false;
    before = c;
  }
  return before != '/';
}

}  // namespace

NodeOptions options_of_environment(const std::string& network_interface) {
  NodeOptions options;
  options.network_interface = network_interface;
  options.cyclonedds_uri = environment("CYCLONEDDS_URI");
  if (const std::string domain = environment("ROS_DOMAIN_ID"); !domain.empty()) {
    const char* end = domain.data() + domain.size();
    const auto [stop, error] = std::from_chars(domain.data(), end, options.domain);
    if (error != std::errc{} || stop != end || options.domain > kLastDomain) {
      throw InputError(fmt::format("ROS_DOMAIN_ID = \"{}\": must be a whole number from 0 to {}",
                                   domain.substr(0, kLongestInterface), kLastDomain));
    }
  }
  if (network_interface.empty()) return options;
  // It becomes part of an XML document.
  const bool fits =
      network_interface.size() <= kLongestInterface &&
      std::all_of(network_interface.begin(), network_interface.end(), [](char c) {
        return is_letter(c) || is_digit(c) || std::string_view(".:-@%").find(c) != std::string_view::npos;
      });
  if (!fits) {
    throw InputError("--network-interface " + network_interface.substr(0, kLongestInterface) +
                     ": must be the name or the address of an interface, as `ip address` lists them");
  }
  if (!options.cyclonedds_uri.empty()) {
    throw InputError("--network-interface " + network_interface +
                     ": CYCLONEDDS_URI is set, too; leave one of them out");
  }
  return options;
}

std::string topic_prefix(std::size_t hand) { return fmt::format("/palpate/hand{}", hand); }

void require_topic_name(const std::string& topic, const std::string& named_by) {
  if (is_topic_name(topic)) return;
  throw InputError(
      fmt::format("{} \"{}\": must be a topic such as /palpate/hand0/target_pose, of letters, "
                  "digits, _ and /",
                  named_by, topic.substr(0, kLongestName)));
}

bool has_plugin() { return !find_plugin(kPlugin).empty(); }

std::unique_ptr<Node> open_node(const NodeOptions& options) {
  const std::vector<std::filesystem::path> files = find_plugin(kPlugin);
  if (files.empty()) {
    throw InputError(
        "ROS 2: this palpate is built without it: install palpate-ros, or install cyclonedds-dev and "
        "cyclonedds-tools and build again");
  }
  const std::string file = files.front().string();
  const SharedLibrary library = open_library(file);
  if (library.handle == nullptr) throw InputError("ROS 2: " + file + " cannot be loaded: " + library.error);
  using Make = Node* (*)(const NodeOptions&);
  const auto make = reinterpret_cast<Make>(find_function(library.handle, "palpate_make_ros_node"));
  if (make == nullptr) throw InputError("ROS 2: " + file + " is not of this program");
  try {
    return std::unique_ptr<Node>(make(options));
  } catch (const std::exception& error) {
    throw InputError(std::string("ROS 2: ") + error.what());
  }
}

}  // namespace palpate::ros
