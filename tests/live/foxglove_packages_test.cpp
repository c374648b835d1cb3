// Foxglove's own packages of npm as clients. They are installed into the build folder when the test first runs; without
// node, npm or a network the test is skipped.
#include <doctest/doctest.h>
#include <signal.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/live/live_program.h"
#include "tests/support/run_process.h"
#include "tests/support/skip.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("live");

namespace simvis {
namespace {

namespace fs = std::filesystem;

/// The folder that has node_modules; empty: they cannot be had, and `why_not` is the reason.
fs::path packages(std::string& why_not) {
  const fs::path folder = fs::path(tested_build()) / "foxglove_packages";
  if (fs::exists(folder / "node_modules/@foxglove/ws-protocol")) return folder;
  try {
    fs::create_directories(folder);
    const Strings install{"npm",
                          "install",
                          "--prefix",
                          folder.string(),
                          "--no-audit",
                          "--no-fund",
                          "--fetch-retries=0",
                          "--silent",
                          "ws@8",
                          "@foxglove/ws-protocol@0.8",
                          "@foxglove/rosmsg@5",
                          "@foxglove/rosmsg2-serialization@3"};
    const ProcessResult result = Process(install).wait(std::chrono::seconds(60));
    if (result.exit_code == 0) return folder;
    why_not = result.timed_out ? "it takes longer than 60 s" : result.err;
  } catch (const std::runtime_error&) {
    why_not = "npm is not installed; ./test does not install it, because Debian's npm brings 365 packages";
  }
  return {};
}

}  // namespace

TEST_CASE("@foxglove/ws-protocol decodes scans, images and clouds, and sets a parameter, under both names") {
  std::string why_not;
  const fs::path folder = packages(why_not);
  if (folder.empty()) return test::skip("npm cannot install @foxglove/ws-protocol: " + why_not);
  test::LiveProgram program;
  for (const std::string protocol : {"foxglove.sdk.v1", "foxglove.websocket.v1"}) {
    CAPTURE(protocol);
    const std::string url = "ws://127.0.0.1:" + std::to_string(program.port) + "/?token=" + program.token;
    const ProcessResult client = Process({"node", std::string(SIMVIS_SOURCE_DIR) + "/tests/live/foxglove_client.mjs",
                                          url, protocol, folder.string()})
                                     .wait();
    CAPTURE(client.err);
    REQUIRE(client.exit_code == 0);
    const nlohmann::json found = nlohmann::json::parse(client.out);
    CHECK(found.at("server") == "SimVis");
    CHECK(found.at("scan").at("frame") == "SCAN");
    CHECK(found.at("scan").at("ranges") == 5);
    CHECK(found.at("image") == nlohmann::json({{"width", 64}, {"encoding", "rgb8"}, {"bytes", 64 * 48 * 3}}));
    CHECK(found.at("points").at("width") == 5);
    CHECK(found.at("points").at("fields")[0] == "x");
    CHECK(found.at("parameter").at("name") == "MOVE.x");
    CHECK(found.at("parameter").at("value") == 0.25);
  }
  CHECK(program.interrupt().exit_code == 130);
}

}  // namespace simvis

TEST_SUITE_END();
