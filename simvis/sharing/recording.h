// A recording of a simulation: its messages in a file, or in a bag folder of ROS 2.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <simvis/simulation_desc.h>
#include "engine/base/result_lock.h"
#include "exchange/messages/recorder.h"
#include "simvis/frame_messages.h"
#include "simvis/sharing/frame_outlet.h"

namespace simvis {

class Recording : public FrameOutlet, private ros::MessageOutlet {
 public:
  /// Throws InputError: the file exists and is no MCAP file; two sensors would have the same topics. MachineError of
  /// ResultLock.
  Recording(const RecordDesc& desc, const BuiltScene& scene);
  /// As finish(); errors are lost.
  ~Recording() override;

  std::string_view name() const override { return "recording"; }
  void check(const BuiltScene& scene) const override { check_messages(scene); }
  std::string_view stage() const override { return "record"; }
  /// Creates the file with the first frame. Throws MachineError of the file, also of earlier frames.
  void frame(const Frame& frame) override;
  void end_early() override { ended_early_ = true; }
  /// After finish(): the patterns of RecordDesc::topics that no topic has matched, unless the frames ended early.
  std::vector<std::string> take_warnings() override { return std::exchange(warnings_, {}); }
  /// Writes what waits and the end of the file. Throws MachineError.
  RecordReport finish();

 private:
  bool wants(const ros::Topic& topic, ros::TopicForm form) override { return topics_.wants(topic.name, form); }
  bool add(ros::MessageJob job) override;
  std::unique_ptr<ros::RecorderSink> make_sink() const;

  RecordDesc desc_;
  std::filesystem::path data_;  // the MCAP file
  ResultLock lock_;
  ros::TopicFilter topics_;
  FrameMessages messages_;
  std::optional<ros::Recorder> recorder_;
  std::uint64_t dropped_ = 0;
  bool ended_early_ = false;
  std::vector<std::string> warnings_;
};

}  // namespace simvis
