// The compressed PLY of PlayCanvas's SuperSplat: splats in four whole numbers each, between the limits of their chunk.
// The layout is that of github.com/playcanvas/engine, src/scene/gsplat/gsplat-compressed-data.js.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/location.h>
#include "import/programs/clouds/cloud_files.h"
#include "import/programs/clouds/splat_columns.h"

namespace simvis {
namespace {

constexpr std::size_t kSplatsOfChunk = 256, kNumberBytes = 4;
constexpr std::array<std::string_view, 18> kLimits{
    "min_x",       "min_y",       "min_z",       "max_x", "max_y", "max_z", "min_scale_x", "min_scale_y", "min_scale_z",
    "max_scale_x", "max_scale_y", "max_scale_z", "min_r", "min_g", "min_b", "max_r",       "max_g",       "max_b"};
constexpr std::size_t kLimitsWithoutColor = 12, kPlaces = 0, kScales = 6, kColors = 12;
constexpr std::array<std::string_view, 4> kNumbers{"packed_position", "packed_rotation", "packed_scale",
                                                   "packed_color"};
enum Number : std::size_t { place, rotation, scale, color };

// A number of some bits as a share of its largest value.
double share(std::uint32_t number, unsigned first_bit, unsigned bits) {
  const std::uint32_t largest = (1u << bits) - 1;
  return static_cast<double>(number >> first_bit & largest) / largest;
}

glm::dvec3 three_shares(std::uint32_t number) {
  return {share(number, 21, 11), share(number, 11, 10), share(number, 0, 11)};
}

bool are_numbers(const PlyElement& element, std::string_view name, std::span<const std::string_view> properties,
                 NumberType::Kind kind) {
  return element.name == name && element.properties.size() == properties.size() &&
         std::ranges::equal(element.properties, properties,
                            [&](const PlyProperty& property, std::string_view expected) {
                              return property.name == expected && !property.length && property.type.kind == kind &&
                                     property.type.bytes == kNumberBytes;
                            });
}

class PackedPly {
 public:
  PackedPly(const PartSource& source, const PlyFile& ply)
      : file_(source.file),
        bytes_(reinterpret_cast<const std::uint8_t*>(ply.text.data()), ply.text.size()),
        at_(ply.body),
        chunks_(ply.elements[0].count),
        splats_(ply.elements[1].count),
        limits_(ply.elements[0].properties.size()),
        has_harmonics_(ply.elements.size() > 2) {}

  ImportedScene read() const {
    check_splat_count(file_, splats_);
    const std::size_t chunks = (splats_ - 1) / kSplatsOfChunk + 1;
    if (chunks_ != chunks) {
      fail_at({.file = file_.string()}, "has " + std::to_string(chunks_) + " chunks, expected " +
                                            std::to_string(chunks) + ": one for each 256 splats");
    }
    const std::size_t body = kNumberBytes * (chunks_ * limits_ + splats_ * kNumbers.size());
    if (body > bytes_.size() - at_) fail_at({.file = file_.string()}, "ends too early");
    ImportedScene scene = splats();
    if (has_harmonics_) {
      scene.warnings.push_back(file_.string() +
                               ": spherical harmonics of degree 1 and above are left out; save the file as SPZ to keep "
                               "them");
    }
    return scene;
  }

 private:
  PointColumn column(std::size_t before, NumberType::Kind kind) const {
    return {bytes_.data() + at_ + kNumberBytes * before, kNumberBytes, {kind, kNumberBytes}};
  }

  // Between the least and the largest three values of a chunk.
  glm::dvec3 between(std::size_t chunk, std::size_t limits, const glm::dvec3& shares) const {
    const PointColumn numbers = column(chunk * limits_ + limits, NumberType::Kind::real);
    const auto three = [&](std::size_t first) {
      return glm::dvec3(numbers.at(first), numbers.at(first + 1), numbers.at(first + 2));
    };
    const glm::dvec3 low = three(0);
    return low + shares * (three(3) - low);
  }

  // Two bits say which of w, x, y, z is the largest and is left out; the others are within sqrt(1/2).
  static glm::dvec4 unpack_rotation(std::uint32_t number) {
    std::array<double, 4> q{};
    const std::size_t largest = number >> 30;
    unsigned first_bit = 30;
    double rest = 1;
    for (std::size_t i = 0; i < q.size(); ++i) {
      if (i == largest) continue;
      first_bit -= 10;
      q[i] = (share(number, first_bit, 10) - 0.5) * std::numbers::sqrt2;
      rest -= q[i] * q[i];
    }
    q[largest] = std::sqrt(std::max(0.0, rest));
    return glm::normalize(glm::dvec4(q[1], q[2], q[3], q[0]));
  }

  ImportedScene splats() const {
    const auto cloud = std::make_shared<SplatCloud>();
    std::size_t left_out = 0;
    const PointColumn numbers = column(chunks_ * limits_, NumberType::Kind::natural);
    for (std::size_t i = 0; i < splats_; ++i) {
      const auto number = [&](Number which) { return numbers.bits_at(i * kNumbers.size() + which); };
      const std::size_t chunk = i / kSplatsOfChunk;
      Splat splat;
      splat.center = glm::vec3(between(chunk, kPlaces, three_shares(number(place))));
      splat.sigma = glm::vec3(glm::exp(between(chunk, kScales, three_shares(number(scale)))));
      splat.rotation = glm::vec4(unpack_rotation(number(rotation)));
      splat.opacity = static_cast<float>(share(number(color), 0, 8));
      glm::dvec3 seen(share(number(color), 24, 8), share(number(color), 16, 8), share(number(color), 8, 8));
      if (limits_ > kColors) seen = between(chunk, kColors, seen);
      const auto is_finite = [](const glm::dvec3& v) { return std::isfinite(v.x + v.y + v.z); };
      const glm::vec3 harmonic((seen - 0.5) / kHarmonicOfDegree0);
      if (!is_finite(splat.center) || !is_finite(splat.sigma) || splat.sigma == glm::vec3(0) ||
          !is_harmonic(harmonic)) {
        ++left_out;
        continue;
      }
      cloud->splats.push_back(splat);
      cloud->harmonics.push_back(harmonic);
    }
    return splat_scene(file_, cloud, left_out);
  }

  static constexpr double kHarmonicOfDegree0 = 0.28209479177387814;  // sqrt(1 / 4 pi)

  std::filesystem::path file_;
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0, chunks_ = 0, splats_ = 0, limits_ = 0;
  bool has_harmonics_ = false;
};

}  // namespace

bool is_packed_ply(const PlyFile& ply) {
  const std::vector<PlyElement>& elements = ply.elements;
  if (ply.encoding != PlyEncoding::little_endian || elements.size() < 2 || elements.size() > 3) return false;
  const std::size_t limits = elements[0].properties.size();
  return (limits == kLimits.size() || limits == kLimitsWithoutColor) &&
         are_numbers(elements[0], "chunk", std::span(kLimits).first(limits), NumberType::Kind::real) &&
         are_numbers(elements[1], "vertex", kNumbers, NumberType::Kind::natural) &&
         (elements.size() == 2 || elements[2].name == "sh");
}

ImportedScene read_packed_ply(const PartSource& source, const PlyFile& ply) { return PackedPly(source, ply).read(); }

}  // namespace simvis
