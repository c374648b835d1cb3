// The live page of a simulation that a program steps.
#pragma once

#include <cstdint>
#include <string>

#include <simvis/simulation.h>
#include "program/live/live_view.h"
#include "simvis/sharing/allowed_folders.h"

namespace simvis::python {

/// Threads  that of the simulation, without the interpreter's lock.
class LiveWindow {
 public:
  /// Listens from now on; 0: a free port. Throws MachineError: the port is taken.
  LiveWindow(Simulation& simulation, std::uint16_t port);
  ~LiveWindow();
  LiveWindow(const LiveWindow&) = delete;
  LiveWindow& operator=(const LiveWindow&) = delete;

  /// It has a token, without which nothing is answered.
  std::string url() const;

  /// Sets values and executes changes that clients ask for. They are told that the program decides about all else.
  void carry_out();
  /// As carry_out(), after a wait of up to `patience` for a request.
  void carry_out_next(std::chrono::milliseconds patience);

  void show(const FrameTime& frame);

 private:
  using Control = live::Control;
  void carry_out(const Control& control);
  void set(const Control& control);
  void execute(const Control& control);
  void command(const Control& control);

  Simulation& simulation_;
  AllowedFolders folders_;  // of requests: the current one
  std::string token_;
  live::LiveView view_;
  std::int64_t shown_ns_ = 0;  // time of the last frame
};

}  // namespace simvis::python
