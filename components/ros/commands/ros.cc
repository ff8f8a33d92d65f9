// `palpate ros`: runs one interaction and publishes it as ROS 2 topics (docs/file-formats.md).
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "io/scene/device_kinds.h"
#include "io/system/output_file.h"
#include "palpate/error.h"
#include "run/ros/ros_node.h"
#include "run/session/usable_core.h"

#include "app/components.h"
#include "app/messages.h"
#include "app/output.h"
#include "app/program.h"
#include "app/progress.h"
#include "app/scene_flags.h"
#include "app/session.h"
#include "ros/publisher/ros_publisher.h"

namespace palpate::app {
namespace {

constexpr double kPublishRate = 100.0;  // Hz

struct RosFlags {
  scene::Overrides request;
  std::optional<double> duration_s;
  std::optional<std::uint64_t> max_missed;
  std::filesystem::path recording;
  double publish_Hz = kPublishRate;
  std::string network_interface;
  haptics::LoopThread thread;
  bool no_cache = false;
  bool json = false;
};

void check(const RosFlags& flags) {
  session::require_usable_core(flags.thread.core, "--core");
  if (!(flags.publish_Hz >= 1.0 && flags.publish_Hz <= ros::RosPublisher::kFastestRate)) {
    throw ParameterError("--publish-rate", flags.publish_Hz, "1 to 1000 Hz");
  }
  if (!flags.recording.empty()) require_regular_file(flags.recording, "--record");
}

/// Rejects a mouse or a gamepad, because they need the window of `palpate run`, and names that are no topics.
/// @throws InputError
void check_devices(const scene::Scene& scene) {
  for (const scene::DeviceSetup& device : scene.devices) {
    const scene::DeviceKind* kind = scene::find_device_kind(device.kind);
    if (kind != nullptr && kind->window) {
      throw InputError("device " + device.kind + ": needs the window of `palpate run`; ros has no window");
    }
    if (device.kind == "ros" && !device.path.empty()) ros::require_topic_name(device.path, "device ros:");
  }
}

void report_network(const ros::NodeOptions& options) {
  const std::string domain = fmt::format("ROS 2: domain {} (ROS_DOMAIN_ID), ", options.domain);
  if (!options.cyclonedds_uri.empty()) {
    report_message(domain + "network of CYCLONEDDS_URI: anyone who can reach it sees the run");
  } else if (!options.network_interface.empty()) {
    report_message(domain + "network interface " + options.network_interface +
                   ": anyone who can reach it sees the run; there is no password");
  } else {
    report_message(domain +
                   "for programs on this machine only (for other machines: --network-interface NAME)");
  }
}

void report_topics(const scene::Scene& scene, double publish_Hz) {
  const std::string live = fmt::format("{} Hz, reliable, keep last 10, volatile", shortest(publish_Hz));
  const auto report = [](const std::string& name, const char* type, const std::string& how) {
    report_message(fmt::format("  {:<30} {:<32} {}", name, type, how));
  };
  for (std::size_t hand = 0; hand < scene.tools.size(); ++hand) {
    const std::string prefix = ros::topic_prefix(hand);
    report(prefix + "/pose", "geometry_msgs/msg/PoseStamped", live);
    report(prefix + "/wrench", "geometry_msgs/msg/WrenchStamped", live);
    if (!ros::joint_names(scene.tools[hand], hand).empty()) {
      report(prefix + "/joint_states", "sensor_msgs/msg/JointState", live);
    }
    report(prefix + "/fault", "std_msgs/msg/String",
           "changes and 1 Hz, reliable, keep last 1, transient local");
  }
}

nlohmann::ordered_json to_json(const ros::NodeOptions& options, const ros::PublisherStatistics& published) {
  return {{"domain", options.domain},
          {"messages", published.messages},
          {"failed", published.failed},
          {"skipped_ticks", published.skipped}};
}

int play_on_ros(const RosFlags& flags) {
  const StopOnSignal signals;
  check(flags);
  const ros::NodeOptions options = ros::options_of_environment(flags.network_interface);
  scene::Scene scene = load_scene(flags.request, flags.no_cache);
  check_devices(scene);
  require_no_overwrite(std::vector<NamedFile>{{"--record", flags.recording}}, sources_of(scene));
  const std::unique_ptr<ros::Node> node = ros::open_node(options);
  report_network(options);
  const std::unique_ptr<Session> session =
      prepare(std::move(scene), flags.duration_s, flags.no_cache, &signals.flag());
  ros::RosPublisher publisher(*node, session->scene().tools, session->scene().rate_Hz, flags.publish_Hz);
  report_topics(session->scene(), session->scene().rate_Hz / static_cast<double>(publisher.every()));
  PlayOptions how;
  how.run = {flags.recording, false, flags.thread};
  how.observers = {&publisher};
  how.stop = &signals.flag();
  const RunResult result = [&] {
    const BackgroundOutput output;
    return play(*session, how);
  }();
  const ros::PublisherStatistics published = publisher.finish();
  const OutputFiles files{flags.recording, {}, {}};
  if (flags.json) {
    nlohmann::ordered_json summary = summary_json(result, files);
    summary["ros"] = to_json(options, published);
    std::cout << json_text(summary) << '\n';
  } else {
    print_summary(std::cout, result, files);
    std::cout << fmt::format("ROS 2: {} messages published, {} failed, {} ticks skipped\n",
                             published.messages, published.failed, published.skipped);
  }
  return exit_code_of(result, flags.max_missed);
}

void add_ros_flags(CLI::App& command, RosFlags& flags) {
  command.add_option("--publish-rate", flags.publish_Hz,
                     "ticks per second that are published, 1 to 1000 (default 100)");
  command.add_option(
      "--network-interface", flags.network_interface,
      "publish to the network of this interface, by name or address (default: this machine only; "
      "CYCLONEDDS_URI is used if it is set)");
  command.add_option("--duration-s", flags.duration_s, "simulated time: exactly round(S x rate) ticks");
  command.add_option("--record", flags.recording, "write every tick to this HDF5 file");
  command.add_option("--max-missed", flags.max_missed,
                     "exit with code 4 when more deadlines than this were missed");
  add_thread_flags(command, flags.thread);
  command.add_flag("--no-cache", flags.no_cache, kNoCacheHelp);
  command.add_flag("--json", flags.json, "summary as one JSON document");
}

void add_ros(CLI::App& program, const std::string& /*command_line*/, int& exit_code) {
  CLI::App* command = add_component_command(program, "ros");
  auto flags = std::make_shared<RosFlags>();
  add_scene_flags(*command, flags->request);
  add_ros_flags(*command, *flags);
  command->footer(
      "Example: palpate ros --device emulated --duration-s 60\n"
      "         then, in another terminal: ROS_LOCALHOST_ONLY=1 ros2 topic echo /palpate/hand0/wrench\n"
      "Example: palpate ros --device ros --record run.h5\n"
      "         a program publishes geometry_msgs/msg/PoseStamped to /palpate/hand0/target_pose, 20 to 1000 "
      "Hz\n"
      "Topics /palpate/handN/pose, wrench, joint_states and fault, in the frame \"world\", in SI units, "
      "stamped with "
      "the\nwall time of the tick. Poses that are received are in the device's frame (the world's without a "
      "base).\n"
      "Without --network-interface only programs on this machine see it. A ROS 2 on this machine must use "
      "the\n"
      "loopback interface, too: ROS_LOCALHOST_ONLY=1, or CYCLONEDDS_URI from Iron on. ROS_DOMAIN_ID is "
      "respected.\n"
      "Tested against CycloneDDS 0.10.2 alone; it was never run with ROS 2 itself.\n"
      "Exit: 0 done, 2 bad input, 3 a fault was latched (even if it was reset),\n"
      "      4 more than --max-missed deadlines missed");
  command->callback([flags, &exit_code] { exit_code = play_on_ros(*flags); });
}

}  // namespace

}  // namespace palpate::app

int main(int argc, char** argv) {
  return palpate::app::run_component_program(argc, argv, palpate::app::add_ros);
}
