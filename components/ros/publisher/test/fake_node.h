#pragma once
// A node without a network, for tests.
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "run/ros/ros_node.h"

namespace palpate::ros::test {

/// Messages of one hand, in their order.
struct Published {
  std::vector<HandSample> samples;
  std::vector<std::vector<double>> joints;
  std::vector<std::string> faults;
};

class FakeTopics final : public HandTopics {
 public:
  explicit FakeTopics(Published& published) : published_(published) {}
  std::size_t publish(const HandSample& sample, std::span<const double> joints) noexcept override {
    published_.samples.push_back(sample);
    published_.joints.emplace_back(joints.begin(), joints.end());
    return joints.empty() ? 2 : 3;
  }
  bool publish_fault(const char* name) noexcept override {
    published_.faults.emplace_back(name);
    return true;
  }
  void wait_for_receipt(std::int64_t /*limit_ns*/) noexcept override {}

 private:
  Published& published_;
};

/// A node without a network. Read `hands` after RosPublisher::finish().
class FakeNode final : public Node {
 public:
  std::unique_ptr<HandTopics> advertise(const std::string& prefix,
                                        const std::vector<std::string>& joints) override {
    prefixes.push_back(prefix);
    names.push_back(joints);
    return std::make_unique<FakeTopics>(hands[prefixes.size() - 1]);
  }
  std::unique_ptr<Subscription> subscribe(const std::string& /*topic*/, PoseListener& /*listener*/) override {
    return nullptr;
  }

  std::array<Published, 2> hands;
  std::vector<std::string> prefixes;
  std::vector<std::vector<std::string>> names;
};

}  // namespace palpate::ros::test
