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
AcceptedCommand CommandSource::accept(const JointPath&) { throw InputError("the element takes no trajectories"); }

std::string command_topic(const ElementContext& context, std::string_view attribute, std::string_view what) {
  const CommandAttribute* const topic = context.command.find(attribute);
  if (topic == nullptr) return topic_name(context.command.require("name").value, what);
  if (is_topic_name(topic->value)) return topic->value;
  fail_at(topic->where, "attribute " + in_quotes(attribute) + ": " + in_quotes(topic->value) +
                            " is not allowed, expected the full name of a topic, such as /robot/" + std::string(what));
}

}  // namespace simvis
