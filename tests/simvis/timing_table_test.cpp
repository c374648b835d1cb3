// Sensors with timing faults in the files of a run: stamps in their tables, true times in timing.csv.
#include <doctest/doctest.h>

#include <string>

#include "tests/support/simvis_run.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {

TEST_CASE("timing.csv has the true times beside the stamps of the tables") {
  const TemporaryFolder folder;
  const std::filesystem::path scene = folder / "late.xml", out = folder / "out";
  write_text(scene, R"(<simvis>
  <sensor type="imu" name="LATE" insert_at="ROOT" delay="0.025" clock_drift="0.5" rate="100"/>
  <sensor type="imu" name="PLAIN" insert_at="ROOT" rate="100"/>
</simvis>)");
  const ProcessResult run =
      Process({simvis_run(), "--frames", "6", "--rate", "100", "--out", out.string(), scene.string()}).wait();
  CAPTURE(run.err);
  REQUIRE(run.exit_code == 0);
  const Table timing = read_csv(out / "timing.csv"), late = read_csv(out / "LATE.csv"),
              plain = read_csv(out / "PLAIN.csv");
  CHECK(timing.columns == Strings{"frame", "sensor", "stamp_s", "capture_time_s", "arrival_time_s"});
  // Those of 0, 0.01 and 0.02 s arrive after 25 ms, in the frames after.
  const std::vector<Strings> expected = {{"3", "LATE", "0.000000000", "0.000000000", "0.025000000"},
                                         {"4", "LATE", "0.015000000", "0.010000000", "0.035000000"},
                                         {"5", "LATE", "0.030000000", "0.020000000", "0.045000000"}};
  CHECK(timing.rows == expected);
  REQUIRE(late.rows.size() == 3);
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(late.rows[i][0] == expected[i][0]);
    CHECK(late.rows[i][1] == expected[i][2]);
  }
  CHECK(plain.rows.size() == 6);
}

TEST_CASE("datasets and shards refuse sensors with timing faults") {
  check_refused({"--dataset", "coco"},
                R"(<sensor type="camera" name="CAM" insert_at="ROOT" outputs="color instance boxes" delay="0.1"/>)",
                {"sensor \"CAM\": a dataset has no measurements with timing faults"});
  check_refused({"--shard", "0/2"}, R"(<sensor type="imu" name="IMU" insert_at="ROOT" drop="0.1"/>)",
                {"sensor \"IMU\""});
}

}  // namespace simvis

TEST_SUITE_END();
