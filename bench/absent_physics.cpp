// Measures what physics costs a scene that has none.
//
//   absent_physics [FRAMES]
//
// Prints CSV. A scene of a thousand boxes, each moved by an element `pose`, makes frames: `absent` before anything in
// the process has physics, so that its engine is not loaded; then, in turns with a scene that has physics and so has
// loaded the engine, `beside`. `ms_per_frame` is the median of the processor time; `ratio` is that to the first row.
// `loaded` is 1 if the engine is in the process.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "elements/dynamics/world/engine_module.h"
#include "simvis/element_motion.h"
#include "simvis/scene_builder.h"

namespace {

using namespace simvis;

constexpr int kBoxes = 1000;
constexpr double kRate_hz = 25;

std::string boxes_xml() {
  std::string xml;
  for (int i = 0; i < kBoxes; ++i) {
    const std::string n = std::to_string(i);
    xml += "<part name='" + n + "' insert_at='ROOT' shape='box' size='0.2 0.2 0.2'/><element type='pose' name='P" + n +
           "' insert_at='" + n + "' x='" + n + "'/>";
  }
  return xml;
}

class Boxes {
 public:
  explicit Boxes(const std::string& xml) : built_(build_scene(parse_commands(xml, "absent_physics", ""))) {
    advance_elements(built_, {});
  }
  double frame_ms() {
    const std::clock_t start = std::clock();
    ++frame_;
    for (int i = 0; i < kBoxes; ++i) {
      built_.parameters.set(built_.parameters.index("P" + std::to_string(i), "z"), frame_);
    }
    advance_elements(built_, {.time_ns = static_cast<std::int64_t>(1e9 / kRate_hz) * frame_});
    return 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  }

 private:
  BuiltScene built_;
  int frame_ = 0;
};

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

}  // namespace

int main(int count, char** arguments) {
  const int frames = count > 1 ? std::atoi(arguments[1]) : 300;
  Boxes scene(boxes_xml());
  std::printf("way,boxes,frames,ms_per_frame,ratio,loaded\n");
  std::vector<double> absent, beside;
  for (int i = 0; i < frames; ++i) absent.push_back(scene.frame_ms());
  std::printf("absent,%d,%d,%.4f,1,%d\n", kBoxes, frames, median(absent), dynamics_engine_is_loaded() ? 1 : 0);
  Boxes moving("<element type='physics' name='PHYSICS' insert_at='ROOT'/>" + boxes_xml());
  for (int i = 0; i < frames; ++i) {
    beside.push_back(scene.frame_ms());
    moving.frame_ms();
  }
  std::printf("beside,%d,%d,%.4f,%.4f,%d\n", kBoxes, frames, median(beside), median(beside) / median(absent),
              dynamics_engine_is_loaded() ? 1 : 0);
  return 0;
}
