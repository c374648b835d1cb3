// The processor time that many bodies take until the first frame, and at their end.
#include <doctest/doctest.h>

#include <sys/resource.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

#include "tests/support/moving_scene.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

constexpr int kFew = 500, kMany = 4 * kFew;
// Four times the bodies take four times as long if loading is linear, and sixteen times if it is quadratic.
constexpr double kMaxGrowth = 8;

double processor_s() {
  rusage used{};
  ::getrusage(RUSAGE_SELF, &used);
  return static_cast<double>(used.ru_utime.tv_sec) + static_cast<double>(used.ru_utime.tv_usec) / 1e6;
}

// The least of three: other work on the machine makes caches cold, but never warmer.
template <typename Action>
double time_of(const Action& action) {
  double least_s = std::numeric_limits<double>::infinity();
  for (int turn = 0; turn < 3; ++turn) {
    const double before_s = processor_s();
    action();
    least_s = std::min(least_s, processor_s() - before_s);
  }
  return least_s;
}

std::string place(int i) { return std::to_string(i % 100) + " " + std::to_string(i / 100) + " 5"; }

std::string many_bodies(int count) {
  std::string all = kPhysics;
  for (int i = 0; i < count; ++i) {
    all += body("P" + std::to_string(i), "shape='box' size='0.2 0.2 0.2' pose_offset='" + place(i) + " 0 0 0'",
                "shape='box' mass='1'");
  }
  return all;
}

std::string many_models(int count) {
  std::string all = "<sdf version='1.9'><world name='w'>\n";
  for (int i = 0; i < count; ++i) {
    all += "<model name='m" + std::to_string(i) + "'><pose>" + place(i) +
           " 0 0 0</pose><link name='l'><inertial><mass>1</mass></inertial><collision name='c'><geometry><box>"
           "<size>0.2 0.2 0.2</size></box></geometry></collision></link></model>\n";
  }
  return all + "</world></sdf>\n";
}

TEST_CASE("the time until the first frame grows as the number of bodies does") {
  const auto load = [](int count) { return time_of([&] { MovingScene scene(many_bodies(count)); }); };
  load(kFew / 10);
  const double few_s = load(kFew), many_s = load(kMany);
  MESSAGE(kFew << " bodies take " << few_s << " s, " << kMany << " take " << many_s << " s");
  CHECK(many_s < kMaxGrowth * few_s);
}

TEST_CASE("the time until the first frame grows as the number of models of a file does") {
  const auto load = [](int count) {
    const TemporaryFolder folder;
    std::ofstream(folder.path() / "m.world") << many_models(count);
    return time_of([&] {
      MovingScene scene(kPhysics +
                            "<part name='W' insert_at='ROOT' file='m.world'/>"
                            "<element type='models' name='M' insert_at='W'/>",
                        folder.path());
    });
  };
  load(kFew / 10);
  const double few_s = load(kFew), many_s = load(kMany);
  MESSAGE(kFew << " models take " << few_s << " s, " << kMany << " take " << many_s << " s");
  CHECK(many_s < kMaxGrowth * few_s);
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
