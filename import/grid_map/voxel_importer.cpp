// Imports voxel grids in archives of NumPy (.npz), as --export writes them: occupied cells become walls. The arrays:
//
//   cells         [x, y, z] of bool, int8 or uint8: a cell is occupied where the number is above 0
//   resolution_m  the side of a cell in metres
//   origin_m      x, y, z of the lowest corner of the first cell; without this array 0
//
// Arrays are in the format of numpy.lib.format, versions 1 and 2.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/gtc/matrix_transform.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/location.h>
#include <simvis/part_importer.h>
#include <simvis/pose.h>
#include "engine/base/binary_numbers.h"
#include "engine/base/input_file.h"
#include "engine/base/words.h"
#include "import/grid_map/grid_part.h"
#include "import/mesh/zip_archive.h"

namespace simvis {
namespace {

// An array of an archive. Its header is foreign: each number in it is checked.
class NumpyArray {
 public:
  NumpyArray(const std::filesystem::path& file, std::string name, Bytes bytes)
      : file_(file), name_(std::move(name)), bytes_(std::move(bytes)) {
    constexpr std::size_t kPrefix = 8, kShort = 2, kLong = 4;
    const std::string_view text(reinterpret_cast<const char*>(bytes_.data()), bytes_.size());
    if (!text.starts_with("\x93NUMPY") || bytes_.size() < kPrefix + kLong) fail("is no array of NumPy");
    const bool is_short = bytes_[6] == 1;
    const std::size_t length =
        is_short ? binary_at<std::uint16_t>(bytes_, kPrefix) : std::size_t{binary_at<std::uint32_t>(bytes_, kPrefix)};
    data_ = kPrefix + (is_short ? kShort : kLong);
    if (length > bytes_.size() - data_) fail("has a header that is cut off");
    read_header(text.substr(data_, length));
    data_ += length;
  }

  const std::vector<std::uint64_t>& shape() const { return shape_; }
  bool is_column_major() const { return is_column_major_; }

  // The bytes of an array whose numbers have one byte each.
  std::span<const std::uint8_t> small_numbers(std::size_t count) const {
    if (type_ != "|b1" && type_ != "|i1" && type_ != "|u1") {
      fail("has numbers of the type " + in_quotes(type_) + ", expected bool, int8 or uint8");
    }
    require(count);
    return {bytes_.data() + data_, count};
  }
  bool is_signed() const { return type_ == "|i1"; }

  std::vector<double> numbers(std::size_t count) const {
    if (type_ == "<f8") return numbers_of<double>(count);
    if (type_ == "<f4") return numbers_of<float>(count);
    if (type_ == "<i8") return numbers_of<std::int64_t>(count);
    if (type_ == "<i4") return numbers_of<std::int32_t>(count);
    fail("has numbers of the type " + in_quotes(type_) + ", expected float64, float32, int64 or int32");
  }

  [[noreturn]] void fail(const std::string& what) const {
    fail_at({.file = file_.string()}, "array " + in_quotes(name_) + " " + what);
  }

 private:
  template <typename Number>
  std::vector<double> numbers_of(std::size_t count) const {
    require(count * sizeof(Number));
    std::vector<double> numbers;
    for (std::size_t i = 0; i < count; ++i) {
      numbers.push_back(static_cast<double>(binary_at<Number>(bytes_, data_ + i * sizeof(Number))));
    }
    return numbers;
  }

  void require(std::size_t bytes) const {
    if (bytes_.size() - data_ != bytes) {
      fail("has " + std::to_string(bytes_.size() - data_) + " bytes, expected " + std::to_string(bytes) +
           " for its shape");
    }
  }

  // {'descr': '|i1', 'fortran_order': False, 'shape': (3, 4, 5), }
  void read_header(std::string_view header) {
    type_ = between(header, "'descr':", "'", "'");
    is_column_major_ = trimmed(between(header, "'fortran_order'", ":", ",")) == "True";
    for (const std::string_view size : words_of(between(header, "'shape':", "(", ")"), ", ")) {
      const std::optional<std::uint64_t> number = as_number<std::uint64_t>(size);
      if (!number) fail("has a shape that cannot be read");
      shape_.push_back(*number);
    }
  }

