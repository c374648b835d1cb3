// Files of Gaussian splats, as the program of Kerbl et al. 2023 writes them, in text.
#pragma once

#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <iomanip>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

namespace simvis::test {

/// A splat of one colour, in the values of the file's scene.
struct FileSplat {
  glm::dvec3 center_m{0};
  glm::dvec3 sigma_m{0.1};
  glm::dvec4 rotation{0, 0, 0, 1};  ///< x, y, z, w
  double opacity = 0.999;           ///< above 0 and below 1
  glm::dvec3 color{0.5};            ///< sRGB
};

inline std::string splat_header(std::size_t count, std::size_t rest = 0, const std::string& format = "ascii") {
  std::string text = "ply\nformat " + format + " 1.0\nelement vertex " + std::to_string(count) + "\n";
  const auto add = [&](const std::string& name) { text += "property float " + name + "\n"; };
  for (const char* const name : {"x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2"}) add(name);
  for (std::size_t i = 0; i < rest; ++i) add("f_rest_" + std::to_string(i));
  for (const char* const name : {"opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"}) {
    add(name);
  }
  return text + "end_header\n";
}

/// The numbers of a splat in the order of the header, without further harmonics.
inline std::array<double, 17> splat_numbers(const FileSplat& splat) {
  constexpr double kDegree0 = 0.28209479177387814;
  const glm::dvec3& c = splat.center_m;
  const glm::dvec3 color = (splat.color - 0.5) / kDegree0, log_sigma = glm::log(splat.sigma_m);
  const glm::dvec4& q = splat.rotation;
  return {c.x,         c.y,         c.z,         0,       0,
          0,           color.r,     color.g,     color.b, std::log(splat.opacity / (1 - splat.opacity)),
          log_sigma.x, log_sigma.y, log_sigma.z, q.w,     q.x,
          q.y,         q.z};
}

inline std::string splat_file(const std::vector<FileSplat>& splats) {
  std::ostringstream text;
  text << splat_header(splats.size()) << std::setprecision(std::numeric_limits<double>::max_digits10);
  for (const FileSplat& splat : splats) {
    for (const double number : splat_numbers(splat)) text << number << ' ';
    text << '\n';
  }
  return text.str();
}

}  // namespace simvis::test
