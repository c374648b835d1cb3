#include "simvis/sharing/network.h"

#include <utility>

#include <simvis/error.h>

namespace simvis {
namespace {

const std::string kSet = "/simvis/set", kRequest = "/simvis/request", kLog = "/simvis/log";

ros::SensorQos qos_of(const DdsDesc& desc) {
  return desc.reliable ? ros::SensorQos::reliable : ros::SensorQos::best_effort;
}

/// The index of "ELEMENT.PARAM".
std::size_t index_of(const Parameters& parameters, const std::string& name) {
  const std::size_t dot = name.rfind('.');
  if (dot == std::string::npos) throw InputError(in_quotes(name) + " names no parameter, expected ELEMENT.PARAM");
  return parameters.index(name.substr(0, dot), name.substr(dot + 1));
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
    : folders_(desc.folders),
      node_(desc.domain),
      topics_(desc.topics),
      messages_(*this, scene),
      recorder_(node_.sink(qos_of(desc))) {
  listen(kSet, kRequest);
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

// What is late is worth nothing on a network. Small messages say how things are, and are never dropped.
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
  std::string request;
  try {
    request = ros::decode<ros::String>(bytes).data;
    execute(folders_.parse(request, name));
    say(name + ": done", false);
  } catch (const Error& error) {  // of the machine too: a client's file that takes too long does not end the run
    say(without_file_content(error.what(), request), true);
  }
}

// All values of a message, or none.
void Network::set(Parameters& parameters, const std::string& bytes) {
  try {
    const ros::ParameterEvent event = ros::decode<ros::ParameterEvent>(bytes);
    std::vector<std::pair<std::size_t, double>> values;
    for (const std::vector<ros::Parameter>* const list : {&event.new_parameters, &event.changed_parameters}) {
      for (const ros::Parameter& parameter : *list) {
        values.emplace_back(index_of(parameters, parameter.name), number_of(parameter));
        const std::string wrong = check_number(parameters.spec(values.back().first), values.back().second);
        if (!wrong.empty()) throw InputError(parameter.name + ": " + wrong);
      }
    }
    for (const auto& [index, value] : values) parameters.set(index, value);
  } catch (const InputError& error) {
    say(error.what(), true);
  }
}

void Network::take(BuiltScene& scene, const Execute& execute_commands) {
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
}

void Network::frame(const Frame& frame) {
  messages_.add_frame(frame.scene, frame.time, frame.sensors);
  if (follow_messages_) follow_messages_->add_frame(frame.scene, frame.time, frame.sensors);
  for (const std::string& text : said_) {
    if (!ros::MessageOutlet::wants<ros::String>(kLog)) break;
    add({.run = [text, time_ns = frame.time.time_ns](ros::MessageSink& sink) {
      sink.write(kLog, time_ns, ros::String{text});
    }});
  }
  said_.clear();
  if (!std::exchange(sent_a_frame_, true)) warnings_ = unmatched_warnings(name(), topics_);
}

DdsReport Network::finish() {
  messages_.add_paths();
  recorder_.finish();
  return {.messages = recorder_.messages(),
          .dropped = dropped_,
          .bytes = recorder_.bytes(),
          .received = received_,
          .refused = refused_};
}

}  // namespace simvis
