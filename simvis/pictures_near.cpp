#include <simvis/pictures_near.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>
#include <vector>

#include "engine/base/output_target.h"
#include "engine/base/temporary_file.h"
#include "scenegraph/pictures/png_bytes.h"
#include "scenegraph/pictures/png_file.h"

namespace simvis::test_kit {
namespace {

constexpr int kGreyPerCode = 16;

std::string pixel_text(std::span<const std::uint8_t> codes, std::size_t pixel) {
  std::string text;
  for (std::size_t c = 0; c < 3; ++c) text += (c == 0 ? "(" : ", ") + std::to_string(codes[3 * pixel + c]);
  return text + ")";
}

void write_difference(const std::filesystem::path& named, const ColorCodes& shape, const std::vector<int>& apart) {
  std::vector<std::uint8_t> grey(apart.size());
  std::ranges::transform(apart, grey.begin(),
                         [](int codes) { return static_cast<std::uint8_t>(std::min(codes * kGreyPerCode, 255)); });
  replace_file(regular_target(named), named,
               png_bytes({.width = shape.width, .height = shape.height, .bits = 8, .channels = 1}, grey));
}

}  // namespace

Verdict pictures_near(const Image& one, const Image& other, int codes, double share,
                      const std::filesystem::path& difference) {
  if (one.channels != 4 || other.channels != 4) return {false, "the pictures are no colour images"};
  const std::vector<std::uint8_t> a = srgb_codes(one), b = srgb_codes(other);
  return pictures_near(ColorCodes{one.width, one.height, a}, ColorCodes{other.width, other.height, b}, codes, share,
                       difference);
}

Verdict pictures_near(const ColorCodes& one, const ColorCodes& other, int codes, double share,
                      const std::filesystem::path& difference) {
  if (one.width != other.width || one.height != other.height || one.width == 0 || one.height == 0) {
    return {false, "the pictures have different sizes, or no pixels"};
  }
  const std::span<const std::uint8_t> a = one.codes, b = other.codes;
  std::vector<int> apart(a.size() / 3);
  for (std::size_t i = 0; i < a.size(); ++i) apart[i / 3] = std::max(apart[i / 3], std::abs(int{a[i]} - int{b[i]}));
  const auto wrong = std::ranges::count_if(apart, [codes](int each) { return each > codes; });
  const double allowed = share * static_cast<double>(apart.size());
  const auto most = static_cast<std::size_t>(std::ranges::max_element(apart) - apart.begin());
  Verdict verdict{static_cast<double>(wrong) <= allowed,
                  std::to_string(wrong) + " of " + std::to_string(apart.size()) + " pixels differ by more than " +
                      std::to_string(codes) + " codes, allowed " + std::to_string(static_cast<std::int64_t>(allowed)) +
                      "; most: pixel (" + std::to_string(most % one.width) + ", " + std::to_string(most / one.width) +
                      "), " + pixel_text(a, most) + " and " + pixel_text(b, most)};
  if (!verdict.ok && !difference.empty()) {
    write_difference(difference, one, apart);
    verdict.text += "; see " + difference.string();
  }
  return verdict;
}

}  // namespace simvis::test_kit
