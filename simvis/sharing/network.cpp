#include "simvis/sharing/network.h"

#include <algorithm>
#include <new>
#include <utility>

#include <simvis/error.h>
#include "simvis/ros/node_name.h"
#include "simvis/sharing/parameter_services.h"

namespace simvis {
namespace {

constexpr const char *kSet = "/set", *kRequest = "/request", *kLog = "/log";  // of the node

ros::SensorQos qos_of(const DdsDesc& desc) {
  return desc.reliable ? ros::SensorQos::reliable : ros::SensorQos::best_effort;
}

double number_of(const ros::Parameter& parameter) {
  constexpr std::uint8_t kInteger = 2, kDouble = 3;
  if (parameter.value.type == kDouble) return parameter.value.double_value;
  if (parameter.value.type == kInteger) return static_cast<double>(parameter.value.integer_value);
  throw InputError(parameter.name + ": its value has type " + std::to_string(parameter.value.type) +
                   ", expected 3, a double, or 2, an integer");
}

}  // namespace

Network::Network(const DdsDesc& desc, const BuiltScene& scene)
    : name_of_node_(full_node_name(desc.node)),
      executes_requests_(desc.requests),
      folders_(desc.folders),
      node_(desc.domain),
      topics_(desc.topics),
      messages_(*this, scene, name_of_node_),
      recorder_(node_.sink(qos_of(desc))) {
  listen(name_of_node_ + kSet, name_of_node_ + kRequest);
  follow_command_inputs(scene);
  for (const ParameterService& service : parameter_services()) serve(service.name, service.type);
  node_.announce(name_of_node_);
}

DdsReach Network::reach() const {
  ros::DdsReach found = node_.reach();
  return {.domain = found.domain, .interfaces = std::move(found.interfaces), .is_local = found.is_local};
}

void Network::listen(const std::string& set_topic, const std::string& request_topic) {
  node_.subscribe(set_topic, ros::describe<ros::ParameterEvent>());
  set_topics_.push_back(set_topic);
  node_.subscribe(request_topic, ros::describe<ros::String>());
  request_topics_.push_back(request_topic);
}

void Network::serve_as(const std::string& name) {
  follow_messages_.emplace(static_cast<ros::MessageOutlet&>(*this), name);
  listen(follow_topic(name, kFollowSet), follow_topic(name, kFollowRequest));
}

Network::~Network() {
  try {
    finish();
  } catch (...) {  // finish() reports errors, no memory among them; the destructor ignores them
  }
}

// Drops measurements when the queue is full; messages of state are small and never dropped.
bool Network::add(ros::MessageJob job) {
  using WhenFull = ros::Recorder::WhenFull;
  const WhenFull when_full = job.kind == ros::MessageJob::Kind::state ? WhenFull::exceed : WhenFull::drop;
  const bool added = recorder_.add(job.held_bytes, when_full, std::move(job.run));
  if (!added) dropped_ += job.messages;
  return added;
}

// A stranger that sends nonsense does not fill the log.
void Network::say(const std::string& text, bool refused) {
  constexpr std::size_t kSaidPerFrame = 16;
  refused_ += refused ? 1 : 0;
  if (said_.size() > kSaidPerFrame) return;
  said_.push_back(said_.size() < kSaidPerFrame ? text : "more of this frame is not said");
}

void Network::execute(const std::string& bytes, const Execute& execute) {
  const std::string name = "request " + std::to_string(received_);
  if (!executes_requests_) {
    return say(name + ": the simulation executes no change requests by DDS, expected one with --dds-requests", true);
  }
  std::string request;
  try {
    request = ros::decode<ros::String>(bytes).data;
    folders_.carry_out([&] { execute(folders_.parse(request, name)); });
    changed_ = true;
    say(name + ": done", false);
  } catch (const Error& error) {  // of the machine too: a client's file that takes too long does not end the run
    say(without_file_content(error.what(), request), true);
  } catch (const std::bad_alloc&) {
    say(std::string(kNoMemoryForRequest), true);
  }
}

// All values of a message, or none.
void Network::set(Parameters& parameters, const std::string& bytes) {
  try {
    const ros::ParameterEvent event = ros::decode<ros::ParameterEvent>(bytes);
    names_.follow(parameters);
    std::vector<std::pair<std::size_t, double>> values;
    for (const std::vector<ros::Parameter>* const list : {&event.new_parameters, &event.changed_parameters}) {
      for (const ros::Parameter& parameter : *list) {
        values.emplace_back(names_.index(parameter.name), number_of(parameter));
        const std::string wrong = check_number(parameters.spec(values.back().first), values.back().second);
        if (!wrong.empty()) throw InputError(parameter.name + ": " + wrong);
      }
    }
    for (const auto& [index, value] : values) parameters.set(index, value);
    changed_ = true;
  } catch (const InputError& error) {
    say(error.what(), true);
  }
}

// Subscribes to the topics of new elements that take commands, and ends the subscriptions of removed ones.
void Network::follow_command_inputs(const BuiltScene& scene) {
  if (!command_sources_.is_old(scene)) return;
  std::map<std::string, CommandInput> inputs;
  for (const CommandInput& input : command_sources_.inputs(scene)) {
    inputs.emplace(input.topic + " " + std::string(input.type->name), input);
  }
  std::erase_if(command_inputs_, [&](const auto& known) {
    if (inputs.contains(known.first)) return false;
    node_.unsubscribe(known.first);
    return true;
  });
  for (const auto& [name, input] : inputs) {
    if (command_inputs_.contains(name)) continue;
    try {
      node_.subscribe_as(name, input.topic, *input.type);
      command_inputs_.emplace(name, input);
    } catch (const MachineError& error) {  // a subscription that fails does not end the run
      say(error.what(), false);
    }
  }
}

void Network::take_commands(BuiltScene& scene, std::int64_t now_ns) {
  follow_command_inputs(scene);
  for (const auto& [name, input] : command_inputs_) {
    for (const std::string& bytes : node_.take(name)) {
      ++received_;
      try {
        apply_command(command_sources_.of(scene), scene.parameters, input, bytes, now_ns);
      } catch (const InputError& error) {
        say(error.what(), true);
      }
    }
  }
}

void Network::serve(std::string_view service, std::string_view type) {
  node_.serve(full_name(service), std::string(type));
}

// Replies are sent by the recorder's thread, since a client that does not take them makes a writer wait. An earlier
// failure of that thread, which add() throws, is reported by frame().
void Network::send_reply(std::string_view service, std::string bytes) {
  const std::size_t size = bytes.size();
  const auto send = [this, name = full_name(service), reply = std::move(bytes)](ros::MessageSink&) {
    if (!node_.reply(name, reply)) ++lost_replies_;
  };
  try {
    recorder_.add(size, ros::Recorder::WhenFull::exceed, send);
  } catch (const MachineError&) {
    ++lost_replies_;
  }
}

// Further requests wait in the readers for the next call; a reader that is full replaces its oldest requests.
void Network::answer(std::string_view service, const Reply& reply) {
  constexpr std::size_t kRequestsPerCall = 4;
  const std::string name = full_name(service);
  for (const std::string& bytes : node_.take_requests(name, kRequestsPerCall)) {
    ++received_;
    try {
      if (std::optional<std::string> sent = reply(bytes)) send_reply(service, *std::move(sent));
    } catch (const InputError& error) {
      say(name + ": " + error.what() + "; expected a request of rmw_cyclonedds, other clients get no answer", true);
    }
  }
}

void Network::answer_requests(Parameters& parameters) {
  const std::uint64_t lost = lost_replies_.exchange(0);
  if (lost > 0) say(std::to_string(lost) + " replies were lost: their clients do not take them", false);
  for (const ParameterService& service : parameter_services()) {
    answer(service.name, [&](std::string_view bytes) {
      std::string sent = service.answer(parameters, names_, bytes);
      changed_ = changed_ || service.name.starts_with("set_");
      return sent;
    });
  }
}

void Network::take(BuiltScene& scene, std::int64_t now_ns, const Execute& execute_commands) {
  for (const std::string& topic : request_topics_) {
    for (const std::string& bytes : node_.take(topic)) {
      ++received_;
      execute(bytes, execute_commands);
    }
  }
  for (const std::string& topic : set_topics_) {
    for (const std::string& bytes : node_.take(topic)) {
      ++received_;
      set(scene.parameters, bytes);
    }
  }
  answer_requests(scene.parameters);
  take_commands(scene, now_ns);
}

void Network::frame(const Frame& frame) {
  messages_.add_frame(frame);
  if (follow_messages_) follow_messages_->add_frame(frame.scene, frame.time, frame.sensors);
  add_said(frame.time.time_ns);
  has_sent_frame_ = true;
  warn_of_namesake();
}

void Network::add_said(std::int64_t time_ns) {
  const std::string topic = name_of_node_ + kLog;
  // Asked in each frame, so that patterns match the topic before the first text.
  if (!ros::MessageOutlet::wants<ros::String>(topic)) said_.clear();
  for (const std::string& text : said_) {
    add({.run = [topic, text, time_ns](ros::MessageSink& sink) { sink.write(topic, time_ns, ros::String{text}); }});
  }
  said_.clear();
}

void Network::send_said(std::int64_t time_ns) {
  try {
    add_said(time_ns);
  } catch (const MachineError&) {
    said_.clear();
  }
}

// ROS 2 expects unique names of nodes but does not enforce them.
void Network::warn_of_namesake() {
  if (has_namesake_) return;
  const std::vector<std::string> nodes = node_.take_other_nodes();
  has_namesake_ = std::ranges::find(nodes, name_of_node_) != nodes.end();
  if (!has_namesake_) return;
  warnings_.push_back("DDS: the domain has another node " + name_of_node_ +
                      ", and both answer requests for parameters; expected a domain or a name, --dds-node, for each");
}

DdsReport Network::finish() {
  messages_.add_paths();
  recorder_.finish();
  if (has_sent_frame_ && !ended_early_) {
    for (std::string& warning : unmatched_warnings(name(), topics_)) warnings_.push_back(std::move(warning));
  }
  return {.messages = recorder_.messages(),
          .dropped = dropped_,
          .bytes = recorder_.bytes(),
          .received = received_,
          .refused = refused_};
}

}  // namespace simvis
