#include <lzf.h>
#include <strings.h>

#include <algorithm>
#include <bit>
#include <optional>
#include <string>
#include <string_view>

#include <simvis/attributes.h>
#include <simvis/location.h>
#include <simvis/size_product.h>
#include "engine/base/input_file.h"
#include "engine/base/words.h"
#include "import/programs/clouds/cloud_files.h"
#include "import/programs/clouds/text_points.h"

namespace simvis {
namespace {

struct PcdField {
  std::string_view name;
  NumberType type{};
  std::size_t count = 1;               // numbers
  std::size_t number = 0, offset = 0;  // the numbers and the bytes of a point before it
};

class PcdFile {
 public:
  explicit PcdFile(const std::filesystem::path& file)
      : file_(file),
        bytes_(read_whole_file(file)),
        text_(reinterpret_cast<const char*>(bytes_.data()), bytes_.size()) {}

  ImportedScene read() {
    read_header();
    place_fields();
    check_point_count(file_, count_);
    if (data_ == "ascii") return read_text();
    if (data_ == "binary") return read_binary();
    return read_compressed();
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    fail_at({.file = file_.string(), .line = line_}, message);
  }
  [[noreturn]] void ends_early() const {
    fail_at({.file = file_.string()}, "ends too early: its header claims " + std::to_string(count_) + " points");
  }

  std::size_t natural(std::string_view word) const {
    const std::optional<std::size_t> value = as_number<std::size_t>(word);
    if (!value) fail("has " + in_quotes(word) + ", expected a whole number");
    return *value;
  }

  void read_header() {
    while (data_.empty()) {
      if (at_ >= text_.size()) fail("the file ends in its header, expected DATA");
      std::vector<std::string_view> words = words_of(line_of(text_, at_));
      ++line_;
      if (words.empty() || words[0].starts_with('#')) continue;
      const std::string_view key = words[0];
      words.erase(words.begin());
      read_line(key, words);
    }
    count_ = points_ ? *points_ : size_product({width_, height_});
  }

  void read_line(std::string_view key, const std::vector<std::string_view>& words) {
    if (key == "FIELDS" || key == "COLUMNS") {
      for (const std::string_view name : words) fields_.push_back({.name = name});
    } else if (key == "SIZE") {
      read_row(key, words, [this](PcdField& field, std::string_view word) { field.type.bytes = size_of(word); });
    } else if (key == "TYPE") {
      read_row(key, words, [this](PcdField& field, std::string_view word) { field.type.kind = kind_of(word); });
    } else if (key == "COUNT") {
      read_row(key, words, [this](PcdField& field, std::string_view word) { field.count = count_of(word); });
    } else if (key == "WIDTH") {
      width_ = own_number(key, words);
    } else if (key == "HEIGHT") {
      height_ = own_number(key, words);
    } else if (key == "POINTS") {
      points_ = own_number(key, words);
    } else if (key == "DATA") {
      data_ = data_of(words);
    } else if (key != "VERSION" && key != "VIEWPOINT") {
      fail("the header has a line that is not understood, beginning with " + in_quotes(key));
    }
  }

  std::size_t own_number(std::string_view key, const std::vector<std::string_view>& words) const {
    if (words.size() != 1) fail(std::string(key) + " has no number of its own");
    return natural(words[0]);
  }

  std::string_view data_of(const std::vector<std::string_view>& words) const {
    constexpr std::string_view kKinds[] = {"ascii", "binary", "binary_compressed"};
    if (words.size() == 1 && std::ranges::count(kKinds, words[0]) > 0) return words[0];
    fail("has DATA of another kind, expected ascii, binary or binary_compressed");
  }

  // A row of the header has a word for each field.
  template <class Set>
  void read_row(std::string_view key, const std::vector<std::string_view>& words, const Set& set) {
    if (words.size() != fields_.size()) {
      fail(std::string(key) + " has " + std::to_string(words.size()) + " words, expected " +
           std::to_string(fields_.size()) + " as FIELDS");
    }
    for (std::size_t i = 0; i < words.size(); ++i) set(fields_[i], words[i]);
  }

  NumberType::Kind kind_of(std::string_view word) const {
    if (word == "F") return NumberType::Kind::real;
    if (word == "I") return NumberType::Kind::whole;
    if (word == "U") return NumberType::Kind::natural;
    fail("has the type " + in_quotes(word) + ", expected F, I or U");
  }

  std::size_t count_of(std::string_view word) const {
    constexpr std::size_t kMaxCount = 1 << 20;
    const std::size_t count = natural(word);
    if (count > kMaxCount) fail("has a field of " + std::string(word) + " numbers");
    return count;
  }

  unsigned size_of(std::string_view word) const {
    const std::size_t size = natural(word);
    if (size == 1 || size == 2 || size == 4 || size == 8) return static_cast<unsigned>(size);
    fail("has the size " + in_quotes(word) + ", expected 1, 2, 4 or 8");
  }

