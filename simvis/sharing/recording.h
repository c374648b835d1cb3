// A recording of a simulation: its messages in a file.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <simvis/simulation_desc.h>
#include "messages/recorder.h"
#include "simvis/frame_messages.h"

namespace simvis {

class Recording : private ros::MessageOutlet {
 public:
  /// Throws InputError: the file exists and is no MCAP file; two sensors would have the same topics.
  Recording(const RecordDesc& desc, const BuiltScene& scene, KeptMeasurements& kept);
  /// As finish(); errors are lost.
  ~Recording() override;
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;

  /// Creates the file with the first frame. Throws MachineError of the file, also of earlier frames.
  void add_frame(const BuiltScene& scene, const FrameTime& time, std::span<const PlacedSensor> sensors);
  /// Writes what waits and the end of the file. Throws MachineError.
  RecordReport finish();

  /// The patterns of RecordDesc::topics that no topic has matched so far.
  std::vector<std::string> unmatched_patterns() const { return topics_.unmatched(); }

 private:
  bool wants(const ros::Topic& topic, ros::TopicForm form) override { return topics_.wants(topic.name, form); }
  void add(ros::MessageJob job) override;

  RecordDesc desc_;
  ros::TopicFilter topics_;
  FrameMessages messages_;
  std::optional<ros::Recorder> recorder_;
  std::uint64_t dropped_ = 0;
};

}  // namespace simvis
