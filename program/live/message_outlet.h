// Messages of a running simulation on their way to Foxglove's clients.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "exchange/messages/message_outlet.h"
#include "program/live/foxglove.h"

namespace simvis::live {

/// Collects the messages of a frame that somebody listens to. Measurements are left out while the server is busy with
/// those of earlier frames.
/// Threads  the simulation's; the batches run on the server's.
class LiveOutlet : public ros::MessageOutlet {
 public:
  explicit LiveOutlet(FoxgloveHub& hub) : hub_(hub) {}

  using ros::MessageOutlet::wants;
  bool wants(const ros::Topic& topic, ros::TopicForm form) override;
  bool add(ros::MessageJob job) override;

  /// What has come since the last call: new topics and messages, for the server's thread. Empty: nothing.
  std::function<void()> take_batch();

 private:
  static constexpr int kMaxUnderWay = 2;

  FoxgloveHub& hub_;
  std::set<std::string> known_;
  std::vector<ros::Topic> new_topics_;
  std::vector<ros::MessageJob> jobs_;
  std::shared_ptr<std::atomic<int>> under_way_ = std::make_shared<std::atomic<int>>(0);
};

}  // namespace simvis::live
