#include "program/datasets/dsec_pictures.h"

#include <cmath>
#include <cstdint>
#include <vector>

#include "engine/base/assert.h"
#include "scenegraph/pictures/png_bytes.h"

namespace simvis {
namespace {

constexpr double kFlowSteps = 128, kFlowZero = 1 << 15, kDisparitySteps = 256, kMaxCode = 0xffff;

void append(std::vector<std::uint8_t>& bytes, double code) {
  const auto whole = static_cast<std::uint16_t>(code);
  bytes.push_back(static_cast<std::uint8_t>(whole >> 8));
  bytes.push_back(static_cast<std::uint8_t>(whole & 0xff));
}

bool is_code(double code) { return code >= 0 && code <= kMaxCode; }

}  // namespace

std::string flow_png(const MeasuredArray& flow) {
  SIMVIS_ASSERT(flow.shape.channels == 2);
  std::vector<std::uint8_t> rows;
  rows.reserve(3 * flow.count());
  for (std::size_t i = 0; i < flow.count(); i += 2) {
    const double x = std::round(flow.number(i) * kFlowSteps + kFlowZero),
                 y = std::round(flow.number(i + 1) * kFlowSteps + kFlowZero);
    const bool is_valid = is_code(x) && is_code(y);
    for (const double code : {x, y, 1.0}) append(rows, is_valid ? code : 0);
  }
  return png_bytes({.width = flow.shape.columns, .height = flow.shape.rows, .bits = 16, .channels = 3}, rows);
}

std::string disparity_png(const Image& depth, double focal_px_baseline_m) {
  std::vector<std::uint8_t> rows;
  rows.reserve(2 * depth.pixels.size());
  for (const float depth_m : depth.pixels) {
    const double code = std::round(kDisparitySteps * focal_px_baseline_m / static_cast<double>(depth_m));
    append(rows, is_code(code) ? code : 0);
  }
  return png_bytes({.width = depth.width, .height = depth.height, .bits = 16, .channels = 1}, rows);
}

}  // namespace simvis
