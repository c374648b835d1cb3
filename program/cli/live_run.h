// A run that browsers and Foxglove look into and control.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <simvis/error.h>
#include <simvis/simulation.h>
#include "program/cli/follower.h"
#include "program/cli/run_outlet.h"
#include "program/live/live_view.h"
#include "program/options/options.h"
#include "simvis/sharing/allowed_folders.h"
#include "simvis/sharing/run_control.h"

namespace simvis {

class LiveRun : public RunOutlet {
 public:
  /// Listens from now on. `follower` is null unless the frames are those of another process, which then gets what
  /// clients ask for. All must outlive it. Throws InputError: the address; MachineError: the port is taken.
  LiveRun(const Options& options, Simulation& simulation, RunControl& control, Follower* follower);

  /// What the user opens: lines for the page, and for Foxglove.
  std::string links() const;

  /// Carries out what clients ask for, and shows them what others have changed of the run.
  void serve();
  /// Waits for a request of a client until `due_ns` (clock of now_ns()), and carries it out.
  void wait(std::int64_t due_ns);
  /// Carries out what clients ask for while the host that is followed makes no frame, and shows them that it stands, or
  /// has ended.
  void while_waiting(bool has_host);
  void frame(const FrameTime& time) override;
  bool shows_all_content() const override { return true; }
  bool can_go_back() const override { return true; }

  /// Shows clients that the run is paused because of an error of a step.
  void show_failure(const InputError& error);

 private:
  using Control = live::Control;
  void carry_out(const Control& control);
  void set(const Control& control);
  void set_one(std::size_t parameter, double value);
  void execute(const Control& control);
  void command(const Control& control);
  void pull(const Control& control);
  void save(const Control& control);
  void set_playing(bool playing);
  void playback(const Control& control);
  void show();
  void show_control();
  void show_playback(bool did_seek = false, const std::string& request = "");
  live::ViewTime view_time() const {
    const bool runs = host_state_ == live::ViewTime::Host::runs;
    return {.speed = runs ? speed_ : 0, .playing = control_.is_playing(), .recorded = false, .host = host_state_};
  }

  Simulation& simulation_;  // built anew if the host that it follows is another one
  RunControl& control_;
  std::string scene_;
  std::string address_;
  SimulationDesc desc_;
  AllowedFolders folders_;  // of requests
  Follower* follower_;
  std::string scene_text_;     // of the file, as it was read or saved last
  std::size_t saved_changes_;  // of the scene that the file has
  std::string token_;
  std::optional<live::PlaybackRange> range_;  // of a run that has an end
  live::LiveView view_;
  live::ViewTime::Host host_state_ = live::ViewTime::Host::runs;
  std::int64_t frame_ns_ = 0;  // when the last frame was made, by now_ns()
  std::uint64_t builds_ = 0;   // of the follower, whose scene view_ shows
  bool is_shown_ = true;       // clients have the last frame, or will get it
  bool shows_play_ = true;     // what they have of the run
  std::optional<FrameTime> shown_;
  double step_ms_ = 0, speed_ = 0;
  std::int64_t speed_since_ns_ = 0, speed_since_simulated_ns_ = 0;
};

}  // namespace simvis
