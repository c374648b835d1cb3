// Messages of files within other messages.
#pragma once

#include <string>
#include <string_view>

namespace simvis {

/// "world.glb: error: no buffers" -> "world.glb: no buffers", for use after another "error:".
inline std::string without_error_word(std::string message) {
  constexpr std::string_view kWord = ": error: ";
  const std::size_t at = message.find(kWord);
  return at == std::string::npos ? message : message.replace(at, kWord.size(), ": ");
}

}  // namespace simvis
