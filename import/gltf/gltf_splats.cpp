#include "import/gltf/gltf_splats.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "import/gltf/gltf_accessors.h"
#include "import/gltf/gltf_hierarchy.h"

namespace simvis {
namespace {

constexpr const char* kExtension = "KHR_gaussian_splatting";
constexpr unsigned kRotationFormats = kGltfF32 | kGltfI8n | kGltfI16n;
constexpr unsigned kScaleFormats = kGltfF32 | kGltfU8 | kGltfU8n | kGltfU16 | kGltfU16n;
constexpr unsigned kOpacityFormats = kGltfF32 | kGltfU8n | kGltfU16n;

std::string attribute(const std::string& name) { return std::string(kExtension) + ':' + name; }

std::string text_of(const tinygltf::Value& extension, const char* name, const char* otherwise) {
  const bool is_there = extension.IsObject() && extension.Has(name) && extension.Get(name).IsString();
  return is_there ? extension.Get(name).Get<std::string>() : otherwise;
}

GltfFloats read(const GltfDocument& document, const tinygltf::Primitive& source, const std::string& name,
                std::span<const int> types, unsigned formats, std::size_t vertices) {
  const auto found = source.attributes.find(attribute(name));
  if (found == source.attributes.end()) {
    document.fail("has Gaussian splats without the attribute " + attribute(name));
  }
  // A compression that is not known.
  if (!has_data(document, found->second)) {
    document.fail("has Gaussian splats without the data of " + attribute(name) + "; save the file without compression");
  }
  return read_vertex_floats(document, found->second, {found->first.c_str(), types, formats}, vertices);
}

std::string harmonic(std::uint32_t degree, std::uint32_t coefficient) {
  return "SH_DEGREE_" + std::to_string(degree) + "_COEF_" + std::to_string(coefficient);
}

// The highest degree of which there is a coefficient.
std::uint32_t degree_of(const tinygltf::Primitive& source) {
  for (std::uint32_t degree = kMaxHarmonicsDegree; degree > 0; --degree) {
    for (std::uint32_t i = 0; i <= 2 * degree; ++i) {
      if (source.attributes.count(attribute(harmonic(degree, i))) != 0) return degree;
    }
  }
  return 0;
}

struct SplatFloats {
  GltfFloats rotation, scale, opacity;
};

std::optional<Splat> splat_at(const SplatFloats& floats, const glm::vec3& center, std::size_t i) {
  const float *const q = floats.rotation[i], *const s = floats.scale[i], opacity = *floats.opacity[i];
  const auto rotation = unit_quaternion({q[0], q[1], q[2], q[3]});
  const glm::vec3 sigma(s[0], s[1], s[2]);
  if (!rotation || !(opacity >= 0 && opacity <= 1)) return {};
  if (!(sigma.x >= 0 && sigma.y >= 0 && sigma.z >= 0) || sigma == glm::vec3(0)) return {};
  return Splat{.center = center, .sigma = sigma, .rotation = glm::vec4(*rotation), .opacity = opacity};
}

}  // namespace

bool has_known_splats(GltfDocument& document, const tinygltf::Primitive& source) {
  const auto found = source.extensions.find(kExtension);
  if (found == source.extensions.end()) return false;
  const tinygltf::Value& extension = found->second;
  const std::string color_space = text_of(extension, "colorSpace", "");
  const auto as_points = [&](const std::string& what) {
    document.warn("Gaussian splats " + what + " are taken as points");
    return false;
  };
  if (text_of(extension, "kernel", "") != "ellipse") return as_points("with another kernel than \"ellipse\"");
  if (color_space != "srgb_rec709_display" && color_space != "lin_rec709_display") {
    return as_points("with another colorSpace than \"srgb_rec709_display\" and \"lin_rec709_display\"");
  }
  if (text_of(extension, "projection", "perspective") != "perspective") {
    return as_points("with another projection than \"perspective\"");
  }
  if (source.mode != TINYGLTF_MODE_POINTS) document.fail("has Gaussian splats that are no points; expected mode 0");
  return true;
}

std::shared_ptr<const SplatCloud> read_splats(GltfDocument& document, const tinygltf::Primitive& source,
                                              std::span<const glm::vec3> centers) {
  if (centers.size() > kMaxSplats) {
    document.fail("has a primitive of " + std::to_string(centers.size()) + " Gaussian splats, expected at most " +
                  std::to_string(kMaxSplats));
  }
  const auto cloud = std::make_shared<SplatCloud>();
  const bool is_linear = text_of(source.extensions.at(kExtension), "colorSpace", "") == "lin_rec709_display";
  cloud->encoding = is_linear ? SplatEncoding::linear : SplatEncoding::srgb;
  cloud->degree = degree_of(source);
  const auto floats_of = [&](const std::string& name, std::span<const int> types, unsigned formats) {
    return read(document, source, name, types, formats, centers.size());
  };
  const SplatFloats floats{.rotation = floats_of("ROTATION", kGltfVec4, kRotationFormats),
                           .scale = floats_of("SCALE", kGltfVec3, kScaleFormats),
                           .opacity = floats_of("OPACITY", kGltfScalar, kOpacityFormats)};
  std::vector<GltfFloats> harmonics;
  for (std::uint32_t degree = 0; degree <= cloud->degree; ++degree) {
    for (std::uint32_t i = 0; i <= 2 * degree; ++i) {
      harmonics.push_back(floats_of(harmonic(degree, i), kGltfVec3, kGltfF32));
    }
  }
  for (std::size_t i = 0; i < centers.size(); ++i) {
    const std::optional<Splat> splat = splat_at(floats, centers[i], i);
    const std::size_t before = cloud->harmonics.size();
    for (const GltfFloats& rgb : harmonics) cloud->harmonics.emplace_back(rgb[i][0], rgb[i][1], rgb[i][2]);
    if (splat && std::all_of(cloud->harmonics.begin() + static_cast<std::ptrdiff_t>(before), cloud->harmonics.end(),
                             is_harmonic)) {
      cloud->splats.push_back(*splat);
    } else {
      cloud->harmonics.resize(before);
    }
  }
  if (const std::size_t left_out = centers.size() - cloud->splats.size(); left_out > 0) {
    document.warn(std::to_string(left_out) +
                  " Gaussian splats are left out, whose opacity, scale, rotation or colour is not allowed");
  }
  return cloud;
}

}  // namespace simvis
