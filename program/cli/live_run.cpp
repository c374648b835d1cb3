#include "program/cli/live_run.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <new>
#include <span>
#include <utility>

#include <simvis/attributes.h>
#include "engine/base/now_ns.h"
#include "program/cli/load_scene.h"
#include "program/cli/saved_scene.h"
#include "program/output/atomic_file.h"
#include "simvis/message_tap.h"
#include "simvis/time/clock.h"

namespace simvis {
namespace {

constexpr std::int64_t kSpeedPeriod_ns = 500'000'000;  // over which the speed is the mean
constexpr std::int64_t kStanding_ns = 1'000'000'000;   // without a frame, the host stands
constexpr std::uint64_t kMaxSteps = 1000;              // that wait
constexpr const char* kRequestName = "live view";      // in messages about a request

live::ServerDesc server_desc(const Options& options, const std::string& token) {
  live::ServerDesc desc{.port = *options.live, .token = token};
  if (!options.live_address.empty()) desc.address = options.live_address;
  return desc;
}

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Empty: the run has no end, its frames come when a sensor is due, or they are those of another process.
std::optional<live::PlaybackRange> range_of(const Options& options, const Follower* follower) {
  if (options.endless || options.frames == 0 || options.simulation.frames_when_due || follower != nullptr) return {};
  return live::PlaybackRange{.start_ns = 0,
                             .end_ns = Clock(options.simulation.rate_hz).frame(options.frames - 1).time_ns};
}

double last_step_ms(const Simulation& simulation) {
  const std::span<const StageTime> stages = simulation.diagnostics().stages();
  return static_cast<double>(stages.back().end_ns - stages.front().start_ns) / 1e6;
}

/// As a link has it.
std::string host_of(const std::string& address) {
  return address.find(':') == std::string::npos ? address : "[" + address + "]";
}

}  // namespace

LiveRun::LiveRun(const Options& options, Simulation& simulation, RunControl& control, Follower* follower)
    : simulation_(simulation),
      control_(control),
      scene_(options.scene),
      address_(options.live_address),
      desc_(scene_desc(options)),
      folders_(request_folders(options)),
      follower_(follower),
      scene_text_(text_of(options.scene)),
      saved_changes_(simulation.parameters().changes().size()),
      token_(live::random_token()),
      range_(range_of(options, follower)),
      view_(server_desc(options, token_), range_) {
  if (follower_ != nullptr) builds_ = follower_->builds();
  view_.attach(simulation);
  show_playback();
}

std::string LiveRun::links() const {
  const std::string place = (address_.empty() ? "127.0.0.1" : host_of(address_)) + ":" + std::to_string(view_.port());
  const std::string token = "/?token=" + token_;
  return "live view: http://" + place + token + "\nFoxglove: ws://" + place + token;
}

// A page that sends requests without end does not stop the simulation.
void LiveRun::serve() {
  for (std::size_t i = 0; i < live::ControlQueue::kMaxWaiting; ++i) {
    const std::optional<Control> control = view_.next_control();
    if (!control) break;
    carry_out(*control);
  }
  if (shows_play_ == control_.is_playing()) return;
  show_control();
  show_playback();
}

void LiveRun::while_waiting(bool has_host) {
  using Host = live::ViewTime::Host;
  if (builds_ != follower_->builds()) return;  // clients get the scene of another host with its first frame
  serve();
  if (!is_shown_) show();
  const bool stands = now_ns() - frame_ns_ > kStanding_ns;
  const Host state = !has_host ? Host::ended : stands ? Host::stands : Host::runs;
  if (std::exchange(host_state_, state) != state) view_.publish(view_time());
}

void LiveRun::wait(std::int64_t due_ns) {
  const auto left = std::chrono::nanoseconds(std::max<std::int64_t>(due_ns - now_ns(), 0));
  if (const std::optional<Control> control = view_.next_control(std::chrono::steady_clock::now() + left)) {
    carry_out(*control);
  }
  if (!is_shown_ && !control_.makes_frame()) show();
}

void LiveRun::frame(const FrameTime& time) {
  if (follower_ != nullptr && std::exchange(builds_, follower_->builds()) != follower_->builds()) {
    view_.attach(simulation_);
  }
  const bool went_back = shown_ && time.time_ns < shown_->time_ns;
  shown_ = time;
  step_ms_ = last_step_ms(simulation_);
  const std::int64_t now = now_ns();
  frame_ns_ = now;
  host_state_ = live::ViewTime::Host::runs;
  if (now - speed_since_ns_ >= kSpeedPeriod_ns) {
    const auto simulated_ns = static_cast<double>(time.time_ns - speed_since_simulated_ns_);
    if (speed_since_ns_ != 0) speed_ = std::max(simulated_ns / static_cast<double>(now - speed_since_ns_), 0.0);
    speed_since_ns_ = now;
    speed_since_simulated_ns_ = time.time_ns;
  }
  show();
  const bool is_last = range_ && time.time_ns >= range_->end_ns;
  if (control_.seek_ns() && (is_last || simulation_.next_frame().time_ns > *control_.seek_ns())) {
    control_.end_seek();
    show_playback(true);
  } else if (is_last || went_back) {
    show_playback(went_back);
  }
}

void LiveRun::show() {
  if (!shown_) return;
  live::OtherMeasurements others;
  if (follower_ != nullptr) {
    others = [this](const std::string& sensor, std::span<const OutputSpec> outputs) {
      return follower_->latest_measurement(sensor, outputs);
    };
  }
  is_shown_ = view_.publish(simulation_, *shown_, step_ms_, view_time(), others);
}

void LiveRun::show_playback(bool did_seek, const std::string& request) {
  if (!range_) return;
  using Status = live::PlaybackState::Status;
  const std::int64_t time_ns = shown_ ? shown_->time_ns : range_->start_ns;
  const double factor = control_.speed();
  live::PlaybackState state{.status = control_.is_playing() ? Status::playing : Status::paused,
                            .time_ns = time_ns,
                            .speed = factor > 0 ? factor : speed_,
                            .did_seek = did_seek,
                            .request = request};
  if (control_.seek_ns()) state.status = Status::buffering;
  if (shown_ && time_ns >= range_->end_ns) state.status = Status::ended;
  view_.publish(state);
}

void LiveRun::show_failure(const InputError& error) {
  show_control();
  show_playback();
  view_.report("step", error.what());
}

void LiveRun::set_playing(bool playing) {
  playing ? control_.play() : control_.pause();
  show_control();
}

// Pages get the last frame with the state.
void LiveRun::show_control() {
  shows_play_ = control_.is_playing();
  if (shows_play_) return view_.publish(view_time());
  speed_ = 0;
  speed_since_ns_ = 0;
  show();
}

// A further request ends a seek that is under way.
void LiveRun::playback(const Control& control) {
  const live::PlaybackRequest& request = *control.playback;
  control_.end_seek();
  control_.set_speed(request.speed);
  set_playing(request.play);
  const std::int64_t now_ns = shown_ ? shown_->time_ns : range_->start_ns;
  if (request.seek_ns && *request.seek_ns < now_ns) {
    view_.answer(control, "the run is at " + format_number(static_cast<double>(now_ns) / 1e9) +
                              " s, expected a later time, since a simulation does not go back");
  } else if (request.seek_ns && *request.seek_ns >= simulation_.next_frame().time_ns) {
    control_.seek(*request.seek_ns);
  }
  show_playback(request.seek_ns == now_ns, request.id);
}

void LiveRun::carry_out(const Control& control) {
  using Kind = Control::Kind;
  switch (control.kind) {
    case Kind::look:
      return show();
    case Kind::set:
      return set(control);
    case Kind::play:
    case Kind::pause:
      set_playing(control.kind == Kind::play);
      show_playback();
      return view_.answer(control, "");
    case Kind::step:
      control_.end_seek();
      if (control_.is_playing()) set_playing(false);
      show_playback();
      if (control_.steps() < kMaxSteps) control_.step(1);
      return view_.answer(control, "");
    case Kind::speed:
      control_.set_speed(control.factor);
      return show_playback();
    case Kind::playback:
      return playback(control);
    case Kind::execute:
      return execute(control);
    case Kind::save:
      return save(control);
    case Kind::command:
      return command(control);
    case Kind::pull:
      return pull(control);
  }
}

void LiveRun::pull(const Control& control) {
  if (follower_ != nullptr) return view_.answer(control, "the bodies are those of another process");
  control_.note_change();
  view_.pull(control, simulation_);
}

void LiveRun::command(const Control& control) {
  std::string refusal;
  try {
    if (follower_ != nullptr) throw InputError("the robots are those of another process, expected commands to it");
    send_command(simulation_, *control.input, control.text, shown_ ? shown_->time_ns : 0);
  } catch (const InputError& error) {
    refusal = error.what();
  }
  view_.answer(control, refusal);
}

void LiveRun::set(const Control& control) {
  std::vector<std::string> refusals;
  for (const auto& [parameter, value] : control.values) {
    try {
      set_one(parameter, value);
    } catch (const InputError& error) {
      refusals.emplace_back(error.what());
    }
  }
  view_.answer_set(control, std::move(refusals), simulation_.parameters());
}

void LiveRun::set_one(std::size_t parameter, double value) {
  Parameters& parameters = simulation_.parameters();
  if (follower_ != nullptr && parameter < parameters.values().size()) {
    const std::string wrong = check_number(parameters.spec(parameter), value);
    if (!wrong.empty()) throw InputError(parameters.name(parameter) + ": " + wrong);
    if (follower_->set(simulation_, parameter, value)) return;
  }
  parameters.set(parameter, value);
  control_.note_change();
}

void LiveRun::execute(const Control& control) {
  std::string refusal;
  try {
    if (follower_ != nullptr) {
      follower_->request(control.text);
    } else {
      folders_.carry_out([&] {
        folders_.parse(control.text, kRequestName);  // throws if it names a file elsewhere
        simulation_.execute(control.text, folders_.start(), kRequestName);
      });
      control_.note_change();
    }
  } catch (const Error& error) {  // of the machine too: a client's file that takes too long does not end the run
    refusal = without_file_content(error.what(), control.text);
  } catch (const std::bad_alloc&) {
    refusal = kNoMemoryForRequest;
  }
  view_.answer(control, refusal);
}

// Another program may have changed the file since it was read.
void LiveRun::save(const Control& control) {
  const Parameters& parameters = simulation_.parameters();
  try {
    if (follower_ != nullptr) throw InputError("the scene is that of another process, expected it to save its own");
    folders_.check(scene_);
    if (text_of(scene_) != scene_text_) throw InputError(scene_ + ": error: has changed since it was read");
    const std::span<const std::string> added = std::span(parameters.changes()).subspan(saved_changes_);
    SavedScene saved = saved_scene(scene_text_, scene_, parameters, added, desc_);
    if (saved.xml != scene_text_) write_file(scene_, saved.xml);
    scene_text_ = std::move(saved.xml);
    saved_changes_ = parameters.changes().size();
    view_.answer_saved(control, scene_text_);
    if (control.call) return;
    for (const std::string& left : saved.left) view_.answer(control, "not saved: " + left);
  } catch (const Error& error) {  // perhaps of a file that another client has added
    view_.answer(control, without_file_content(error.what(), ""));
  }
}

}  // namespace simvis
