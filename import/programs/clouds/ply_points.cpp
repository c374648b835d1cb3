#include <algorithm>
#include <charconv>
#include <string>
#include <string_view>

#include <simvis/location.h>
#include "import/programs/clouds/cloud_files.h"
#include "import/programs/clouds/splat_columns.h"
#include "import/programs/clouds/text_points.h"

namespace simvis {
namespace {

struct PlyNumber {
  std::string_view name, alias;
  NumberType type;
};
constexpr PlyNumber kPlyNumbers[] = {
    {"char", "int8", {NumberType::Kind::whole, 1}},    {"uchar", "uint8", {NumberType::Kind::natural, 1}},
    {"short", "int16", {NumberType::Kind::whole, 2}},  {"ushort", "uint16", {NumberType::Kind::natural, 2}},
    {"int", "int32", {NumberType::Kind::whole, 4}},    {"uint", "uint32", {NumberType::Kind::natural, 4}},
    {"float", "float32", {NumberType::Kind::real, 4}}, {"double", "float64", {NumberType::Kind::real, 8}}};

struct PlyProperty {
  std::string_view name;
  NumberType type;
  std::size_t offset = 0;  // bytes of a point before it
};

class PlyPoints {
 public:
  PlyPoints(const std::filesystem::path& file, std::span<const std::uint8_t> bytes)
      : file_(file), bytes_(bytes), text_(reinterpret_cast<const char*>(bytes_.data()), bytes_.size()) {}

  std::optional<ImportedScene> read() {
    if (!read_header()) return {};
    if (has_splats()) {
      check_splat_count(file_, count_);
    } else {
      check_point_count(file_, count_);
    }
    if (format_ == "ascii") {
      const std::vector<double> numbers = read_text_points(file_, text_, at_, line_, count_, properties_.size());
      return scene_of([&](const PlyProperty& property) {
        return text_column(numbers, properties_.size(), static_cast<std::size_t>(&property - properties_.data()));
      });
    }
    if (count_ > (bytes_.size() - at_) / stride_) {
      fail_at({.file = file_.string()}, "ends too early: its header claims " + std::to_string(count_) + " points");
    }
    return scene_of([&](const PlyProperty& property) {
      PointColumn column{bytes_.data() + at_ + property.offset, stride_, property.type};
      column.type.big_endian = format_ == "binary_big_endian";
      return column;
    });
  }

 private:
  // Returns whether the file is points alone, by a header without anything odd: check_ply() names what is wrong.
  bool read_header() {
    if (!text_.starts_with("ply")) return false;
    std::size_t elements = 0;
    line_of(text_, at_);
    line_ = 1;
    while (at_ < text_.size()) {
      const std::vector<std::string_view> words = words_in(line_of(text_, at_));
      ++line_;
      if (words.empty()) return false;
      if (words[0] == "end_header") return has_place() && find("alpha") == nullptr && has_format();
      if (words[0] == "comment" || words[0] == "obj_info") continue;
      if (words[0] == "format" && words.size() == 3) {
        format_ = words[1];
      } else if (words[0] == "element" && words.size() == 3) {
        if (++elements > 1 || words[1] != "vertex" || !read_count(words[2])) return false;
      } else if (words[0] != "property" || words.size() != 3 || elements == 0 || !add_property(words)) {
        return false;
      }
    }
    return false;
  }

  bool has_format() const {
    return format_ == "ascii" || format_ == "binary_little_endian" || format_ == "binary_big_endian";
  }

  bool read_count(std::string_view word) {
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), count_);
    return error == std::errc() && end == word.data() + word.size();
  }

  bool add_property(const std::vector<std::string_view>& words) {
    const auto type = std::ranges::find_if(
        kPlyNumbers, [&](const PlyNumber& number) { return number.name == words[1] || number.alias == words[1]; });
    if (type == std::end(kPlyNumbers) || find(words[2]) != nullptr) return false;
    properties_.push_back({words[2], type->type, stride_});
    stride_ += type->type.bytes;
    return true;
  }

  const PlyProperty* find(std::string_view name) const {
    const auto found = std::ranges::find(properties_, name, &PlyProperty::name);
    return found != properties_.end() ? &*found : nullptr;
  }

  bool has_place() const {
    return std::ranges::all_of(std::array<std::string_view, 3>{"x", "y", "z"}, [&](std::string_view axis) {
      const PlyProperty* const found = find(axis);
      return found != nullptr && found->type.kind == NumberType::Kind::real;
    });
  }

  // What the program of Kerbl et al. 2023 writes, and others after it.
  bool has_splats() const {
    return std::ranges::all_of(std::array<std::string_view, 4>{"f_dc_0", "opacity", "scale_0", "rot_0"},
                               [&](std::string_view name) { return find(name) != nullptr; });
  }

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
    if (has_splats()) return splats_of(column);
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
      const NumberType& type = channels[0]->type;
      columns.color_range = type.kind == NumberType::Kind::real ? 1 : type.bytes == 1 ? 255 : 65535;
    }
    for (const std::string_view name : {"intensity", "scalar_Intensity"}) {
      if (const PlyProperty* const intensity = find(name)) columns.intensity = column(*intensity);
    }
    return cloud_scene(columns);
  }

  std::filesystem::path file_;
  std::span<const std::uint8_t> bytes_;
  std::string_view text_, format_;
  std::vector<PlyProperty> properties_;
  std::size_t at_ = 0, count_ = 0, stride_ = 0;
  int line_ = 0;
};

}  // namespace

std::optional<ImportedScene> read_ply_points(const std::filesystem::path& file, std::span<const std::uint8_t> bytes) {
  return PlyPoints(file, bytes).read();
}

}  // namespace simvis
