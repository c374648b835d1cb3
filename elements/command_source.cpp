#include "elements/command_source.h"

#include <simvis/error.h>
#include <simvis/location.h>
#include "scenegraph/language/topic_name.h"

namespace simvis {

// Topics bring what their element takes, so these are never called.
AcceptedCommand CommandSource::accept(const VelocityCommand&) { throw InputError("the element takes no velocities"); }
AcceptedCommand CommandSource::accept(const JointCommand&) {
  throw InputError("the element takes no states of joints");
}
AcceptedCommand CommandSource::accept(const JointValues&) { throw InputError("the element takes no joint values"); }
AcceptedCommand CommandSource::accept(const JointPath&) { throw InputError("the element takes no trajectories"); }
AcceptedCommand CommandSource::accept(const WrenchCommand&) { throw InputError("the element takes no forces"); }

CommandTopic command_topic(const ElementContext& context, std::string_view attribute, std::string_view what,
                           CommandContent content) {
  const Command& command = context.command;
  const CommandAttribute* const topic = command.find(attribute);
  if (topic == nullptr) return {topic_name(command.require("name").value, what), command.where, true, content};
  if (is_topic_name(topic->value)) return {topic->value, topic->where, false, content};
  fail_at(topic->where, "attribute " + in_quotes(attribute) + ": " + in_quotes(topic->value) +
                            " is not allowed, expected the full name of a topic, such as /robot/" + std::string(what));
}

}  // namespace simvis
