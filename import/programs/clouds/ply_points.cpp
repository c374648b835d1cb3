#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include <simvis/location.h>
#include "import/programs/clouds/cloud_files.h"
#include "import/programs/clouds/splat_columns.h"
#include "import/programs/clouds/text_points.h"

namespace simvis {
namespace {

// What the program of Kerbl et al. 2023 writes, and others after it.
bool has_splats(const PlyElement& vertex) {
  return std::ranges::all_of(std::array<std::string_view, 4>{"f_dc_0", "opacity", "scale_0", "rot_0"},
                             [&](std::string_view name) { return vertex.find(name) != nullptr; });
}

class PlyPoints {
 public:
  PlyPoints(const PartSource& source, const PlyFile& ply)
      : file_(source.file), ply_(ply), vertex_(ply.elements[0]), count_(vertex_.count) {
    for (const PlyProperty& property : vertex_.properties) {
      offsets_.push_back(stride_);
      stride_ += property.type.bytes;
    }
  }

  ImportedScene read() const {
    if (has_splats(vertex_)) {
      check_splat_count(file_, count_);
    } else {
      check_point_count(file_, count_);
    }
    const std::size_t properties = vertex_.properties.size();
    if (ply_.encoding == PlyEncoding::text) {
      const std::vector<double> numbers = read_text_points(file_, ply_.text, ply_.body, ply_.lines, count_, properties);
      return scene_of(
          [&](const PlyProperty& property) { return text_column(numbers, properties, number_of_property(property)); });
    }
    if (count_ > (ply_.text.size() - ply_.body) / stride_) {
      fail_at({.file = file_.string()}, "ends too early: its header claims " + std::to_string(count_) + " points");
    }
    const auto* const first = reinterpret_cast<const std::uint8_t*>(ply_.text.data()) + ply_.body;
    return scene_of([&](const PlyProperty& property) {
      return PointColumn{first + offsets_[number_of_property(property)], stride_, property.type};
    });
  }

 private:
  std::size_t number_of_property(const PlyProperty& property) const {
    return static_cast<std::size_t>(&property - vertex_.properties.data());
  }

  const PlyProperty* find(std::string_view name) const { return vertex_.find(name); }

  template <class Column>
  ImportedScene splats_of(const Column& column) const {
    const auto required = [&](const std::string& name) {
      const PlyProperty* const property = find(name);
      if (property != nullptr) return column(*property);
      fail_at({.file = file_.string()}, "has Gaussian splats without the property \"" + name + "\"");
    };
    SplatColumns columns{.file = file_, .count = count_};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      columns.center[axis] = required(std::string(1, "xyz"[axis]));
      columns.log_sigma[axis] = required("scale_" + std::to_string(axis));
      columns.harmonics.push_back(required("f_dc_" + std::to_string(axis)));
    }
    for (std::size_t i = 0; i < 4; ++i) columns.rotation[i] = required("rot_" + std::to_string(i));
    columns.opacity = required("opacity");
    for (std::size_t i = 0;; ++i) {
      const PlyProperty* const harmonic = find("f_rest_" + std::to_string(i));
      if (harmonic == nullptr) break;
      columns.harmonics.push_back(column(*harmonic));
    }
    return splat_scene(columns);
  }

  template <class Column>
  ImportedScene scene_of(const Column& column) const {
    if (has_splats(vertex_)) return splats_of(column);
    PointColumns columns =
        named_columns(file_, count_, [&](std::string_view name) { return find(name); }, column, {"nx", "ny", "nz"});
    for (const std::string_view prefix : {"", "diffuse_"}) {
      const PlyProperty* channels[3] = {};
      for (std::size_t i = 0; i < 3; ++i) {
        constexpr std::string_view kChannels[] = {"red", "green", "blue"};
        channels[i] = find(std::string(prefix) + std::string(kChannels[i]));
      }
      if (channels[0] == nullptr || channels[1] == nullptr || channels[2] == nullptr || !columns.color.empty())
        continue;
      for (const PlyProperty* const channel : channels) columns.color.push_back(column(*channel));
      columns.color_range = color_range(channels[0]->type);
    }
    for (const std::string_view name : {"intensity", "scalar_Intensity"}) {
      if (const PlyProperty* const intensity = find(name)) columns.intensity = column(*intensity);
    }
    return cloud_scene(columns);
  }

  std::filesystem::path file_;
  const PlyFile& ply_;
  const PlyElement& vertex_;
  std::size_t count_ = 0, stride_ = 0;
  std::vector<std::size_t> offsets_;  // of each property: bytes of a point before it
};

}  // namespace

bool is_ply_of_points(const PlyFile& ply) {
  if (ply.elements.size() != 1 || ply.elements[0].name != "vertex") return false;
  const PlyElement& vertex = ply.elements[0];
  const bool has_place =
      std::ranges::all_of(std::array<std::string_view, 3>{"x", "y", "z"}, [&](std::string_view axis) {
        const PlyProperty* const found = vertex.find(axis);
        return found != nullptr;
      });
  return has_place && vertex.find("alpha") == nullptr &&
         std::ranges::none_of(vertex.properties, [](const PlyProperty& property) { return bool(property.length); });
}

ImportedScene read_ply_points(const PartSource& source, const PlyFile& ply) { return PlyPoints(source, ply).read(); }

}  // namespace simvis
