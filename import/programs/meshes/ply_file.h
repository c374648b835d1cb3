// The header and the values of a PLY file, for its readers: meshes, points and splats.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "import/programs/clouds/point_columns.h"
#include "import/programs/part_source.h"

namespace simvis {

enum class PlyEncoding { text, little_endian, big_endian };

struct PlyProperty {
  std::string_view name;
  NumberType type{};
  std::optional<NumberType> length{};  ///< of a list: the type of its length
  bool is_used = false;                ///< only numbers of properties that are used must be finite in text
};

struct PlyElement {
  std::string_view name;
  std::uint64_t count = 0;
  int line = 0;  ///< of its declaration
  std::vector<PlyProperty> properties{};

  /// Null if there is none.
  const PlyProperty* find(std::string_view property) const;
};

struct PlyFile {
  std::string_view text;  ///< all bytes of the file
  PlyEncoding encoding = PlyEncoding::text;
  std::vector<PlyElement> elements{};
  std::string_view picture{};  ///< the name behind "comment TextureFile", as VCGLIB writes it
  std::size_t body = 0;        ///< the first byte behind the header
  int lines = 0;               ///< of the header
};

/// Throws InputError with the place for a header that breaks the format, two elements of the same name, and materials.
/// Lines that are not understood are left out, each with a warning. The bytes must outlive the result.
PlyFile read_ply_header(PartSource& source, std::span<const std::uint8_t> bytes);

/// Reads the elements of a file in their order.
class PlyBody {
 public:
  /// `source` and `file` must outlive this object.
  PlyBody(PartSource& source, const PlyFile& file);

  /// The values of the next instance of the element, by property; one if the property is no list. `index` counts the
  /// instances from 0. Valid until the next call. Throws InputError with the line of a text if a value is missing or is
  /// no number of its type.
  const std::vector<std::vector<double>>& next(const PlyElement& element, std::uint64_t index);

  /// Throws InputError "element NAME INDEX MESSAGE" for the instance that was read last.
  [[noreturn]] void fail(const std::string& message) const;

  /// Warns if a text goes on.
  void finish();

 private:
  std::string_view next_line();
  double value(const NumberType& type, bool may_be_no_number);
  double text_value(const NumberType& type, bool may_be_no_number);
  std::uint64_t length_of(const PlyProperty& property);

  PartSource& source_;
  const PlyFile& file_;
  std::size_t at_ = 0, used_ = 0;  // the next byte, and the next word of a line of text
  int line_ = 0;
  bool has_more_ = false;
  std::string_view element_;
  std::uint64_t index_ = 0;
  std::vector<std::string_view> words_;
  std::vector<std::vector<double>> values_;
};

}  // namespace simvis
