// Two network namespaces, for tests of what goes from one machine to another.
#pragma once

#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/run_process.h"

namespace simvis {

/// Two network namespaces that a cable joins, in place of two machines: 10.123.0.1 at its end `east`, and 10.123.0.2.
class TwoMachines {
 public:
  explicit TwoMachines(const std::filesystem::path& folder) : pids_(folder / "pids"), keeper_(keeper_command()) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (!std::filesystem::exists(pids_) && keeper_.err_so_far().empty() && std::chrono::steady_clock::now() < end) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    std::istringstream(read_text_if_there(pids_)) >> first_ >> second_;
  }
  ~TwoMachines() { keeper_.send(SIGTERM); }

  bool exist() const { return !second_.empty(); }
  std::string why_not() const { return "no network namespaces can be made: " + keeper_.err_so_far(); }
  std::vector<std::string> on_first(const std::vector<std::string>& command) const { return on(first_, command); }
  std::vector<std::string> on_second(const std::vector<std::string>& command) const { return on(second_, command); }

 private:
  std::vector<std::string> keeper_command() const {
    const std::string script = R"sh(set -eu
      unshare --net sleep 300 & other=$!
      trap 'kill $other' EXIT
      trap 'exit 0' TERM
      until [ "$(readlink /proc/$other/ns/net)" != "$(readlink /proc/$$/ns/net)" ]; do sleep 0.01; done
      ip link add east type veth peer name west netns $other
      ip address add 10.123.0.1/24 dev east
      ip link set lo up
      ip link set east up
      on_other='nsenter --target '$other' --net'
      $on_other ip address add 10.123.0.2/24 dev west
      $on_other ip link set lo up
      $on_other ip link set west up
      echo $$ $other >"$1.new"
      mv "$1.new" "$1"
      wait $other)sh";
    std::vector<std::string> command{"unshare", "--net"};
    if (!is_root()) command.insert(command.end(), {"--user", "--map-root-user"});
    command.insert(command.end(), {"sh", "-c", script, "sh", pids_.string()});
    return command;
  }
  // Root needs no user namespace, and could make none in a changed root.
  static bool is_root() { return ::geteuid() == 0; }
  static std::string read_text_if_there(const std::filesystem::path& file) {
    return std::filesystem::exists(file) ? read_text(file) : "";
  }
  static std::vector<std::string> on(const std::string& pid, const std::vector<std::string>& command) {
    std::vector<std::string> all{"nsenter", "--target", pid, "--net"};
    if (!is_root()) all.insert(all.end(), {"--user", "--preserve-credentials"});
    all.insert(all.end(), command.begin(), command.end());
    return all;
  }

  std::filesystem::path pids_;
  Process keeper_;
  std::string first_, second_;
};

}  // namespace simvis