  void place_fields() {
    for (PcdField& field : fields_) {
      if (field.type.kind == NumberType::Kind::real && field.type.bytes < 4) {
        fail("field " + in_quotes(field.name) + " is a real number of " + std::to_string(field.type.bytes) +
             " bytes, expected 4 or 8");
      }
      field.number = numbers_;
      field.offset = stride_;
      numbers_ += field.count;
      stride_ += field.count * field.type.bytes;
      constexpr std::size_t kMaxPointBytes = std::size_t{1} << 24;
      if (stride_ > kMaxPointBytes) fail("has points of more than " + std::to_string(kMaxPointBytes) + " bytes");
    }
    for (const std::string_view axis : {"x", "y", "z"}) {
      if (find(axis) == nullptr) fail("has no field " + std::string(axis) + ", expected FIELDS x y z");
    }
  }

  // Some programs write X, Y, Z and Red.
  const PcdField* find(std::string_view name) const {
    const auto found = std::ranges::find_if(fields_, [&](const PcdField& field) {
      return field.name.size() == name.size() && ::strncasecmp(field.name.data(), name.data(), name.size()) == 0;
    });
    return found != fields_.end() && found->count > 0 ? &*found : nullptr;
  }

  // `column` gives that of a field.
  template <class Column>
  ImportedScene scene_of(const Column& column) const {
    PointColumns columns = named_columns(file_, count_, [&](std::string_view name) { return find(name); }, column,
                                         {"normal_x", "normal_y", "normal_z"});
    for (const std::string_view name : {"rgb", "rgba"}) {
      const PcdField* const packed = find(name);
      if (packed != nullptr && packed->type.bytes == 4) columns.packed_color = column(*packed);
    }
    const PcdField* const colors[] = {find("red"), find("green"), find("blue")};
    if (!columns.packed_color && std::ranges::none_of(colors, [](const PcdField* color) { return color == nullptr; })) {
      for (const PcdField* const color : colors) columns.color.push_back(column(*color));
      fit_color_range(columns);
    }
    if (const PcdField* const intensity = find("intensity")) columns.intensity = column(*intensity);
    return cloud_scene(columns);
  }

  // Colours are written as the whole number, or as the real number of the same bits.
  ImportedScene read_text() const {
    std::vector<double> numbers = read_text_points(file_, text_, at_, line_, count_, numbers_);
    return scene_of([&](const PcdField& field) {
      if (field.name == "rgb" && field.type.kind == NumberType::Kind::real) {
        for (std::size_t i = field.number; i < numbers.size(); i += numbers_) {
          numbers[i] = std::bit_cast<std::uint32_t>(static_cast<float>(numbers[i]));
        }
      }
      return text_column(numbers, numbers_, field.number);
    });
  }

  ImportedScene read_binary() const {
    if (stride_ == 0 || count_ > (bytes_.size() - at_) / stride_) ends_early();
    return scene_of([&](const PcdField& field) {
      return PointColumn{bytes_.data() + at_ + field.offset, stride_, field.type};
    });
  }

  // The numbers of a field of all points stand together.
  ImportedScene read_compressed() const {
    constexpr std::size_t kSizes = 8;
    if (bytes_.size() - at_ < kSizes) ends_early();
    constexpr NumberType kSize{NumberType::Kind::natural, 4};
    const auto size = [&](std::size_t at) {
      return static_cast<std::size_t>(PointColumn{bytes_.data() + at_ + at, 0, kSize}.at(0));
    };
    const std::size_t compressed = size(0), expected = size(4);
    if (compressed > bytes_.size() - at_ - kSizes) ends_early();
    const std::size_t needed = size_product({count_, stride_});
    if (expected != needed) {
      fail_at({.file = file_.string()}, "has " + std::to_string(expected) + " bytes of points, expected " +
                                            std::to_string(needed) + " as its header says");
    }
    // A run of LZF stands for at most 264 bytes, so that a wrong size costs no memory.
    constexpr std::size_t kMaxRun = 264;
    Bytes data(expected / kMaxRun <= compressed ? expected : 0);
    if (data.empty() || lzf_decompress(&bytes_[at_ + kSizes], static_cast<unsigned>(compressed), data.data(),
                                       static_cast<unsigned>(expected)) != expected) {
      fail_at({.file = file_.string()}, "has compressed points that are broken");
    }
    return scene_of([&](const PcdField& field) {
      return PointColumn{data.data() + field.offset * count_, field.count * field.type.bytes, field.type};
    });
  }

  std::filesystem::path file_;
  Bytes bytes_;
  std::string_view text_, data_;
  std::vector<PcdField> fields_;
  std::size_t width_ = 0, height_ = 1;
  std::optional<std::size_t> points_;
  std::size_t at_ = 0, count_ = 0, numbers_ = 0, stride_ = 0;
  int line_ = 0;
};

}  // namespace

ImportedScene read_pcd(const std::filesystem::path& file) { return PcdFile(file).read(); }

}  // namespace simvis
