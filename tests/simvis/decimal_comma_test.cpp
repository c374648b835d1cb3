// A decimal comma in the locale of the process, as a program has it after setlocale() or std::locale::global(), changes
// no text: neither of the C library's functions nor of streams.
#include <doctest/doctest.h>

#include <stdlib.h>

#include <clocale>
#include <cstdio>
#include <locale>
#include <string>

#include <simvis/simulation.h>
#include <simvis/verdict.h>
#include "engine/base/decimal.h"
#include "program/report/scene_list.h"
#include "sensors/laser_scanner/scan_tolerance.h"
#include "simvis/built_scene.h"
#include "tests/support/error_of.h"
#include "tests/support/run_process.h"
#include "tests/support/skip.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("simvis");

using namespace simvis;

namespace {

struct Comma : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
};

/// Has a decimal comma from here to the end of its scope: in streams, and in functions of C if localedef makes the
/// locale.
class CommaLocale {
 public:
  CommaLocale() {
    const std::string name = "de_DE.UTF-8";
    Process({"localedef", "-i", "de_DE", "-f", "UTF-8", (folder_ / name).string()}).wait();
    ::setenv("LOCPATH", folder_.path().c_str(), 1);
    has_comma_ = std::setlocale(LC_NUMERIC, name.c_str()) != nullptr;
  }
  ~CommaLocale() {
    std::setlocale(LC_NUMERIC, c_before_.c_str());
    std::locale::global(before_);
    ::unsetenv("LOCPATH");
  }
  CommaLocale(const CommaLocale&) = delete;
  CommaLocale& operator=(const CommaLocale&) = delete;

  bool has_comma() const { return has_comma_; }  ///< for functions of C

 private:
  TemporaryFolder folder_;
  std::string c_before_ = std::setlocale(LC_NUMERIC, nullptr);
  std::locale before_ = std::locale::global(std::locale(std::locale::classic(), new Comma));
  bool has_comma_ = false;
};

const char* const kRoom = R"(
  <part name="WALL" shape="box" size="0.25 4.5 4" insert_at="ROOT" pose_offset="3.5 0 0 0 0 0"/>
  <sensor type="laser_scanner" name="S" insert_at="ROOT" samples="11" method="auto" max_error_m="0.001"/>)";

/// What people read of a scene: its list, what its scanner reports, tolerances, an error, values of tests.
std::string texts() {
  Simulation simulation = Simulation::from_string(kRoom);
  simulation.step();
  std::string all = to_text(list_scene(built_scene(simulation)));
  all += to_string(ScanTolerance{.max_error_m = 0.25, .max_error_rel = 0.125});
  all += error_of([] {
    Simulation::from_string(R"(<sensor type="laser_scanner" name="S" insert_at="ROOT" )"
                            R"(min_angle="10.5" max_angle="-0.5"/>)");
  });
  return all + test_kit::detail::number(0.5) + test_kit::detail::short_number(0.1);
}

}  // namespace

TEST_CASE("a decimal comma in the locale of the process changes no text") {
  const std::string right = texts();
  CHECK(right.find("4.5") != right.npos);
  const CommaLocale comma;
  CHECK(texts() == right);
  if (!comma.has_comma()) test::skip("localedef cannot make a locale with a decimal comma");
}

TEST_CASE("decimals are those of printf in the C locale") {
  for (const double value : {0.0, -0.0, 1.0, 0.1, -2.5e-7, 123456.789, 1e22, 1.7976931348623157e308, 5e-324}) {
    char text[400];
    std::snprintf(text, sizeof text, "%.6g", value);
    CHECK(decimal(value, 6) == text);
    std::snprintf(text, sizeof text, "%.2f", value);
    CHECK(decimal(value, 2, std::chars_format::fixed) == text);
    std::snprintf(text, sizeof text, "%.1e", value);
    CHECK(decimal(value, 1, std::chars_format::scientific) == text);
  }
}

TEST_SUITE_END();
