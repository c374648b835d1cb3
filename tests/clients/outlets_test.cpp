// Consumers of frames that fail: the frame stays made, once, and the other consumers get it.
#include <doctest/doctest.h>
#include <unistd.h>

#include <fstream>
#include <optional>

#include <simvis/simulation.h>
#include <simvis_client/connection.h>
#include "simvis/message_tap.h"
#include "tests/clients/shared_host.h"
#include "tests/messages/file_size_limit.h"
#include "tests/messages/mcap_file.h"
#include "tests/support/error_of.h"
#include "tests/support/long_count.h"
#include "tests/support/loopback_dds.h"
#include "tests/support/tested_build.h"
#include "tests/support/wall_scene.h"

using namespace simvis;

TEST_SUITE_BEGIN("clients");

namespace {

constexpr std::uint64_t kFrames = 12;

// 400 KB of ranges and points in each frame, so that chunks of 1 MB are written early.
constexpr const char* kFallingScanner = R"(
    <element type='physics' name='PHYSICS' insert_at='ROOT'/>
    <part name='BALL' insert_at='ROOT' shape='sphere' radius='0.1' pose_offset='1 0 9 0 0 0'/>
    <element type='body' name='BALL_BODY' insert_at='BALL' mass='1'/>
    <sensor type='laser_scanner' name='SCAN' insert_at='BALL' ignore='BALL' samples='20000' min_angle='-60' max_angle='60'/>
    <sensor type='psd' name='IR' insert_at='ROOT' rate='5' pose_offset='3.5 0 0 0 0 0'/>)";

/// What a program sees after a frame.
struct Seen {
  std::vector<std::string> measured;
  std::uint64_t next_frame, scans;
  double body_z;
  std::vector<float> ranges;
  bool operator==(const Seen&) const = default;
};

/// Takes messages, and fails at one frame.
class FailingTap : public ros::MessageOutlet {
 public:
  bool wants(const ros::Topic&, ros::TopicForm form) override { return form == ros::TopicForm::own; }
  bool add(ros::MessageJob) override {
    ++jobs;
    if (fails) throw MachineError("the listener is gone");
    return true;
  }
  bool fails = false;
  std::uint64_t jobs = 0;
};

struct Falling {
  Falling() {
    desc.rate_hz = 10;
    simulation.emplace(Simulation::load(write_wall_scene(folder.path(), kFallingScanner), desc));
  }
  /// Makes the next frame; returns the error of an outlet.
  std::string step() {
    try {
      simulation->step();
    } catch (const OutletError& error) {
      return error.what();
    }
    return "";
  }
  Seen seen() const {
    const std::span<const std::string> names = simulation->measured();
    return {.measured = {names.begin(), names.end()},
            .next_frame = simulation->next_frame().index,
            .scans = simulation->sensors()[0].frames,
            .body_z = simulation->get("BALL_BODY", "z"),
            .ranges = simulation->scan("SCAN").range_m};
  }

  TemporaryFolder folder;
  std::filesystem::path file = folder / "run.mcap";
  SimulationDesc desc;
  std::optional<Simulation> simulation;
};

/// The frames of a run without outlets.
const std::vector<Seen>& expected_frames() {
  static const std::vector<Seen> frames = [] {
    Falling plain;
    std::vector<Seen> all;
    for (std::uint64_t i = 0; i < kFrames; ++i) {
      plain.simulation->step();
      all.push_back(plain.seen());
    }
    return all;
  }();
  REQUIRE(frames.back().body_z < -0.4);
  return frames;
}

}  // namespace

TEST_CASE("an outlet that fails at any frame changes no frame, and the other outlets are complete") {
  const std::vector<Seen>& expected = expected_frames();
  std::string complete;  // the recording of a run in which nothing fails
  for (std::uint64_t failing = kFrames + 1; failing-- > 0;) {
    if (sanitized() && failing % 4 != 0) continue;
    CAPTURE(failing);
    FailingTap tap;
    Falling run;
    send_messages(*run.simulation, &tap);
    const std::string name = unique_name("outlets-" + std::to_string(failing));
    run.simulation->serve({.name = name});
    run.simulation->record({.file = run.file});
    const client::Connection connection(name, "reader");
    std::uint64_t errors = 0;
    for (std::uint64_t i = 0; i < kFrames; ++i) {
      tap.fails = i == failing;
      const std::uint64_t jobs = tap.jobs;
      const std::string error = run.step();
      errors += error.empty() ? 0 : 1;
      CHECK(error == (i == failing ? "messages: the listener is gone" : ""));
      CHECK((tap.jobs > jobs) == (i <= failing));
      CHECK(run.seen() == expected[i]);
      const auto served = connection.latest(connection.sensor("SCAN"));
      REQUIRE(served);
      CHECK(served->slot().frame == i);
      CHECK(std::ranges::equal(served->output<float>("range_m"), expected[i].ranges));
    }
    CHECK(errors == (failing < kFrames ? 1 : 0));
    run.simulation->finish_recording();
    if (failing == kFrames) complete = read_text(run.file);
    REQUIRE_FALSE(complete.empty());
    CHECK(read_text(run.file) == complete);
  }
}

