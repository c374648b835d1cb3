#include "import/mjcf/mjcf_cameras.h"

#include <cmath>
#include <glm/glm.hpp>
#include <string_view>
#include <vector>

#include "import/model/file_command.h"

namespace simvis {
namespace {

constexpr double kWidth_px = 640, kHeight_px = 480, kMaxPixels = 16384, kFovy_deg = 45;

glm::dvec2 pair_of(const MjcfElement& camera, const char* name, const glm::dvec2& fallback) {
  const std::vector<double> numbers = camera.numbers(name, 2, 2);
  return numbers.empty() ? fallback : glm::dvec2(numbers[0], numbers[1]);
}

// What the camera measures: its `output`, or colour.
std::string outputs_of(const MjcfElement& camera, ImportReport& report) {
  struct Word {
    std::string_view own, ours;
  };
  constexpr Word kWords[] = {
      {"rgb", "color"}, {"depth", "depth"}, {"distance", "range"}, {"normal", "normal"}, {"segmentation", "instance"}};
  const std::string written = camera.text("output", "rgb");
  std::string outputs;
  for (const Word& word : kWords) {
    if (written.find(word.own) != written.npos) outputs += (outputs.empty() ? "" : " ") + std::string(word.ours);
  }
  if (!outputs.empty()) return outputs;
  report.leave_out("output " + in_quotes(written) + " of a camera", camera.at());
  return "color";
}

// The focal lengths and the principal point, in pixels. `principal` moves the frustum to the right and upwards, and so
// the optical axis to the left and down.
void add_intrinsics(const MjcfElement& camera, const glm::dvec2& size_px, const glm::dvec2& sensor_m,
                    FileCommand& command) {
  const glm::dvec2 px_per_m = size_px / sensor_m;
  const glm::dvec2 focal_px = pair_of(camera, "focalpixel", pair_of(camera, "focal", glm::dvec2(0)) * px_per_m);
  const glm::dvec2 principal_px =
      pair_of(camera, "principalpixel", pair_of(camera, "principal", glm::dvec2(0)) * px_per_m);
  if (!(focal_px.x > 0 && focal_px.y > 0)) {
    camera.fail("has a sensorsize and no focal lengths above 0, expected focal or focalpixel");
  }
  if (focal_px.x == focal_px.y && principal_px == glm::dvec2(0)) {
    command.add("hfov", glm::degrees(2 * std::atan(size_px.x / 2 / focal_px.x)));
    return;
  }
  command.add("fx", focal_px.x);
  command.add("fy", focal_px.y);
  command.add("cx", size_px.x / 2 - principal_px.x - 0.5);
  command.add("cy", size_px.y / 2 + principal_px.y - 0.5);
}

}  // namespace

std::string mjcf_camera_command(const MjcfElement& camera, const std::string& name, const std::string& point,
                                ImportReport& report) {
  glm::dvec2 size_px = pair_of(camera, "resolution", glm::dvec2(1));
  for (int i = 0; i < 2; ++i) {
    if (size_px[i] >= 1 && size_px[i] <= kMaxPixels && size_px[i] == std::floor(size_px[i])) continue;
    camera.fail("has a resolution that is not allowed, expected whole numbers from 1 to " + format_number(kMaxPixels));
  }
  if (size_px == glm::dvec2(1)) size_px = {kWidth_px, kHeight_px};
  if (camera.flag("orthographic", false) || camera.text("projection") == "orthographic") {
    camera.fail("has parallel rays, which no sensor has");
  }
  if (const std::string mode = camera.text("mode", "fixed"); mode != "fixed") {
    report.leave_out("mode " + in_quotes(mode) + " of a camera", camera.at());
  }
  FileCommand command(CommandKind::sensor, "camera", name, point);
  command.add("width", size_px.x);
  command.add("height", size_px.y);
  const glm::dvec2 sensor_m = pair_of(camera, "sensorsize", glm::dvec2(0));
  if (sensor_m.x > 0 && sensor_m.y > 0) {
    add_intrinsics(camera, size_px, sensor_m, command);
  } else {
    const double fovy_deg = camera.number("fovy", kFovy_deg);
    if (!(fovy_deg > 0 && fovy_deg < 180)) camera.fail("has a fovy that is not between 0 and 180 degrees");
    const double half = std::tan(glm::radians(fovy_deg) / 2) * size_px.x / size_px.y;
    command.add("hfov", glm::degrees(2 * std::atan(half)));
  }
  command.add("outputs", outputs_of(camera, report));
  return command.text();
}

}  // namespace simvis
