#include "python/core/live_window.h"

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <new>
#include <optional>
#include <utility>
#include <vector>

#include <simvis/error.h>
#include "simvis/message_tap.h"

namespace simvis::python {
namespace {

constexpr const char* kRequestName = "live view";  // in messages about a request
const std::filesystem::path kRequestFolders[] = {"."};
constexpr live::ViewTime kTime{.speed = 0, .playing = true, .recorded = false};

}  // namespace

LiveWindow::LiveWindow(Simulation& simulation, std::uint16_t port)
    : simulation_(simulation),
      folders_(kRequestFolders),
      token_(live::random_token()),
      view_({.port = port, .token = token_}) {
  view_.attach(simulation);
}

LiveWindow::~LiveWindow() { send_messages(simulation_, nullptr); }

std::string LiveWindow::url() const { return "http://127.0.0.1:" + std::to_string(view_.port()) + "/?token=" + token_; }

void LiveWindow::carry_out() {
  // Who asks without end does not stop the simulation.
  for (std::size_t i = 0; i < live::ControlQueue::kMaxWaiting; ++i) {
    const std::optional<Control> control = view_.next_control();
    if (!control) return;
    carry_out(*control);
  }
}

void LiveWindow::carry_out_next(std::chrono::milliseconds patience) {
  const std::optional<Control> control = view_.next_control(std::chrono::steady_clock::now() + patience);
  if (control) carry_out(*control);
  carry_out();
}

void LiveWindow::show(const FrameTime& frame) {
  shown_ns_ = frame.time_ns;
  view_.publish(simulation_, frame, 0, kTime);
}

void LiveWindow::carry_out(const Control& control) {
  switch (control.kind) {
    case Control::Kind::look:  // the next frame has what is looked at
      return view_.publish(simulation_.parameters());
    case Control::Kind::set:
      return set(control);
    case Control::Kind::execute:
      return execute(control);
    case Control::Kind::command:
      return command(control);
    case Control::Kind::pull:
      return view_.pull(control, simulation_);
    default:
      return view_.answer(control, "the program that steps the simulation decides about that");
  }
}

void LiveWindow::set(const Control& control) {
  Parameters& parameters = simulation_.parameters();
  std::vector<std::string> refusals;
  for (const auto& [parameter, value] : control.values) {
    try {
      parameters.set(parameter, value);
    } catch (const InputError& error) {
      refusals.emplace_back(error.what());
    }
  }
  view_.answer_set(control, std::move(refusals), parameters);
}

void LiveWindow::command(const Control& control) {
  std::string refusal;
  try {
    send_command(simulation_, *control.input, control.text, shown_ns_);
  } catch (const InputError& error) {
    refusal = error.what();
  }
  view_.answer(control, refusal);
}

void LiveWindow::execute(const Control& control) {
  std::string refusal;
  try {
    folders_.carry_out([&] {
      folders_.parse(control.text, kRequestName);  // throws if it names a file elsewhere
      simulation_.execute(control.text, folders_.start(), kRequestName);
    });
  } catch (const Error& error) {  // of the machine too: a client's file that takes too long does not end the run
    refusal = without_file_content(error.what(), control.text);
  } catch (const std::bad_alloc&) {
    refusal = kNoMemoryForRequest;
  }
  view_.answer(control, refusal);
}

}  // namespace simvis::python