TEST_CASE("a recording on a full disk fails once, and its file opens") {
  const std::vector<Seen>& expected = expected_frames();
  for (const rlim_t limit : {0, 4'096, 100'000, 1'200'000}) {
    CAPTURE(limit);
    Falling run;
    const std::string name = unique_name("full-disk-" + std::to_string(limit));
    run.simulation->serve({.name = name});
    run.simulation->record({.file = run.file});
    const client::Connection connection(name, "reader");
    std::vector<std::string> errors;
    {
      const FileSizeLimit limited(limit);
      // The recorder's thread may need longer to find the disk full.
      for (std::uint64_t i = 0; i < kFrames || (errors.empty() && i < 1000); ++i) {
        const std::string error = run.step();
        if (!error.empty()) errors.push_back(error);
        if (i < kFrames) CHECK(run.seen() == expected[i]);
        CHECK(connection.latest(0)->slot().frame == i);
      }
    }
    REQUIRE(errors.size() == 1);
    CHECK(contains(errors[0], "recording: " + run.file.string() + ": error: "));
    CHECK(contains(errors[0], "File too large"));
    CHECK(contains(error_of([&] { run.simulation->finish_recording(); }), "the simulation is not recorded"));
    if (limit >= 100'000) CHECK(ros::test::McapReader::read(read_text(run.file)).has_end);
    // The disk has room again.
    run.simulation->record({.file = run.folder / "second.mcap"});
    CHECK(run.step().empty());
    CHECK(run.simulation->finish_recording().messages > 0);
  }
}

TEST_CASE("outlets that fail at the same frame are named in one error") {
  Falling run;
  FailingTap tap;
  tap.fails = true;
  run.simulation->record({.file = run.file});
  send_messages(*run.simulation, &tap);
  std::filesystem::create_directory(run.file);  // no recording can be made here
  const std::string error = run.step();
  CHECK(contains(error, "recording: " + run.file.string()));
  CHECK(contains(error, "; messages: the listener is gone"));
  CHECK(run.seen() == expected_frames()[0]);
  CHECK(run.step().empty());
  CHECK(run.seen() == expected_frames()[1]);
}

TEST_CASE("of a frame that is under way, the call that completes it reports the outlet") {
  Falling run;
  FailingTap tap;
  send_messages(*run.simulation, &tap);
  run.simulation->step_async();
  tap.fails = true;
  CHECK_THROWS_WITH_AS(run.simulation->step_async(), "messages: the listener is gone", OutletError);
  CHECK(run.seen() == expected_frames()[0]);
  run.simulation->step_async();
  run.simulation->finish();
  CHECK(run.seen() == expected_frames()[1]);
}

TEST_CASE("clients and a DDS domain that come and go end no frame") {
  const std::vector<Seen>& expected = expected_frames();
  Falling run;
  const std::string name = unique_name("come-and-go");
  run.simulation->serve({.name = name});
  const bool dds = has_dds();
  for (std::uint64_t i = 0; i < kFrames; ++i) {
    std::optional<client::Connection> connection;
    if (i % 2 == 0) connection.emplace(name, "guest");
    if (dds && i % 4 == 0) run.simulation->join_dds({.domain = own_domain()});
    CHECK(run.step().empty());
    CHECK(run.seen() == expected[i]);
    if (dds && i % 4 == 2) run.simulation->leave_dds();
  }
}

TEST_CASE("a frame whose visualization fails counts as not made") {
  const TemporaryFolder folder;
  SimulationDesc desc;
  desc.strict = true;
  Simulation simulation = Simulation::load(write_wall_scene(folder.path(), R"(
    <sensor type="psd" name="IR" insert_at="ROOT" pose_offset="3.5 0 0 0 0 0"/>
    <sensor type="camera" view="visualization" name="CAM" insert_at="ROOT" width="8" height="8" pose_offset="0 0 0 0 0 180"/>)"),
                                           desc);
  CHECK_THROWS_AS(simulation.step(), InputError);
  CHECK(simulation.measured().empty());
  CHECK(simulation.sensors()[0].frames == 0);
  CHECK(simulation.next_frame().index == 0);
}

// By hand: SIMVIS_TEST_FRAMES=1000000.
TEST_CASE("frames for outlets need no more memory the longer the run") {
  const auto resident_bytes = [] {
    std::ifstream statm("/proc/self/statm");
    std::int64_t size = 0, resident = 0;
    statm >> size >> resident;
    return resident * ::sysconf(_SC_PAGESIZE);
  };
  const TemporaryFolder folder;
  Simulation simulation = Simulation::load(write_wall_scene(folder.path(), R"(
    <sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="3" min_angle="-5" max_angle="5"/>)"));
  simulation.serve({.name = unique_name("soak")});
  FailingTap tap;
  const auto frames = [&](int count) {
    for (int i = 0; i < count; ++i) {
      tap.fails = i % 50 == 49;
      if (i % 50 == 0) send_messages(simulation, &tap);
      try {
        simulation.step();
      } catch (const OutletError&) {
        CHECK(tap.fails);
      }
    }
  };
  const int first = sanitized() ? 100 : 1000;
  frames(first);  // caches and pools fill
  const std::int64_t before = resident_bytes();
  const int count = count_of("SIMVIS_TEST_FRAMES", sanitized() ? 200 : 3000);
  frames(count);
  CHECK(simulation.next_frame().index == static_cast<std::uint64_t>(first + count));
  // What the allocator may spread over; a million frames that leave 8 bytes each exceed it.
  constexpr std::int64_t kSpread_bytes = std::int64_t{4} << 20;
  // The address sanitizer keeps freed memory for a while.
  if (!sanitized()) CHECK(resident_bytes() - before < kSpread_bytes);
}

TEST_SUITE_END();
