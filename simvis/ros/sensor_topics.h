// The topics of a sensor: /NAME/WHAT, or what its attribute `topics` says.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include <simvis/command.h>
#include "simvis/scene_builder.h"

namespace simvis {

/// Checks the attributes `topics` and `frame` of a sensor's command. Throws InputError at the attribute.
void check_message_names(const Command& sensor);

class SensorTopics {
 public:
  /// The command of the sensor has passed check_message_names().
  explicit SensorTopics(const BuiltSensor& sensor);

  /// The topic of a kind of message, such as "scan" or "left/image_raw".
  std::string of(const std::string& what) const;
  /// What all topics without a name of their own begin with: "/NAME".
  const std::string& folder() const { return folder_; }
  /// Those with a name of their own, by kind.
  const std::map<std::string, std::string>& named() const { return named_; }

 private:
  std::string folder_;
  std::map<std::string, std::string> named_;
};

/// Whether a topic belongs to the simulation in each scene, if its node has the default name.
bool is_simulation_topic(std::string_view topic);

/// Throws InputError if two messages of the scene would have one topic, if an element takes commands on a topic that
/// the scene itself sends, or if a topic is one of the node with this full name.
void check_topics(const BuiltScene& scene, std::string_view node);

}  // namespace simvis