  std::string_view between(std::string_view header, std::string_view key, std::string_view open,
                           std::string_view close) const {
    const std::size_t at = header.find(key);
    const std::size_t first = at == header.npos ? at : header.find(open, at + key.size());
    const std::size_t end = first == header.npos ? first : header.find(close, first + 1);
    if (end == header.npos) fail("has a header without " + std::string(key) + ", expected a plain array");
    return header.substr(first + 1, end - first - 1);
  }

  std::filesystem::path file_;
  std::string name_, type_;
  Bytes bytes_;
  std::size_t data_ = 0;
  bool is_column_major_ = false;
  std::vector<std::uint64_t> shape_;
};

class VoxelFile {
 public:
  explicit VoxelFile(const std::filesystem::path& file) : file_(file), archive_(file, read_whole_file(file)) {}

  PlacedGrid read() const {
    const double cell_m = read_array("resolution_m").numbers(1)[0];
    if (!(cell_m >= kMinCell_m && cell_m <= kMaxCell_m)) {
      fail_at({.file = file_.string()}, "array \"resolution_m\": " + format_number(cell_m) +
                                            " is not allowed, expected metres from 1e-06 to 1000000");
    }
    return {read_cells(), glm::dvec3(cell_m), 1, glm::translate(glm::dmat4(1), read_origin())};
  }

 private:
  NumpyArray read_array(const std::string& name) const {
    const std::string entry = name + ".npy";
    if (!archive_.contains(entry)) {
      fail_at({.file = file_.string()},
              "has no array " + in_quotes(name) + ", expected cells, resolution_m and origin_m of a voxel grid");
    }
    return {file_, name, archive_.read(entry)};
  }

  glm::dvec3 read_origin() const {
    if (!archive_.contains("origin_m.npy")) return glm::dvec3(0);
    const std::vector<double> numbers = read_array("origin_m").numbers(3);
    for (const double number : numbers) {
      if (std::abs(number) <= kMaxCoordinate_m) continue;
      fail_at({.file = file_.string()}, "array \"origin_m\": " + format_number(number) +
                                            " is not allowed, expected metres from -" +
                                            format_number(kMaxCoordinate_m) + " to " + format_number(kMaxCoordinate_m));
    }
    return {numbers[0], numbers[1], numbers[2]};
  }

  CellGrid read_cells() const {
    const NumpyArray array = read_array("cells");
    if (array.shape().size() != 3)
      array.fail("has " + std::to_string(array.shape().size()) + " axes, expected x, y, z");
    if (std::ranges::find(array.shape(), 0u) != array.shape().end()) {
      array.fail("has an axis without cells, expected at least one cell along x, y and z");
    }
    check_grid_size(file_, "has", {array.shape()[0], array.shape()[1], array.shape()[2]});
    const glm::uvec3 size(array.shape()[0], array.shape()[1], array.shape()[2]);
    CellGrid grid(size);
    const std::span<const std::uint8_t> numbers = array.small_numbers(std::size_t{size.x} * size.y * size.z);
    const glm::uvec3 order = array.is_column_major() ? glm::uvec3(0, 1, 2) : glm::uvec3(2, 1, 0);
    std::size_t i = 0;
    glm::uvec3 cell;
    for (cell[order[2]] = 0; cell[order[2]] < size[order[2]]; ++cell[order[2]]) {
      for (cell[order[1]] = 0; cell[order[1]] < size[order[1]]; ++cell[order[1]]) {
        for (cell[order[0]] = 0; cell[order[0]] < size[order[0]]; ++cell[order[0]]) {
          const std::uint8_t number = numbers[i++];
          if (array.is_signed() ? static_cast<std::int8_t>(number) > 0 : number > 0) grid.occupy(cell);
        }
      }
    }
    return grid;
  }

  std::filesystem::path file_;
  ZipArchive archive_;
};

PartContent import_voxels(const ImportRequest& request, ContentPool& pool) {
  return grid_part(request.file, VoxelFile(request.file).read(), pool);
}

const PartImporterRegistration voxel_registration({".npz"}, import_voxels);

}  // namespace
}  // namespace simvis
