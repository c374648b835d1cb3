// A simulation on DDS: its messages go out, values and change requests of strangers come in.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <simvis/parameters.h>
#include <simvis/simulation_desc.h>
#include "exchange/messages/dds/dds_node.h"
#include "exchange/messages/recorder.h"
#include "exchange/messages/types/system_types.h"
#include "simvis/frame_messages.h"
#include "simvis/ros/command_inputs.h"
#include "simvis/scene_builder.h"
#include "simvis/sharing/allowed_folders.h"
#include "simvis/sharing/follow_messages.h"
#include "simvis/sharing/frame_outlet.h"
#include "simvis/sharing/parameter_services.h"

namespace simvis {

class Network : public FrameOutlet, private ros::MessageOutlet {
 public:
  /// Throws InputError: no such folder, a build without DDS, a name that no node has, two sensors with the same topics.
  /// MachineError: the domain cannot be joined.
  Network(const DdsDesc& desc, const BuiltScene& scene);
  /// As finish(); errors are lost.
  ~Network() override;

  DdsReach reach() const;

  /// From the next frame on, followers find the simulation under this name, and may send what they ask for to it alone.
  void serve_as(const std::string& name);

  /// Executes commands of others, in the scene that `execute` changes.
  using Execute = std::function<void(std::span<const Command>)>;
  /// Executes requests with DdsDesc::requests, then sets values, then applies commands of robots, at the time `now_ns`.
  /// What is refused is sent on NODE/log by the next frame or send_said().
  void take(BuiltScene& scene, std::int64_t now_ns, const Execute& execute);
  /// For a paused run, which makes no frame. Errors of earlier frames are left to the next one.
  void send_said(std::int64_t time_ns);
  /// Whether a client has executed a request or set values.
  bool is_changed() const { return changed_; }

  /// Offers a service of the node, such as "step_simulation", beside those of its parameters.
  void serve(std::string_view service, std::string_view type);
  /// Answers some of the requests of a service that wait, with CDR and headers; the others wait on. What `reply` throws
  /// as InputError, for bytes that are no request, is said on NODE/log. Empty: the reply is sent later, by
  /// send_reply().
  using Reply = std::function<std::optional<std::string>(std::string_view request)>;
  void answer(std::string_view service, const Reply& reply);
  void send_reply(std::string_view service, std::string bytes);

  std::string_view name() const override { return "DDS"; }
  void check(const BuiltScene& scene) const override { check_messages(scene, name_of_node_); }
  std::string_view stage() const override { return "dds"; }
  /// Sends the messages of a frame. Throws MachineError, also of earlier frames.
  void frame(const Frame& frame) override;
  void end_early() override { ended_early_ = true; }
  /// Warnings of another node of the same name, and, after finish(), of patterns of DdsDesc::topics that no topic has
  /// matched, unless the frames ended early.
  std::vector<std::string> take_warnings() override { return std::exchange(warnings_, {}); }
  /// Sends what waits. Throws MachineError.
  DdsReport finish();

 private:
  bool wants(const ros::Topic& topic, ros::TopicForm form) override { return topics_.wants(topic.name, form); }
  bool add(ros::MessageJob job) override;
  void listen(const std::string& set_topic, const std::string& request_topic);
  void execute(const std::string& bytes, const Execute& execute);
  void set(Parameters& parameters, const std::string& bytes);
  void follow_command_inputs(const BuiltScene& scene);
  void take_commands(BuiltScene& scene, std::int64_t now_ns);
  void answer_requests(Parameters& parameters);
  std::string full_name(std::string_view service) const { return name_of_node_ + "/" + std::string(service); }
  void say(const std::string& text, bool refused);
  void add_said(std::int64_t time_ns);
  void warn_of_namesake();

  std::string name_of_node_;  // the full name
  bool executes_requests_;
  AllowedFolders folders_;
  ros::DdsNode node_;
  ros::TopicFilter topics_;
  FrameMessages messages_;
  std::optional<FollowMessages> follow_messages_;
  std::vector<std::string> set_topics_, request_topics_;
  ParameterNames names_;
  CommandSources command_sources_;
  std::map<std::string, CommandInput> command_inputs_;  // by the name of the subscription
  std::vector<std::string> said_;                       // since add_said()
  std::uint64_t received_ = 0, refused_ = 0, dropped_ = 0;
  std::atomic<std::uint64_t> lost_replies_ = 0;  // counted by the recorder's thread too
  bool has_sent_frame_ = false, has_namesake_ = false, changed_ = false, ended_early_ = false;
  std::vector<std::string> warnings_;
  ros::Recorder recorder_;
};

}  // namespace simvis
