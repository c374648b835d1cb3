// A running simvis-run --live.
#pragma once

#include <doctest/doctest.h>
#include <signal.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <regex>
#include <string>
#include <thread>

#include "tests/live/web_client.h"
#include "tests/support/run_process.h"
#include "tests/support/simvis_run.h"
#include "tests/support/wall_scene.h"

namespace simvis::test {

/// A running simvis-run --live.
struct LiveProcess {
  void start(const Strings& arguments, const std::string& with_port, const std::filesystem::path& out) {
    std::filesystem::remove(out);
    Strings command{"sh", "-c", "exec \"$0\" \"$@\" > \"$LIVE_OUT\"", simvis_run(), "--live", with_port};
    command.insert(command.end(), arguments.begin(), arguments.end());
    process = std::make_unique<Process>(command, Strings{"LIVE_OUT=" + out.string()});
    std::smatch match;
    std::string text;
    const std::regex links(
        "live view: http://127\\.0\\.0\\.1:(\\d+)/\\?token=\\w+\nFoxglove: "
        "ws://127\\.0\\.0\\.1:\\d+/\\?token=(\\w+)\n");
    for (int i = 0; i < kPatience_ms / 10 && !std::regex_search(text, match, links); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      if (std::filesystem::exists(out)) text = read_text(out);
    }
    REQUIRE(match.size() == 3);
    port = static_cast<std::uint16_t>(std::stoi(match[1]));
    token = match[2];
    open_link(port, token);
  }
  ProcessResult interrupt() const {
    process->send(SIGINT);
    return process->wait();
  }

  std::unique_ptr<Process> process;
  std::uint16_t port = 0;
  std::string token;
};

/// A program that runs the scene of the wall. The element MOVE moves its sensors towards the wall.
struct LiveProgram : LiveProcess {
  LiveProgram() {
    write_wall_scene(folder.path(), kWallSensors);
    start("0");
  }
  void start(const std::string& with_port) { LiveProcess::start({scene().string()}, with_port, folder / "out.txt"); }
  std::filesystem::path scene() const { return folder / "scene.xml"; }

  TemporaryFolder folder;
};

}  // namespace simvis::test
