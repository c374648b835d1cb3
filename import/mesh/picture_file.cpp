#include "import/mesh/picture_file.h"

#include <string_view>

#include <simvis/error.h>
#include <simvis/location.h>
#include "engine/base/input_file.h"
#include "import/mesh/picture_search.h"
#include "import/mesh/stb_picture.h"
#include "import/sandbox/sandboxed_decode.h"

namespace simvis {

Texture decode_picture(std::span<const std::uint8_t> bytes, const std::string& subject) {
  return is_png_or_jpeg(bytes) ? decode_with_stb(bytes, subject) : decode_picture_in_sandbox(bytes, subject);
}

Texture read_picture_file(const std::filesystem::path& file) {
  return decode_picture(read_whole_file(file), file.string() + ": error: the picture");
}

std::optional<Texture> find_and_read_picture(const std::string& name, const std::filesystem::path& part_file,
                                             std::vector<std::string>& warnings) {
  const PictureSearch search = find_picture(name, part_file);
  const std::string subject = part_file.string() + ": picture " + in_quotes(name);
  if (!search.file) {
    warnings.push_back(subject + " " + search.not_found());
    return std::nullopt;
  }
  try {
    Texture texture = read_picture_file(*search.file);
    if (search.elsewhere) warnings.push_back(subject + " is taken from " + search.file->string());
    return texture;
  } catch (const InputError& error) {
    warnings.push_back(subject + ": the material's colour replaces it, " + without_word_error(error.what()));
    return std::nullopt;
  }
}

std::string without_word_error(std::string message) {
  constexpr std::string_view kWord = ": error: ";
  const std::size_t at = message.find(kWord);
  return at == std::string::npos ? message : message.replace(at, kWord.size(), ": ");
}

}  // namespace simvis
